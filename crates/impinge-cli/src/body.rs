//! A mesh from a file, with its provenance: format, unit, polygons and parts.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use impinge::hierarchy::Builder;
use impinge::{Mesh, Positions};
use impinge_files::{Baked, Format, Limits, LoadErrorKind, Model, Provenance, Unit, Warning};

use crate::failure::Failure;
use crate::{console, repair};

/// Options for reading input files.
#[derive(Args, Clone, Copy, Debug, Default)]
#[group(id = "reading")]
pub(crate) struct Reading {
    /// The format of the inputs, overriding their names: obj, stl, ply, off, gltf, glb, 3mf or dae
    ///
    /// An input named - is read from standard input. Without this option its format is detected
    /// from its content, which is impossible for OBJ. With standard input or this option, other
    /// files that an input refers to are not read.
    #[arg(long, value_name = "FORMAT", value_parser = parse_format)]
    format: Option<Format>,
}

fn parse_format(name: &str) -> Result<Format, String> {
    let known = Format::ALL.into_iter().filter(|&format| format != Format::Baked);
    known.clone().find(|format| format.extension().eq_ignore_ascii_case(name)).ok_or_else(|| {
        let names: Vec<_> = known.map(Format::extension).collect();
        format!("unknown format; expected one of {}", names.join(", "))
    })
}

impl Reading {
    fn model(&self, path: &Path) -> Result<Model, Failure> {
        let is_standard_input = path == Path::new("-");
        if !is_standard_input && self.format.is_none() {
            return Ok(impinge_files::load(path)?);
        }
        let bytes = if is_standard_input {
            let mut bytes = Vec::new();
            let read = io::stdin().read_to_end(&mut bytes);
            read.map_err(|error| Failure::from_io(&error, "cannot be read").in_file(path))?;
            bytes
        } else {
            impinge_files::read_regular_file(path, &Limits::default())?
        };
        let parsed = match self.format {
            Some(format) => impinge_files::parse(&bytes, format),
            None => impinge_files::parse_by_content(&bytes),
        };
        parsed.map_err(|error| match error.kind() {
            LoadErrorKind::UnsupportedFormat { .. } => {
                let failure = Failure::new("unsupported-format", "its format cannot be detected from its content");
                failure.in_file(path).hint("state the format with --format")
            }
            _ => Failure::from(error).in_file(path),
        })
    }
}

/// A loaded file whose mesh has not been built yet.
pub(crate) struct Loaded {
    content: Content,
    about: About,
    warnings: Vec<Warning>,
}

/// Geometry of a loaded file.
enum Content {
    Triangles {
        positions: Positions,
        faces: Vec<[u32; 3]>,
    },
    /// A baked file with its hierarchy, which has not been validated yet.
    Baked(Box<Baked>),
}

/// A mesh and its provenance.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    pub(crate) about: About,
    /// Warnings about content of the file that was skipped or is unusual.
    pub(crate) warnings: Vec<String>,
    /// Summary of the repair; `None` if no repair was requested.
    pub(crate) repair: Option<repair::Summary>,
}

/// Provenance of a mesh.
pub(crate) struct About {
    pub(crate) path: PathBuf,
    pub(crate) format: Format,
    /// The unit stated by the user, else by the file; `None` if neither states one.
    pub(crate) unit: Option<Unit>,
    /// For each face, the index of its polygon in the file.
    pub(crate) sources: Vec<u32>,
    /// For each face, the index of its part in `parts`.
    pub(crate) part_of: Vec<u32>,
    pub(crate) parts: Vec<String>,
}

impl Loaded {
    /// Reads a file, or standard input if the path is `-`. `unit` overrides the unit that the file
    /// states.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is invalid.
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

    /// Returns the baked file, or `None` if the input is in another format.
    pub(crate) fn baked(&self) -> Option<&Baked> {
        match &self.content {
            Content::Baked(baked) => Some(baked),
            Content::Triangles { .. } => None,
        }
    }

    /// Prints the warnings of the reader on standard error.
    pub(crate) fn warn(&self) {
        for warning in &self.warnings {
            console::warn(&format!("{}: {warning}", self.about.path.display()));
        }
    }

    /// Builds the hierarchy with `builder`, or validates the hierarchy of a baked file. Then
    /// repairs the mesh if that was requested.
    ///
    /// # Errors
    /// Returns an error if a vertex is out of range, there are too many faces, or a baked file is
    /// corrupt.
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
            let empty = "the mesh has no faces, so it intersects nothing";
            console::warn(&format!("{}: {empty}", about.path.display()));
            warnings.push(empty.to_owned());
        }
        Ok(Body { mesh, about, warnings, repair })
    }
}

impl About {
    /// Combines the provenance of a file with the user's options. `unit` overrides the unit that
    /// the file states.
    fn new(path: &Path, format: Format, provenance: Provenance, unit: Option<Unit>) -> Self {
        let Provenance { sources, part_of, parts, unit: stated } = provenance;
        Self { path: path.to_owned(), format, unit: unit.or(stated), sources, part_of, parts }
    }

    /// Returns the name of the part that a face belongs to; empty if the file gives no name.
    pub(crate) fn part(&self, face: u32) -> &str {
        &self.parts[self.part_of[face as usize] as usize]
    }
}
