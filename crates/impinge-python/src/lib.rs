//! The extension module `impinge._impinge`: arrays in, arrays out. It holds no geometry; the package around it,
//! `python/impinge`, is what people import.

mod broadcast;
mod errors;
mod mesh;
mod model;
mod poses;
mod question;
mod scene;
mod verbs;
mod workers;

/// What `python/impinge` imports; every name is private to that package.
#[pyo3::pymodule]
mod _impinge {
    #[pymodule_export]
    use super::mesh::MeshBase;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::scene::check_scene;
    #[pymodule_export]
    use super::verbs::{contact_points, distance, intersecting_pairs, intersection_curves, intersects, within};
    #[pymodule_export]
    use super::workers::after_fork;

    /// Keeps what is asked on the caller's own thread on that thread.
    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        super::workers::keep_callers_alone();
        pyo3::types::PyModuleMethods::add(module, "__version__", env!("CARGO_PKG_VERSION"))
    }
}
