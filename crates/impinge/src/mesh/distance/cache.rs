//! A direct-mapped cache.

/// The most recent results of a costly computation, by the number of its subject, such as a node.
/// There are `SLOTS` slots, a power of two.
pub(super) struct Cache<T, const SLOTS: usize> {
    /// Index of each slot's value in `kept`, plus one. Zero for an empty slot.
    places: [u16; SLOTS],
    kept: Vec<T>,
}

impl<T, const SLOTS: usize> Cache<T, SLOTS> {
    pub(super) fn new() -> Self {
        Self { places: [0; SLOTS], kept: Vec::new() }
    }

    /// Returns the value of a number. Computes the value with `make` if it is not cached.
    /// `number_of` returns the number of a cached value.
    #[inline(always)]
    pub(super) fn get(&mut self, number: u32, number_of: impl Fn(&T) -> u32, make: impl FnOnce(u32) -> T) -> &T {
        self.get_current(number, |kept| number_of(kept) == number, make)
    }

    /// Returns the value of a number. Computes the value with `make` if the value in its slot is
    /// not current.
    #[inline(always)]
    pub(super) fn get_current(
        &mut self,
        number: u32,
        is_current: impl Fn(&T) -> bool,
        make: impl FnOnce(u32) -> T,
    ) -> &T {
        let index = number as usize % SLOTS;
        let place = match self.places[index] {
            0 => {
                self.kept.push(make(number));
                self.places[index] = self.kept.len() as u16;
                self.kept.len() - 1
            }
            place => {
                let place = usize::from(place) - 1;
                if !is_current(&self.kept[place]) {
                    self.kept[place] = make(number);
                }
                place
            }
        };
        &self.kept[place]
    }
}
