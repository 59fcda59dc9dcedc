//! Queries of managers: which members collide, with their contacts, and which are nearest.
//!
//! Pairs are pairs of keys. Within one manager, the member that was inserted first comes first.
//! With another manager or an object, the member of the manager comes first.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

use impinge::budget::{Budget, Stopped};
use impinge::partition::Partition;
use impinge::query::Query;
use impinge::query::batch::Execution;
use pyo3::prelude::*;

use crate::arrays::row_array;
use crate::errors::Fault;
use crate::fcl_distance::{OVERLAP, Separation, separation};
use crate::fcl_object::{ObjectBase, Placed};
use crate::managers::{ManagerBase, Members};
use crate::workers::{self, Call};

/// Relative margin between the depth of two boxes and the depth of two bodies in them, whose upper
/// bound may be larger than the depth. Bounds of round bodies are within 2^-20 of each other.
const DEPTH_MARGIN: f64 = 1.0 / 1024.0;

/// Members of a manager, and the members that they are compared with, if these are others.
#[derive(Clone)]
pub(crate) struct Asked {
    own: Arc<Members>,
    other: Option<Arc<Members>>,
}

impl Asked {
    /// Reads a manager, and `None`, another manager or an object.
    pub(crate) fn read(manager: &Bound<'_, ManagerBase>, other: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let py = manager.py();
        let own = manager.get().snapshot(py)?;
        let other = match other {
            None => None,
            Some(other) => Some(match (other.cast::<ManagerBase>(), other.cast::<ObjectBase>()) {
                (Ok(other), _) => other.get().snapshot(py)?,
                (_, Ok(object)) => Members::of_one(object)?,
                _ => return Err(Fault::new("type", "other", "must be a manager or an object").raised(py)),
            }),
        };
        Ok(Self { own, other })
    }

    /// Returns the two members of a pair, or `None` if one of them is not there.
    pub(crate) fn pair(&self, [a, b]: [u32; 2]) -> Option<[&Placed; 2]> {
        Some([self.own.get(a)?, self.other.as_ref().unwrap_or(&self.own).get(b)?])
    }

    /// Visits the pairs whose boxes overlap, in no particular order.
    fn each_near(&self, visit: &mut dyn FnMut([u32; 2]) -> ControlFlow<()>) {
        let _ = match &self.other {
            None => self.own.tree.for_each_pair(&mut |pair| visit(self.own.ordered(pair))),
            Some(other) => self.own.tree.for_each_pair_with_tree(&other.tree, visit),
        };
    }

    /// Visits pairs in ascending order of the gap between their boxes. The visitor returns the
    /// largest gap to visit from then on.
    fn each_by_gap(&self, reach: f64, visit: &mut dyn FnMut([u32; 2]) -> f64) {
        match &self.other {
            None => self.own.tree.for_each_pair_by_gap(reach, &mut |pair, _| visit(self.own.ordered(pair))),
            Some(other) => {
                self.own.tree.for_each_pair_with_tree_by_gap(&other.tree, reach, &mut |pair, _| visit(pair));
            }
        }
    }

