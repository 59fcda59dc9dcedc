//! A tree over the faces of a skin, with spheres that hold in any pose. Each sphere is computed on
//! demand from the bones.
//!
//! # Source
//! Kavan, Žára, *Fast collision detection for skeletally deformable models*, Computer Graphics
//! Forum 24(3), 2005. The spheres of a hierarchy are refitted on demand, one by one, from the
//! joints that their contents are blended from. Three things differ here: the bound; one tree per
//! bone, so that no sphere is blended from many joints; and exact faces at the leaves.
//!
//! # The bound
//! A vertex `p` goes to `Σ wⱼ (Lⱼ p + oⱼ)` with weights that sum to one. For any center `c` and
//! weights `vⱼ` of a node, which also sum to one, let `mⱼ = Lⱼ c + oⱼ` and `m = Σ vⱼ mⱼ`. The
//! vertex differs from `m` by `Σ (wⱼ - vⱼ) (mⱼ - m) + Σ wⱼ Lⱼ (p - c)`, because the sum does not
//! depend on the origin if the weights have equal sums. So the distance is at most `Σ max |wⱼ - vⱼ|
//! |mⱼ - m| + max ‖Lⱼ‖ max |p - c|`, in which only `mⱼ` and `Lⱼ` depend on the pose. The first sum
//! is zero if the vertices have the same weights or the joints have moved as one.
//!
//! Tests: `skin_tree/tests.rs`, `impinge-files/tests/it/characters/surface.rs`. Benchmark:
//! `characters`.

use std::collections::BTreeMap;

use super::plan::bones_of_faces;
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::skin::{Skin, blended};
use super::transform::{Matrix, apply, times};
use super::volume::box_of;
use crate::math::vec3::{Vector, add, length, scale, sub};

/// Maximum number of faces per leaf. This is a choice: with fewer faces, more spheres are computed
/// on the way to them; with more faces, a ray that reaches a leaf skins more vertices.
const MAX_LEAF_FACES: usize = 8;

/// Rounding error bound per added number, relative to the sizes of the terms: eight roundings.
const ROUNDING: f64 = 1.0 / (1_u64 << 50) as f64;

/// The tree of a skin. It does not depend on a pose.
#[derive(Clone, Debug)]
pub(super) struct SkinTree {
    nodes: Vec<Node>,
    /// One root for each bone that some faces follow most.
    roots: Vec<u32>,
    blends: Vec<Blend>,
    /// Morph targets that move vertices of a node, and the maximum distance of that move for a
    /// weight of one.
    reaches: Vec<(u32, f64)>,
    faces: Vec<LeafFace>,
    /// Vertices of the leaves, without duplicates within a leaf.
    vertices: Vec<u32>,
    /// Morph targets and offsets, by vertex, then in the order of the targets.
    offsets: Vec<(u32, Vector)>,
    /// The offsets of vertex `i` are those from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
}

/// A group of faces that follow one bone most.
#[derive(Clone, Debug)]
struct Node {
    bone: u32,
    /// Center of the vertices before any bone or morph target moves them.
    center: Vector,
    radius: f64,
    /// Maximum number of terms added for a vertex or for the center.
    terms: f64,
    blends: [u32; 2],
    reaches: [u32; 2],
    children: Children,
}

/// The contents of a node.
#[derive(Clone, Debug)]
pub(super) enum Children {
    /// Two child nodes.
    Nodes([u32; 2]),
    /// The faces of a leaf and all their vertices, as ranges of the lists in the tree.
    Faces { faces: [u32; 2], vertices: [u32; 2] },
}

/// A joint that vertices of a node follow.
#[derive(Clone, Copy, Debug)]
struct Blend {
    joint: u32,
    /// Weight of the joint for the node's center.
    weight: f64,
    /// Maximum difference between the weight of a vertex and that of the center.
    spread: f64,
}

/// A face of a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafFace {
    pub(super) face: u32,
    /// Positions of the corners in the leaf's list of vertices.
    pub(super) corners: [u8; 3],
}

/// Maximum number of vertices per leaf.
pub(super) const MAX_LEAF_VERTICES: usize = 3 * MAX_LEAF_FACES;

/// The data of a pose that skinning needs.
#[derive(Clone, Debug, Default)]
pub(super) struct SkinPose {
    palette: Vec<(Matrix, Vector)>,
    /// Upper bounds of the factors by which the entries of the palette stretch lengths.
    stretches: Vec<f64>,
    morph_weights: Vec<f64>,
    origin: Vector,
}

impl SkinPose {
    pub(super) fn new(skin: &Skin, pose: &RigPose, origin: Vector) -> Self {
        let palette = skin.palette(pose.bones());
        let stretches = palette.iter().map(|(linear, _)| stretch(linear)).collect();
        Self { palette, stretches, morph_weights: pose.morph_weights().to_vec(), origin }
    }
}

