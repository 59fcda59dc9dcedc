//! The rows of OBJ, STL, PLY and OFF.

use impinge_files::{
    Format::{self, Obj, Ply, Stl},
    WarningKind,
};

use super::{
    Dialect,
    Expect::{self, Triangles},
};

mod obj;
mod off;
mod ply;
mod stl;

pub(crate) fn rows() -> Vec<Dialect> {
    [obj::rows(), stl::rows(), ply::rows(), off::rows()].into_iter().flatten().collect()
}

/// Returns a row whose samples are texts, each with the extension of the format.
fn row<T: AsRef<[u8]>>(
    format: Format,
    what: &'static str,
    answer: &'static str,
    expect: Expect,
    samples: impl IntoIterator<Item = T>,
) -> Dialect {
    let name = match format {
        Obj => "sample.obj",
        Stl => "sample.stl",
        Ply => "sample.ply",
        _ => "sample.off",
    };
    let files = samples.into_iter().map(|sample| (name, sample.as_ref().to_vec())).collect();
    Dialect { format, what, answer, files, expect }
}

fn triangles(count: usize, warnings: &'static [WarningKind]) -> Expect {
    Triangles { count, warnings }
}

fn utf16(text: &str, unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(unit).collect()
}
