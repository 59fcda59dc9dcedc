//! Builders: strategies that turn boxes into the neutral binary tree, all behind one enum.
//!
//! | strategy | file | complexity |
//! |---|---|---|
//! | linear: along a space-filling curve | `../morton.rs` | O(n log n) |
//! | top-down: halves of equal number | `median.rs` | O(n log n) |
//! | top-down: the plane of least cost among some | `binned_sah.rs` | O(n log n) |
//! | top-down: the plane of least cost among all | `sweep_sah.rs` | O(n log n) |
//! | bottom-up: nearest neighbors are joined | `ploc.rs` | O(n log n) |
//! | insertion: one box after the other | `dynamic.rs`, `../dynamic/` | O(n log n) |
//! | any of these, then improved by moving subtrees | `reinsertion.rs` | O(n log n) and a bounded search for each node |
//!
//! `docs/notes/hierarchies.md` compares their measurements. [`Builder::Auto`] follows them.

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
pub use reinsertion::optimize;

use super::binary::{BinaryTree, LEAF_CAPACITY};
use super::morton::build_morton;
use crate::volume::Aabb;

/// A strategy for building a tree. It determines the time to build and to query, and no answer
/// depends on it. There are two exceptions. If several answers are equally right, another one may
/// be returned: the faces that [`distance`](crate::query::distance) names for intersecting meshes.
/// The winding number of an open mesh may differ within its error.
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
    /// [`SweepSah`](Self::SweepSah) for up to 8,192 boxes, [`BinnedSah`](Self::BinnedSah) for up to
    /// 131,072, [`Morton`](Self::Morton) for more.
    #[default]
    Auto,
    /// Splits along a space-filling curve. The fastest build.
    Morton,
    /// Splits top-down at the median of the widest axis. It has the fullest leaves and the smallest
    /// depth.
    Median,
    /// Splits top-down at the plane of least cost by surface area, among a few planes.
    BinnedSah,
    /// Splits top-down at the plane of least cost by surface area, among all planes.
    SweepSah,
    /// Joins nearest neighbors bottom-up.
    Ploc,
    /// Inserts one box after the other, as a [`DynamicTree`] does.
    Insertion,
    /// [`Ploc`](Self::Ploc), then improved by [`optimize`]. The slowest build.
    Reinsertion,
}

/// Maximum number of boxes for which `Auto` takes `SweepSah`. The build then takes about 6 ms.
const MAX_SWEPT: usize = 1 << 13;

/// Maximum number of boxes for which `Auto` takes `BinnedSah`. The build then takes about 40 ms. If
/// triangles are uneven, as those of machines and rooms are, the tree answers up to 3 times faster
/// than a Morton tree. For more boxes the build takes too long.
const MAX_BINNED: usize = 1 << 17;

impl Builder {
    /// Every strategy. `Auto` is not included, because it selects one of them.
    pub const ALL: [Self; 7] =
        [Self::Morton, Self::Median, Self::BinnedSah, Self::SweepSah, Self::Ploc, Self::Insertion, Self::Reinsertion];

    /// Returns the name of the strategy in reports and options.
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

    /// Returns the strategy with this name, or `None` if there is none.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().chain([Self::Auto]).find(|builder| builder.name() == name)
    }

    /// Returns the strategy for this number of boxes. It resolves `Auto`.
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
            Self::Auto if boxes <= MAX_SWEPT => Self::SweepSah,
            Self::Auto if boxes <= MAX_BINNED => Self::BinnedSah,
            Self::Auto => Self::Morton,
            chosen => chosen,
        }
    }

    /// Builds the tree of these boxes; without boxes it has no nodes. No box may be empty or
    /// infinite. The tree is the same for any number of threads.
    ///
    /// # Complexity
    /// O(n log n), depth at most [`MAX_DEPTH`](super::MAX_DEPTH), for any input: equal, nested or
    /// sorted boxes included.
    #[must_use]
    pub fn build(self, boxes: &[Aabb]) -> BinaryTree {
        self.build_with_leaves_of(LEAF_CAPACITY, boxes)
    }

    /// Builds the tree as [`build`](Self::build) does, with at most `capacity` boxes in a leaf.
    /// `capacity` is clamped to 1 to [`LEAF_CAPACITY`].
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
            Self::Reinsertion => optimize(&ploc::build(boxes, capacity), boxes, capacity),
        }
    }
}
