//! Objects that are asked together, for the managers of `impinge.fcl` and `impinge.trimesh`: a tree
//! over their boxes, which follows the objects.
//!
//! Queries use a snapshot. A call that changes a manager while a query runs makes a copy, so that
//! neither waits for the other.

use std::sync::{Arc, Mutex, PoisonError};

use impinge::partition::{BoxTree, Dynamic};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors::Fault;
use crate::fcl_object::{Moved, Object, ObjectBase, Placed};

/// Base class of the managers in Python.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct ManagerBase {
    members: Mutex<Arc<Members>>,
    moved: Arc<Moved>,
    /// Pairs with which the next search begins.
    pub(crate) hints: Mutex<Hints>,
}

/// Members that a query found. The next query starts with them, and its answer does not depend on
/// them.
#[derive(Clone, Copy, Default)]
pub(crate) struct Hints {
    /// Pair of members that collided last.
    pub(crate) colliding: Option<[u32; 2]>,
    /// Pair of members that was nearest last.
    pub(crate) nearest: Option<[u32; 2]>,
    /// Member that was nearest to an object last.
    pub(crate) nearest_to_object: Option<u32>,
}

/// Objects under keys, with a tree over their boxes.
#[derive(Clone, Default)]
pub(crate) struct Members {
    /// Members by key.
    all: Vec<Option<Member>>,
    /// Keys that have no member.
    free: Vec<u32>,
    pub(crate) tree: BoxTree,
    /// Number of members that were ever inserted.
    inserted: u64,
}

#[derive(Clone)]
struct Member {
    object: Arc<Object>,
    /// Place in the order of insertion.
    rank: u64,
    /// The object at its transform. Absent before the first query.
    placed: Option<Arc<Placed>>,
}

#[pymethods]
impl ManagerBase {
    /// Makes an empty manager. Subclasses read the arguments.
    #[new]
    #[pyo3(signature = (*_arguments, **_named))]
    fn new(_arguments: &Bound<'_, PyTuple>, _named: Option<&Bound<'_, PyDict>>) -> Self {
        Self { members: Mutex::default(), moved: Arc::default(), hints: Mutex::default() }
    }

    /// Inserts an object and returns its key. It takes the place of the member with the key
    /// `replaced`, if there is one.
    fn _insert(&self, object: &Bound<'_, ObjectBase>, replaced: Option<u32>) -> u32 {
        let object = object.get().object.clone();
        self.change(|members| {
            let key = replaced.unwrap_or_else(|| members.free_key());
            let rank = match members.all[key as usize].take() {
                Some(old) => {
                    old.object.unwatch(&self.moved, key);
                    old.rank
                }
                None => {
                    members.inserted += 1;
                    members.inserted
                }
            };
            object.watch(&self.moved, key);
            self.moved.mark(key);
            members.all[key as usize] = Some(Member { object: object.clone(), rank, placed: None });
            key
        })
    }

    /// Removes the member with a key.
    fn _remove(&self, key: u32) {
        self.change(|members| {
            if let Some(old) = members.all.get_mut(key as usize).and_then(Option::take) {
                old.object.unwatch(&self.moved, key);
                members.tree.remove(key);
                members.free.push(key);
            }
        });
    }

    /// Marks all members as moved, because their geometries may have changed.
    fn _renew(&self) {
        self.change(|members| {
            (0..).zip(&members.all).filter(|(_, member)| member.is_some()).for_each(|(key, _)| self.moved.mark(key));
        });
    }
}

impl ManagerBase {
    fn change<T>(&self, change: impl FnOnce(&mut Members) -> T) -> T {
        change(Arc::make_mut(&mut *self.members.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Returns the members at their current transforms.
    ///
    /// # Errors
    /// `InputError` if an object cannot be placed at its transform.
    pub(crate) fn snapshot(&self, py: Python<'_>) -> PyResult<Arc<Members>> {
        let mut members = self.members.lock().unwrap_or_else(PoisonError::into_inner);
        let moved = self.moved.take();
        if !moved.is_empty() {
            let own = Arc::make_mut(&mut *members);
            let mut keys: Vec<u32> = moved.iter().copied().collect();
            keys.sort_unstable();
            if let Err(fault) = keys.iter().try_for_each(|&key| own.place(key)) {
                keys.into_iter().for_each(|key| self.moved.mark(key));
                return Err(fault.raised(py));
            }
        }
        Ok(members.clone())
    }
}

impl Members {
    /// Returns the only member of a set, with key 0.
    ///
    /// # Errors
    /// `InputError` if the object cannot be placed at its transform.
    pub(crate) fn of_one(object: &Bound<'_, ObjectBase>) -> PyResult<Arc<Self>> {
        let mut members = Self::default();
        members.all.push(Some(Member { object: object.get().object.clone(), rank: 0, placed: None }));
        members.place(0).map_err(|fault| fault.raised(object.py()))?;
        Ok(Arc::new(members))
    }

    /// Returns the member with a key at its transform.
    pub(crate) fn get(&self, key: u32) -> Option<&Arc<Placed>> {
        self.all.get(key as usize)?.as_ref()?.placed.as_ref()
    }

    /// Returns all members at their transforms, with their keys.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &Arc<Placed>)> {
        (0..).zip(&self.all).filter_map(|(key, member)| Some((key, member.as_ref()?.placed.as_ref()?)))
    }

    /// Returns the place of a member in the order of insertion.
    pub(crate) fn rank(&self, key: u32) -> u64 {
        self.all.get(key as usize).and_then(Option::as_ref).map_or(0, |member| member.rank)
    }

    /// Returns the two keys, the member that was inserted first first.
    pub(crate) fn ordered(&self, [a, b]: [u32; 2]) -> [u32; 2] {
        if self.rank(a) <= self.rank(b) { [a, b] } else { [b, a] }
    }

    fn free_key(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.all.push(None);
            self.all.len() as u32 - 1
        })
    }

    /// Moves a member to the transform of its object.
    fn place(&mut self, key: u32) -> Result<(), Fault> {
        let Some(member) = self.all.get_mut(key as usize).and_then(Option::as_mut) else { return Ok(()) };
        let placed = member.object.placed("transform")?;
        match placed.bounds {
            Some(bounds) => self.tree.insert(key, bounds),
            None => self.tree.remove(key),
        };
        member.placed = Some(placed);
        Ok(())
    }
}
