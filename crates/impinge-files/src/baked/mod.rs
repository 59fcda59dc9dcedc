//! Baked files: a mesh with its hierarchy, as the arrays that it consists of, which are used where they lie in the file.
//!
//! | bytes | what |
//! |---|---|
//! | 0 .. 64 | the header, whose fields are in [`header`] |
//! | 64 .. 280 | nine sections: what it is, its checksum (CRC-32), where it starts, how long it is |
//! | from 320 | the sections in that order, each from a multiple of 64 on, with zeros between them |
//!
//! All numbers are little-endian, on every machine; one of the other byte order is told so. The sections are those of
//! [`Parts`], where each face comes from, and the [`Proxies`], of which a file may have none.
//!
//! Opening looks at the header and the table alone. Before the first answer the arrays are proved to be a mesh
//! ([`Mesh::validate`]), and what that cannot prove, the numbers of the vertices and faces themselves, is compared with the
//! checksums. So a file that was spoiled by accident is refused, and one that was made with ill intent is refused or is a
//! mesh whose answers are true.

mod header;
mod names;

use std::{
    fs::File,
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
    error::{LoadError, LoadErrorKind},
    format::Format,
    model::Model,
    unit::Unit,
};
pub(crate) use header::MAGIC;
use header::{HEADER, Header, Section};

/// A mesh with its hierarchy in a file, opened and not yet believed.
///
/// The file is mapped, not read: it must not be changed while it, or a mesh from it, is in use. If somebody shortens
/// it, the system may end the program. If somebody writes to it, answers may be wrong and questions may panic. Without
/// the feature `mmap` the file is read when it is opened, and later changes to it do not matter.
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

/// Where the faces of a mesh come from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The polygon of the original file that each face is from.
    pub sources: Vec<u32>,
    /// The part of each face, as an index into `parts`.
    pub part_of: Vec<u32>,
    /// The names of the parts.
    pub parts: Vec<String>,
    /// The unit of length, where the original file states one.
    pub unit: Option<Unit>,
}

impl Baked {
    /// Maps a file and judges its header and its table.
    ///
    /// # Errors
    /// Where the file cannot be mapped, is no baked file or one of another version, or is not as long as its table says.
    ///
    /// # Complexity
    /// O(1); linear in the size of the file without the feature `mmap`.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, LoadError> {
        let path = path.as_ref().to_owned();
        let opened = || {
            let file = File::open(&path).map_err(|e| LoadError::io(&e))?;
            let length = file.metadata().map_err(|e| LoadError::io(&e))?.len();
            if length < HEADER as u64 {
                return Err(LoadError::truncated("bytes of a header", HEADER as u64, length));
            }
            let bytes = bytes_of(&file).map_err(|e| LoadError::io(&e))?;
            let header = Header::read((*bytes).as_ref())?;
            Ok((bytes, header))
        };
        let (bytes, header) = opened().map_err(|e: LoadError| e.in_file(&path))?;
        Ok(Self { path, bytes, header })
    }

    /// Takes what [`write_baked`] wrote where it lies in memory, and judges its header and its table. Bytes that others may change
    /// are to be copied first ([`AlignedBytes`](impinge::storage::AlignedBytes)).
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
    /// As [`open`](Self::open), with an empty path. Bytes that do not start at a multiple of
    /// [`Mesh::PARTS_ALIGNMENT`] are refused when the mesh is asked for.
    ///
    /// # Complexity
    /// O(1).
    pub fn from_bytes(bytes: SharedBytes) -> Result<Self, LoadError> {
        let header = Header::read((*bytes).as_ref())?;
        Ok(Self { path: PathBuf::new(), bytes, header })
    }

    /// The mesh, proved to be one.
    ///
    /// # Errors
    /// Where it is not what was baked, or no mesh.
    ///
    /// # Complexity
    /// Linear, whatever the file holds; a refit and a half, on all cores of the current rayon pool.
    pub fn mesh(&self) -> Result<Mesh, LoadError> {
        let mesh = self.trusted_mesh()?;
        let proved = mesh.validate().map_err(|flaw| corrupt(flaw.to_string()));
        let checked = proved.and_then(|()| self.check(&[Section::Positions, Section::Faces]));
        checked.map_err(|e| e.in_file(&self.path))?;
        Ok(mesh)
    }

    /// The mesh, believed: as [`mesh`](Self::mesh) for a file that this machine has just written. From any other, answers may be
    /// wrong, and questions may panic or go on without end; nothing outside the file is ever read for them.
    ///
    /// # Errors
    /// Where a section is not a whole number of elements.
    ///
    /// # Complexity
    /// As [`Mesh::borrow`].
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

    /// Whether there are proxies in the file.
    #[must_use]
    pub fn has_proxies(&self) -> bool {
        !self.header.range(Section::Proxies).is_empty()
    }

    /// The proxies of the mesh that [`mesh`](Self::mesh) returned, proved to be some; none where the file has none.
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
    /// Where they are not what was baked, or not those of this mesh ([`Mesh::validate_proxies`]).
    ///
    /// # Complexity
    /// Nearly linear in the mesh's vertices and faces, on all cores of the current rayon pool.
    pub fn proxies(&self, mesh: &Mesh) -> Result<Option<Proxies>, LoadError> {
        let read = self.trusted_proxies(mesh)?;
        if let Some(proxies) = &read {
            let proved = mesh.validate_proxies(proxies).map_err(|flaw| corrupt(flaw.to_string()));
            let checked = proved.and_then(|()| self.check(&[Section::Proxies]));
            checked.map_err(|e| e.in_file(&self.path))?;
        }
        Ok(read)
    }

    /// The proxies, believed: as [`proxies`](Self::proxies) for a file that this machine has just written. From any other, what
    /// they answer may be wrong.
    ///
    /// # Errors
    /// Where the section is not that of a hull of some vertices of this mesh, and of volumes.
    ///
    /// # Complexity
    /// Linear in the hull.
    pub fn trusted_proxies(&self, mesh: &Mesh) -> Result<Option<Proxies>, LoadError> {
        if !self.has_proxies() {
            return Ok(None);
        }
        let bytes = &(*self.bytes).as_ref()[self.header.range(Section::Proxies)];
        let read = mesh.proxies_from_bytes(bytes).map_err(|flaw| corrupt(flaw.to_string()).in_file(&self.path))?;
        Ok(Some(read))
    }

    /// Where the faces come from, with an entry for each face of the mesh.
    ///
    /// # Errors
    /// Where that is not what was baked.
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

