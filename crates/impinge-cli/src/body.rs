//! A mesh from a file, and what is known of it beside its triangles.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use impinge::hierarchy::Builder;
use impinge::{Mesh, Positions};
use impinge_files::{Baked, Format, LoadErrorKind, Model, Provenance, Unit, Warning};

use crate::failure::Failure;
use crate::{console, repair};

/// How files are read.
#[derive(Args, Clone, Copy, Debug, Default)]
#[group(id = "reading")]
pub(crate) struct Reading {
    /// The format of inputs, whatever their names say: obj, stl, ply, off, gltf, glb, 3mf or dae
    ///
    /// An input named - is standard input. Without this option its format must be clear from its content, as that of OBJ
    /// is not. Other files that an input names are then not read.
    #[arg(long, value_name = "FORMAT", value_parser = parse_format)]
    format: Option<Format>,
}

fn parse_format(name: &str) -> Result<Format, String> {
    let known = Format::ALL.into_iter().filter(|&format| format != Format::Baked);
    known.clone().find(|format| format.extension().eq_ignore_ascii_case(name)).ok_or_else(|| {
        let names: Vec<_> = known.map(Format::extension).collect();
        format!("none of {}", names.join(", "))
    })
}

impl Reading {
    fn model(&self, path: &Path) -> Result<Model, Failure> {
        let is_standard_input = path == Path::new("-");
        if !is_standard_input && self.format.is_none() {
            return Ok(impinge_files::load(path)?);
        }
        let mut bytes = Vec::new();
        let read = if is_standard_input {
            io::stdin().read_to_end(&mut bytes).map(drop)
        } else {
            fs::read(path).map(|content| bytes = content)
        };
        read.map_err(|error| Failure::from_io(&error, "cannot be read").in_file(path))?;
        let parsed = match self.format {
            Some(format) => impinge_files::parse(&bytes, format),
            None => impinge_files::parse_by_content(&bytes),
        };
        parsed.map_err(|error| match error.kind() {
            LoadErrorKind::UnsupportedFormat { .. } => {
                let failure = Failure::new("unsupported-format", "its content does not say what format it has");
                failure.in_file(path).hint("name the format by --format")
            }
            _ => Failure::from(error).in_file(path),
        })
    }
}

/// A file as loaded, its mesh not yet built.
pub(crate) struct Loaded {
    content: Content,
    about: About,
    warnings: Vec<Warning>,
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
    /// What was left out of the file or is odd in it.
    pub(crate) warnings: Vec<String>,
    /// What was repaired, if that was asked for.
    pub(crate) repair: Option<repair::Summary>,
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
    /// Reads a file, or standard input if the path is `-`; `unit` overrides what it states.
    ///
    /// # Errors
    /// The file cannot be read, or is broken.
    pub(crate) fn from_file(path: &Path, unit: Option<Unit>, reading: Reading) -> Result<Self, Failure> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        if Format::from_extension(&extension) == Some(Format::Baked) {
            let baked = Baked::open(path)?;
            let about = About::new(path, Format::Baked, baked.provenance()?, unit);
            return Ok(Self { content: Content::Baked(Box::new(baked)), about, warnings: Vec::new() });
        }
        let Model { positions, faces, sources, part_of, parts, unit: stated, warnings, format } =
            reading.model(path)?;
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

    /// Says on standard error what was left out of the file or is odd in it.
    pub(crate) fn warn(&self) {
        for warning in &self.warnings {
            console::warn(&format!("{}: {warning}", self.about.path.display()));
        }
    }

    /// Builds the hierarchy in this way, or proves the one that the file brings. Then repairs the mesh if that was asked
    /// for.
    ///
    /// # Errors
    /// A vertex is out of the range of the proofs, there are too many faces, or a baked file is not what was baked.
    pub(crate) fn build(self, builder: Builder, repairs: &repair::Arguments) -> Result<Body, Failure> {
        let Self { content, about, warnings } = self;
        let mesh = match content {
            Content::Triangles { positions, faces } => {
                let mesh = Mesh::with_builder(positions, faces, builder);
                mesh.map_err(|error| Failure::from_input(&error).in_file(&about.path))?
            }
            Content::Baked(baked) => baked.mesh()?,
        };
        let (mesh, repair) = repairs.apply(mesh, builder)?;
        if let Some(repair) = &repair {
            console::note(&format!("{}: {}", about.path.display(), repair.sentence()));
        }
        let mut warnings: Vec<String> = warnings.iter().map(Warning::to_string).collect();
        if mesh.faces().is_empty() {
            let empty = "the mesh has no faces, so it meets nothing";
            console::warn(&format!("{}: {empty}", about.path.display()));
            warnings.push(empty.to_owned());
        }
        Ok(Body { mesh, about, warnings, repair })
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
