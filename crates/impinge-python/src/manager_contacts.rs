//! Contacts of all pairs of a manager, in columns. Their faces are found at once, and their points,
//! normals and depths when they are first requested.

use std::sync::Arc;

use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::fcl_contacts::{Detail, Faces, contacts, details_of};
use crate::manager_queries::{Asked, all_rows};
use crate::managers::ManagerBase;

/// Contacts of the pairs of a manager at the time of the query.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct ManagerContacts {
    asked: Asked,
    /// Pairs that collide, with the faces of their contacts.
    pairs: Arc<Vec<([u32; 2], Vec<Faces>)>>,
}

/// Returns the contacts of all pairs that collide.
#[pyfunction]
pub(crate) fn manager_contacts(
    manager: &Bound<'_, ManagerBase>,
    other: Option<&Bound<'_, PyAny>>,
) -> PyResult<ManagerContacts> {
    let asked = Asked::read(manager, other)?;
    let near = asked.near();
    let (pairs, own) = (near.clone(), asked.clone());
    let found = all_rows(manager.py(), near.len(), move |row, budget| match own.pair(pairs[row]) {
        Some([a, b]) => contacts(a, b, usize::MAX, budget),
        None => Vec::new(),
    })?;
    let pairs = near.into_iter().zip(found).filter(|(_, faces)| !faces.is_empty()).collect();
    Ok(ManagerContacts { asked, pairs: Arc::new(pairs) })
}

#[pymethods]
impl ManagerContacts {
    /// Returns the pairs that collide.
    fn pairs(&self) -> Vec<(u32, u32)> {
        self.pairs.iter().map(|(pair, _)| (*pair).into()).collect()
    }

    /// Returns for each contact the index of its pair, (k,), and its faces, (k, 2).
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 2]> {
        let of_pair = |(number, (_, faces)): (i64, &([u32; 2], Vec<Faces>))| vec![number; faces.len()];
        let numbers: Vec<i64> = (0..).zip(self.pairs.iter()).flat_map(of_pair).collect();
        let faces: Vec<Faces> = self.pairs.iter().flat_map(|(_, faces)| faces.iter().copied()).collect();
        let count = [faces.len()];
        Ok([array(py, numbers, &count)?, row_array(py, faces, &count)?])
    }

    /// Returns for each contact its point and its normal, (k, 3), and its depth, (k,).
    fn details<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 3]> {
        let (asked, pairs) = (self.asked.clone(), self.pairs.clone());
        let found =
            all_rows(py, self.pairs.len(), move |row, budget| match (asked.pair(pairs[row].0), &pairs[row].1) {
                (Some([a, b]), faces) => details_of(a, b, faces, budget),
                (None, faces) => vec![Detail::default(); faces.len()],
            })?;
        let found = found.into_iter().flatten().collect::<Vec<_>>();
        let count = [found.len()];
        Ok([
            row_array(py, found.iter().map(|own| own.point).collect(), &count)?,
            row_array(py, found.iter().map(|own| own.normal).collect(), &count)?,
            array(py, found.iter().map(|own| own.depth).collect(), &count)?,
        ])
    }
}
