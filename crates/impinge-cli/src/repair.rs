//! The options `--weld` and `--orient`, which repair a mesh before a query and report the changes.

use clap::Args;
use impinge::Mesh;
use impinge::hierarchy::Builder;
use impinge::mesh::{Health, RepairOptions};
use serde::Serialize;

use crate::failure::Failure;
use crate::numerals::counted;

#[derive(Args, Clone, Copy, Debug, Default)]
#[group(id = "repair")]
pub(crate) struct Arguments {
    /// Weld vertices that are at most this far apart, in the unit of the file
    ///
    /// Each vertex moves to the nearest earlier vertex that has not moved, if that is within
    /// LENGTH. `impinge inspect` suggests a length that closes a cracked mesh.
    #[arg(long, value_name = "LENGTH", value_parser = parse_tolerance, allow_hyphen_values = true)]
    weld: Option<f64>,
    /// Turn faces so that neighbors have consistent orientation and closed surfaces face outward
    #[arg(long)]
    orient: bool,
}

/// Summary of the changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Summary {
    welded_vertices: usize,
    greatest_move: f64,
    turned_faces: usize,
    /// Number of faces on one-sided surfaces, which are left unchanged.
    one_sided_faces: usize,
}

fn parse_tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length >= 0.0 && length.is_finite() => Ok(length),
        _ => Err("a length is a finite number of at least 0".to_owned()),
    }
}

impl Arguments {
    /// Repairs a mesh if that was requested, and rebuilds its hierarchy with `builder` if it
    /// changed.
    ///
    /// # Errors
    /// Returns an error if the repaired mesh is invalid.
    pub(crate) fn apply(&self, mesh: Mesh, builder: Builder) -> Result<(Mesh, Option<Summary>), Failure> {
        if self.weld.is_none() && !self.orient {
            return Ok((mesh, None));
        }
        let options = RepairOptions { weld: self.weld.unwrap_or(0.0), orient: self.orient };
        let (mut mesh, repair) = mesh.repaired(options).map_err(|error| Failure::from_input(&error).at("--weld"))?;
        if repair.welded_vertices.len() + repair.turned_faces.len() > 0 {
            mesh.rebuild(builder);
        }
        let summary = Summary {
            welded_vertices: repair.welded_vertices.len(),
            greatest_move: repair.greatest_move,
            turned_faces: repair.turned_faces.len(),
            one_sided_faces: repair.one_sided_faces.len(),
        };
        Ok((mesh, Some(summary)))
    }
}

impl Summary {
    /// Returns one sentence about the changes.
    pub(crate) fn sentence(&self) -> String {
        let mut done = Vec::new();
        if self.welded_vertices > 0 {
            let vertices = counted(self.welded_vertices, "vertex");
            done.push(format!("{vertices} welded, moved by at most {:e}", self.greatest_move));
        }
        if self.turned_faces > 0 {
            done.push(format!("{} turned", counted(self.turned_faces, "face")));
        }
        if self.one_sided_faces > 0 {
            done.push(format!("{} left unchanged on one-sided surfaces", counted(self.one_sided_faces, "face")));
        }
        if done.is_empty() { "nothing to repair".to_owned() } else { format!("repaired: {}", done.join(", ")) }
    }
}

/// Returns the defects that keep a mesh from being closed, and the options that repair them.
/// Returns `None` if the mesh is closed or has no faces.
pub(crate) fn diagnosis(mesh: &Mesh, health: &Health) -> Option<String> {
    if mesh.is_closed() || mesh.faces().is_empty() {
        return None;
    }
    let mut defects = Vec::new();
    for (number, defect) in [
        (health.open_edges, "open"),
        (health.misoriented_edges, "between faces with inconsistent orientation"),
        (health.non_manifold_edges, "of more than two faces"),
    ] {
        if number > 0 {
            defects.push(format!("{} {defect}", counted(number, "edge")));
        }
    }
    let mut text = defects.join(", ");
    let tolerance = mesh.closing_tolerance();
    if let Some(tolerance) = tolerance {
        text += &format!("; --weld {tolerance:e} closes open edges");
    }
    if health.misoriented_edges > 0 || tolerance.is_some() {
        text += "; --orient makes the orientation consistent";
    }
    Some(text)
}
