//! Builders: from boxes to the neutral binary tree, each by another strategy, all behind one enum.
//!
//! | strategy | file | complexity |
//! |---|---|---|
//! | linear: along a space-filling curve | `../morton.rs` | O(n log n) |
//! | top-down: halves of equal number | `median.rs` | O(n log n) |
//! | top-down: the cheapest of some planes | `binned_sah.rs` | O(n log n) |
//! | top-down: the cheapest of all planes | `sweep_sah.rs` | O(n log n) |
//! | bottom-up: nearest neighbours joined | `ploc.rs` | O(n log n) |
//! | insertion: one box after the other | `dynamic.rs`, `../dynamic/` | O(n log n) |
//! | any of these, then improved by moving subtrees | `reinsertion.rs` | O(n log n) and a bounded search for each node |
//!
//! Which of them to take is measured in `docs/hierarchies.md`; [`Builder::Auto`] goes by it.

mod binned_sah;
mod bins;
mod dynamic;
mod item;
mod linked;
mod median;
mod ploc;
mod reinsertion;
mod sweep_sah;
mod top_down;

pub use dynamic::DynamicTree;
pub use reinsertion::optimise;

use super::binary::{BinaryTree, LEAF_CAPACITY};
use super::morton::build_morton;
use crate::volume::Aabb;

/// How a tree is built. No answer depends on it: only how long it takes to build, and to ask. Of answers that are equally right it may be
/// another one: which faces that meet [`distance`](crate::query::distance) names, and the winding number of an open mesh within its error.
///
/// ```
/// use impinge::hierarchy::{Builder, MAX_DEPTH};
/// use impinge::volume::Aabb;
///
/// let boxes: Vec<Aabb> = (0..100).map(|i| Aabb { min: [i as f32, 0.0, 0.0], max: [i as f32 + 1.0, 1.0, 1.0] }).collect();
/// for builder in Builder::ALL {
///     let tree = builder.build(&boxes);
///     assert!(tree.nodes[0].count == 100 && tree.depth() <= MAX_DEPTH);
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Builder {
    /// [`SweepSah`](Self::SweepSah) for up to 8,192 boxes, [`BinnedSah`](Self::BinnedSah) for up to 131,072, [`Morton`](Self::Morton)
    /// for more.
    #[default]
    Auto,
    /// Along a space-filling curve: the fastest build.
    Morton,
    /// Top-down, halved at the median of the widest axis: the fullest leaves and the least depth.
    Median,
    /// Top-down, at the cheapest of a few planes by surface area.
    BinnedSah,
    /// Top-down, at the cheapest of all planes by surface area.
    SweepSah,
    /// Bottom-up, nearest neighbours joined.
    Ploc,
    /// One box after the other, as a [`DynamicTree`] takes them.
    Insertion,
    /// [`Ploc`](Self::Ploc), then improved by [`optimise`]: the slowest build.
    Reinsertion,
}

/// Up to so many boxes `Auto` sweeps, which takes some 6 ms for as many.
const MOST_SWEPT: usize = 1 << 13;

/// Up to so many it goes by the surface area in bins, which takes some 40 ms for as many: the tree answers up to three times as soon as
/// one along a curve where triangles are uneven, as those of machines and rooms are. Many more are waited for.
const MOST_BINNED: usize = 1 << 17;

impl Builder {
    /// Every strategy, which leaves out `Auto`.
    pub const ALL: [Self; 7] =
        [Self::Morton, Self::Median, Self::BinnedSah, Self::SweepSah, Self::Ploc, Self::Insertion, Self::Reinsertion];

    /// What reports and options call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Morton => "morton",
            Self::Median => "median",
            Self::BinnedSah => "binned-sah",
            Self::SweepSah => "sweep-sah",
            Self::Ploc => "ploc",
            Self::Insertion => "insertion",
            Self::Reinsertion => "reinsertion",
        }
    }

    /// The builder that is called so.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().chain([Self::Auto]).find(|builder| builder.name() == name)
    }

    /// The strategy for so many boxes.
    ///
    /// ```
    /// use impinge::hierarchy::Builder;
    ///
    /// assert_eq!(Builder::Auto.strategy(8_192), Builder::SweepSah);
    /// assert_eq!(Builder::Auto.strategy(131_072), Builder::BinnedSah);
    /// assert_eq!(Builder::Auto.strategy(131_073), Builder::Morton);
    /// assert_eq!(Builder::named("ploc").map(|named| named.strategy(3)), Some(Builder::Ploc));
    /// ```
    #[must_use]
    pub fn strategy(self, boxes: usize) -> Self {
        match self {
            Self::Auto if boxes <= MOST_SWEPT => Self::SweepSah,
            Self::Auto if boxes <= MOST_BINNED => Self::BinnedSah,
            Self::Auto => Self::Morton,
            chosen => chosen,
        }
    }

    /// The tree of these boxes, none of which may be empty or not finite; the same for any number of threads.
    ///
    /// # Complexity
    /// O(n log n), depth at most [`MAX_DEPTH`](super::MAX_DEPTH), for any input: equal, nested or sorted boxes included.
    #[must_use]
    pub fn build(self, boxes: &[Aabb]) -> BinaryTree {
        self.build_with_leaves_of(LEAF_CAPACITY, boxes)
    }

    /// As [`build`](Self::build), with at most `capacity` boxes in a leaf, which is brought between one and
    /// [`LEAF_CAPACITY`].
    #[must_use]
    pub fn build_with_leaves_of(self, capacity: usize, boxes: &[Aabb]) -> BinaryTree {
        let capacity = capacity.clamp(1, LEAF_CAPACITY);
        if boxes.is_empty() {
            return BinaryTree::default();
        }
        match self {
            Self::Auto => self.strategy(boxes.len()).build_with_leaves_of(capacity, boxes),
            Self::Morton if capacity == LEAF_CAPACITY => build_morton(boxes),
            Self::Morton => median::cut_leaves(&build_morton(boxes), boxes, capacity),
            Self::Median => median::build(boxes, capacity),
            Self::BinnedSah => binned_sah::build(boxes, capacity),
            Self::SweepSah => sweep_sah::build(boxes, capacity),
            Self::Ploc => ploc::build(boxes, capacity),
            Self::Insertion => {
                let mut tree = DynamicTree::new();
                for bounds in boxes {
                    tree.insert(*bounds);
                }
                tree.to_binary(capacity)
            }
            Self::Reinsertion => optimise(&ploc::build(boxes, capacity), boxes, capacity),
        }
    }
}
