//! A tree over the faces of a skin, of spheres that hold in any pose: each follows from where the bones are, when it is asked for.
//!
//! # Source
//! Kavan, Žára, *Fast collision detection for skeletally deformable models*, Computer Graphics Forum 24(3), 2005: the spheres of a
//! hierarchy are refitted on demand, one by one, from the joints that what they hold is blended from. Ours departs in the bound, in
//! that a tree stands for each bone, so that no sphere is blended from many joints, and in that exact faces are below.
//!
//! # The bound
//! A vertex `p` goes to `Σ wⱼ (Lⱼ p + oⱼ)`, weights summing up to one. For any centre `c` and weights `vⱼ` of a node, which also do,
//! let `mⱼ = Lⱼ c + oⱼ` and `m = Σ vⱼ mⱼ`. Then the vertex is off from `m` by
//! `Σ (wⱼ - vⱼ) (mⱼ - m) + Σ wⱼ Lⱼ (p - c)`, as weights that sum up to the same do not care where the origin is. So it is within
//! `Σ max |wⱼ - vⱼ| |mⱼ - m| + max ‖Lⱼ‖ max |p - c|`, where nothing but `mⱼ` and `Lⱼ` depends on the pose. The first sum is zero where
//! vertices have the same weights, and where the joints have moved as one.

use std::collections::BTreeMap;

use super::plan::bones_of_faces;
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::skin::{Skin, blended};
use super::transform::{Matrix, apply, times};
use super::volume::box_of;
use crate::math::vec3::{Vector, add, length, scale, sub};

/// Faces of a leaf at most: a choice. With fewer more spheres are found on the way to them, with more a ray that comes to a leaf
/// skins more.
const LEAF: usize = 8;

/// Of the sizes of what is added up, for each number that is: eight roundings.
const ROUNDING: f64 = 1.0 / (1_u64 << 50) as f64;

/// The tree of a skin; it knows no pose.
#[derive(Clone, Debug)]
pub(super) struct SkinTree {
    nodes: Vec<Node>,
    /// One for each bone that some faces follow most.
    roots: Vec<u32>,
    blends: Vec<Blend>,
    /// Morph targets that move vertices of a node, and how far they move them by a weight of one.
    reaches: Vec<(u32, f64)>,
    faces: Vec<LeafFace>,
    /// The vertices of leaves, each once a leaf.
    vertices: Vec<u32>,
    /// Morph targets and offsets, by vertex, then in the order of the targets.
    offsets: Vec<(u32, Vector)>,
    /// The offsets of vertex `i` are those from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
}

/// Some faces that follow one bone most.
#[derive(Clone, Debug)]
struct Node {
    bone: u32,
    /// About the vertices before any bone or morph moves them.
    centre: Vector,
    radius: f64,
    /// How many numbers are added up for a vertex or for the centre, at most.
    terms: f64,
    blends: [u32; 2],
    reaches: [u32; 2],
    below: Below,
}

/// What is below a node.
#[derive(Clone, Debug)]
pub(super) enum Below {
    /// Two nodes.
    Nodes([u32; 2]),
    /// Some faces, and all their vertices: places in the lists of these.
    Faces { faces: [u32; 2], vertices: [u32; 2] },
}

/// A joint that vertices of a node follow.
#[derive(Clone, Copy, Debug)]
struct Blend {
    joint: u32,
    /// Of the node's centre.
    weight: f64,
    /// What the weights of vertices differ from that by at most.
    spread: f64,
}

/// A face of a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafFace {
    pub(super) face: u32,
    /// Places in the leaf's list of vertices.
    pub(super) corners: [u8; 3],
}

/// The most vertices of a leaf.
pub(super) const LEAF_VERTICES: usize = 3 * LEAF;

/// What of a pose a skin follows.
#[derive(Clone, Debug, Default)]
pub(super) struct SkinPose {
    palette: Vec<(Matrix, Vector)>,
    /// No less than what each entry of the palette makes lengths grow by.
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

/// No less than the greatest factor by which a matrix makes a vector longer: the root of the greatest eigenvalue of its square,
/// which no sum of magnitudes of a row falls short of. Of a rotation it is one.
fn stretch(linear: &Matrix) -> f64 {
    let transposed = [0, 1, 2].map(|i| [0, 1, 2].map(|j| linear[j][i]));
    let rows = times(&transposed, linear).map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
    rows.into_iter().fold(0.0, f64::max).sqrt() * (1.0 + 1e-12)
}

impl SkinTree {
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

