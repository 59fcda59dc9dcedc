//! What a file holds: triangles, and what is known of where they came from.

use std::fmt;

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    polygon::{Outcome, Triangulator},
    unit::Unit,
};

/// The triangles of a file, in its order.
///
/// Every index in `faces` is below `positions.len()`, every coordinate is finite, and `faces`, `sources` and `part_of`
/// have one entry per triangle.
#[derive(Clone, Debug)]
pub struct Model {
    /// The vertices, in the precision of the file, in its frame and unit.
    pub positions: Positions,
    /// Three vertices per triangle; degenerate ones are kept.
    pub faces: Vec<[u32; 3]>,
    /// The polygon of the file from which each triangle comes, counted from zero through the whole file.
    pub sources: Vec<u32>,
    /// The part to which each triangle belongs, as an index into `parts`.
    pub part_of: Vec<u32>,
    /// The names of the parts that have triangles, in order of their first; empty text where the file gives no name.
    pub parts: Vec<String>,
    /// The unit of length, where the file states one.
    pub unit: Option<Unit>,
    /// What was left out or is odd.
    pub warnings: Vec<Warning>,
    /// The format that the file turned out to have.
    pub format: Format,
}

/// Something in a file that was left out, or read otherwise than a user may expect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What it is.
    pub kind: WarningKind,
    /// How many times it occurs.
    pub count: u64,
    /// Where it occurs first.
    pub first: Option<Place>,
}

/// The kinds of [`Warning`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WarningKind {
    /// The content proves another format than the extension; it was read as what it is.
    OtherExtension,
    /// Lines that are no statement of the format, skipped.
    UnknownLines,
    /// Points, lines and curves: no triangles, skipped.
    NotTriangles,
    /// Faces of fewer than three corners, skipped: they have no surface.
    ShortFaces,
    /// Polygons that cross themselves, have no area or are huge: made a fan about their first corner.
    FannedPolygons,
    /// Rows with more values than the header tells, which were skipped.
    SurplusValues,
    /// Bytes after the end of the content, ignored.
    TrailingBytes,
    /// Corners left over after the last whole triangle, ignored.
    LeftoverCorners,
    /// Triangles of a strip that repeat a corner: joints of the strip, left out.
    StripJoints,
    /// Skinned meshes, taken as modelled, without their skeleton's pose.
    Unposed,
    /// Nodes whose instancing extension places no instances: the mesh was taken once.
    SingleInstances,
    /// Nodes that several paths from the root reach: one instance was taken for each path.
    SharedNodes,
    /// Beams and balls of lattices, left out.
    Beams,
    /// Holes in polygons, which were filled.
    FilledHoles,
    /// Geometries of a file without a scene, taken as they are modelled.
    NoScene,
    /// NUL bytes between the lines of a text or at its end, ignored.
    PaddingNuls,
    /// Vertices with a NaN or infinite coordinate that no face uses. They are stored at the position of the first vertex
    /// that is finite, so that the bounds do not change, or at the origin if no vertex is finite.
    UnusedNonFinite,
    /// Text in a statement where the format allows none, skipped.
    StrayText,
    /// Keywords of ASCII STL that are missing: `normal` or `endsolid`. No triangle depends on them.
    MissingKeywords,
    /// Facets of ASCII STL with more than three corners, triangulated.
    PolygonFacets,
    /// A binary STL states 0 or 4294967295 triangles, but triangles follow: all of them were read.
    UnsetCount,
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OtherExtension => "the content is not what the extension says, and was read as what it is",
            Self::UnknownLines => "lines that are no statement of this format, skipped",
            Self::NotTriangles => "points, lines or curves, skipped",
            Self::ShortFaces => "faces of fewer than three corners, skipped",
            Self::FannedPolygons => "polygons without a simple outline or too large, triangulated as a fan",
            Self::SurplusValues => "rows with more values than the header tells, which were skipped",
            Self::TrailingBytes => "bytes after the end of the content, ignored",
            Self::LeftoverCorners => "corners after the last whole triangle, ignored",
            Self::StripJoints => "triangles of strips that repeat a corner, left out",
            Self::Unposed => "skinned meshes, taken as modelled without the pose of their skeleton",
            Self::SingleInstances => "nodes with instancing that places nothing, taken once",
            Self::SharedNodes => "nodes that several paths reach, taken once for each path",
            Self::Beams => "beams and balls of lattices, left out",
            Self::FilledHoles => "holes in polygons, filled",
            Self::NoScene => "geometries of a file without a scene, taken as they are modelled",
            Self::PaddingNuls => "NUL bytes between lines or at the end of the text, ignored",
            Self::UnusedNonFinite => {
                "vertices with a NaN or infinite coordinate that no face uses, stored at the position of another vertex"
            }
            Self::StrayText => "text in places where the format allows none, skipped",
            Self::MissingKeywords => "missing keywords (normal or endsolid) on which no triangle depends",
            Self::PolygonFacets => "facets with more than three corners, triangulated",
            Self::UnsetCount => "triangle counts of 0 or 4294967295 with triangles after them, which were all read",
        })
    }
}

/// `faces of fewer than three corners, skipped: 3, the first at line 12`.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.kind)?;
        if self.kind != WarningKind::OtherExtension {
            write!(f, ": {}", self.count)?;
        }
        match &self.first {
            Some(place) if self.count > 1 => write!(f, ", the first at {place}"),
            Some(place) => write!(f, ", at {place}"),
            None => Ok(()),
        }
    }
}

/// Counts warnings by kind.
#[derive(Default)]
pub(crate) struct Warnings(Vec<Warning>);

