//! The boxes of some bodies in one structure, and the choice between the structures.

use std::ops::ControlFlow;
use std::sync::OnceLock;

use super::columns::Columns;
use super::every::Every;
use super::sizes::{SAMPLE, Sizes};
use crate::budget::{Budget, Stopped};
use crate::partition::{
    BoxTree, Changes, Dynamic, HierarchicalGrid, Move, Partition, Ray, SweepOneAxis, SweepThreeAxes,
};
use crate::volume::MinMax;

/// Maximum number of boxes that are compared one by one; more use a structure. Comparing one by one
/// resumes at half of it, so that a world of about this size does not switch back and forth.
///
/// Measured by `--bin worlds -- kinds` of the benchmarks: with 100 moving boxes, comparing every
/// box takes as long as columns. If 1/5 of 100 boxes move, it is faster than every structure. With
/// 300 boxes, it takes 1.6 times as long.
const MAX_FOR_EVERY: usize = 128;

/// Minimum share of the boxes that must move before all pairs of boxes without a structure are
/// found together. For fewer moves it takes longer than comparing each moved box with every box.
const SHARE_FOR_SWEEP: f64 = 0.125;

/// Minimum share of the boxes that must move before all boxes are sorted into columns. Below half
/// of this share, each box is moved in a tree instead.
///
/// By the same measurement: if 1/20 of 1,000 or 10,000 boxes move, columns take 0.8 and 0.6 times
/// as long as the tree. If 1/1000 of 10,000 boxes move, columns take 17 times as long. Boxes of
/// different sizes change this little.
const SHARE_FOR_COLUMNS: f64 = 0.04;

/// Weight of the last step in the average share of moving boxes. A burst of one step changes no
/// choice; a burst of two steps may.
const LAST_STEP_WEIGHT: f64 = 0.03;

/// Method by which overlapping pairs of boxes are found. No result depends on it;
/// `docs/tasks/worlds.md` compares the methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BroadPhase {
    /// Chooses by the number of bodies, the share of them that moves, and their sizes. Uses
    /// [`Every`](Self::Every) for a few bodies and [`Columns`](Self::Columns) if many move.
    /// Otherwise uses [`Grid`](Self::Grid) for bodies of similar size in a world in which no ray
    /// was ever cast, else [`Tree`](Self::Tree).
    #[default]
    Auto,
    /// Compares every box with every box that moved.
    Every,
    /// Uses the dynamic bounding-volume tree, [`BoxTree`].
    Tree,
    /// Finds all pairs again at each step, by [`ColumnSweep`](crate::partition::ColumnSweep).
    /// Queries visit every box, so use a tree if you cast many rays per step.
    Columns,
    /// Uses the [`HierarchicalGrid`], whose smallest cells follow the sizes of the boxes.
    Grid,
    /// Sorts and sweeps along one axis, by [`SweepOneAxis`].
    OneAxis,
    /// Sorts and sweeps along three axes, by [`SweepThreeAxes`].
    ThreeAxes,
}

impl BroadPhase {
    /// All choices.
    pub const ALL: [Self; 7] =
        [Self::Auto, Self::Every, Self::Tree, Self::Columns, Self::Grid, Self::OneAxis, Self::ThreeAxes];
}

/// The boxes of some bodies, in the structure in use.
#[derive(Clone, Debug)]
pub(super) struct Boxes {
    choice: BroadPhase,
    structure: Structure,
    /// Average share of the bodies that move in a step, weighted to the most recent steps.
    moving: f64,
    sizes: Sizes,
    /// Bound for the keys: all are smaller.
    keys: u32,
    /// Set once a ray was cast.
    knows_rays: OnceLock<()>,
}

/// The structure in use.
#[derive(Clone, Debug)]
enum Structure {
    Every(Every),
    Tree(Box<BoxTree>),
    Columns(Box<Columns>),
    Grid(Box<HierarchicalGrid>),
    OneAxis(Box<SweepOneAxis>),
    ThreeAxes(Box<SweepThreeAxes>),
}