/// Returns an upper bound of the factor by which a matrix stretches a vector. That factor is the
/// square root of the largest eigenvalue of MᵀM, which is at most the largest sum of magnitudes of
/// a row. For a rotation the bound is 1, up to rounding.
fn stretch(linear: &Matrix) -> f64 {
    let transposed = [0, 1, 2].map(|i| [0, 1, 2].map(|j| linear[j][i]));
    let rows = times(&transposed, linear).map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
    rows.into_iter().fold(0.0, f64::max).sqrt() * (1.0 + 1e-12)
}

impl SkinTree {
    /// Builds the tree.
    ///
    /// # Complexity
    /// O(n log n) for n faces.
    pub(super) fn new(rig: &Rig) -> Self {
        let skin = rig.skin();
        let mut of_bones: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (face, bone) in (0..).zip(bones_of_faces(rig)) {
            of_bones.entry(bone).or_default().push(face);
        }
        let (offsets, first) = offsets_by_vertex(skin);
        let mut tree = Self {
            nodes: Vec::new(),
            roots: Vec::new(),
            blends: Vec::new(),
            reaches: Vec::new(),
            faces: Vec::new(),
            vertices: Vec::new(),
            offsets,
            first,
        };
        for (bone, mut faces) in of_bones {
            let root = tree.grow(skin, bone, &mut faces);
            tree.roots.push(root);
        }
        tree
    }

