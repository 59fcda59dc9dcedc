//! The blocks of data of a page.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Returns the bytes of a block.
pub(crate) fn block(page: &str, id: &str) -> Vec<u8> {
    let head = format!("<script type=\"application/octet-stream\" id=\"{id}\">");
    let (_, rest) = page.split_once(&head).unwrap();
    let (text, _) = rest.split_once("</script>").unwrap();
    let deflated = STANDARD.decode(text.trim()).unwrap();
    let mut bytes = Vec::new();
    flate2::read::DeflateDecoder::new(&deflated[..]).read_to_end(&mut bytes).unwrap();
    bytes
}
