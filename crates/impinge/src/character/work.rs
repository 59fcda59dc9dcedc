//! Limits the work of following all motions of a rig, so that it stays within a multiple of the
//! rig's size. A few keys and a few vertices would otherwise cost time proportional to their
//! product.
//!
//! Tests: `impinge-files/tests/it/characters/many_keys.rs`.

use super::error::{RigError, RigErrorKind, RigPlace};
use super::rig::Rig;

/// Work that every rig may take, in steps. A step is a vertex or bone at one sample, and takes
/// between 0.1 and 0.2 microseconds. A larger value lets small hostile rigs take longer; a smaller
/// one makes the volumes of small rigs with fast motions larger.
const BASE: u64 = 1 << 24;

/// Additional steps for each number of the rig. The robot of the examples takes up to 40. A body of
/// 20,000 vertices with 60 animated bones and 30,000 keys takes about 300. A larger value lets
/// hostile rigs take longer; a smaller one rejects long animations.
const PER_NUMBER: u64 = 512;

/// The work that is left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    limit: u64,
    spent: u64,
}

impl Work {
    /// Returns the work that a rig may take.
    pub(super) fn for_rig(rig: &Rig) -> Self {
        Self { limit: BASE.saturating_add(PER_NUMBER.saturating_mul(numbers(rig))), spent: 0 }
    }

    /// Reports whether `steps` are left.
    pub(super) fn has(&self, steps: u64) -> bool {
        steps <= self.limit - self.spent
    }

    /// Takes `steps`. Returns an error if fewer are left.
    pub(super) fn take(&mut self, steps: u64) -> Result<(), RigError> {
        if self.has(steps) {
            self.spent += steps;
            return Ok(());
        }
        let count = self.spent.saturating_add(steps);
        let kind = RigErrorKind::TooMany { what: "vertices and bones over all keys", count, limit: self.limit };
        Err(RigError::new(kind, RigPlace::Rig))
    }
}

/// Returns the number of numbers that a rig consists of, about.
fn numbers(rig: &Rig) -> u64 {
    let skin = rig.skin();
    let offsets: usize = skin.morphs().iter().map(|morph| 1 + 4 * morph.offsets.len()).sum();
    let keys: usize = rig.animations().iter().map(|animation| animation.numbers()).sum();
    let surface = 3 * (skin.positions().len() + skin.faces().len()) + 2 * skin.influence_count();
    (10 * rig.skeleton().bones().len() + 13 * skin.joints().len() + surface + offsets + keys) as u64
}
