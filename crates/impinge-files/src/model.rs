//! The content of a file: triangles, and their provenance.

use std::fmt;

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::{Limits, too_many_triangles},
    polygon::{Outcome, Triangulator},
    unit::Unit,
};

/// The triangles of a file, in the order of the file.
///
/// Every index in `faces` is below `positions.len()`, every coordinate is finite, and `faces`,
/// `sources` and `part_of` have one entry per triangle.
#[derive(Clone, Debug)]
pub struct Model {
    /// The vertices, in the precision, frame and unit of the file; those of COLLADA are rotated so
    /// that Z points up.
    pub positions: Positions,
    /// Three vertex indices per triangle; degenerate triangles are kept.
    pub faces: Vec<[u32; 3]>,
    /// For each triangle, the index of its polygon, counted from zero through the whole file.
    pub sources: Vec<u32>,
    /// For each triangle, the index of its part in `parts`.
    pub part_of: Vec<u32>,
    /// The names of all parts that have triangles, in order of their first triangle. The name is
    /// empty if the file gives none.
    pub parts: Vec<String>,
    /// The unit of the vertices; `None` if the file states none.
    pub unit: Option<Unit>,
    /// Content that was skipped or is unusual.
    pub warnings: Vec<Warning>,
    /// The format in which the file was read.
    pub format: Format,
}

/// Content of a file that was skipped, or was read in a way that may surprise a user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The kind of warning.
    pub kind: WarningKind,
    /// Number of occurrences.
    pub count: u64,
    /// Place of the first occurrence; `None` if it is not known.
    pub first: Option<Place>,
}

/// The kind of a [`Warning`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WarningKind {
    /// The content proves another format than the extension; the file was read in the format of its
    /// content.
    OtherExtension,
    /// Lines that are not statements of the format; they were skipped.
    UnknownLines,
    /// Points, lines and curves; they were skipped because they have no triangles.
    NotTriangles,
    /// Faces of fewer than three corners; they were skipped because they have no surface.
    ShortFaces,
    /// Polygons that cross themselves, have no area or are huge; they were triangulated as a fan
    /// about their first corner.
    FannedPolygons,
    /// Rows with more values than the header declares; the extra values were skipped.
    SurplusValues,
    /// Bytes after the end of the content; they were ignored.
    TrailingBytes,
    /// Corners after the last complete triangle; they were ignored.
    LeftoverCorners,
    /// Triangles of a strip that repeat a corner; they join strips and were skipped.
    StripJoints,
    /// Skinned meshes; they were loaded as modeled, without the pose of their skeleton.
    Unposed,
    /// Nodes whose instancing extension places no instances; their mesh was loaded once.
    SingleInstances,
    /// Nodes that several paths from the root reach; one instance was loaded for each path.
    SharedNodes,
    /// Entries of a file of names that name no node of the scene; they were ignored.
    UnknownNames,
    /// Beams and balls of lattices; they were skipped.
    Beams,
    /// Holes in polygons; they were filled.
    FilledHoles,
    /// Geometries of a file without a scene; they were loaded as modeled.
    NoScene,
    /// NUL bytes between the lines of a text or at its end; they were ignored.
    PaddingNuls,
    /// Vertices with a NaN or infinite coordinate that no face uses. They are stored at the
    /// position of the first finite vertex, so that the bounds do not change, or at the origin if
    /// no vertex is finite.
    UnusedNonFinite,
    /// Text in places of a statement where the format allows none; it was skipped.
    StrayText,
    /// Missing keywords of ASCII STL: `normal` or `endsolid`. No triangle depends on them.
    MissingKeywords,
    /// Facets of ASCII STL with more than three corners; they were triangulated.
    PolygonFacets,
    /// A binary STL file that states 0 or 4294967295 triangles although triangles follow; all of
    /// them were read.
    UnsetCount,
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OtherExtension => "the content does not match the extension and was read in its own format",
            Self::UnknownLines => "lines that are not statements of this format, skipped",
            Self::NotTriangles => "points, lines or curves, skipped",
            Self::ShortFaces => "faces of fewer than three corners, skipped",
            Self::FannedPolygons => "polygons without a simple outline or too large, triangulated as a fan",
            Self::SurplusValues => "rows with more values than the header declares, the extra values skipped",
            Self::TrailingBytes => "bytes after the end of the content, ignored",
            Self::LeftoverCorners => "corners after the last whole triangle, ignored",
            Self::StripJoints => "triangles of strips that repeat a corner, skipped",
            Self::Unposed => "skinned meshes, loaded as modeled without the pose of their skeleton",
            Self::SingleInstances => "nodes whose instancing extension places no instances, loaded once",
            Self::SharedNodes => "nodes that several paths reach, loaded once for each path",
            Self::UnknownNames => "entries of the file of names that name no node of the scene, ignored",
            Self::Beams => "beams and balls of lattices, skipped",
            Self::FilledHoles => "holes in polygons, filled",
            Self::NoScene => "geometries of a file without a scene, loaded as modeled",
            Self::PaddingNuls => "NUL bytes between lines or at the end of the text, ignored",
            Self::UnusedNonFinite => {
                "vertices with a NaN or infinite coordinate that no face uses, stored at the position of another vertex"
            }
            Self::StrayText => "text in places where the format allows none, skipped",
            Self::MissingKeywords => "missing keywords (normal or endsolid) on which no triangle depends",
            Self::PolygonFacets => "facets with more than three corners, triangulated",
            Self::UnsetCount => "triangle counts of 0 or 4294967295 although triangles follow, all of which were read",
        })
    }
}

