//! What was made last and may be wanted again.

/// The last few of many things that are costly to make, by number: at most `SLOTS`, a power of two.
pub(super) struct Cache<T, const SLOTS: usize> {
    /// One more than the place of the thing whose number ends in this index.
    places: [u16; SLOTS],
    kept: Vec<T>,
}

impl<T, const SLOTS: usize> Cache<T, SLOTS> {
    pub(super) fn new() -> Self {
        Self { places: [0; SLOTS], kept: Vec::new() }
    }

    /// The thing of this number, made where it is not at hand.
    #[inline(always)]
    pub(super) fn get(&mut self, number: u32, number_of: impl Fn(&T) -> u32, make: impl FnOnce(u32) -> T) -> &T {
        self.get_current(number, |kept| number_of(kept) == number, make)
    }

    /// The thing of this number, made where what is at hand in its place is another or no longer right.
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
