//! Queries of a partition by boxes, points and rays, and all pairs of boxes.

use std::ops::ControlFlow;

use impinge::partition::{Neighbor, Partition, Ray, RayVisit};
use pyo3::prelude::*;

use crate::arrays::{array, ragged, row_array};
use crate::boxes::Boxes;
use crate::errors::Fault;
use crate::partitions::{EXPONENT, PartitionCore, Snapshot};
use crate::points::Points;
use crate::rays::Rays;
use crate::workers::{self, Call};

/// Maximum number of rows of a call that runs on the caller's thread. It takes a fraction of a
/// millisecond.
const MAX_QUERIES_ON_CALLER: usize = 64;

/// Box that a ray enters, and the ray's parameter there.
#[derive(Clone, Copy)]
struct Entry {
    t: f64,
    key: u32,
}

/// Returns for each box or point the boxes that overlap it: offsets of the rows, (n + 1,), keys,
/// (k,), ascending in each row, and the leading axes.
#[pyfunction]
pub(crate) fn partition_overlapping<'py>(
    partition: &Bound<'py, PartitionCore>,
    low: &Bound<'py, PyAny>,
    high: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = partition.py();
    let Boxes { shape, rows } = Boxes::read(low, high, EXPONENT)?;
    let found = ask(partition, rows.len(), move |partition, row| {
        let mut keys = Vec::new();
        let _ = partition.overlapping(&rows[row], &mut |key| {
            keys.push(key);
            ControlFlow::Continue(())
        });
        keys.sort_unstable();
        keys
    })?;
    let (offsets, keys) = ragged(found);
    let (places, count) = (offsets.len(), keys.len());
    Ok((array(py, offsets, &[places])?, array(py, keys, &[count])?, shape).into_pyobject(py)?.into_any())
}

/// Returns the ray parameter t at which each ray enters its first box, (...), and the key of the
/// box, (...). A ray that enters no box has infinity and -1.
#[pyfunction]
pub(crate) fn partition_ray_cast<'py>(
    partition: &Bound<'py, PartitionCore>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    reach: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let py = partition.py();
    let shape = Rays::read(origins, directions)?.lead().to_vec();
    let found = cast(partition, origins, directions, reach, |partition, ray| {
        let mut first: Option<Entry> = None;
        partition.ray(ray, &mut |RayVisit { key, t, .. }| {
            if first.is_none_or(|first| (t, key) < (first.t, first.key)) {
                first = Some(Entry { t, key });
            }
            first.map_or(t, |first| first.t)
        });
        first
    })?;
    let t = found.iter().map(|entry| entry.map_or(f64::INFINITY, |entry| entry.t)).collect();
    let key = found.iter().map(|entry| entry.map_or(-1, |entry| i64::from(entry.key))).collect();
    Ok((array(py, t, &shape)?, array(py, key, &shape)?).into_pyobject(py)?.into_any())
}

/// Returns all boxes that each ray enters: offsets of the rows, (n + 1,), ray parameters t, (k,),
/// keys, (k,), and the leading axes.
#[pyfunction]
pub(crate) fn partition_ray_cast_all<'py>(
    partition: &Bound<'py, PartitionCore>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    reach: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let py = partition.py();
    let shape = Rays::read(origins, directions)?.lead().to_vec();
    let found = cast(partition, origins, directions, reach, |partition, ray| {
        let mut entries = Vec::new();
        partition.ray(ray, &mut |RayVisit { key, t, reach }| {
            entries.push(Entry { t, key });
            reach
        });
        entries.sort_unstable_by(|one, other| one.t.total_cmp(&other.t).then(one.key.cmp(&other.key)));
        entries
    })?;
    let (offsets, entries) = ragged(found);
    let (places, count) = (offsets.len(), entries.len());
    let t = array(py, entries.iter().map(|entry| entry.t).collect(), &[count])?;
    let key = array(py, entries.iter().map(|entry| i64::from(entry.key)).collect(), &[count])?;
    Ok((array(py, offsets, &[places])?, t, key, shape).into_pyobject(py)?.into_any())
}

