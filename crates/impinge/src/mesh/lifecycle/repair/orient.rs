//! Finds the faces to turn so that neighbors agree on their orientation. `Mesh::repaired` documents
//! how the orientation is chosen.

use crate::math::vec3::{cross, dot, sub};
use crate::mesh::Positions;

/// Result of orienting a mesh. Both lists are ascending.
pub(super) struct Orientation {
    /// Faces to turn.
    pub(super) turned: Vec<u32>,
    /// Faces of sheets that cannot be oriented.
    pub(super) one_sided: Vec<u32>,
}

/// An edge of a face.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Share {
    /// Ends of the edge, the smaller one first.
    edge: [u32; 2],
    face: u32,
    /// Whether the face traverses the edge from the smaller end to the larger one.
    is_forward: bool,
}

/// Returns 1 if `is_positive`, else -1: the sign with which a face or an edge counts.
fn sign(is_positive: bool) -> i64 {
    if is_positive { 1 } else { -1 }
}

/// A sheet, with orientations relative to the given orientation of its root face.
#[derive(Clone, Copy, Default)]
struct Sheet {
    /// Twice the area of the faces that agree with the root, and of the other faces.
    areas: [f64; 2],
    /// Six times the volume that the sheet encloses.
    volume: f64,
    is_open: bool,
    is_one_sided: bool,
    /// Whether the faces that agree with the root are turned, and not the others.
    is_turned: bool,
}

/// Chooses the orientation of each face. `names` contains for each vertex the first vertex at its
/// position.
pub(super) fn orientation(positions: &Positions, faces: &[[u32; 3]], names: &[u32]) -> Orientation {
    let mut links = Links::new(faces.len());
    let left = links.join_pairs(shares(faces));
    let renamed = left.into_iter().map(|share| {
        let [p, q] = share.edge.map(|vertex| names[vertex as usize]);
        Share { edge: [p.min(q), p.max(q)], is_forward: share.is_forward == (p < q), ..share }
    });
    let mut renamed: Vec<Share> = renamed.filter(|share| share.edge[0] != share.edge[1]).collect();
    // A face with two corners at one position traverses an edge in both directions. If both
    // traversals are left, they link nothing. If one is left, the other is linked to a neighbor
    // already.
    let has_three_corners = |face: u32| {
        let [a, b, c] = faces[face as usize].map(|vertex| names[vertex as usize]);
        a != b && b != c && c != a
    };
    renamed.sort_unstable_by_key(|share| share.face);
    let kept = renamed
        .chunk_by(|a, b| a.face == b.face)
        .filter(|of_face| of_face.len() == 1 || has_three_corners(of_face[0].face));
    let left = links.join_pairs(kept.flatten().copied().collect());

    let mut sheets = vec![Sheet::default(); faces.len()];
    for face in std::mem::take(&mut links.twisted) {
        let (root, _) = links.root(face);
        sheets[root as usize].is_one_sided = true;
    }
    // The point from which volumes are measured matters little; a near one gives smaller rounding
    // errors.
    let origin = faces.first().map_or([0.0; 3], |face| positions.get(face[0] as usize));
    for (face, corners) in (0..).zip(faces) {
        let (root, agrees) = links.root(face);
        let [p, q, r] = corners.map(|vertex| sub(&positions.get(vertex as usize), &origin));
        let normal = cross(&sub(&q, &p), &sub(&r, &p));
        let sheet = &mut sheets[root as usize];
        sheet.areas[usize::from(!agrees)] += dot(&normal, &normal).sqrt();
        sheet.volume += sign(agrees) as f64 * dot(&p, &cross(&q, &r));
    }
    // A sheet is open at a remaining edge if it does not traverse it equally often in both
    // directions.
    let mut nets: Vec<([u32; 2], u32, i64)> = left
        .iter()
        .map(|share| {
            let (root, agrees) = links.root(share.face);
            (share.edge, root, sign(share.is_forward == agrees))
        })
        .collect();
    nets.sort_unstable();
    for net in nets.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if net.iter().map(|&(_, _, times)| times).sum::<i64>() != 0 {
            sheets[net[0].1 as usize].is_open = true;
        }
    }
    choose_sides(&mut sheets);

    let mut orientation = Orientation { turned: Vec::new(), one_sided: Vec::new() };
    for face in 0..faces.len() as u32 {
        let (root, agrees) = links.root(face);
        let sheet = &sheets[root as usize];
        if sheet.is_one_sided {
            orientation.one_sided.push(face);
        } else if sheet.is_turned == agrees {
            orientation.turned.push(face);
        }
    }
    orientation
}

