//! Options of a query: a cache, a budget, and which contacts to find.

use super::{Cache, ContactOptions};
use crate::budget::Budget;
use crate::mesh::Options;

/// A query with options.
///
/// Most callers do not need it: `query::intersects(a, b)` is `Query::new().intersects(a, b)`. The
/// same holds for `proximity`, `within`, `nearness`, `distance`, `contacts`, `intersecting_pairs`
/// and `intersecting_pairs_up_to`. A query can use a cache ([`with_cache`](Self::with_cache)), have
/// a budget ([`with_budget`](Self::with_budget)) and limit contacts
/// ([`with_contacts`](Self::with_contacts)).
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
    /// Returns a query without a cache and without limits.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns this query with a cache. The query starts from the state in the cache and updates
    /// it. No answer depends on it, with one exception that [`Cache`] describes.
    #[must_use]
    pub fn with_cache(self, cache: &'q mut Cache) -> Self {
        Self { cache: Some(cache), ..self }
    }

    /// Returns this query with limits on its work. Once a limit is reached, the query returns soon
    /// with the safe answer that [`Budget`] describes; [`Budget::stopped`] says whether this
    /// happened.
    #[must_use]
    pub fn with_budget(self, budget: &'q Budget<'q>) -> Self {
        Self { options: Options { budget, ..self.options }, ..self }
    }

    /// Returns this query with options for [`contacts`](Self::contacts). Other queries ignore them.
    #[must_use]
    pub fn with_contacts(self, contacts: ContactOptions) -> Self {
        Self { contacts, ..self }
    }

    /// Returns this query with a given vector unit and frame, for tests and measurements. No answer
    /// depends on them.
    #[doc(hidden)]
    #[must_use]
    pub fn with_options(self, options: Options<'q>) -> Self {
        Self { options, ..self }
    }
}
