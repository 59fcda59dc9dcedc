//! What waits for its memory: a short queue between the moment at which something is known to be needed and its turn.

/// The most tasks between the stack and their turn, and the approaches between their node's turn and theirs. Fewer
/// hide less of the memory's latency; more push each other's lines out of the first cache.
pub(crate) const QUEUE: usize = 8;

/// The first to come is the first to go, of at most so many.
pub(super) struct Queue<T, const ROOM: usize> {
    items: [T; ROOM],
    next: usize,
    len: usize,
}

impl<T: Copy, const ROOM: usize> Queue<T, ROOM> {
    /// Nothing; any filler will do.
    pub(super) fn new(filler: T) -> Self {
        Self { items: [filler; ROOM], next: 0, len: 0 }
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Only for one that is not full.
    #[inline(always)]
    pub(super) fn push(&mut self, item: T) {
        self.items[(self.next + self.len) % ROOM] = item;
        self.len += 1;
    }

    /// The first so many of four; only where there is room for all.
    #[inline(always)]
    pub(super) fn push_some(&mut self, four: [T; 4], count: usize) {
        for (at, item) in four.into_iter().enumerate() {
            self.items[(self.next + self.len + at) % ROOM] = item;
        }
        self.len += count.min(4);
    }

    /// The one whose turn it is once so many before it had theirs, if it is here already.
    #[inline(always)]
    pub(super) fn ahead(&self, before: usize) -> Option<T> {
        (self.len > before).then(|| self.items[(self.next + before) % ROOM])
    }

    /// Takes out all that is left, in order.
    pub(super) fn drain(&mut self) -> impl Iterator<Item = T> + use<'_, T, ROOM> {
        std::iter::from_fn(|| (self.len > 0).then(|| self.pop()))
    }

    /// Only for one that is not empty.
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
    fn what_comes_first_goes_first() {
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
                assert_eq!(queue.ahead(before), (before < queue.len()).then(|| popped + before + 1));
            }
            for _ in 0..=round % queue.len() {
                popped += 1;
                assert_eq!(queue.pop(), popped);
            }
            assert_eq!(queue.len(), pushed - popped);
        }
    }
}
