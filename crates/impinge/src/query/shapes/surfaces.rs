//! Queries about the surfaces of two meshes, either of which may be solid.

use crate::budget::Budget;
use crate::convex::{Separation, Surface};
use crate::mesh::{Options, PlacedMesh, WarmStart};
use crate::query::last_hit::LastHit;
use crate::query::nesting::nested;
use crate::query::{Proximity, of_meshes};

/// Returns whether two meshes are at most `clearance` apart. Without a clearance the search for an
/// intersection is much faster if the meshes nearly coincide.
pub(super) fn nearness_of_surfaces(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    clearance: f64,
    budget: &Budget<'_>,
) -> Proximity {
    let options = Options { budget, ..Options::default() };
    if clearance == 0.0 {
        return of_meshes::proximity(a, b, &mut LastHit::default(), &options);
    }
    of_meshes::nearness(a, b, clearance, &mut WarmStart::default(), &options)
}

/// Computes the distance of two meshes. If the budget ends the query, the lower bound is zero and
/// the answer undecided.
pub(super) fn separation_of_surfaces(a: PlacedMesh<'_>, b: PlacedMesh<'_>, budget: &Budget<'_>) -> Separation {
    // The nearest points are those of the surfaces, even if one mesh is inside the other.
    let [surface_a, surface_b] = [PlacedMesh { is_solid: false, ..a }, PlacedMesh { is_solid: false, ..b }];
    let found = of_meshes::distance_without_cache(surface_a, surface_b, budget);
    let proximity = if found.upper == 0.0 {
        Proximity::Intersects
    } else if budget.stopped().is_some() {
        Proximity::Undecided
    } else {
        nested(a, b, budget)
    };
    let [lower, upper] = match proximity {
        Proximity::Apart => [found.lower, found.upper],
        Proximity::Undecided => [0.0, found.upper],
        Proximity::Intersects => [0.0; 2],
    };
    Separation { lower, upper, points: found.points().unwrap_or([[0.0; 3]; 2]), proximity }
}

/// Returns the surface of a mesh, whether it is solid or not.
pub(super) fn surface_of<'a>(surface: &Surface<'a>) -> PlacedMesh<'a> {
    surface.mesh.at(*surface.pose)
}

/// Returns the mesh as it is given, as its surface or as a solid.
pub(super) fn mesh_of<'a>(surface: &Surface<'a>) -> PlacedMesh<'a> {
    PlacedMesh { is_solid: surface.is_solid, ..surface_of(surface) }
}
