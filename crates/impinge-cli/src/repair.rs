//! `--weld` and `--orient` repair a mesh before the question, and say what they changed.

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
    /// Each vertex is moved to the nearest of the vertices before it that have stayed. `impinge inspect` names a length
    /// that closes a cracked mesh.
    #[arg(long, value_name = "LENGTH", value_parser = parse_tolerance, allow_hyphen_values = true)]
    weld: Option<f64>,
    /// Turn faces so that neighbors agree on a side, and closed surfaces face outward
    #[arg(long)]
    orient: bool,
}

/// What was changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Summary {
    welded_vertices: usize,
    greatest_move: f64,
    turned_faces: usize,
    /// Faces of sheets that have only one side, which are left.
    one_sided_faces: usize,
}

fn parse_tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length >= 0.0 && length.is_finite() => Ok(length),
        _ => Err("a length is a number that is not negative".to_owned()),
    }
}

impl Arguments {
    /// Repairs a mesh if that was asked for, and builds its hierarchy in this way.
    ///
    /// # Errors
    /// The library refuses.
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
    /// Returns one sentence about what was changed.
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
            done.push(format!("{} left on surfaces that have only one side", counted(self.one_sided_faces, "face")));
        }
        if done.is_empty() { "nothing to repair".to_owned() } else { format!("repaired: {}", done.join(", ")) }
    }
}

/// Returns what keeps a mesh of this health from being closed, and which options repair it; `None` if it is closed.
pub(crate) fn diagnosis(mesh: &Mesh, health: &Health) -> Option<String> {
    if mesh.is_closed() || mesh.faces().is_empty() {
        return None;
    }
    let mut odd = Vec::new();
    for (number, what) in [
        (health.open_edges, "open"),
        (health.misoriented_edges, "between faces that do not agree on a side"),
        (health.non_manifold_edges, "of more than two faces"),
    ] {
        if number > 0 {
            odd.push(format!("{} {what}", counted(number, "edge")));
        }
    }
    let mut text = odd.join(", ");
    let tolerance = mesh.closing_tolerance();
    if let Some(tolerance) = tolerance {
        text += &format!("; --weld {tolerance:e} closes what is open");
    }
    if health.misoriented_edges > 0 || tolerance.is_some() {
        text += "; --orient turns faces that do not agree";
    }
    Some(text)
}