    /// Returns the pairs whose boxes overlap, in the order of insertion of their members.
    pub(crate) fn near(&self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        self.each_near(&mut |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        });
        let other = self.other.as_ref().unwrap_or(&self.own);
        pairs.sort_unstable_by_key(|&[a, b]| (self.own.rank(a), other.rank(b)));
        pairs
    }

    fn collide(&self, pair: [u32; 2], budget: &Budget<'_>) -> bool {
        self.pair(pair).is_some_and(|[a, b]| {
            let are_meshes = a.mesh().is_some() && b.mesh().is_some();
            let query = Query::new().with_budget(budget);
            !a.is_apart_from(b)
                && if are_meshes { query.intersects(&a.shape, &b.shape) } else { query.intersects(a.hull(), b.hull()) }
        })
    }

    /// Returns a pair that collides, if there is one. `hint` is tried first.
    fn any_colliding(&self, hint: Option<[u32; 2]>, budget: &Budget<'_>) -> Result<Option<[u32; 2]>, Stopped> {
        if let Some(pair) = hint.filter(|&pair| self.collide(pair, budget)) {
            return Ok(Some(pair));
        }
        let mut found = Ok(None);
        self.each_near(&mut |pair| {
            if let Err(stopped) = budget.check() {
                found = Err(stopped);
            } else if self.collide(pair, budget) {
                found = Ok(Some(pair));
            } else {
                return ControlFlow::Continue(());
            }
            ControlFlow::Break(())
        });
        found
    }

    /// Returns the pair with the smallest signed distance, if there are pairs with a finite one.
    /// `hint` is measured first. Pairs whose first member is `skipped` are left out.
    fn nearest(
        &self,
        hint: Option<[u32; 2]>,
        skipped: Option<u32>,
        budget: &Budget<'_>,
    ) -> Result<Option<([u32; 2], Separation)>, Stopped> {
        let measure = |[a, b]: [&Placed; 2]| separation(a, b, true, budget);
        let known = hint.and_then(|pair| Some((pair, measure(self.pair(pair)?))));
        let limits = Limits::of(self);
        let mut best: Option<([u32; 2], Separation)> = None;
        let mut stopped = Ok(());
        let mut visit = |pair: [u32; 2]| {
            if let Err(reason) = budget.check() {
                stopped = Err(reason);
                return f64::NEG_INFINITY;
            }
            let members = self.pair(pair).filter(|_| skipped != Some(pair[0]));
            if let Some(members) = members {
                let found = match known {
                    Some((same, found)) if same == pair => found,
                    _ => measure(members),
                };
                if best.is_none_or(|(_, least)| found.value < least.value) {
                    best = Some((pair, found));
                }
            }
            best.map_or(f64::INFINITY, |(_, least)| limits.reach(least.value))
        };
        let reach = known.map_or(f64::INFINITY, |(_, found)| limits.reach_of_equal(found.value));
        self.each_by_gap(reach, &mut visit);
        stopped.map(|()| best.filter(|(_, found)| found.value < f64::INFINITY))
    }
}

/// How small the signed distances of the members can be, given the gaps of their boxes.
#[derive(Clone, Copy)]
struct Limits {
    has_surfaces: bool,
    has_solids: bool,
}

impl Limits {
    fn of(asked: &Asked) -> Self {
        let all = || asked.own.iter().chain(asked.other.iter().flat_map(|other| other.iter()));
        let has = |is_solid: bool| all().any(|(_, member)| member.body.is_solid == is_solid);
        Self { has_surfaces: has(false), has_solids: has(true) }
    }

    /// Returns the largest gap of the boxes of a pair whose signed distance may be below `least`.
    fn reach(self, least: f64) -> f64 {
        // Surfaces that intersect have distance 0.
        if least <= 0.0 && !self.has_solids { f64::NEG_INFINITY } else { self.reach_of_equal(least) }
    }

    /// Returns the largest gap of the boxes of a pair whose signed distance may be `least` or
    /// below.
    fn reach_of_equal(self, least: f64) -> f64 {
        if least > 0.0 {
            least
        } else if self.has_surfaces && least >= OVERLAP {
            // Bodies that overlap have this distance if one is a surface, however deep they are.
            0.0
        } else {
            least / (1.0 + DEPTH_MARGIN)
        }
    }
}

