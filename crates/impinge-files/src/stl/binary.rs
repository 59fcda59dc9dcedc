//! Reads binary STL: a header of 80 bytes, the number of triangles, and 50 bytes for each.

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::Limits,
    model::{Faces, Model, WarningKind, too_many},
    weld::Weld,
};

use super::non_finite;

/// Size of the header with the number of triangles, in bytes.
const HEADER: usize = 84;

/// Size of a facet, in bytes.
const FACET: usize = 50;

/// Reports whether the length of the file is that of a binary file.
pub(crate) fn has_binary_length(bytes: &[u8]) -> bool {
    stated_count(bytes).is_some_and(|count| bytes.len() as u64 == HEADER as u64 + FACET as u64 * u64::from(count))
}

/// Returns the number of triangles that a binary file states, or `None` if the file is too short.
pub(super) fn stated_count(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Model, LoadError> {
    let Some(count) = stated_count(bytes) else {
        return Err(LoadError::truncated("bytes of header", HEADER as u64, bytes.len() as u64));
    };
    let room = (bytes.len() - HEADER) / FACET;
    match count {
        // A program that did not know the number beforehand and did not set it at the end leaves
        // one of these.
        u32::MAX if room > 0 => read_facets(bytes, room, true, limits),
        // A file without triangles may have other bytes after its count. Text has no NULs; facets
        // almost always have some.
        0 if room > 0 && memchr::memchr(0, &bytes[HEADER..]).is_some() => {
            match read_facets(bytes, room, true, limits) {
                Err(error) if matches!(error.kind(), LoadErrorKind::NonFinite { .. }) => {
                    read_facets(bytes, 0, false, limits)
                }
                result => result,
            }
        }
        _ if count as u64 > room as u64 => {
            Err(LoadError::truncated("triangles", count.into(), room as u64).at(Place::Byte(HEADER as u64 - 4)))
        }
        _ => read_facets(bytes, count as usize, false, limits),
    }
}

/// Reads `count` facets, which must fit in the file.
fn read_facets(bytes: &[u8], count: usize, is_unset: bool, limits: &Limits) -> Result<Model, LoadError> {
    let (facets, trailing) = bytes[HEADER..].split_at(count * FACET);
    let mut faces = Faces::new(limits);
    faces.check_room(count as u64).map_err(|e| e.at(Place::Byte(HEADER as u64 - 4)))?;
    faces.reserve(count);
    let mut weld = Weld::<f32>::with_capacity(count / 2);
    for (i, facet) in facets.as_chunks::<FACET>().0.iter().enumerate() {
        let (numbers, _) = facet[12..48].as_chunks::<4>();
        let numbers: [f32; 9] = std::array::from_fn(|k| f32::from_le_bytes(numbers[k]));
        if let Some(k) = numbers.iter().position(|x| !x.is_finite()) {
            return Err(non_finite(3 * i + k / 3).at(Place::Byte((HEADER + i * FACET + 12 + 4 * k) as u64)));
        }
        let [a, b, c] = [0, 3, 6].map(|k| weld.vertex([numbers[k], numbers[k + 1], numbers[k + 2]]));
        let face = a.zip(b).zip(c).ok_or_else(|| too_many("vertices", 3 * count as u64))?;
        faces.triangle([face.0.0, face.0.1, face.1], 0)?;
    }
    faces.warnings.add(WarningKind::UnsetCount, is_unset.into(), || Some(Place::Byte(HEADER as u64 - 4)));
    faces.warnings.add(WarningKind::TrailingBytes, trailing.len() as u64, || {
        Some(Place::Byte((bytes.len() - trailing.len()) as u64))
    });
    let parts = if count == 0 { Vec::new() } else { vec![String::new()] };
    faces.into_model(Positions::F32(weld.into_positions()), parts, None, Format::Stl)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary(header: &[u8], facets: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend((facets.len() as u32).to_le_bytes());
        for facet in facets {
            bytes.extend([f32::NAN; 3].iter().chain(facet.as_flattened()).flat_map(|x| x.to_le_bytes()));
            bytes.extend([0xFF, 0xFF]);
        }
        bytes
    }

    const FACETS: [[[f32; 3]; 3]; 2] =
        [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0, 1.0, 0.0], [1.0, -0.0, 0.0], [1.0, 1.0, 0.1]]];

    fn read(bytes: &[u8]) -> Result<Model, LoadError> {
        crate::stl::read(bytes, &Limits::default())
    }

    fn error(bytes: &[u8]) -> String {
        read(bytes).unwrap_err().to_string()
    }

    fn kinds(model: &Model) -> Vec<(WarningKind, u64)> {
        model.warnings.iter().map(|w| (w.kind, w.count)).collect()
    }

    #[test]
    fn corners_are_welded() {
        for header in [&b"solid facet"[..], b"", b"solid\nfacet normal"] {
            let model = read(&binary(header, &FACETS)).unwrap();
            let expected = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.1]];
            assert_eq!(model.positions, Positions::F32(expected));
            assert_eq!(model.faces, [[0, 1, 2], [2, 1, 3]]);
            assert_eq!((&model.sources[..], &model.part_of[..], model.parts.len()), (&[0, 1][..], &[0, 0][..], 1));
        }
        let empty = read(&binary(b"", &[])).unwrap();
        assert!(empty.positions.is_empty() && empty.parts.is_empty());
    }

    #[test]
    fn errors_name_the_byte() {
        let mut lying = binary(b"", &FACETS);
        lying[80..84].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
        let text = "byte 80: 4000000000 triangles promised, but there is room for 2 at most (the file is cut off or its counts are wrong)";
        assert_eq!(error(&lying), text);
        assert!(error(&binary(b"solid", &FACETS)[..100]).starts_with("byte 80: 2 triangles promised"));
        assert!(error(&[0; 20]).starts_with("84 bytes of header promised"));
        let mut nan = FACETS;
        nan[1][2][0] = f32::NAN;
        let text = "byte 170: vertex 5 has a coordinate that is NaN, infinite or too large";
        assert_eq!(error(&binary(b"", &nan)), text);
    }

    #[test]
    fn trailing_bytes_are_counted() {
        let mut bytes = binary(b"", &FACETS);
        bytes.extend(b"tail");
        let model = read(&bytes).unwrap();
        assert_eq!(model.faces.len(), 2);
        assert_eq!(
            model.warnings[0].to_string(),
            "bytes after the end of the content, ignored: 4, the first at byte 184"
        );
    }

    #[test]
    fn triangles_after_an_unset_count_are_read() {
        for count in [0, u32::MAX] {
            let mut bytes = binary(b"", &[[[1.1; 3], [1.2; 3], [-1.3; 3]]; 2]);
            bytes[182..184].fill(0);
            bytes[80..84].copy_from_slice(&count.to_le_bytes());
            let model = read(&bytes).unwrap();
            assert_eq!(model.faces, [[0, 1, 2]; 2]);
            assert_eq!(kinds(&model), [(WarningKind::UnsetCount, 1)]);
            // The last facet is cut off.
            let model = read(&bytes[..bytes.len() - 1]).unwrap();
            assert_eq!(model.faces.len(), 1);
            assert_eq!(kinds(&model), [(WarningKind::UnsetCount, 1), (WarningKind::TrailingBytes, 49)]);
        }
    }

    #[test]
    fn binary_files_without_nuls_are_read() {
        let mut bytes = binary(&[b' '; 80], &[[[1.1; 3], [1.2; 3], [-1.3; 3]]; 2]);
        // Only the count shows that the file is binary.
        bytes[80..84].fill(0xFF);
        assert_eq!(read(&bytes).unwrap().faces.len(), 2);
        let text = [&binary(b"", &[])[..], &b"text after the end".repeat(10)].concat();
        let model = read(&text).unwrap();
        assert_eq!((model.faces.len(), kinds(&model)), (0, vec![(WarningKind::TrailingBytes, 180)]));
    }

    #[test]
    fn invalid_triangles_after_count_zero_are_ignored() {
        let mut bytes = binary(b"", &[[[f32::NAN; 3]; 3]]);
        let finite = error(&bytes);
        assert_eq!(finite, "byte 96: vertex 0 has a coordinate that is NaN, infinite or too large");
        bytes[80..84].copy_from_slice(&[0; 4]);
        let model = read(&bytes).unwrap();
        assert_eq!((model.faces.len(), kinds(&model)), (0, vec![(WarningKind::TrailingBytes, 50)]));
        // A header may begin like UTF-16.
        let marked = binary(b"\xFF\xFEsolid", &FACETS);
        assert_eq!(read(&[&marked[..], b"tail"].concat()).unwrap().faces.len(), 2);
        let short = read(&[&binary(b"", &[])[..], &[0; 49]].concat()).unwrap();
        assert_eq!((short.faces.len(), kinds(&short)), (0, vec![(WarningKind::TrailingBytes, 49)]));
        bytes[80..84].copy_from_slice(&[0xFF; 4]);
        assert_eq!(error(&bytes), finite);
        assert!(error(&bytes[..100]).starts_with("byte 80: 4294967295 triangles promised"));
    }
}
