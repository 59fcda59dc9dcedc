//! A mesh from a file, and what is known of it beside its triangles.

use std::path::{Path, PathBuf};

use impinge::hierarchy::Builder;
use impinge::{Mesh, Positions};
use impinge_files::{Baked, Format, Model, Provenance, Unit, Warning};

use crate::failure::Failure;

/// A file as loaded, its mesh not yet built.
pub(crate) struct Loaded {
    content: Content,
    about: About,
    /// What was left out of the file or is odd in it.
    pub(crate) warnings: Vec<Warning>,
}

/// What a file holds.
enum Content {
    Triangles {
        positions: Positions,
        faces: Vec<[u32; 3]>,
    },
    /// A hierarchy too, which is not yet proved to be one.
    Baked(Box<Baked>),
}

/// A mesh and where it comes from.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    pub(crate) about: About,
}

/// Where a mesh comes from.
pub(crate) struct About {
    pub(crate) path: PathBuf,
    pub(crate) format: Format,
    /// As stated by the user, else by the file.
    pub(crate) unit: Option<Unit>,
    /// The polygon of the file that each face is from.
    pub(crate) sources: Vec<u32>,
    /// The part of each face, as an index into `parts`.
    pub(crate) part_of: Vec<u32>,
    pub(crate) parts: Vec<String>,
}

impl Loaded {
    /// Reads a file; `unit` overrides what it states.
    ///
    /// # Errors
    /// Where the file cannot be read or is broken.
    pub(crate) fn from_file(path: &Path, unit: Option<Unit>) -> Result<Self, Failure> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        if Format::from_extension(&extension) == Some(Format::Baked) {
            let baked = Baked::open(path)?;
            let about = About::new(path, Format::Baked, baked.provenance()?, unit);
            return Ok(Self { content: Content::Baked(Box::new(baked)), about, warnings: Vec::new() });
        }
        let Model { positions, faces, sources, part_of, parts, unit: stated, warnings, format } =
            impinge_files::load(path)?;
        let about = About::new(path, format, Provenance { sources, part_of, parts, unit: stated }, unit);
        Ok(Self { content: Content::Triangles { positions, faces }, about, warnings })
    }

    pub(crate) fn about(&self) -> &About {
        &self.about
    }

    /// The file, where it is a baked one.
    pub(crate) fn baked(&self) -> Option<&Baked> {
        match &self.content {
            Content::Baked(baked) => Some(baked),
            Content::Triangles { .. } => None,
        }
    }

    /// Builds the hierarchy in this way, or proves the one that the file brings.
    ///
    /// # Errors
    /// Where a vertex is out of the range of the proofs, or there are too many faces; where a baked file is not what was
    /// baked.
    pub(crate) fn build(self, builder: Builder) -> Result<Body, Failure> {
        let Self { content, about, .. } = self;
        let mesh = match content {
            Content::Triangles { positions, faces } => {
                let mesh = Mesh::with_builder(positions, faces, builder);
                mesh.map_err(|error| Failure::from_input(&error).in_file(&about.path))?
            }
            Content::Baked(baked) => baked.mesh()?,
        };
        Ok(Body { mesh, about })
    }
}

impl About {
    /// `unit` overrides what the file states.
    fn new(path: &Path, format: Format, provenance: Provenance, unit: Option<Unit>) -> Self {
        let Provenance { sources, part_of, parts, unit: stated } = provenance;
        Self { path: path.to_owned(), format, unit: unit.or(stated), sources, part_of, parts }
    }

    /// The name of a face's part; empty where the file gives none.
    pub(crate) fn part(&self, face: u32) -> &str {
        &self.parts[self.part_of[face as usize] as usize]
    }
}
