//! The structures that find overlapping boxes, one of them at work.

mod columns;
mod every;
mod sizes;

use std::ops::ControlFlow;
use std::sync::OnceLock;

use crate::partition::{
    BoxTree, Changes, Dynamic, HierarchicalGrid, Move, Partition, Ray, SweepOneAxis, SweepThreeAxes,
};
use crate::volume::MinMax;
use columns::Columns;
use every::Every;
use sizes::{SAMPLE, Sizes};

/// More boxes than this are looked for through a structure, and fewer than half of it one by one again, so that a world about
/// as large does not go back and forth. By `--bin worlds -- kinds` of the benchmarks: of 100 that move, to look at each takes
/// as long as columns do, and less than anything else where a fifth of them moves; of 300 it takes 1.6 times as long.
const MOST_FOR_EVERY: usize = 128;

/// Where a greater share of the boxes moves, all of them are sorted into columns, and where less than half of it does, each is
/// moved in a tree. By the same measurement: where a twentieth of 1,000 or 10,000 moves, columns take 0.8 and 0.6 of the tree's
/// time, and 17 times as long where a thousandth of 10,000 does; sizes that are spread change little of that.
const SHARE_FOR_COLUMNS: f64 = 0.04;

/// How much the last step counts in what share moves: a burst of one step changes nothing, one of two may.
const LAST_STEP: f64 = 0.03;

/// How pairs of boxes are found. No answer depends on it; `docs/worlds.md` says which is at home where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BroadPhase {
    /// By the number of bodies, how many of them move, and what they are: [`Every`](Self::Every) for a few, [`Columns`](Self::Columns)
    /// where many move, [`Grid`](Self::Grid) for bodies of like size in a world that was never asked about rays, else [`Tree`](Self::Tree).
    #[default]
    Auto,
    /// Every box is compared with every box that moved.
    Every,
    /// The dynamic bounding-volume tree, [`BoxTree`].
    Tree,
    /// All pairs anew at each step, by [`ColumnSweep`](crate::partition::ColumnSweep). Queries look at every box, so that a world
    /// that is asked about many rays a step is better off with a tree.
    Columns,
    /// The [`HierarchicalGrid`], with least cells that follow the sizes of the boxes.
    Grid,
    /// Sort and sweep along one axis, [`SweepOneAxis`].
    OneAxis,
    /// Sort and sweep along three axes, [`SweepThreeAxes`].
    ThreeAxes,
}

/// The boxes of the bodies.
#[derive(Clone, Debug)]
pub(super) struct Broad {
    choice: BroadPhase,
    structure: Structure,
    /// The share of the bodies that moves in a step, as it was of late.
    moving: f64,
    sizes: Sizes,
    /// Keys are below this.
    keys: u32,
    /// Set once rays were asked about.
    knows_rays: OnceLock<()>,
}

/// What is at work.
#[derive(Clone, Debug)]
enum Structure {
    Every(Every),
    Tree(Box<BoxTree>),
    Columns(Box<Columns>),
    Grid(Box<HierarchicalGrid>),
    OneAxis(Box<SweepOneAxis>),
    ThreeAxes(Box<SweepThreeAxes>),
}

/// What a structure knows about pairs after boxes moved.
#[derive(Clone, Debug)]
pub(super) enum Told {
    /// Nothing: each box is to be asked about.
    Nothing,
    /// What changed by the moves.
    Changes(Changes),
    /// All pairs.
    All(Vec<[u32; 2]>),
}

impl Default for Broad {
    fn default() -> Self {
        Self::new(BroadPhase::Auto)
    }
}

impl Broad {
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

