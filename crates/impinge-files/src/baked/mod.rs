//! Baked files: a mesh with its hierarchy, stored as the arrays that it consists of. The arrays are
//! used in place, without copying.
//!
//! | bytes | content |
//! |---|---|
//! | 0 .. 64 | the header, whose fields are in [`header`] |
//! | 64 .. 280 | a table of nine sections: number, checksum (CRC-32), offset, length |
//! | from 320 | the sections in order, each at a multiple of 64, with zeros between them |
//!
//! All numbers are little-endian on every machine; big-endian machines get an error. The sections
//! are those of [`Parts`], the provenance of each face, and the optional [`Proxies`].
//!
//! Opening reads only the header and the table. Before the first answer the arrays are validated as
//! a mesh ([`Mesh::validate`]). The values of vertices and faces cannot be validated in this way,
//! so they are compared with the checksums. So a file that was damaged by accident is rejected. A
//! file that was made to deceive is rejected, or is a valid mesh with correct answers.

mod header;
mod names;

use std::{
    io::{self, Write},
    ops::Range,
    path::{Path, PathBuf},
};

use impinge::{Mesh, Positions, mesh::Parts, storage::SharedBytes, volume::Proxies};

#[cfg(not(feature = "mmap"))]
use crate::memory_copy::copy as bytes_of;
#[cfg(feature = "mmap")]
use crate::memory_map::map as bytes_of;
use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::{Limits, OF_FILE, too_many_triangles},
    model::Model,
    regular_file,
    unit::Unit,
};
pub(crate) use header::MAGIC;
use header::{HEADER, Header, Section};

/// A baked file with a mesh and its hierarchy, opened but not yet validated.
///
/// The file is mapped, not read: do not change it while this value, or a mesh from it, is in use.
/// If another program shortens the file, the system may end this process. If another program writes
/// to it, answers may be wrong and queries may panic. Without the feature `mmap` the file is read
/// when it is opened, and later changes have no effect.
///
/// ```no_run
/// let mesh = impinge_files::Baked::open("engine.impinge")?.mesh()?;
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
#[derive(Clone)]
pub struct Baked {
    path: PathBuf,
    bytes: SharedBytes,
    header: Header,
}

/// The provenance of a mesh: the polygons and parts of its faces, and its unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// For each face, the index of its polygon in the original file.
    pub sources: Vec<u32>,
    /// For each face, the index of its part in `parts`.
    pub part_of: Vec<u32>,
    /// The names of the parts; a name is empty if the original file gives none.
    pub parts: Vec<String>,
    /// The unit of length; `None` if the original file states none.
    pub unit: Option<Unit>,
}

