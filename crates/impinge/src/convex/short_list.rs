//! Lists that are almost always short, and then need no memory of their own.

use std::ops::{Deref, DerefMut};

/// A list of copies that lie in the list itself as long as there are at most `N`.
#[derive(Clone, Debug)]
pub(super) struct ShortList<T, const N: usize> {
    few: [T; N],
    len: usize,
    /// All items, if there are more than `N`.
    many: Vec<T>,
}

impl<T: Copy, const N: usize> ShortList<T, N> {
    /// Returns an empty list. The `filler` is in no list that is read.
    pub(super) fn new(filler: T) -> Self {
        Self { few: [filler; N], len: 0, many: Vec::new() }
    }

    pub(super) fn push(&mut self, item: T) {
        if self.len < N {
            self.few[self.len] = item;
        } else {
            if self.len == N {
                self.many.extend_from_slice(&self.few);
            }
            self.many.push(item);
        }
        self.len += 1;
    }
}

impl<T: Copy, const N: usize> Extend<T> for ShortList<T, N> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        items.into_iter().for_each(|item| self.push(item));
    }
}

impl<T, const N: usize> Deref for ShortList<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        if self.len <= N { &self.few[..self.len] } else { &self.many }
    }
}

impl<T, const N: usize> DerefMut for ShortList<T, N> {
    fn deref_mut(&mut self) -> &mut [T] {
        if self.len <= N { &mut self.few[..self.len] } else { &mut self.many }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_keep_the_items_of_short_ones() {
        let mut list = ShortList::<u32, 4>::new(99);
        for len in 0..10 {
            assert_eq!(list[..], (0..len).collect::<Vec<u32>>()[..]);
            list.push(len);
        }
        list.reverse();
        assert_eq!((list[0], list.len()), (9, 10));
    }
}