/// Chooses the orientation of each sheet.
fn choose_sides(sheets: &mut [Sheet]) {
    for sheet in sheets.iter_mut() {
        let [agreeing, other] = sheet.areas;
        let most = agreeing.max(other);
        sheet.is_turned = if most >= 0.75 * (agreeing + other) || sheet.is_open || sheet.volume == 0.0 {
            other > agreeing
        } else {
            sheet.volume < 0.0
        };
    }
    let closed = |sheet: &&mut Sheet| !sheet.is_open && !sheet.is_one_sided;
    let volume: f64 = sheets.iter_mut().filter(closed).map(|sheet| sign(!sheet.is_turned) as f64 * sheet.volume).sum();
    if volume < 0.0 {
        sheets.iter_mut().filter(closed).for_each(|sheet| sheet.is_turned = !sheet.is_turned);
    }
}

/// Returns the edges of all faces that have three different vertices.
fn shares(faces: &[[u32; 3]]) -> Vec<Share> {
    let mut shares = Vec::with_capacity(3 * faces.len());
    for (face, &[a, b, c]) in (0..).zip(faces) {
        if a != b && b != c && c != a {
            shares.extend([[a, b], [b, c], [c, a]].map(|[from, to]| Share {
                edge: [from.min(to), from.max(to)],
                face,
                is_forward: from < to,
            }));
        }
    }
    shares
}

/// Disjoint sets of faces. For each face it is known whether it has the orientation of the root of
/// its set (Tarjan and van Leeuwen, *Worst-case Analysis of Set Union Algorithms*, JACM 31(2),
/// 1984; the parity along each path is ours).
struct Links {
    /// For each face, a face nearer to the root, and whether both agree.
    above: Vec<(u32, bool)>,
    /// Faces at which two paths of links contradict each other.
    twisted: Vec<u32>,
}

impl Links {
    fn new(faces: usize) -> Self {
        Self { above: (0..faces as u32).map(|face| (face, true)).collect(), twisted: Vec::new() }
    }

    /// Returns the root of a face, and whether the face agrees with it.
    fn root(&mut self, mut face: u32) -> (u32, bool) {
        let mut agrees = true;
        while self.above[face as usize].0 != face {
            let (up, agrees_up) = self.above[face as usize];
            let (top, agrees_top) = self.above[up as usize];
            self.above[face as usize] = (top, agrees_up == agrees_top);
            // One step at a time along the old path.
            agrees = agrees == agrees_up;
            face = up;
        }
        (face, agrees)
    }

    /// Links two faces. `agree` tells whether they have the same orientation.
    fn join(&mut self, a: u32, b: u32, agree: bool) {
        let ((root_a, agrees_a), (root_b, agrees_b)) = (self.root(a), self.root(b));
        let roots_agree = (agrees_a == agrees_b) == agree;
        if root_a == root_b {
            if !roots_agree {
                self.twisted.push(a);
            }
            return;
        }
        self.above[root_a.max(root_b) as usize] = (root_a.min(root_b), roots_agree);
    }

    /// Links the faces of each edge that exactly two faces have, and returns the edges of faces
    /// that were not linked.
    fn join_pairs(&mut self, mut shares: Vec<Share>) -> Vec<Share> {
        shares.sort_unstable();
        let mut left = Vec::new();
        for same in shares.chunk_by(|a, b| a.edge == b.edge) {
            match same {
                [one, other] => self.join(one.face, other.face, one.is_forward != other.is_forward),
                _ => left.extend_from_slice(same),
            }
        }
        left
    }
}
