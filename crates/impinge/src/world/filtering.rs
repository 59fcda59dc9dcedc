//! Sets and removes the filter of a world.

use std::sync::Arc;

use super::body::BodyId;
use super::filter::PairFilter;
use super::{Change, World};

impl World {
    /// Sets a filter, which decides about every pair that kinds, layers and owners admit, from the
    /// next step on. The next step filters all pairs again.
    pub fn set_filter(&mut self, filter: impl PairFilter + 'static) {
        self.filter = Some(Arc::new(filter));
        self.refilter();
    }

    /// Removes the filter, so that every pair is admitted that kinds, layers and owners admit, from
    /// the next step on.
    pub fn clear_filter(&mut self) {
        self.filter = None;
        self.refilter();
    }

    fn refilter(&mut self) {
        let all: Vec<BodyId> = self.bodies().collect();
        all.into_iter().for_each(|body| _ = self.state.changed.mark(body.index() as u32, Change::Traits));
    }
}