/// Formats the warning like `faces of fewer than three corners, skipped: 3, the first at line 12`.
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

    /// Adds each of the warnings to the warning of the same kind.
    pub(crate) fn extend(&mut self, warnings: Vec<Warning>) {
        for Warning { kind, count, first } in warnings {
            self.add(kind, count, || first);
        }
    }

    pub(crate) fn into_vec(self) -> Vec<Warning> {
        self.0
    }
}

/// Collects the triangles of a file, up to a limit.
pub(crate) struct Faces {
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) sources: Vec<u32>,
    pub(crate) part_of: Vec<u32>,
    pub(crate) warnings: Warnings,
    polygons: u32,
    triangulator: Triangulator,
    max_triangles: u64,
    /// Number of triangles that were taken out, which count towards the limit.
    taken: u64,
}

impl Default for Faces {
    fn default() -> Self {
        Self::new(&Limits::default())
    }
}

impl Faces {
    /// Returns an empty list for at most the number of triangles that `limits` allow.
    pub(crate) fn new(limits: &Limits) -> Self {
        Self {
            faces: Vec::new(),
            sources: Vec::new(),
            part_of: Vec::new(),
            warnings: Warnings::default(),
            polygons: 0,
            triangulator: Triangulator::default(),
            max_triangles: limits.triangles(),
            taken: 0,
        }
    }

    /// Takes out the triangles that were added since the last call, and their polygons. Triangles
    /// that are taken out still count towards the limit, and their polygons keep their numbers.
    pub(crate) fn take(&mut self) -> (Vec<[u32; 3]>, Vec<u32>) {
        self.taken += self.faces.len() as u64;
        self.part_of.clear();
        (std::mem::take(&mut self.faces), std::mem::take(&mut self.sources))
    }

    /// Returns an error if `more` triangles would exceed the limit.
    #[inline]
    pub(crate) fn check_room(&self, more: u64) -> Result<(), LoadError> {
        let count = self.taken + self.faces.len() as u64 + more;
        if count <= self.max_triangles { Ok(()) } else { Err(too_many_triangles(count, self.max_triangles)) }
    }

    /// Reserves memory for `triangles` more triangles.
    pub(crate) fn reserve(&mut self, triangles: usize) {
        self.faces.reserve(triangles);
        self.sources.reserve(triangles);
        self.part_of.reserve(triangles);
    }

    /// Returns the number of polygons added so far, including those with fewer than three corners.
    pub(crate) fn polygons(&self) -> u32 {
        self.polygons
    }

    /// Adds a polygon with three corners.
    pub(crate) fn triangle(&mut self, face: [u32; 3], part: u32) -> Result<(), LoadError> {
        self.check_room(1)?;
        let source = self.polygons;
        self.polygons = source.checked_add(1).ok_or_else(|| too_many("faces", u64::from(source) + 1))?;
        self.faces.push(face);
        self.sources.push(source);
        self.part_of.push(part);
        Ok(())
    }

    /// Adds a polygon with any number of corners; `place` gives its place in the file.
    pub(crate) fn polygon(
        &mut self,
        corners: &[u32],
        position: impl Fn(u32) -> [f64; 3],
        part: u32,
        place: impl FnOnce() -> Place,
    ) -> Result<(), LoadError> {
        if let &[a, b, c] = corners {
            return self.triangle([a, b, c], part).map_err(|e| e.at(place()));
        }
        let source = self.polygons;
        self.polygons = source.checked_add(1).ok_or_else(|| too_many("faces", u64::from(source) + 1))?;
        if corners.len() < 3 {
            self.warnings.add(WarningKind::ShortFaces, 1, || Some(place()));
            return Ok(());
        }
        let n = u32::try_from(corners.len()).map_err(|_| too_many("corners", corners.len() as u64))?;
        if let Err(error) = self.check_room(u64::from(n) - 2) {
            return Err(error.at(place()));
        }
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

    /// Adds the triangles of another list to a part. Their vertex indices are increased by `first`.
    /// If `mirrored` is true, the winding of the triangles is reversed.
    pub(crate) fn append(&mut self, other: &Self, first: u32, part: u32, mirrored: bool) -> Result<(), LoadError> {
        self.check_room(other.faces.len() as u64)?;
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

    /// Returns the model with these vertices. Returns an error if there are more vertices or
    /// triangles than 32-bit indices can address.
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

/// Builds the error that there are more items than 32-bit indices can address.
pub(crate) fn too_many(what: &'static str, count: u64) -> LoadError {
    LoadError::new(LoadErrorKind::TooMany { what, count, limit: u64::from(u32::MAX) })
}

/// Returns the positions as f32 if that changes no number, else as f64. Decimal text has no
/// precision of its own, so its numbers were read as the nearest f64.
pub(crate) fn stored(positions: Vec<[f64; 3]>) -> Positions {
    #[expect(clippy::cast_possible_truncation, reason = "the caller checks whether precision is lost")]
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
    fn decimal_text_is_stored_without_loss() {
        assert_eq!(stored(vec![[0.5, -0.0, 3.0]]), Positions::F32(vec![[0.5, 0.0, 3.0]]));
        assert_eq!(stored(vec![[0.5, 0.1, 3.0]]), Positions::F64(vec![[0.5, 0.1, 3.0]]));
        assert_eq!(stored(vec![[1e39, 0.0, 0.0]]), Positions::F64(vec![[1e39, 0.0, 0.0]]));
        assert_eq!(stored(Vec::new()), Positions::F32(Vec::new()));
    }
}
