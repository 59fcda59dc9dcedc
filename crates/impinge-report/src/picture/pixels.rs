//! A finished picture.

use std::io;

/// A picture of pixels without transparency.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    pub(super) size: [u32; 2],
    pub(super) pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Returns width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns red, green and blue of each pixel, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// Returns the picture as a PNG file. The same picture gives the same bytes.
    ///
    /// # Errors
    /// Returns an error if a side is zero pixels long.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        png(self.size, self.pixels.as_flattened())
    }
}

/// Returns red, green and blue bytes, row by row from the top, as a PNG file.
///
/// # Errors
/// Returns an error if a side is zero pixels long, or there are not three bytes for each pixel.
pub fn png([width, height]: [u32; 2], bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(bytes).map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)?;
    Ok(file)
}