impl Baked {
    /// Maps a file and validates its header and its table.
    ///
    /// # Errors
    /// Returns an error if the file cannot be mapped, is not a baked file, has another version, or
    /// does not have the length in its header.
    ///
    /// # Complexity
    /// O(1); linear in the size of the file without the feature `mmap`.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, LoadError> {
        Self::open_with(path, &Limits::default())
    }

    /// Maps a file, as [`open`](Self::open) does, within other limits.
    ///
    /// # Errors
    /// Returns an error as [`open`](Self::open) does, and if the file has more bytes or triangles
    /// than the limits allow.
    ///
    /// # Complexity
    /// The same as [`open`](Self::open).
    pub fn open_with(path: impl AsRef<Path>, limits: &Limits) -> Result<Self, LoadError> {
        let path = path.as_ref().to_owned();
        let opened = || {
            let (file, length) = regular_file::open(&path)?;
            limits.check_bytes(OF_FILE, length)?;
            if length < HEADER as u64 {
                return Err(LoadError::truncated("bytes of a header", HEADER as u64, length));
            }
            let bytes = bytes_of(&file).map_err(|e| LoadError::io(&e))?;
            let header = Header::read((*bytes).as_ref())?;
            check_triangles(&header, limits)?;
            Ok((bytes, header))
        };
        let (bytes, header) = opened().map_err(|e: LoadError| e.in_file(&path))?;
        Ok(Self { path, bytes, header })
    }

    /// Opens the bytes that [`write_baked`] wrote, in place, and validates the header and the
    /// table. If other code may change the bytes, copy them first
    /// ([`AlignedBytes`](impinge::storage::AlignedBytes)).
    ///
    /// ```
    /// use std::sync::Arc;
    /// use impinge::{Mesh, Positions, storage::AlignedBytes};
    /// use impinge_files::{Baked, Provenance, write_baked};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]]).expect("a triangle");
    /// let about = Provenance { sources: vec![0], part_of: vec![0], parts: vec!["flap".to_owned()], unit: None };
    /// let mut written = Vec::new();
    /// write_baked(&mesh, &about, None, &mut written)?;
    ///
    /// let mut bytes = AlignedBytes::zeroed(written.len());
    /// bytes.as_mut().copy_from_slice(&written);
    /// let baked = Baked::from_bytes(Arc::new(bytes))?;
    /// assert_eq!((baked.mesh()?.faces(), baked.provenance()?), (mesh.faces(), about));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error as [`open`](Self::open) does; its path is empty. Bytes that do not start at
    /// a multiple of [`Mesh::PARTS_ALIGNMENT`] give an error only in [`mesh`](Self::mesh).
    ///
    /// # Complexity
    /// O(1).
    pub fn from_bytes(bytes: SharedBytes) -> Result<Self, LoadError> {
        let header = Header::read((*bytes).as_ref())?;
        Ok(Self { path: PathBuf::new(), bytes, header })
    }

    /// Returns the mesh after validating it.
    ///
    /// # Errors
    /// Returns an error if the file differs from the file that was written, or does not hold a
    /// valid mesh.
    ///
    /// # Complexity
    /// Linear in the size of the file, whatever it holds: about 1.5 times the cost of a refit, on
    /// all threads of the current rayon pool.
    pub fn mesh(&self) -> Result<Mesh, LoadError> {
        let mesh = self.trusted_mesh()?;
        let proved = mesh.validate().map_err(|flaw| corrupt(flaw.to_string()));
        let checked = proved.and_then(|()| self.check(&[Section::Positions, Section::Faces]));
        checked.map_err(|e| e.in_file(&self.path))?;
        Ok(mesh)
    }

    /// Returns the mesh without validating it, for files that this machine has just written. If the
    /// file is invalid, answers may be wrong, and queries may panic or never end, but they never
    /// read outside of the file.
    ///
    /// # Errors
    /// Returns an error if the length of a section is not a multiple of its element size.
    ///
    /// # Complexity
    /// The same as [`Mesh::borrow`].
    pub fn trusted_mesh(&self) -> Result<Mesh, LoadError> {
        let range = |section| self.header.range(section);
        let parts: Parts<Range<usize>> = Parts {
            frame: range(Section::Frame),
            positions: range(Section::Positions),
            faces: range(Section::Faces),
            nodes: range(Section::Nodes),
            leaves: range(Section::Leaves),
        };
        Mesh::borrow(&self.bytes, self.header.is_single_precision, &parts)
            .map_err(|flaw| corrupt(flaw.to_string()).in_file(&self.path))
    }

    /// Reports whether the file contains proxies.
    #[must_use]
    pub fn has_proxies(&self) -> bool {
        !self.header.range(Section::Proxies).is_empty()
    }

    /// Returns the proxies after validating them. `mesh` is the mesh that [`mesh`](Self::mesh)
    /// returned. Returns `None` if the file contains no proxies.
    ///
    /// ```no_run
    /// use impinge::shape::Shape;
    ///
    /// let baked = impinge_files::Baked::open("engine.impinge")?;
    /// let mesh = baked.mesh()?;
    /// let shape = baked.proxies(&mesh)?.map(|proxies| Shape::hull(proxies.hull().clone()));
    /// # Ok::<(), impinge_files::LoadError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the proxies differ from those that were written, or do not fit this mesh
    /// ([`Mesh::validate_proxies`]).
    ///
    /// # Complexity
    /// Nearly linear in the mesh's vertices and faces, on all threads of the current rayon pool.
    pub fn proxies(&self, mesh: &Mesh) -> Result<Option<Proxies>, LoadError> {
        let read = self.trusted_proxies(mesh)?;
        if let Some(proxies) = &read {
            let proved = mesh.validate_proxies(proxies).map_err(|flaw| corrupt(flaw.to_string()));
            let checked = proved.and_then(|()| self.check(&[Section::Proxies]));
            checked.map_err(|e| e.in_file(&self.path))?;
        }
        Ok(read)
    }

    /// Returns the proxies without validating them, for files that this machine has just written.
    /// If the file is invalid, answers of the proxies may be wrong.
    ///
    /// # Errors
    /// Returns an error if the section does not hold a hull of vertices of this mesh, and volumes.
    ///
    /// # Complexity
    /// Linear in the size of the hull.
    pub fn trusted_proxies(&self, mesh: &Mesh) -> Result<Option<Proxies>, LoadError> {
        if !self.has_proxies() {
            return Ok(None);
        }
        let bytes = &(*self.bytes).as_ref()[self.header.range(Section::Proxies)];
        let read = mesh.proxies_from_bytes(bytes).map_err(|flaw| corrupt(flaw.to_string()).in_file(&self.path))?;
        Ok(Some(read))
    }

    /// Returns the provenance of the mesh, with an entry for each face.
    ///
    /// # Errors
    /// Returns an error if the provenance differs from the provenance that was written.
    pub fn provenance(&self) -> Result<Provenance, LoadError> {
        self.read_provenance().map_err(|e| e.in_file(&self.path))
    }

    fn read_provenance(&self) -> Result<Provenance, LoadError> {
        self.check(&[Section::Sources, Section::PartOf, Section::Parts])?;
        provenance((*self.bytes).as_ref(), &self.header)
    }

    fn check(&self, sections: &[Section]) -> Result<(), LoadError> {
        self.header.check((*self.bytes).as_ref(), sections)
    }
}