    /// Adds a node around some faces, and all nodes below it. Faces are halved by rank, so the
    /// depth is logarithmic in their number.
    fn grow(&mut self, skin: &Skin, bone: u32, faces: &mut [u32]) -> u32 {
        let at = self.nodes.len();
        let mut vertices: Vec<u32> = faces.iter().flat_map(|&face| skin.faces()[face as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let node = self.about(skin, bone, &vertices);
        self.nodes.push(node);
        self.nodes[at].children = if faces.len() <= MAX_LEAF_FACES {
            faces.sort_unstable();
            self.leaf(skin, faces, &vertices)
        } else {
            let middle = |face: &u32| {
                let corners = skin.faces()[*face as usize].map(|corner| skin.positions()[corner as usize]);
                corners.into_iter().fold([0.0; 3], |sum, corner| add(&sum, &corner))
            };
            let [low, high] = box_of(&faces.iter().map(middle).collect::<Vec<_>>());
            let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).unwrap_or(0);
            let half = faces.len() / 2;
            faces.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(b)));
            let (lower, upper) = faces.split_at_mut(half);
            Children::Nodes([self.grow(skin, bone, lower), self.grow(skin, bone, upper)])
        };
        at as u32
    }

    fn leaf(&mut self, skin: &Skin, faces: &[u32], vertices: &[u32]) -> Children {
        let starts = [self.faces.len() as u32, self.vertices.len() as u32];
        // All corners are in `vertices`, which has at most 24 entries.
        let place = |corner: u32| vertices.partition_point(|&vertex| vertex < corner) as u8;
        let of_leaf = faces.iter().map(|&face| LeafFace { face, corners: skin.faces()[face as usize].map(place) });
        self.faces.extend(of_leaf);
        self.vertices.extend(vertices);
        Children::Faces {
            faces: [starts[0], self.faces.len() as u32],
            vertices: [starts[1], self.vertices.len() as u32],
        }
    }

    /// Builds a node around some vertices, without its children.
    fn about(&mut self, skin: &Skin, bone: u32, vertices: &[u32]) -> Node {
        let places: Vec<Vector> = vertices.iter().map(|&vertex| skin.positions()[vertex as usize]).collect();
        let [low, high] = box_of(&places);
        let center = scale(&add(&low, &high), 0.5);
        let radius = places.iter().map(|&p| length(&sub(&p, &center))).fold(0.0, f64::max) * (1.0 + 1e-12);

        // For each joint: the minimum and maximum weight, and the number of vertices that follow
        // it. Other vertices have a weight of zero.
        let mut ranges: BTreeMap<u32, (f64, f64, usize)> = BTreeMap::new();
        let mut reaches: BTreeMap<u32, f64> = BTreeMap::new();
        let mut terms = 0;
        for &vertex in vertices {
            let influences = skin.influences(vertex);
            let mut own: BTreeMap<u32, f64> = BTreeMap::new();
            influences.iter().for_each(|i| *own.entry(i.joint).or_default() += i.weight);
            for (joint, weight) in own {
                let range = ranges.entry(joint).or_insert((weight, weight, 0));
                *range = (range.0.min(weight), range.1.max(weight), range.2 + 1);
            }
            let mut moved: BTreeMap<u32, f64> = BTreeMap::new();
            let offsets = self.offsets_of(vertex);
            offsets.iter().for_each(|&(morph, offset)| *moved.entry(morph).or_default() += length(&offset));
            for (morph, by) in moved {
                let reach = reaches.entry(morph).or_default();
                *reach = reach.max(by * (1.0 + 1e-12));
            }
            terms = terms.max(influences.len() + offsets.len());
        }
        let starts = [self.blends.len() as u32, self.reaches.len() as u32];
        let terms = (terms + ranges.len() + 16) as f64;
        let ranges: Vec<(u32, [f64; 2])> = ranges
            .into_iter()
            .map(|(joint, (least, most, count))| (joint, [if count < vertices.len() { 0.0 } else { least }, most]))
            .collect();
        let sum: f64 = ranges.iter().map(|(_, [least, most])| least + most).sum();
        self.blends.extend(ranges.into_iter().map(|(joint, [least, most])| {
            let weight = (least + most) / sum;
            Blend { joint, weight, spread: (most - weight).max(weight - least) }
        }));
        self.reaches.extend(reaches);
        let [blends, reaches] = [[starts[0], self.blends.len() as u32], [starts[1], self.reaches.len() as u32]];
        Node { bone, center, radius, terms, blends, reaches, children: Children::Nodes([0; 2]) }
    }

    fn offsets_of(&self, vertex: u32) -> &[(u32, Vector)] {
        let at = vertex as usize;
        &self.offsets[self.first[at] as usize..self.first[at + 1] as usize]
    }

    pub(super) fn roots(&self) -> &[u32] {
        &self.roots
    }

    pub(super) fn children(&self, node: u32) -> &Children {
        &self.nodes[node as usize].children
    }

    /// Returns the bone that the faces of a node follow most.
    pub(super) fn bone(&self, node: u32) -> u32 {
        self.nodes[node as usize].bone
    }

    /// Returns the faces in a range of a leaf.
    pub(super) fn faces(&self, [start, end]: [u32; 2]) -> &[LeafFace] {
        &self.faces[start as usize..end as usize]
    }

    /// Returns a sphere in the world that encloses all faces of a node in a pose, including the
    /// rounding of their vertices. If numbers leave the range, its center or radius is not finite.
    pub(super) fn sphere(&self, node: u32, pose: &SkinPose) -> (Vector, f64) {
        let node = &self.nodes[node as usize];
        let blends = &self.blends[node.blends[0] as usize..node.blends[1] as usize];
        let reaches = &self.reaches[node.reaches[0] as usize..node.reaches[1] as usize];
        let morphed = |&(morph, by): &(u32, f64)| pose.morph_weights[morph as usize].abs() * by;
        let radius = node.radius + reaches.iter().map(morphed).sum::<f64>();
        let farthest = length(&node.center) + radius;
        let image = |blend: &Blend| {
            let (linear, offset) = &pose.palette[blend.joint as usize];
            add(&apply(linear, node.center), offset)
        };
        let (mut middle, mut stretch, mut size) = ([0.0; 3], 0.0_f64, 0.0_f64);
        for blend in blends {
            let own = pose.stretches[blend.joint as usize];
            middle = add(&middle, &scale(&image(blend), blend.weight));
            stretch = stretch.max(own);
            size = size.max(own * farthest + length(&pose.palette[blend.joint as usize].1));
        }
        let apart: f64 = if let [_] = blends {
            0.0
        } else {
            blends.iter().map(|blend| blend.spread * length(&sub(&image(blend), &middle))).sum()
        };
        let radius = (stretch * radius + apart) * (1.0 + 1e-12);
        (add(&middle, &pose.origin), radius + node.terms * ROUNDING * (size + length(&pose.origin)))
    }

    /// Computes the positions of the vertices of a leaf in the world, for a pose. If the origin is
    /// zero, they have the same bits as those of [`Skin::skinned`].
    pub(super) fn skin(
        &self,
        skin: &Skin,
        [start, end]: [u32; 2],
        pose: &SkinPose,
        places: &mut [Vector; MAX_LEAF_VERTICES],
    ) {
        for (place, &vertex) in places.iter_mut().zip(&self.vertices[start as usize..end as usize]) {
            let mut point = skin.positions()[vertex as usize];
            for &(morph, offset) in self.offsets_of(vertex) {
                let weight = pose.morph_weights[morph as usize];
                if weight != 0.0 {
                    point = [0, 1, 2].map(|k| point[k] + weight * offset[k]);
                }
            }
            *place = add(&blended(&pose.palette, skin.influences(vertex), point), &pose.origin);
        }
    }
}

/// Returns the morph offsets sorted by vertex, and the start of each vertex's offsets.
pub(super) fn offsets_by_vertex(skin: &Skin) -> (Vec<(u32, Vector)>, Vec<u32>) {
    let mut all: Vec<(u32, u32, Vector)> = Vec::new();
    for (morph, target) in (0..).zip(skin.morphs()) {
        all.extend(target.offsets.iter().map(|&(vertex, offset)| (vertex, morph, offset)));
    }
    // The sort is stable, so that sums keep the order of the file.
    all.sort_by_key(|&(vertex, ..)| vertex);
    let first = (0..=skin.positions().len() as u32).map(|vertex| all.partition_point(|own| own.0 < vertex) as u32);
    let first = first.collect();
    (all.into_iter().map(|(_, morph, offset)| (morph, offset)).collect(), first)
}

#[cfg(test)]
mod tests;
