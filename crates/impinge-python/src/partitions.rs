//! Partitions of space in Python: boxes under keys that the caller chooses, which are inserted,
//! moved and removed.
//!
//! Queries use a snapshot. A call that changes a partition while a query runs makes a copy, so that
//! neither waits for the other.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use impinge::InputError;
use impinge::budget::{Budget, Stopped};
use impinge::partition::{
    Axis, BoxTree, BspTree, Cells, Changes, ColumnSweep, Dynamic, HashedGrid, HierarchicalGrid, KdTree, LooseOctree,
    Move, Octree, Partition, SweepOneAxis, SweepThreeAxes, UniformGrid,
};
use impinge::volume::MinMax;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::boxes::Boxes;
use crate::errors::{Fault, OUT_OF_MEMORY, kind_and_place, message};
use crate::workers;

/// Exponent of the magnitude below which coordinates of boxes must be, 2^320.
pub(crate) const EXPONENT: i32 = 320;

/// Keys below this are accepted for any number of boxes. Memory for this number of keys takes 48
/// MiB.
const ALWAYS_ACCEPTED_KEYS: usize = 1 << 20;

/// Maximum number of keys for each box, if keys exceed [`ALWAYS_ACCEPTED_KEYS`].
const MAX_KEYS_PER_BOX: usize = 16;

/// Keys, one in each row of an array of u32.
type Keys<'py> = Bound<'py, PyArray1<u32>>;

/// Contents of a partition of `impinge.partition`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct PartitionCore(Mutex<Arc<Held>>);

#[derive(Clone)]
struct Held {
    kind: Kind,
    /// Number that is larger than all keys that were ever used.
    reach: usize,
}

#[derive(Clone)]
enum Kind {
    BoxTree(BoxTree),
    UniformGrid(UniformGrid),
    HashedGrid(HashedGrid),
    HierarchicalGrid(HierarchicalGrid),
    Octree(Octree),
    LooseOctree(LooseOctree),
    OneAxis(SweepOneAxis),
    ThreeAxes(SweepThreeAxes),
    KdTree(KdTree),
    BspTree(BspTree),
}

impl Kind {
    /// Returns the partition called `name` with boxes whose keys are their indices. `size` is the
    /// edge of a cell or the margin of a leaf. `space` is the box that cells cover, for partitions
    /// that need it.
    fn made(name: &str, boxes: &[MinMax], size: f64, space: Option<&MinMax>) -> Result<Self, InputError> {
        let mut made = match (name, space) {
            ("kd_tree", _) => return Ok(Self::KdTree(KdTree::build(boxes))),
            ("bsp_tree", _) => return Ok(Self::BspTree(BspTree::build(boxes))),
            ("sweep_x", _) => return Ok(Self::OneAxis(SweepOneAxis::build(Axis::X, boxes))),
            ("sweep_y", _) => return Ok(Self::OneAxis(SweepOneAxis::build(Axis::Y, boxes))),
            ("sweep_z", _) => return Ok(Self::OneAxis(SweepOneAxis::build(Axis::Z, boxes))),
            ("three_axes", _) => return Ok(Self::ThreeAxes(SweepThreeAxes::build(boxes))),
            ("hashed_grid", _) => Self::HashedGrid(HashedGrid::new(size)?),
            ("hierarchical_grid", _) => Self::HierarchicalGrid(HierarchicalGrid::new(size)?),
            ("uniform_grid", Some(space)) => Self::UniformGrid(UniformGrid::over(space, size)?),
            ("octree", Some(space)) => Self::Octree(Octree::over(space)),
            ("loose_octree", Some(space)) => Self::LooseOctree(LooseOctree::over(space)),
            _ if size > 0.0 => Self::BoxTree(BoxTree::with_margin(size)),
            _ => return Ok(Self::BoxTree(BoxTree::build(boxes))),
        };
        if let Some(partition) = made.as_dynamic() {
            for (key, bounds) in boxes.iter().enumerate() {
                partition.insert(key as u32, *bounds);
            }
        }
        Ok(made)
    }

    fn as_partition(&self) -> &dyn Partition {
        match self {
            Self::BoxTree(partition) => partition,
            Self::UniformGrid(partition) => partition,
            Self::HashedGrid(partition) => partition,
            Self::HierarchicalGrid(partition) => partition,
            Self::Octree(partition) => partition,
            Self::LooseOctree(partition) => partition,
            Self::OneAxis(partition) => partition,
            Self::ThreeAxes(partition) => partition,
            Self::KdTree(partition) => partition,
            Self::BspTree(partition) => partition,
        }
    }