/// Writes a mesh with its hierarchy, its provenance, and its [proxies](Mesh::proxies) if they are
/// given. The bytes are the same on every machine.
///
/// # Errors
/// Returns an error if `out` does, if `provenance` lacks an entry for a face, or if this machine is
/// big-endian.
pub fn write_baked(
    mesh: &Mesh,
    provenance: &Provenance,
    proxies: Option<&Proxies>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if cfg!(target_endian = "big") {
        return Err(io::Error::new(
            io::ErrorKind::Unsupported,
            "baked files can be written only on little-endian machines",
        ));
    }
    let faces = mesh.faces().len();
    let is_complete = provenance.sources.len() == faces
        && provenance.part_of.len() == faces
        && provenance.part_of.iter().all(|&part| (part as usize) < provenance.parts.len());
    if !is_complete {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "the provenance must have a source and a valid part for each face",
        ));
    }
    let little = |numbers: &[u32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let (sources, part_of) = (little(&provenance.sources), little(&provenance.part_of));
    let names = names::to_bytes(&provenance.parts);
    let proxies = proxies.map(Proxies::to_bytes).unwrap_or_default();
    let Parts { frame, positions, faces, nodes, leaves } = mesh.parts();
    let contents = [frame, positions, faces, nodes, leaves, &sources, &part_of, &names, &proxies];
    let header = Header::new(mesh.is_single_precision(), provenance.unit, &contents);
    out.write_all(&header.to_bytes())?;
    let mut written = HEADER;
    for (content, section) in contents.into_iter().zip(Section::ALL) {
        let start = header.range(section).start;
        out.write_all(&[0; header::ALIGNMENT][..start - written])?;
        out.write_all(content)?;
        written = start + content.len();
    }
    Ok(())
}

/// Reads the triangles without the hierarchy.
pub(crate) fn read(bytes: &[u8], limits: &Limits) -> Result<Model, LoadError> {
    let header = Header::read(bytes)?;
    check_triangles(&header, limits)?;
    header.check(bytes, &[Section::Positions, Section::Faces, Section::Sources, Section::PartOf, Section::Parts])?;
    let content = |section| &bytes[header.range(section)];
    let positions = if header.is_single_precision {
        Positions::F32(rows(content(Section::Positions)).map(|row| row.map(f32::from_le_bytes)).collect())
    } else {
        Positions::F64(rows(content(Section::Positions)).map(|row| row.map(f64::from_le_bytes)).collect())
    };
    let finite = |vertex: &usize| positions.get(*vertex).iter().all(|x| x.is_finite());
    if let Some(vertex) = (0..positions.len()).find(|vertex| !finite(vertex)) {
        return Err(LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 }));
    }
    let faces: Vec<[u32; 3]> = rows(content(Section::Faces)).map(|row| row.map(u32::from_le_bytes)).collect();
    let len = positions.len() as u64;
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&vertex| u64::from(vertex) >= len) {
            let (face, index) = (face as u64, i64::from(index));
            return Err(LoadError::new(LoadErrorKind::IndexOutOfBounds { face, index, len }));
        }
    }
    let Provenance { sources, part_of, parts, unit } = provenance(bytes, &header)?;
    Ok(Model { positions, faces, sources, part_of, parts, unit, warnings: Vec::new(), format: Format::Baked })
}

fn check_triangles(header: &Header, limits: &Limits) -> Result<(), LoadError> {
    let triangles = header.range(Section::Faces).len() as u64 / 12;
    if triangles <= limits.triangles() {
        return Ok(());
    }
    Err(too_many_triangles(triangles, limits.triangles()).at(Place::Entry("the section of faces".into())))
}

/// Returns rows of three numbers of `N` bytes each.
fn rows<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [[u8; N]; 3]> {
    bytes.as_chunks::<N>().0.as_chunks::<3>().0.iter().copied()
}

fn provenance(bytes: &[u8], header: &Header) -> Result<Provenance, LoadError> {
    let numbers = |section| -> Vec<u32> {
        bytes[header.range(section)].as_chunks().0.iter().map(|&x| u32::from_le_bytes(x)).collect()
    };
    let parts = names::from_bytes(&bytes[header.range(Section::Parts)])
        .ok_or_else(|| corrupt("the names of parts are invalid"))?;
    let (sources, part_of) = (numbers(Section::Sources), numbers(Section::PartOf));
    let faces = header.range(Section::Faces).len() / 12;
    if sources.len() != faces || part_of.len() != faces || part_of.iter().any(|&part| part as usize >= parts.len()) {
        return Err(corrupt("the sources and parts do not match the faces"));
    }
    Ok(Provenance { sources, part_of, parts, unit: header.unit })
}

fn corrupt(what: impl Into<String>) -> LoadError {
    LoadError::new(LoadErrorKind::Corrupt { what: what.into() }).with_hint("bake the original mesh again")
}