impl Warnings {
    pub(crate) fn add(&mut self, kind: WarningKind, count: u64, first: impl FnOnce() -> Option<Place>) {
        if count == 0 {
            return;
        }
        match self.0.iter_mut().find(|w| w.kind == kind) {
            Some(warning) => warning.count += count,
            None => self.0.push(Warning { kind, count, first: first() }),
        }
    }

    /// Adds all of these warnings, each to the one of its kind.
    pub(crate) fn extend(&mut self, warnings: Vec<Warning>) {
        for Warning { kind, count, first } in warnings {
            self.add(kind, count, || first);
        }
    }

    pub(crate) fn into_vec(self) -> Vec<Warning> {
        self.0
    }
}

/// Gathers the triangles of a file.
#[derive(Default)]
pub(crate) struct Faces {
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) sources: Vec<u32>,
    pub(crate) part_of: Vec<u32>,
    pub(crate) warnings: Warnings,
    polygons: u32,
    triangulator: Triangulator,
}

impl Faces {
    /// Reserves room for this many more triangles.
    pub(crate) fn reserve(&mut self, triangles: usize) {
        self.faces.reserve(triangles);
        self.sources.reserve(triangles);
        self.part_of.reserve(triangles);
    }

    /// How many polygons there are so far, short ones included.
    pub(crate) fn polygons(&self) -> u32 {
        self.polygons
    }

    /// Adds a polygon that is a triangle.
    pub(crate) fn triangle(&mut self, face: [u32; 3], part: u32) -> Result<(), LoadError> {
        let source = self.polygons;
        self.polygons = source.checked_add(1).ok_or_else(|| too_many("faces", u64::from(source) + 1))?;
        self.faces.push(face);
        self.sources.push(source);
        self.part_of.push(part);
        Ok(())
    }

    /// Adds a polygon with any number of corners; `place` says where it stands.
    pub(crate) fn polygon(
        &mut self,
        corners: &[u32],
        position: impl Fn(u32) -> [f64; 3],
        part: u32,
        place: impl FnOnce() -> Place,
    ) -> Result<(), LoadError> {
        if let &[a, b, c] = corners {
            return self.triangle([a, b, c], part);
        }
        let source = self.polygons;
        self.polygons = source.checked_add(1).ok_or_else(|| too_many("faces", u64::from(source) + 1))?;
        if corners.len() < 3 {
            self.warnings.add(WarningKind::ShortFaces, 1, || Some(place()));
            return Ok(());
        }
        let n = u32::try_from(corners.len()).map_err(|_| too_many("corners", corners.len() as u64))?;
        let (faces, sources, part_of) = (&mut self.faces, &mut self.sources, &mut self.part_of);
        let outcome = self.triangulator.triangulate(
            n,
            |i| position(corners[i as usize]),
            |triangle| {
                faces.push(triangle.map(|i| corners[i as usize]));
                sources.push(source);
                part_of.push(part);
            },
        );
        if outcome == Outcome::Fanned {
            self.warnings.add(WarningKind::FannedPolygons, 1, || Some(place()));
        }
        Ok(())
    }

    /// Adds the triangles of another list to a part. Its vertices become those from `first` on. If `mirrored` is true, the
    /// triangles are turned over.
    pub(crate) fn append(&mut self, other: &Self, first: u32, part: u32, mirrored: bool) -> Result<(), LoadError> {
        let before = self.polygons;
        let after = u64::from(before) + u64::from(other.polygons);
        self.polygons = u32::try_from(after).map_err(|_| too_many("faces", after))?;
        self.faces.extend(other.faces.iter().map(|face| {
            let [a, b, c] = face.map(|i| first + i);
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
        self.sources.extend(other.sources.iter().map(|source| before + source));
        self.part_of.extend(std::iter::repeat_n(part, other.faces.len()));
        Ok(())
    }

    /// The model with these vertices; fails where there are more vertices or triangles than 32-bit indices can name.
    pub(crate) fn into_model(
        self,
        positions: Positions,
        parts: Vec<String>,
        unit: Option<Unit>,
        format: Format,
    ) -> Result<Model, LoadError> {
        for (what, count) in [("vertices", positions.len()), ("faces", self.faces.len())] {
            if u32::try_from(count).is_err() {
                return Err(too_many(what, count as u64));
            }
        }
        let (faces, sources, part_of) = (self.faces, self.sources, self.part_of);
        Ok(Model { positions, faces, sources, part_of, parts, unit, warnings: self.warnings.into_vec(), format })
    }
}

/// More of something than 32-bit indices can name.
pub(crate) fn too_many(what: &'static str, count: u64) -> LoadError {
    LoadError::new(LoadErrorKind::TooMany { what, count, limit: u64::from(u32::MAX) })
}

/// Decimal text has no precision of its own: its numbers are read as the nearest f64, and stored as f32 only where that
/// changes not one of them.
pub(crate) fn stored(positions: Vec<[f64; 3]>) -> Positions {
    #[expect(clippy::cast_possible_truncation, reason = "it is asked whether anything is lost")]
    let narrow = |x: f64| x as f32;
    if positions.iter().flatten().all(|&x| f64::from(narrow(x)) == x) {
        Positions::F32(positions.into_iter().map(|p| p.map(narrow)).collect())
    } else {
        Positions::F64(positions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_stored_without_loss() {
        assert_eq!(stored(vec![[0.5, -0.0, 3.0]]), Positions::F32(vec![[0.5, 0.0, 3.0]]));
        assert_eq!(stored(vec![[0.5, 0.1, 3.0]]), Positions::F64(vec![[0.5, 0.1, 3.0]]));
        assert_eq!(stored(vec![[1e39, 0.0, 0.0]]), Positions::F64(vec![[1e39, 0.0, 0.0]]));
        assert_eq!(stored(Vec::new()), Positions::F32(Vec::new()));
    }
}