/// Facts about pairs that a structure knows after boxes moved.
#[derive(Clone, Debug)]
pub(in crate::world) enum KnownPairs {
    /// Nothing is known: each box must be searched for.
    Nothing,
    /// The changes by the moves are known.
    Changes(Changes),
    /// All overlapping pairs are known.
    All(Vec<[u32; 2]>),
}

impl Default for Boxes {
    fn default() -> Self {
        Self::new(BroadPhase::Auto)
    }
}

impl Boxes {
    pub(super) fn new(choice: BroadPhase) -> Self {
        Self {
            choice,
            structure: Structure::of(choice),
            moving: 0.0,
            sizes: Sizes::default(),
            keys: 0,
            knows_rays: OnceLock::new(),
        }
    }

    /// Switches to the structure that suits the current boxes, if the choice is automatic. Adapts
    /// the cells of a grid in any case.
    pub(super) fn adapt(&mut self, moved: usize) {
        let len = self.structure.len();
        self.moving += LAST_STEP_WEIGHT * (moved.min(len) as f64 / len.max(1) as f64 - self.moving);
        self.sizes.age(moved);
        let suits = |choice: BroadPhase| choice == BroadPhase::Every || len <= MAX_FOR_EVERY;
        if matches!(self.structure, Structure::Every(_)) && suits(self.choice) {
            return;
        }
        if self.sizes.are_stale(len) {
            self.sizes = Sizes::of(self.structure.sample(self.keys));
            if let Structure::Grid(grid) = &self.structure
                && !self.sizes.fit(grid.cell())
            {
                self.structure = self.build(BroadPhase::Grid);
            }
        }
        if self.choice != BroadPhase::Auto {
            return;
        }
        let wanted = match &self.structure {
            _ if len < MAX_FOR_EVERY / 2 => BroadPhase::Every,
            _ if self.moving > SHARE_FOR_COLUMNS => BroadPhase::Columns,
            Structure::Columns(_) if self.moving > 0.5 * SHARE_FOR_COLUMNS => return,
            _ if self.sizes.are_uniform && self.knows_rays.get().is_none() => BroadPhase::Grid,
            _ => BroadPhase::Tree,
        };
        if wanted != self.structure.kind() {
            self.structure = self.build(wanted);
        }
    }

    /// Builds a structure of the current boxes.
    fn build(&self, kind: BroadPhase) -> Structure {
        let boxes = self.structure.boxes();
        let mut structure = match kind {
            // Inserts the boxes one after the other, through `FromIterator`.
            BroadPhase::Tree => return Structure::Tree(Box::new(boxes.into_iter().collect())),
            BroadPhase::Grid => Structure::Grid(Box::new(HierarchicalGrid::with_cell(self.sizes.cell))),
            _ => Structure::of(kind),
        };
        boxes.iter().for_each(|(body, bounds)| structure.insert(*body, bounds));
        structure
    }

    /// Inserts the box of a body, or replaces it.
    pub(super) fn insert(&mut self, body: u32, bounds: &MinMax) {
        self.sizes.age(1);
        self.keys = self.keys.max(body + 1);
        self.structure.insert(body, bounds);
    }

    pub(super) fn remove(&mut self, body: u32) {
        match &mut self.structure {
            Structure::Every(every) => every.remove(body),
            Structure::Columns(columns) => columns.boxes.remove(body),
            Structure::Tree(tree) => _ = tree.remove(body),
            Structure::Grid(grid) => _ = grid.remove(body),
            Structure::OneAxis(sweep) => _ = sweep.remove(body),
            Structure::ThreeAxes(sweep) => _ = sweep.remove(body),
        }
    }

