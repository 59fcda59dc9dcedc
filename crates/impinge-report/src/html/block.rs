//! A block of data in a page: deflated, in base64, in a script element that browsers do not run.

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::DeflateEncoder;

/// Writes a block with an identity, which the page looks up.
pub(super) fn write_block(out: &mut dyn Write, id: &str, bytes: &[u8]) -> io::Result<()> {
    writeln!(out, "<script type=\"application/octet-stream\" id=\"{id}\">")?;
    let mut deflate = DeflateEncoder::new(EncoderWriter::new(&mut *out, &STANDARD), Compression::default());
    deflate.write_all(bytes)?;
    deflate.finish()?.finish()?;
    out.write_all(b"\n</script>\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine;
    use std::io::Read;

    #[test]
    fn a_block_is_read_back() {
        let bytes: Vec<u8> = (0..100_000_u32).map(|at| (at.wrapping_mul(at) >> 3) as u8).collect();
        let mut page = Vec::new();
        write_block(&mut page, "name", &bytes).unwrap();
        let page = String::from_utf8(page).unwrap();
        let text = page.lines().nth(1).unwrap();
        assert_eq!(page.lines().next(), Some("<script type=\"application/octet-stream\" id=\"name\">"));
        let deflated = STANDARD.decode(text).unwrap();
        let mut back = Vec::new();
        flate2::read::DeflateDecoder::new(&deflated[..]).read_to_end(&mut back).unwrap();
        assert_eq!(back, bytes);
    }
}
