//! The curves in which the surfaces of the two parts of a clash intersect.
//!
//! Guarded by `tests/it/clash/reports.rs`.

use super::kinds::Kind;
use super::report::{Clash, Report};
use super::sides::{Member, Side};
use crate::budget::{Budget, Stopped};
use crate::math::Pose;
use crate::mesh::Mesh;
use crate::query::batch::Execution;
use crate::query::{Curves, Query};

impl Report {
    /// Traces the curves in which the surfaces of the parts of each clash intersect, and stores
    /// them as [`Clash::curves`]. `sides` has the scenes of the search.
    ///
    /// # Errors
    /// Returns an error if the work was canceled, or memory ran out. Once another limit of the
    /// budget is reached, the clashes that are left have no curves.
    ///
    /// ```
    /// use impinge::clash::{self, Options, Side};
    /// use impinge::query::batch::Execution;
    /// use impinge::scene::Scene;
    /// use impinge::{Mesh, Pose, Positions};
    ///
    /// let corners = vec![[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// let solid = Mesh::new(Positions::F64(corners), faces)?;
    /// let mut scene = Scene::new();
    /// scene.add("floor", &solid, Pose::IDENTITY)?;
    /// scene.add("roof", &solid, Pose::from_translation([0.5, 0.5, -7.5])?)?;
    /// let sides = [Side { label: "house".to_owned(), scene: &scene }];
    /// let mut report = clash::find(&sides, Options::new(1e-3), Execution::default())?;
    /// report.trace_curves(&sides, Execution::default())?;
    /// let curves = report.clashes[0].curves.as_ref().unwrap();
    /// assert_eq!((curves.polylines.len(), curves.closed()), (1, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn trace_curves(&mut self, sides: &[Side<'_>], execution: Execution<'_>) -> Result<(), Stopped> {
        let trace = |row| curves_of(&self.clashes[row], sides, execution.budget());
        let traced = execution.single_rows(self.clashes.len(), trace)?;
        for (clash, curves) in self.clashes.iter_mut().zip(traced) {
            clash.curves = curves;
        }
        Ok(())
    }
}

/// Returns the curves in which the surfaces of the parts of a clash intersect, in the world frame.
/// Returns `None` if a part is not a mesh, or if there is a gap between the parts. `sides` has the
/// scenes of the search.
#[must_use]
pub fn curves(clash: &Clash, sides: &[Side<'_>]) -> Option<Curves> {
    curves_of(clash, sides, Budget::unlimited())
}

fn curves_of(clash: &Clash, sides: &[Side<'_>], budget: &Budget<'_>) -> Option<Curves> {
    if clash.kind == Kind::Clearance {
        return None;
    }
    let [(a, pose_a), (b, pose_b)] = [mesh_of(&clash.a, sides)?, mesh_of(&clash.b, sides)?];
    let curves = Query::new().with_budget(budget).intersection_curves(a.at(pose_a), b.at(pose_b));
    budget.stopped().is_none().then_some(curves)
}

fn mesh_of<'s>(member: &Member, sides: &[Side<'s>]) -> Option<(&'s Mesh, Pose)> {
    let scene = sides.iter().find(|side| side.label == member.scene)?.scene;
    let (mesh, _) = scene.shape(member.part).as_mesh()?;
    Some((mesh, *scene.pose(member.part)))
}
