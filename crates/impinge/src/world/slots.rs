//! Reusable slots for bodies, with handles that distinguish successive bodies in one slot.

use super::body::BodyId;
use crate::simd::prefetch;

/// Values by handle.
#[derive(Clone, Debug)]
pub(super) struct Slots<T> {
    slots: Vec<Slot<T>>,
    /// Slots that are free; the last one is taken next.
    free: Vec<u32>,
    count: usize,
}

#[derive(Clone, Debug)]
struct Slot<T> {
    /// Number of times that the slot was taken or freed. It is odd while the slot is in use. A slot
    /// that reaches the largest number is never used again.
    generation: u32,
    value: Option<T>,
}

impl<T> Default for Slots<T> {
    fn default() -> Self {
        Self { slots: Vec::new(), free: Vec::new(), count: 0 }
    }
}

impl<T> Slots<T> {
    /// Stores a value in a free slot and returns its handle, or `None` if there are no more slots.
    pub(super) fn insert(&mut self, value: T) -> Option<BodyId> {
        if let Some(index) = self.free.pop() {
            let slot = &mut self.slots[index as usize];
            slot.generation += 1;
            slot.value = Some(value);
            self.count += 1;
            return Some(BodyId::new(index, slot.generation));
        }
        let index = u32::try_from(self.slots.len()).ok().filter(|&index| index != u32::MAX)?;
        self.slots.push(Slot { generation: 1, value: Some(value) });
        self.count += 1;
        Some(BodyId::new(index, 1))
    }

    pub(super) fn remove(&mut self, id: BodyId) -> Option<T> {
        self.get(id)?;
        let slot = &mut self.slots[id.index()];
        let value = slot.value.take();
        self.count -= 1;
        // The largest generation is odd. A slot that has reached it is not freed.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(id.index() as u32);
        }
        value
    }

    pub(super) fn get(&self, id: BodyId) -> Option<&T> {
        let slot = self.slots.get(id.index()).filter(|slot| slot.generation == id.generation())?;
        slot.value.as_ref()
    }

    /// Prefetches a value.
    pub(super) fn prefetch(&self, id: BodyId) {
        if let Some(slot) = self.slots.get(id.index()) {
            prefetch(slot);
        }
    }

    pub(super) fn get_mut(&mut self, id: BodyId) -> Option<&mut T> {
        let slot = self.slots.get_mut(id.index()).filter(|slot| slot.generation == id.generation())?;
        slot.value.as_mut()
    }

    /// Returns the value in a slot, and its handle.
    pub(super) fn at(&self, index: u32) -> Option<(BodyId, &T)> {
        let slot = self.slots.get(index as usize)?;
        Some((BodyId::new(index, slot.generation), slot.value.as_ref()?))
    }

    /// Returns all values with their handles, by slot.
    pub(super) fn iter(&self) -> impl Iterator<Item = (BodyId, &T)> {
        (0..self.slots.len() as u32).filter_map(|index| self.at(index))
    }

    /// Returns the generation of each slot, and the indices of the free slots.
    pub(super) fn places(&self) -> (Vec<u32>, Vec<u32>) {
        (self.slots.iter().map(|slot| slot.generation).collect(), self.free.clone())
    }

    /// Returns the given values in slots with these generations, or `None` if the arguments
    /// contradict each other.
    pub(super) fn of(generations: &[u32], free: &[u32], values: Vec<(BodyId, T)>) -> Option<Self> {
        // One slot fewer than there are numbers, because the largest number is not a slot.
        let is_countable = u32::try_from(generations.len()).is_ok_and(|count| count < u32::MAX);
        let mut slots: Vec<Slot<T>> = generations.iter().map(|&generation| Slot { generation, value: None }).collect();
        let count = values.len();
        for (id, value) in values {
            let slot = slots.get_mut(id.index()).filter(|slot| slot.generation == id.generation())?;
            if slot.generation % 2 == 0 || slot.value.replace(value).is_some() {
                return None;
            }
        }
        let mut is_free = vec![false; slots.len()];
        for &index in free {
            if std::mem::replace(is_free.get_mut(index as usize)?, true) {
                return None;
            }
        }
        let is_consistent = slots.iter().zip(is_free).all(|(slot, is_free)| {
            let is_spent = slot.generation == u32::MAX;
            is_free == (slot.generation % 2 == 0) && (is_free || is_spent || slot.value.is_some())
        });
        (is_countable && is_consistent).then(|| Self { slots, free: free.to_vec(), count })
    }

    /// Returns the number of values.
    pub(super) fn len(&self) -> usize {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_handle_never_refers_to_another_value() {
        let mut slots = Slots::default();
        let first = slots.insert('a').unwrap();
        assert_eq!(slots.remove(first), Some('a'));
        let second = slots.insert('b').unwrap();
        assert_eq!((first.index(), slots.len()), (second.index(), 1));
        assert!(slots.get(first).is_none() && slots.remove(first).is_none() && slots.get(second) == Some(&'b'));
    }

    #[test]
    fn a_place_with_the_last_generation_is_not_reused() {
        let mut slots = Slots::default();
        let first = slots.insert(0).unwrap();
        slots.slots[0].generation = u32::MAX;
        let last = BodyId::new(0, u32::MAX);
        assert!(slots.get(first).is_none());
        assert_eq!(slots.remove(last), Some(0));
        assert!(slots.get(last).is_none());
        assert_eq!(slots.insert(1).unwrap().index(), 1);
    }
}
