//! The structures that find overlapping boxes, one of them at work.

mod columns;
mod every;

use std::ops::ControlFlow;

use crate::partition::{
    BoxTree, Changes, Dynamic, HierarchicalGrid, Move, Partition, Ray, SweepOneAxis, SweepThreeAxes,
};
use crate::volume::MinMax;
use columns::Columns;
use every::Every;

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

/// The edge of the least cells of a hierarchical grid, in world units: smaller boxes share these.
const LEAST_CELL: f64 = 1.0 / 1024.0;

/// No place.
const NONE: u32 = u32::MAX;

/// How pairs of boxes are found. No answer depends on it; `docs/worlds.md` says which is at home where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BroadPhase {
    /// By the number of bodies and how many of them move: [`Every`](Self::Every) for a few, [`Columns`](Self::Columns) where
    /// many move, else [`Tree`](Self::Tree).
    #[default]
    Auto,
    /// Every box is compared with every box that moved.
    Every,
    /// The dynamic bounding-volume tree, [`BoxTree`].
    Tree,
    /// All pairs anew at each step, by [`ColumnSweep`](crate::partition::ColumnSweep). Queries look at every box, so that a world
    /// that is asked about many rays a step is better off with a tree.
    Columns,
    /// The [`HierarchicalGrid`].
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
        Self { choice, structure: Structure::of(choice), moving: 0.0 }
    }

    /// Takes up the structure that suits what there is now, where the choice is left to it.
    pub(super) fn adapt(&mut self, moved: usize) {
        let len = self.structure.len();
        self.moving += LAST_STEP * (moved.min(len) as f64 / len.max(1) as f64 - self.moving);
        if self.choice != BroadPhase::Auto {
            return;
        }
        let wanted = match &self.structure {
            Structure::Every(_) if len <= MOST_FOR_EVERY => return,
            _ if len < MOST_FOR_EVERY / 2 => BroadPhase::Every,
            _ if self.moving > SHARE_FOR_COLUMNS => BroadPhase::Columns,
            Structure::Columns(_) if self.moving > 0.5 * SHARE_FOR_COLUMNS => return,
            _ => BroadPhase::Tree,
        };
        if wanted == self.structure.kind() {
            return;
        }
        let boxes = self.structure.boxes();
        self.structure = match wanted {
            // All at once, by a builder.
            BroadPhase::Tree => Structure::Tree(Box::new(boxes.into_iter().collect())),
            _ => {
                let mut structure = Structure::of(wanted);
                boxes.iter().for_each(|(body, bounds)| structure.insert(*body, bounds));
                structure
            }
        };
    }

    /// A new box, or another one for a body that has one.
    pub(super) fn insert(&mut self, body: u32, bounds: &MinMax) {
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
        let sweep: &mut dyn Dynamic = match &mut self.structure {
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
        sweep.step(moves, &mut changes);
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
            BroadPhase::Grid => match HierarchicalGrid::new(LEAST_CELL) {
                Ok(grid) => Self::Grid(Box::new(grid)),
                // Only for cells that are not above zero.
                Err(_) => Self::Tree(Box::default()),
            },
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
            Look::Through(every) => every.boxes().iter().map(|&(bounds, body)| (body, bounds)).collect(),
            Look::In(partition) => {
                let mut boxes = Vec::with_capacity(partition.len());
                partition.each(&mut |body, bounds| boxes.push((body, *bounds)));
                boxes
            }
        }
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