    /// Moves boxes, and returns the facts about pairs that are known afterwards.
    ///
    /// # Errors
    /// Returns an error if the budget ended the search for pairs, or if there is not enough
    /// memory for them. The boxes have moved all the same.
    pub(super) fn step(&mut self, moves: &[Move], budget: &Budget<'_>) -> Result<KnownPairs, Stopped> {
        let dynamic: &mut dyn Dynamic = match &mut self.structure {
            Structure::Grid(grid) => &mut **grid,
            Structure::OneAxis(sweep) => &mut **sweep,
            Structure::ThreeAxes(sweep) => &mut **sweep,
            Structure::Columns(columns) => {
                columns.boxes.update(moves);
                return columns.pairs(budget).map(KnownPairs::All);
            }
            Structure::Every(every) => {
                every.update(moves);
                let is_sweep = moves.len() as f64 > SHARE_FOR_SWEEP * every.boxes().len() as f64;
                return if is_sweep { every.pairs(budget).map(KnownPairs::All) } else { Ok(KnownPairs::Nothing) };
            }
            Structure::Tree(tree) => {
                moves.iter().for_each(|step| step.to.iter().for_each(|bounds| _ = tree.insert(step.key, *bounds)));
                return Ok(KnownPairs::Nothing);
            }
        };
        let mut changes = Changes::default();
        dynamic.step(moves, &mut changes);
        changes.check_complete()?;
        Ok(KnownPairs::Changes(changes))
    }

    /// Calls `visit` for each body.
    pub(super) fn for_each(&self, visit: &mut dyn FnMut(u32, &MinMax)) {
        match self.structure.look() {
            Look::Through(every) => every.iter().for_each(|(bounds, body)| visit(body, bounds)),
            Look::In(partition) => partition.each(visit),
        }
    }

    /// Returns `true` if there are no boxes.
    pub(super) fn is_empty(&self) -> bool {
        self.structure.len() == 0
    }

    pub(super) fn for_each_overlapping(&self, bounds: &MinMax, visit: &mut dyn FnMut(u32)) {
        match self.structure.look() {
            Look::Through(every) => every.for_each_overlapping(bounds, visit),
            Look::In(partition) => {
                let _ = partition.overlapping(bounds, &mut |body| {
                    visit(body);
                    ControlFlow::Continue(())
                });
            }
        }
    }

    /// Visits the bodies whose boxes a ray enters, up to the ray parameter that `visit` last
    /// returned.
    pub(super) fn along(&self, ray: &Ray, visit: &mut dyn FnMut(u32) -> f64) {
        if self.knows_rays.get().is_none() {
            let _ = self.knows_rays.set(());
        }
        match self.structure.look() {
            Look::Through(every) => every.along(ray, visit),
            Look::In(partition) => partition.ray(ray, &mut |found| visit(found.key)),
        }
    }
}

