//! Summary of the proxies in a baked file.

use std::collections::BTreeMap;

use impinge::volume::{BoundingVolume, Proxies};
use serde::Serialize;

use crate::numerals::{counted, length};

/// Sizes of the hull and of the volumes around it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Summary {
    hull_vertices: usize,
    hull_faces: usize,
    bytes: usize,
    /// Volumes by kind, in cubic units of the mesh.
    volumes: BTreeMap<&'static str, f64>,
}

impl Summary {
    pub(super) fn of(proxies: &Proxies) -> Self {
        let volumes = [
            ("box", proxies.bounds().volume()),
            ("sphere", proxies.sphere().volume()),
            ("capsule", proxies.capsule().volume()),
            ("lozenge", proxies.lozenge().volume()),
            ("oriented box", proxies.obb().volume()),
            ("14-DOP", proxies.kdop14().volume()),
            ("18-DOP", proxies.kdop18().volume()),
            ("26-DOP", proxies.kdop26().volume()),
        ];
        Self {
            hull_vertices: proxies.hull().vertices().len(),
            hull_faces: proxies.hull().faces().len(),
            bytes: proxies.memory(),
            volumes: volumes.into(),
        }
    }

    /// Returns labels and values for the report: the hull, then the volumes in ascending order.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        let (corners, faces) = (counted(self.hull_vertices, "corner"), counted(self.hull_faces, "triangle"));
        let mut volumes: Vec<(&'static str, f64)> =
            self.volumes.iter().map(|(&name, &volume)| (name, volume)).collect();
        volumes.sort_by(|a, b| a.1.total_cmp(&b.1));
        let hull = ("hull", format!("{corners}, {faces}, {:.1} kB", self.bytes as f64 / 1e3));
        std::iter::once(hull)
            .chain(volumes.into_iter().map(|(name, volume)| (name, format!("volume {}", length(volume)))))
            .collect()
    }
}