    /// Returns the partition as one whose boxes can move, or `None` if its boxes are fixed.
    fn as_dynamic(&mut self) -> Option<&mut dyn Dynamic> {
        Some(match self {
            Self::BoxTree(partition) => partition,
            Self::UniformGrid(partition) => partition,
            Self::HashedGrid(partition) => partition,
            Self::HierarchicalGrid(partition) => partition,
            Self::Octree(partition) => partition,
            Self::LooseOctree(partition) => partition,
            Self::OneAxis(partition) => partition,
            Self::ThreeAxes(partition) => partition,
            Self::KdTree(_) | Self::BspTree(_) => return None,
        })
    }
}

/// A partition as it was when the query began.
#[derive(Clone)]
pub(crate) struct Snapshot(Arc<Held>);

impl Snapshot {
    pub(crate) fn get(&self) -> &dyn Partition {
        self.0.kind.as_partition()
    }

    pub(crate) fn try_pairs_with(&self, other: &Self, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        match (&self.0.kind, &other.0.kind) {
            (Kind::BoxTree(own), Kind::BoxTree(other)) => own.try_pairs_with_tree(other, budget),
            (own, other) => own.as_partition().try_pairs_with(other.as_partition(), budget),
        }
    }
}

impl PartitionCore {
    /// Waits for calls that change the partition, detached from the interpreter.
    pub(crate) fn snapshot(&self, py: Python<'_>) -> Snapshot {
        Snapshot(py.detach(|| self.lock().clone()))
    }

    fn lock(&self) -> MutexGuard<'_, Arc<Held>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Moves some boxes and removes others, on the caller's thread.
    ///
    /// # Errors
    /// `InputError` if a key is too large for the number of boxes, or if a key to remove has no
    /// box. In both cases nothing changes. `MemoryError` if there is not enough memory for the
    /// pairs; the boxes have moved then.
    fn make(&self, py: Python<'_>, keys: &[u32], boxes: &[MinMax], gone: &[u32]) -> PyResult<Changes> {
        let made = py.detach(|| {
            let mut held = self.lock();
            let len = held.kind.as_partition().len();
            let limit = ALWAYS_ACCEPTED_KEYS.max(MAX_KEYS_PER_BOX * (len + keys.len())).max(held.reach);
            if let Some(row) = keys.iter().position(|&key| key as usize >= limit) {
                let message =
                    format!("key {} is too large for the number of boxes: memory grows with the keys", keys[row]);
                let hint = "number the boxes from 0 on";
                return Err(Fault::new("out-of-range", "keys", message).at(vec![row]).hint(Some(hint)));
            }
            if let Some(row) = gone.iter().position(|&key| held.kind.as_partition().get(key).is_none()) {
                return Err(unknown("removed", row, gone[row]));
            }
            let held = Arc::make_mut(&mut held);
            held.reach = keys.iter().map(|&key| key as usize + 1).fold(held.reach, usize::max);
            let comes = keys.iter().zip(boxes).map(|(&key, bounds)| Move { key, to: Some(*bounds) });
            let goes = gone.iter().map(|&key| Move { key, to: None });
            let mut changes = Changes::default();
            if let Some(partition) = held.kind.as_dynamic() {
                partition.step(&comes.chain(goes).collect::<Vec<_>>(), &mut changes);
            }
            changes.check_complete().map_err(|error| Fault::new(OUT_OF_MEMORY, "keys", error.to_string()))?;
            Ok(changes)
        });
        made.map_err(|fault| fault.raised(py))
    }
}

fn unknown(argument: &str, row: usize, key: u32) -> Fault {
    Fault::new("unknown-key", argument, format!("there is no box with the key {key}")).at(vec![row])
}