    /// Takes up the structure that suits what there is now, where the choice is left to it.
    pub(super) fn adapt(&mut self, moved: usize) {
        let len = self.structure.len();
        self.moving += LAST_STEP * (moved.min(len) as f64 / len.max(1) as f64 - self.moving);
        self.sizes.age(moved);
        if self.sizes.are_old(len) {
            self.sizes = Sizes::of(self.structure.sample(self.keys));
            if let Structure::Grid(grid) = &self.structure
                && !self.sizes.suit(grid.cell())
            {
                self.structure = self.build(BroadPhase::Grid);
            }
        }
        if self.choice != BroadPhase::Auto {
            return;
        }
        let wanted = match &self.structure {
            Structure::Every(_) if len <= MOST_FOR_EVERY => return,
            _ if len < MOST_FOR_EVERY / 2 => BroadPhase::Every,
            _ if self.moving > SHARE_FOR_COLUMNS => BroadPhase::Columns,
            Structure::Columns(_) if self.moving > 0.5 * SHARE_FOR_COLUMNS => return,
            _ if self.sizes.are_alike && self.knows_rays.get().is_none() => BroadPhase::Grid,
            _ => BroadPhase::Tree,
        };
        if wanted != self.structure.kind() {
            self.structure = self.build(wanted);
        }
    }

    /// A structure of the boxes that there are.
    fn build(&self, kind: BroadPhase) -> Structure {
        let boxes = self.structure.boxes();
        let mut structure = match kind {
            // All at once, by a builder.
            BroadPhase::Tree => return Structure::Tree(Box::new(boxes.into_iter().collect())),
            BroadPhase::Grid => Structure::Grid(Box::new(HierarchicalGrid::with_cell(self.sizes.cell))),
            _ => Structure::of(kind),
        };
        boxes.iter().for_each(|(body, bounds)| structure.insert(*body, bounds));
        structure
    }

    /// A new box, or another one for a body that has one.
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

    /// Moves boxes, and tells what is known by that.
    pub(super) fn step(&mut self, moves: &[Move]) -> Told {
        let dynamic: &mut dyn Dynamic = match &mut self.structure {
            Structure::Grid(grid) => &mut **grid,
            Structure::OneAxis(sweep) => &mut **sweep,
            Structure::ThreeAxes(sweep) => &mut **sweep,
            structure => {
                let moves = moves.iter().filter_map(|step| Some((step.key, step.to.as_ref()?)));
                moves.for_each(|(body, bounds)| structure.insert(body, bounds));
                return match structure {
                    Structure::Columns(columns) => Told::All(columns.pairs()),
                    _ => Told::Nothing,
                };
            }
        };
        let mut changes = Changes::default();
        dynamic.step(moves, &mut changes);
        Told::Changes(changes)
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

    /// Visits the bodies whose boxes a ray meets before what `visit` last returned.
    pub(super) fn along(&self, ray: &Ray, visit: &mut dyn FnMut(u32) -> f64) {
        if self.knows_rays.get().is_none() {
            let _ = self.knows_rays.set(());
        }
        match self.structure.look() {
            Look::Through(every) => every.along(ray, visit),
            Look::In(partition) => partition.ray(ray, &mut |met| visit(met.key)),
        }
    }
}

/// Where a query looks.
enum Look<'b> {
    Through(&'b Every),
    In(&'b dyn Partition),
}

impl Structure {
    /// Of nothing.
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

    /// Some of the boxes, spread over the keys, which are below this.
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

    fn world_of(sizes: impl Fn(u32) -> f64) -> Broad {
        let mut broad = Broad::default();
        for body in 0..300 {
            let low = [f64::from(body), 0.0, 0.0];
            let size = sizes(body);
            broad.insert(body, &MinMax::from_ordered(low, low.map(|x| x + size)));
        }
        broad
    }

    fn kind_after(broad: &mut Broad, steps: usize, moved: usize) -> BroadPhase {
        (0..steps).for_each(|_| broad.adapt(moved));
        broad.structure.kind()
    }

    #[test]
    fn a_choice_goes_by_numbers_moves_sizes_and_rays() {
        let mut broad = world_of(|_| 1.0);
        assert_eq!(kind_after(&mut broad, 1, 1), BroadPhase::Grid);
        assert_eq!(kind_after(&mut broad, 20, 300), BroadPhase::Columns);
        assert_eq!(kind_after(&mut broad, 200, 1), BroadPhase::Grid);
        let ray = Ray::new([0.5; 3], [1.0, 0.0, 0.0], f64::INFINITY).expect("a ray");
        let mut met = 0;
        broad.along(&ray, &mut |_| {
            met += 1;
            f64::INFINITY
        });
        assert_eq!(met, 300);
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
        let mut broad = Broad::new(BroadPhase::Grid);
        let cell = |broad: &Broad| match &broad.structure {
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