/// Returns the keys of the `count` boxes nearest to each point, (..., count), by distance and then
/// by key, and their distances, (..., count). Missing boxes have the key -1 and an infinite
/// distance.
#[pyfunction]
pub(crate) fn partition_nearest<'py>(
    partition: &Bound<'py, PartitionCore>,
    points: &Bound<'py, PyAny>,
    count: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let py = partition.py();
    let Points { shape, rows } = Points::read(points, "points", EXPONENT)?;
    let found = ask(partition, rows.len(), move |partition, row| partition.nearest(rows[row], count))?;
    let places = found.len().saturating_mul(count);
    let refused =
        || Fault::new("too-many", "count", format!("not enough memory for {count} boxes for each point")).raised(py);
    let (mut keys, mut distances) = (Vec::new(), Vec::new());
    keys.try_reserve_exact(places).map_err(|_| refused())?;
    distances.try_reserve_exact(places).map_err(|_| refused())?;
    for (at, near) in found.iter().enumerate() {
        keys.extend(near.iter().map(|near: &Neighbor| i64::from(near.key)));
        distances.extend(near.iter().map(|near| near.distance_squared.sqrt()));
        keys.resize((at + 1) * count, -1);
        distances.resize((at + 1) * count, f64::INFINITY);
    }
    let shape = [&shape[..], &[count]].concat();
    Ok((array(py, keys, &shape)?, array(py, distances, &shape)?).into_pyobject(py)?.into_any())
}

/// Returns all pairs of boxes that overlap, (k, 2).
#[pyfunction]
pub(crate) fn partition_pairs<'py>(partition: &Bound<'py, PartitionCore>) -> PyResult<Bound<'py, PyAny>> {
    let (py, snapshot) = (partition.py(), partition.get().snapshot(partition.py()));
    let pairs = workers::pairs(py, move |budget| snapshot.get().try_pairs(budget))?;
    let count = pairs.len();
    row_array(py, pairs, &[count])
}

/// Returns all pairs of a box of one partition and a box of the other that overlap, (k, 2).
#[pyfunction]
pub(crate) fn partition_pairs_with<'py>(
    partition: &Bound<'py, PartitionCore>,
    other: &Bound<'py, PartitionCore>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = partition.py();
    let (own, other) = (partition.get().snapshot(py), other.get().snapshot(py));
    let pairs = workers::pairs(py, move |budget| own.try_pairs_with(&other, budget))?;
    let count = pairs.len();
    row_array(py, pairs, &[count])
}

/// Returns the results of `ask` for `count` rows, from one snapshot.
fn ask<T: Send + 'static>(
    partition: &Bound<'_, PartitionCore>,
    count: usize,
    ask: impl Fn(&dyn Partition, usize) -> T + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    let (py, snapshot) = (partition.py(), partition.get().snapshot(partition.py()));
    let call = Call { rows: count, is_brief: count <= MAX_QUERIES_ON_CALLER, progress: false };
    workers::rows(py, call, move |row| ask(snapshot.get(), row))
}

fn cast<T: Send + 'static>(
    partition: &Bound<'_, PartitionCore>,
    origins: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
    reach: f64,
    ask: impl Fn(&dyn Partition, &Ray) -> T + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    let py = partition.py();
    if reach.is_nan() || reach < 0.0 {
        let kind = if reach.is_nan() { "non-finite" } else { "negative" };
        return Err(Fault::new(kind, "reach", format!("must be at least zero, not {reach}")).raised(py));
    }
    let (rays, snapshot): (Rays, Snapshot) = (Rays::read(origins, directions)?, partition.get().snapshot(py));
    let brief = rays.len() <= MAX_QUERIES_ON_CALLER;
    rays.ask_each(py, brief, move |origin, direction| Ok(ask(snapshot.get(), &Ray::new(origin, direction, reach)?)))
}