/// Returns a pair that collides, or `None`.
#[pyfunction]
pub(crate) fn manager_any(
    manager: &Bound<'_, ManagerBase>,
    other: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<(u32, u32)>> {
    let asked = Asked::read(manager, other)?;
    Ok(any_colliding(manager, asked, other.is_none())?.map(Into::into))
}

fn any_colliding(manager: &Bound<'_, ManagerBase>, asked: Asked, is_within: bool) -> PyResult<Option<[u32; 2]>> {
    let hints = &manager.get().hints;
    let hint = hints.lock().unwrap_or_else(PoisonError::into_inner).colliding.filter(|_| is_within);
    let found = alone(manager.py(), move |budget| asked.any_colliding(hint, budget))?;
    if is_within && found.is_some() {
        hints.lock().unwrap_or_else(PoisonError::into_inner).colliding = found;
    }
    Ok(found)
}

/// Calls `visit` with the keys of the pairs whose boxes overlap, until it returns `True`.
#[pyfunction]
pub(crate) fn manager_each_near(
    manager: &Bound<'_, ManagerBase>,
    other: Option<&Bound<'_, PyAny>>,
    visit: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let mut done = Ok(());
    Asked::read(manager, other)?.each_near(&mut |pair| match visit
        .call1((pair[0], pair[1]))
        .and_then(|it| it.is_truthy())
    {
        Ok(false) => ControlFlow::Continue(()),
        Ok(true) => ControlFlow::Break(()),
        Err(error) => {
            done = Err(error);
            ControlFlow::Break(())
        }
    });
    done
}

/// Calls `visit` with the keys of the pairs in ascending order of the gap between their boxes. It
/// returns the largest gap to visit from then on.
#[pyfunction]
pub(crate) fn manager_each_by_gap(
    manager: &Bound<'_, ManagerBase>,
    other: Option<&Bound<'_, PyAny>>,
    visit: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let mut done = Ok(());
    Asked::read(manager, other)?.each_by_gap(f64::INFINITY, &mut |[a, b]| {
        visit.call1((a, b)).and_then(|reach| reach.extract::<f64>()).unwrap_or_else(|error| {
            done = Err(error);
            f64::NEG_INFINITY
        })
    });
    done
}

/// Returns all pairs that collide.
#[pyfunction]
pub(crate) fn manager_pairs(
    manager: &Bound<'_, ManagerBase>,
    other: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<(u32, u32)>> {
    let asked = Asked::read(manager, other)?;
    let near = asked.near();
    let pairs = near.clone();
    let hits = all_rows(manager.py(), near.len(), move |row, budget| asked.collide(pairs[row], budget))?;
    Ok(near.into_iter().zip(hits).filter(|(_, is_hit)| *is_hit).map(|(pair, _)| pair.into()).collect())
}

/// Pair with the smallest signed distance: the pair, the distance, the faces, and the points, (2,
/// 3).
type Nearest<'py> = ((u32, u32), f64, (i64, i64), Bound<'py, PyAny>);

/// Returns the pair with the smallest signed distance, or `None` if no distance is finite. The
/// member with the key `skipped` is left out.
#[pyfunction]
pub(crate) fn manager_nearest<'py>(
    manager: &Bound<'py, ManagerBase>,
    other: Option<&Bound<'py, PyAny>>,
    skipped: Option<u32>,
) -> PyResult<Option<Nearest<'py>>> {
    let py = manager.py();
    let asked = Asked::read(manager, other)?;
    let hints = &manager.get().hints;
    let kept = *hints.lock().unwrap_or_else(PoisonError::into_inner);
    let is_object = other.is_some_and(|other| other.cast::<ObjectBase>().is_ok());
    let hint = match other {
        None => kept.nearest,
        // An object that is asked about has key 0.
        Some(_) if is_object => kept.nearest_to_object.filter(|&key| skipped != Some(key)).map(|key| [key, 0]),
        Some(_) => None,
    };
    let found = alone(py, move |budget| asked.nearest(hint, skipped, budget))?;
    if let Some((pair, _)) = found {
        let mut kept = hints.lock().unwrap_or_else(PoisonError::into_inner);
        match other {
            None => kept.nearest = Some(pair),
            Some(_) if is_object => kept.nearest_to_object = Some(pair[0]),
            Some(_) => {}
        }
    }
    let Some((pair, found)) = found else { return Ok(None) };
    let points = row_array(py, found.points.to_vec(), &[2])?;
    Ok(Some((pair.into(), found.value, found.faces.into(), points)))
}

/// Runs a search on the caller's thread, with checks for signals.
fn alone<T: Send + 'static>(
    py: Python<'_>,
    search: impl Fn(&Budget<'_>) -> Result<T, Stopped> + Send + Sync + 'static,
) -> PyResult<T> {
    let call = Call { rows: 1, is_brief: true, progress: false };
    let (found, _) = workers::execute_interruptibly(py, call, true, move |execution: Execution<'_>| {
        let found = search(execution.budget())?;
        execution.budget().stopped().map_or(Ok(found), Err)
    })?;
    Ok(found)
}

/// Returns the answers of `ask` for all rows. The caller's thread begins. If that takes long, the
/// pool answers the rows that are left.
pub(crate) fn all_rows<T: Send + 'static>(
    py: Python<'_>,
    count: usize,
    ask: impl Fn(usize, &Budget<'_>) -> T + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    // With one thread, waking the pool is no help.
    let is_one_thread = workers::requested_threads(py)? == 1;
    let cells: Arc<Vec<Mutex<Option<T>>>> = Arc::new((0..count).map(|_| Mutex::new(None)).collect());
    let kept = cells.clone();
    let call = Call { rows: 1, is_brief: true, progress: false };
    workers::execute_interruptibly(py, call, is_one_thread, move |execution: Execution<'_>| {
        let answered = execution.rows(
            count,
            || (),
            |(), row| {
                let mut cell = kept[row].lock().unwrap_or_else(PoisonError::into_inner);
                if cell.is_none() {
                    let answer = ask(row, execution.budget());
                    // An answer of a spent budget is not complete.
                    *cell = execution.budget().stopped().is_none().then_some(answer);
                }
            },
        );
        answered.map(drop)
    })?;
    Ok(cells.iter().filter_map(|cell| cell.lock().unwrap_or_else(PoisonError::into_inner).take()).collect())
}