#[pymethods]
impl PartitionCore {
    /// Makes a partition of the kind called `name`, of boxes with the keys 0, 1, ...; see
    /// `Kind::made`. Keys below `reach` were used before.
    #[new]
    fn new<'py>(
        name: &str,
        low: &Bound<'py, PyAny>,
        high: Option<&Bound<'py, PyAny>>,
        size: (f64, &str),
        space: Option<[Bound<'py, PyAny>; 2]>,
        reach: usize,
    ) -> PyResult<Self> {
        let py = low.py();
        let boxes = Boxes::read(low, high, EXPONENT)?.rows;
        let (size, size_name) = size;
        let space = space.map(|[low, high]| Boxes::read(&low, Some(&high), EXPONENT)).transpose()?;
        let space = space.and_then(|space| space.rows.first().copied());
        let (name, reach) = (name.to_owned(), reach.max(boxes.len()));
        let kind = workers::run(py, move |_| Kind::made(&name, &boxes, size, space.as_ref()))?;
        let kind = kind.map_err(|error| {
            Fault::new(kind_and_place(&error).0, size_name, message(&error)).hint(error.hint()).raised(py)
        })?;
        Ok(Self(Mutex::new(Arc::new(Held { kind, reach }))))
    }

    /// Returns another partition with the same boxes, which do not move with the boxes of this one.
    fn copy(&self, py: Python<'_>) -> Self {
        Self(Mutex::new(self.snapshot(py).0))
    }

    fn len(&self, py: Python<'_>) -> usize {
        self.snapshot(py).get().len()
    }

    fn cells(&self, py: Python<'_>) -> &'static str {
        match self.snapshot(py).get().cells() {
            Cells::Disjoint => "disjoint",
            Cells::Loose => "loose",
            Cells::Volumes => "volumes",
            Cells::Order => "order",
        }
    }

    /// Returns a number that is larger than all keys that were ever used.
    fn reach(&self, py: Python<'_>) -> usize {
        self.snapshot(py).0.reach
    }

    /// Returns the corners of a box around all boxes, (2, 3), or `None` if there are no boxes.
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let bounds = self.snapshot(py).get().bounds();
        bounds.map(|bounds| array(py, Boxes::corners(&[bounds]), &[2, 3])).transpose()
    }

    /// Returns the keys, (n,), in ascending order.
    fn keys<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut keys = Vec::new();
        self.snapshot(py).get().each(&mut |key, _| keys.push(key));
        let count = keys.len();
        array(py, keys, &[count])
    }

    /// Returns the corners of boxes, (n, 2, 3).
    fn boxes<'py>(&self, keys: &Keys<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (py, keys) = (keys.py(), keys.readonly().as_slice()?.to_vec());
        let snapshot = self.snapshot(py);
        let found = keys
            .iter()
            .enumerate()
            .map(|(row, &key)| snapshot.get().get(key).ok_or_else(|| unknown("keys", row, key).raised(py)));
        let found: Vec<MinMax> = found.collect::<PyResult<_>>()?;
        array(py, Boxes::corners(&found), &[found.len(), 2, 3])
    }

    /// Inserts or moves boxes, removes others, and returns the pairs that began, (k, 2), and ended,
    /// (k, 2).
    fn step<'py>(
        &self,
        keys: &Keys<'py>,
        low: &Bound<'py, PyAny>,
        high: Option<&Bound<'py, PyAny>>,
        gone: &Keys<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = low.py();
        let (keys, gone) = (keys.readonly().as_slice()?.to_vec(), gone.readonly().as_slice()?.to_vec());
        let boxes = Boxes::read(low, high, EXPONENT)?.rows;
        if boxes.len() != keys.len() {
            let message = format!("{} boxes for {} keys: each key needs one box", boxes.len(), keys.len());
            return Err(Fault::new("shape", "low", message).raised(py));
        }
        let changes = self.make(py, &keys, &boxes, &gone)?;
        let [began, ended] =
            [changes.began(), changes.ended()].map(|pairs| row_array(py, pairs.to_vec(), &[pairs.len()]));
        Ok((began?, ended?).into_pyobject(py)?.into_any())
    }
}

/// Returns all pairs of boxes that overlap, (k, 2), found by a sweep of columns.
#[pyfunction]
pub(crate) fn box_pairs<'py>(low: &Bound<'py, PyAny>, high: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
    let (py, boxes) = (low.py(), Boxes::read(low, high, EXPONENT)?.rows);
    let pairs = workers::pairs(py, move |budget| {
        let mut pairs = Vec::new();
        ColumnSweep::new().try_find(&boxes, &mut pairs, budget).map(|()| pairs)
    })?;
    let count = pairs.len();
    row_array(py, pairs, &[count])
}
