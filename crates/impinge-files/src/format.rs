//! File formats, and how they are detected by extension and by content.

use std::fmt;

use crate::text::{trim_start, without_bom};

/// A file format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// STL, binary or ASCII.
    Stl,
    /// PLY, the Stanford polygon format, ASCII or binary.
    Ply,
    /// OFF, the object file format of Geomview, ASCII or binary.
    Off,
    /// glTF 2.0 as JSON.
    Gltf,
    /// glTF 2.0 in its binary container.
    Glb,
    /// 3MF, the 3D manufacturing format.
    ThreeMf,
    /// COLLADA 1.4 or 1.5.
    Collada,
    /// A mesh that was baked with its hierarchy ([`Baked`](crate::Baked)).
    Baked,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 9] =
        [Self::Obj, Self::Stl, Self::Ply, Self::Off, Self::Gltf, Self::Glb, Self::ThreeMf, Self::Collada, Self::Baked];

    /// Returns the extension of files in this format, in lower case and without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Off => "off",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::ThreeMf => "3mf",
            Self::Collada => "dae",
            Self::Baked => "impinge",
        }
    }

    /// Returns the format with this extension, in any case. Returns `None` if no format has it.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.extension().eq_ignore_ascii_case(extension))
    }

    /// Returns the format that the bytes prove, by a signature or by the length of a binary STL
    /// file. Returns `None` if they prove no format: OBJ has no signature, and ASCII STL has one
    /// only if a facet or `endsolid` follows the line of `solid`. A gzip file proves no format
    /// until it is unpacked.
    #[must_use]
    pub fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(&crate::baked::MAGIC) {
            return Some(Self::Baked);
        }
        if bytes.starts_with(b"glTF") {
            return Some(Self::Glb);
        }
        if bytes.starts_with(b"PK\x03\x04") {
            return Some(Self::ThreeMf);
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        if crate::stl::has_binary_length(bytes) || crate::stl::opens_as_text(bytes) {
            return Some(Self::Stl);
        }
        if crate::collada::opens(bytes) {
            return Some(Self::Collada);
        }
        let text = trim_start(without_bom(bytes));
        if crate::off::opens(text) {
            return Some(Self::Off);
        }
        (text.starts_with(b"{") && memchr::memmem::find(text, b"\"asset\"").is_some()).then_some(Self::Gltf)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::ThreeMf => "3MF",
            Self::Collada => "COLLADA",
            Self::Baked => "baked",
        })
    }
}
