//! Of the contacts of several pairs of bodies, those that remain once the shallower ones are
//! resolved.
//!
//! A body that is pushed out of one piece along the shortest way may then be out of another piece
//! too: a crate on a platform, close to its edge, is out of the platform's side once it is lifted.
//! A contact with that side would push it sideways. In a corner, a crate that is out of the floor
//! is still in the wall, and both contacts remain.

use super::Body;
use crate::convex::depth::depth;
use crate::convex::manifold::Contacts;
use crate::convex::posed::Swept;
use crate::math::Pose;
use crate::math::vec3::dot;

/// Minimum cosine of the angle between normals that count as one: 2.5 degrees.
const SAME_NORMAL_COSINE: f64 = 1.0 - 1.0 / 1_024.0;

/// The contacts of two bodies.
pub(crate) struct Found {
    pub(crate) contacts: Contacts,
    /// Numbers of the two bodies.
    pub(crate) bodies: [usize; 2],
}

/// Returns the contacts that remain once the shallower ones are resolved, merged by their normals.
/// A depth of at most `near` counts as none.
pub(crate) fn unresolved(mut found: Vec<Found>, bodies: [&[Body<'_>]; 2], near: f64) -> Vec<Contacts> {
    let key = |found: &Found| (found.contacts.deepest(), found.contacts.middle_of_first());
    found.sort_by(|x, y| {
        let (x, y) = (key(x), key(y));
        x.0.total_cmp(&y.0).then(x.1.partial_cmp(&y.1).unwrap_or(std::cmp::Ordering::Equal))
    });
    let mut merged: Vec<Contacts> = Vec::new();
    // The translation of the second bodies that resolves what was kept.
    let mut resolved = [0.0; 3];
    for Found { contacts, bodies: [a, b] } in found {
        let (deepest, normal) = (contacts.deepest(), contacts.normal);
        let [a, b] = [&bodies[0][a], &bodies[1][b]];
        if deepest > near && resolved != [0.0; 3] {
            let left = deepest - dot(&normal, &resolved);
            let is_same = merged.iter().any(|known| is_same_normal(known, &contacts) && left <= near);
            if !is_same && left_depth(a, b, &resolved) <= near {
                continue;
            }
        }
        let left = (deepest - dot(&normal, &resolved)).max(0.0);
        resolved = std::array::from_fn(|k| resolved[k] + normal[k] * left);
        merge(&mut merged, contacts);
    }
    merged
}

fn is_same_normal(one: &Contacts, other: &Contacts) -> bool {
    dot(&one.normal, &other.normal) >= SAME_NORMAL_COSINE
}

/// Returns the depth of two bodies after the second was moved.
fn left_depth(a: &Body<'_>, b: &Body<'_>, by: &[f64; 3]) -> f64 {
    let (a, b) = (a.faceted().swept, b.faceted().swept);
    let translation = std::array::from_fn(|k| b.pose.translation()[k] + by[k]);
    let Ok(pose) = Pose::new(*b.pose.linear(), translation) else { return f64::INFINITY };
    depth(&a, &Swept { pose: &pose, ..b }).upper
}

/// Adds contacts to the contacts with the same normal. Of contacts in one place the deepest stays;
/// the first wins a tie. The normal of the deepest contact is the normal of all.
fn merge(merged: &mut Vec<Contacts>, contacts: Contacts) {
    let Some(same) = merged.iter_mut().find(|known| is_same_normal(known, &contacts)) else {
        merged.push(contacts);
        return;
    };
    if contacts.deepest() > same.deepest() {
        same.normal = contacts.normal;
    }
    for contact in contacts.contacts {
        let is_there =
            same.contacts.iter_mut().find(|known| known.features == contact.features || known.points == contact.points);
        match is_there {
            Some(known) if contact.upper > known.upper => *known = contact,
            Some(_) => {}
            None => same.contacts.push(contact),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::along::Along;
    use crate::convex::facets::Facets;
    use crate::convex::manifold::Faceted;
    use crate::convex::posed::Core;

    const UP: [f64; 3] = [0.0, 0.0, 1.0];
    const SIDEWAYS: [f64; 3] = [1.0, 0.0, 0.0];

    fn corners(low: [f64; 3], high: [f64; 3]) -> Vec<[f64; 3]> {
        let corner = |at: usize| std::array::from_fn(|k| if at >> k & 1 == 0 { low[k] } else { high[k] });
        (0..8).map(corner).collect()
    }

    /// Returns the normals of the contacts of a crate that remain, of contacts with boxes along
    /// given directions.
    fn remaining(boxes: &[[[f64; 3]; 2]], crate_box: [[f64; 3]; 2], along: &[(usize, [f64; 3])]) -> Vec<[f64; 3]> {
        let points: Vec<_> = boxes.iter().chain([&crate_box]).map(|[low, high]| corners(*low, *high)).collect();
        let facets: Vec<_> = points.iter().map(|corners| Facets::of_points(corners)).collect();
        let mut bodies = Vec::new();
        for (corners, facets) in points.iter().zip(&facets) {
            let swept = Swept { core: Core::Points(corners), pose: &Pose::IDENTITY, radius: [0.0; 2] };
            bodies.push(Body::Convex(Faceted { swept, facets: facets.as_ref(), has_all_facets: false }));
        }
        let moving = bodies.split_off(boxes.len());
        let found = along.iter().map(|&(number, normal)| Found {
            contacts: Along::new(&bodies[number].faceted(), &moving[0].faceted()).contacts(normal, 0.0),
            bodies: [number, 0],
        });
        unresolved(found.collect(), [&bodies, &moving], 1e-9).into_iter().map(|contacts| contacts.normal).collect()
    }

    #[test]
    fn a_crate_on_a_platform_is_not_pushed_off_sideways() {
        let platform = [[0.0, 0.0, -1.0], [2.0, 2.0, 0.0]];
        let on_the_edge = [[1.75, 0.5, -0.01], [2.75, 1.5, 0.99]];
        assert_eq!(remaining(&[platform], on_the_edge, &[(0, SIDEWAYS), (0, UP)]), [UP]);
    }

    #[test]
    fn a_crate_in_a_corner_keeps_both_contacts() {
        let (floor, wall) = ([[-1.0, -1.0, -1.0], [2.0, 2.0, 0.0]], [[-1.0, -1.0, 0.0], [0.0, 2.0, 2.0]]);
        let in_the_corner = [[-0.02, 0.0, -0.01], [0.98, 1.0, 0.99]];
        assert_eq!(remaining(&[floor, wall], in_the_corner, &[(0, UP), (1, SIDEWAYS)]), [UP, SIDEWAYS]);
    }
}
