//! A short queue of items between the prefetch of their memory and their processing.

/// Maximum number of queued tasks, and of queued approaches. Fewer hide less memory latency. More
/// evict each other's cache lines from the first-level cache.
pub(crate) const QUEUE: usize = 8;

/// A first-in, first-out queue with room for `ROOM` items.
pub(super) struct Queue<T, const ROOM: usize> {
    items: [T; ROOM],
    next: usize,
    len: usize,
}

impl<T: Copy, const ROOM: usize> Queue<T, ROOM> {
    /// Returns an empty queue. `filler` fills the unused slots and is never returned.
    pub(super) fn new(filler: T) -> Self {
        Self { items: [filler; ROOM], next: 0, len: 0 }
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Appends an item. The queue must not be full.
    #[inline(always)]
    pub(super) fn push(&mut self, item: T) {
        self.items[(self.next + self.len) % ROOM] = item;
        self.len += 1;
    }

    /// Appends the first `count` of four items. There must be room for four.
    #[inline(always)]
    pub(super) fn push_some(&mut self, four: [T; 4], count: usize) {
        for (at, item) in four.into_iter().enumerate() {
            self.items[(self.next + self.len + at) % ROOM] = item;
        }
        self.len += count.min(4);
    }

    /// Returns the item that `before` items precede, or `None` if there is no such item.
    #[inline(always)]
    pub(super) fn get(&self, before: usize) -> Option<T> {
        (self.len > before).then(|| self.items[(self.next + before) % ROOM])
    }

    /// Removes and returns all items, in order.
    pub(super) fn drain(&mut self) -> impl Iterator<Item = T> + use<'_, T, ROOM> {
        std::iter::from_fn(|| (self.len > 0).then(|| self.pop()))
    }

    /// Removes and returns the first item. The queue must not be empty.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> T {
        let item = self.items[self.next];
        self.next = (self.next + 1) % ROOM;
        self.len -= 1;
        item
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_leave_in_the_order_they_came() {
        let mut queue = Queue::<_, 16>::new(0);
        let (mut pushed, mut popped) = (0, 0);
        for round in 1..100 {
            while queue.len() < 1 + round % QUEUE {
                pushed += 1;
                queue.push(pushed);
            }
            if queue.len() + 4 <= 16 {
                queue.push_some([1, 2, 3, 4].map(|later| pushed + later), round % 6);
                pushed += (round % 6).min(4);
            }
            for before in 0..16 {
                assert_eq!(queue.get(before), (before < queue.len()).then(|| popped + before + 1));
            }
            for _ in 0..=round % queue.len() {
                popped += 1;
                assert_eq!(queue.pop(), popped);
            }
            assert_eq!(queue.len(), pushed - popped);
        }
    }
}
