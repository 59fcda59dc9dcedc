//! How a verb is asked: with a cache, and until it is interrupted.

use super::{Cache, ContactOptions};
use crate::mesh::{Interrupt, Options};

/// How a verb is asked.
///
/// Ordinary use needs none: `query::intersects(a, b)` is `Query::new().intersects(a, b)`, and so are `proximity`, `within`, `nearness`,
/// `distance`, `contacts` and `intersecting_pairs`. A query adds what earlier answers tell ([`with_cache`](Self::with_cache)) and what may end a long search ([`with_interrupt`](Self::with_interrupt)).
///
/// ```
/// use impinge::query::{self, Cache, Query};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let above = mesh.at(Pose::from_translation([0.0, 0.0, 2.0])?);
/// let mut cache = Cache::default();
/// let found = Query::new().with_cache(&mut cache).distance(&mesh, above);
/// assert_eq!(found, query::distance(&mesh, above));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Debug, Default)]
pub struct Query<'q> {
    pub(super) options: Options<'q>,
    pub(super) cache: Option<&'q mut Cache>,
    pub(super) contacts: ContactOptions,
}

impl<'q> Query<'q> {
    /// Returns a query without a cache that nothing interrupts.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Uses a cache, and leaves in it what the answer tells.
    #[must_use]
    pub fn with_cache(self, cache: &'q mut Cache) -> Self {
        Self { cache: Some(cache), ..self }
    }

    /// Ends the verb early if the interrupt asks for it. The answer is then the safe one, which the caller has to discard
    /// ([`Interrupt`]). Interrupted are `intersects`, `proximity`, `within`, `nearness`, `distance`, `intersecting_pairs` and
    /// `intersecting_pairs_up_to` while they search the faces of two meshes. Other work goes on to its end: that on shapes and
    /// compounds, and on what lies inside a solid.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt<'q>) -> Self {
        Self { options: Options { interrupt, ..self.options }, ..self }
    }

    /// Asks [`contacts`](Self::contacts) for what the options say.
    #[must_use]
    pub fn with_contacts(self, contacts: ContactOptions) -> Self {
        Self { contacts, ..self }
    }

    /// Uses a stated vector unit and frame, for tests and measurements. No answer depends on them.
    #[doc(hidden)]
    #[must_use]
    pub fn with_options(self, options: Options<'q>) -> Self {
        Self { options, ..self }
    }
}