/// Writes a mesh with its hierarchy, where its faces come from, and its [proxies](Mesh::proxies) where they are wanted: the
/// same bytes on every machine.
///
/// # Errors
/// Where `out` refuses, where `provenance` has not an entry for each face, or where this machine is big-endian.
pub fn write_baked(
    mesh: &Mesh,
    provenance: &Provenance,
    proxies: Option<&Proxies>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if cfg!(target_endian = "big") {
        return Err(io::Error::new(io::ErrorKind::Unsupported, "baked files are written on little-endian machines"));
    }
    let faces = mesh.faces().len();
    let is_complete = provenance.sources.len() == faces
        && provenance.part_of.len() == faces
        && provenance.part_of.iter().all(|&part| (part as usize) < provenance.parts.len());
    if !is_complete {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not every face has a source and a part"));
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

/// Reads the triangles alone.
pub(crate) fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    let header = Header::read(bytes)?;
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

/// Numbers of `N` bytes, three to a row.
fn rows<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [[u8; N]; 3]> {
    bytes.as_chunks::<N>().0.as_chunks::<3>().0.iter().copied()
}

fn provenance(bytes: &[u8], header: &Header) -> Result<Provenance, LoadError> {
    let numbers = |section| -> Vec<u32> {
        bytes[header.range(section)].as_chunks().0.iter().map(|&x| u32::from_le_bytes(x)).collect()
    };
    let parts = names::from_bytes(&bytes[header.range(Section::Parts)]).ok_or_else(|| corrupt("the names of parts"))?;
    let (sources, part_of) = (numbers(Section::Sources), numbers(Section::PartOf));
    let faces = header.range(Section::Faces).len() / 12;
    if sources.len() != faces || part_of.len() != faces || part_of.iter().any(|&part| part as usize >= parts.len()) {
        return Err(corrupt("the sources and parts are not those of the faces"));
    }
    Ok(Provenance { sources, part_of, parts, unit: header.unit })
}

fn corrupt(what: impl Into<String>) -> LoadError {
    LoadError::new(LoadErrorKind::Corrupt { what: what.into() }).with_hint("bake it anew from the original mesh")
}