/// The data that a query searches.
enum Look<'b> {
    Through(&'b Every),
    In(&'b dyn Partition),
}

impl Structure {
    /// Returns an empty structure.
    fn of(kind: BroadPhase) -> Self {
        match kind {
            BroadPhase::Auto | BroadPhase::Every => Self::Every(Every::default()),
            BroadPhase::Tree => Self::Tree(Box::default()),
            BroadPhase::Columns => Self::Columns(Box::default()),
            BroadPhase::Grid => Self::Grid(Box::new(HierarchicalGrid::with_cell(Sizes::default().cell))),
            BroadPhase::OneAxis => Self::OneAxis(Box::default()),
            BroadPhase::ThreeAxes => Self::ThreeAxes(Box::default()),
        }
    }

    fn kind(&self) -> BroadPhase {
        match self {
            Self::Every(_) => BroadPhase::Every,
            Self::Tree(_) => BroadPhase::Tree,
            Self::Columns(_) => BroadPhase::Columns,
            Self::Grid(_) => BroadPhase::Grid,
            Self::OneAxis(_) => BroadPhase::OneAxis,
            Self::ThreeAxes(_) => BroadPhase::ThreeAxes,
        }
    }

    fn look(&self) -> Look<'_> {
        match self {
            Self::Every(every) => Look::Through(every),
            Self::Columns(columns) => Look::Through(&columns.boxes),
            Self::Tree(tree) => Look::In(&**tree),
            Self::Grid(grid) => Look::In(&**grid),
            Self::OneAxis(sweep) => Look::In(&**sweep),
            Self::ThreeAxes(sweep) => Look::In(&**sweep),
        }
    }

    fn len(&self) -> usize {
        match self.look() {
            Look::Through(every) => every.boxes().len(),
            Look::In(partition) => partition.len(),
        }
    }

    fn boxes(&self) -> Vec<(u32, MinMax)> {
        match self.look() {
            Look::Through(every) => every.iter().map(|(bounds, body)| (body, *bounds)).collect(),
            Look::In(partition) => {
                let mut boxes = Vec::with_capacity(partition.len());
                partition.each(&mut |body, bounds| boxes.push((body, *bounds)));
                boxes
            }
        }
    }

    /// Returns some of the boxes, spread over the keys, which are all below `keys`.
    fn sample(&self, keys: u32) -> impl Iterator<Item = MinMax> {
        let len = match self.look() {
            Look::Through(every) => every.boxes().len(),
            Look::In(_) => keys as usize,
        };
        (0..len).step_by(len.div_ceil(SAMPLE).max(1)).filter_map(move |at| match self.look() {
            Look::Through(every) => every.boxes().get(at).copied(),
            Look::In(partition) => partition.get(at as u32),
        })
    }

    fn insert(&mut self, body: u32, bounds: &MinMax) {
        match self {
            Self::Every(every) => every.insert(body, bounds),
            Self::Columns(columns) => columns.boxes.insert(body, bounds),
            Self::Tree(tree) => _ = tree.insert(body, *bounds),
            Self::Grid(grid) => _ = grid.insert(body, *bounds),
            Self::OneAxis(sweep) => _ = sweep.insert(body, *bounds),
            Self::ThreeAxes(sweep) => _ = sweep.insert(body, *bounds),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world_of(sizes: impl Fn(u32) -> f64) -> Boxes {
        let mut broad = Boxes::default();
        for body in 0..300 {
            let low = [f64::from(body), 0.0, 0.0];
            let size = sizes(body);
            broad.insert(body, &MinMax::from_ordered(low, low.map(|x| x + size)));
        }
        broad
    }

    fn kind_after(broad: &mut Boxes, steps: usize, moved: usize) -> BroadPhase {
        (0..steps).for_each(|_| broad.adapt(moved));
        broad.structure.kind()
    }

    #[test]
    fn the_choice_depends_on_numbers_moves_sizes_and_rays() {
        let mut broad = world_of(|_| 1.0);
        assert_eq!(kind_after(&mut broad, 1, 1), BroadPhase::Grid);
        assert_eq!(kind_after(&mut broad, 20, 300), BroadPhase::Columns);
        assert_eq!(kind_after(&mut broad, 200, 1), BroadPhase::Grid);
        let ray = Ray::new([0.5; 3], [1.0, 0.0, 0.0], f64::INFINITY).expect("a ray");
        let mut found = 0;
        broad.along(&ray, &mut |_| {
            found += 1;
            f64::INFINITY
        });
        assert_eq!(found, 300);
        assert_eq!(kind_after(&mut broad, 1, 1), BroadPhase::Tree);
        (64..300).for_each(|body| broad.remove(body));
        assert_eq!(kind_after(&mut broad, 1, 1), BroadPhase::Tree);
        broad.remove(63);
        assert_eq!(kind_after(&mut broad, 1, 1), BroadPhase::Every);
        let mut spread = world_of(|body| 1.1_f64.powi(body as i32));
        assert_eq!(kind_after(&mut spread, 1, 1), BroadPhase::Tree);
    }

    #[test]
    fn cells_of_a_grid_follow_the_boxes() {
        let mut broad = Boxes::new(BroadPhase::Grid);
        let cell = |broad: &Boxes| match &broad.structure {
            Structure::Grid(grid) => grid.cell(),
            _ => 0.0,
        };
        for size in [1.0, 100.0, 2.0] {
            for body in 0..300 {
                let low = [f64::from(body), 0.0, 0.0];
                broad.insert(body, &MinMax::from_ordered(low, low.map(|x| x + size)));
            }
            broad.adapt(300);
            assert!(cell(&broad) > size && cell(&broad) < 2.0 * size, "{} for {size}", cell(&broad));
            assert_eq!(broad.structure.len(), 300);
        }
    }
}