    /// Adds a node about some faces, and all below; as they are halved by rank it is as deep as their number is long.
    fn grow(&mut self, skin: &Skin, bone: u32, faces: &mut [u32]) -> u32 {
        let at = self.nodes.len();
        let mut vertices: Vec<u32> = faces.iter().flat_map(|&face| skin.faces()[face as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let node = self.about(skin, bone, &vertices);
        self.nodes.push(node);
        self.nodes[at].below = if faces.len() <= LEAF {
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
            Below::Nodes([self.grow(skin, bone, lower), self.grow(skin, bone, upper)])
        };
        at as u32
    }

    fn leaf(&mut self, skin: &Skin, faces: &[u32], vertices: &[u32]) -> Below {
        let starts = [self.faces.len() as u32, self.vertices.len() as u32];
        // All are among the vertices, of which there are 24 at most.
        let place = |corner: u32| vertices.partition_point(|&vertex| vertex < corner) as u8;
        let of_leaf = faces.iter().map(|&face| LeafFace { face, corners: skin.faces()[face as usize].map(place) });
        self.faces.extend(of_leaf);
        self.vertices.extend(vertices);
        Below::Faces { faces: [starts[0], self.faces.len() as u32], vertices: [starts[1], self.vertices.len() as u32] }
    }

    /// A node about some vertices, without what is below.
    fn about(&mut self, skin: &Skin, bone: u32, vertices: &[u32]) -> Node {
        let places: Vec<Vector> = vertices.iter().map(|&vertex| skin.positions()[vertex as usize]).collect();
        let [low, high] = box_of(&places);
        let centre = scale(&add(&low, &high), 0.5);
        let radius = places.iter().map(|&p| length(&sub(&p, &centre))).fold(0.0, f64::max) * (1.0 + 1e-12);

        // For each joint the least and the greatest weight, and how many vertices have one; the others have none.
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
        Node { bone, centre, radius, terms, blends, reaches, below: Below::Nodes([0; 2]) }
    }

    fn offsets_of(&self, vertex: u32) -> &[(u32, Vector)] {
        let at = vertex as usize;
        &self.offsets[self.first[at] as usize..self.first[at + 1] as usize]
    }

    pub(super) fn roots(&self) -> &[u32] {
        &self.roots
    }

    pub(super) fn below(&self, node: u32) -> &Below {
        &self.nodes[node as usize].below
    }

    /// The bone that the faces of a node follow most.
    pub(super) fn bone(&self, node: u32) -> u32 {
        self.nodes[node as usize].bone
    }

    /// Some faces of a leaf.
    pub(super) fn faces(&self, [start, end]: [u32; 2]) -> &[LeafFace] {
        &self.faces[start as usize..end as usize]
    }

    /// A sphere in the world that holds all faces of a node in a pose, as their vertices are rounded. Where numbers leave the range,
    /// its centre or radius is not finite.
    pub(super) fn sphere(&self, node: u32, pose: &SkinPose) -> (Vector, f64) {
        let node = &self.nodes[node as usize];
        let blends = &self.blends[node.blends[0] as usize..node.blends[1] as usize];
        let reaches = &self.reaches[node.reaches[0] as usize..node.reaches[1] as usize];
        let morphed = |&(morph, by): &(u32, f64)| pose.morph_weights[morph as usize].abs() * by;
        let radius = node.radius + reaches.iter().map(morphed).sum::<f64>();
        let farthest = length(&node.centre) + radius;
        let image = |blend: &Blend| {
            let (linear, offset) = &pose.palette[blend.joint as usize];
            add(&apply(linear, node.centre), offset)
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

    /// Where the vertices of a leaf are in the world in a pose; to the bit what [`Skin::skinned`] says, where the origin is zero.
    pub(super) fn skin(
        &self,
        skin: &Skin,
        [start, end]: [u32; 2],
        pose: &SkinPose,
        places: &mut [Vector; LEAF_VERTICES],
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

/// The morph targets of each vertex, and where those of each begin.
fn offsets_by_vertex(skin: &Skin) -> (Vec<(u32, Vector)>, Vec<u32>) {
    let mut all: Vec<(u32, u32, Vector)> = Vec::new();
    for (morph, target) in (0..).zip(skin.morphs()) {
        all.extend(target.offsets.iter().map(|&(vertex, offset)| (vertex, morph, offset)));
    }
    // Stable, as sums are made in the order of the file.
    all.sort_by_key(|&(vertex, ..)| vertex);
    let first = (0..=skin.positions().len() as u32).map(|vertex| all.partition_point(|own| own.0 < vertex) as u32);
    let first = first.collect();
    (all.into_iter().map(|(_, morph, offset)| (morph, offset)).collect(), first)
}

#[cfg(test)]
mod tests;
