//! Some faces of a mesh, and for each whether it is in a piece.

/// Maximum number of bytes of a table by face for each listed face. Sparser faces are sorted and
/// searched, which takes longer for each face but no memory for the faces between them.
const MAX_BYTES_PER_FACE: usize = 64;

/// The faces that are divided into pieces.
pub(super) struct Listed {
    order: Order,
    states: Vec<State>,
    /// Number of faces that are not in a piece.
    open: usize,
}

/// How the state of a face is found.
enum Order {
    /// By the number of the face, less the number of the first face.
    ByNumber { first: u32 },
    /// By searching the sorted faces.
    Sorted(Vec<u32>),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// Not listed.
    Absent,
    /// In no piece.
    Open,
    /// In a piece.
    Taken { is_flipped: bool },
}

impl Listed {
    /// Lists faces, each of which is given once.
    pub(super) fn new(faces: &[u32]) -> Self {
        let (first, last) = faces.iter().fold((u32::MAX, 0), |(low, high), &face| (low.min(face), high.max(face)));
        let open = faces.len();
        let range = if open == 0 { 0 } else { (last - first) as usize + 1 };
        if range <= MAX_BYTES_PER_FACE * open {
            let mut states = vec![State::Absent; range];
            faces.iter().for_each(|&face| states[(face - first) as usize] = State::Open);
            return Self { order: Order::ByNumber { first }, states, open };
        }
        let mut sorted = faces.to_vec();
        sorted.sort_unstable();
        Self { order: Order::Sorted(sorted), states: vec![State::Open; open], open }
    }

    fn place(&self, face: u32) -> Option<usize> {
        match &self.order {
            Order::ByNumber { first } => face.checked_sub(*first).map(|at| at as usize),
            Order::Sorted(faces) => faces.binary_search(&face).ok(),
        }
    }

    fn state(&self, face: u32) -> State {
        self.place(face).and_then(|at| self.states.get(at)).copied().unwrap_or(State::Absent)
    }

    /// Reports whether a listed face is in no piece.
    pub(super) fn has_open(&self) -> bool {
        self.open > 0
    }

    /// Reports whether a face is listed and in no piece.
    pub(super) fn is_open(&self, face: u32) -> bool {
        self.state(face) == State::Open
    }

    /// Returns whether a face is flipped in its piece, or `None` if it is in no piece.
    pub(super) fn flipped_in_piece(&self, face: u32) -> Option<bool> {
        match self.state(face) {
            State::Taken { is_flipped } => Some(is_flipped),
            State::Absent | State::Open => None,
        }
    }

    /// Records that a listed face is in a piece.
    pub(super) fn take(&mut self, face: u32, is_flipped: bool) {
        if let Some(at) = self.place(face) {
            self.open -= usize::from(self.states[at] == State::Open);
            self.states[at] = State::Taken { is_flipped };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;
    use std::collections::BTreeMap;

    #[test]
    fn dense_and_sparse_faces_are_found_alike() {
        let mut rng = Rng::new(81);
        for spread in [1, 1000] {
            let faces: Vec<u32> =
                (0..200).map(|at| 70 + spread * at + rng.integer(0, spread.into()) as u32 / 2).collect();
            let mut distinct = faces.clone();
            distinct.dedup();
            let mut listed = Listed::new(&distinct);
            assert_eq!(matches!(listed.order, Order::Sorted(_)), spread == 1000);
            let mut expected: BTreeMap<u32, Option<bool>> = distinct.iter().map(|&face| (face, None)).collect();
            for _ in 0..100 {
                let (face, is_flipped) = (rng.choose(&distinct), rng.one_in(2));
                listed.take(face, is_flipped);
                expected.insert(face, Some(is_flipped));
            }
            for face in (0..100).chain(faces.iter().flat_map(|&face| [face, face + 1])).chain([u32::MAX]) {
                assert_eq!(listed.is_open(face), expected.get(&face) == Some(&None));
                assert_eq!(listed.flipped_in_piece(face), expected.get(&face).copied().flatten());
            }
            distinct.iter().for_each(|&face| {
                assert!(listed.has_open() || !listed.is_open(face));
                listed.take(face, false);
            });
            assert!(!listed.has_open());
        }
        assert!(!Listed::new(&[]).has_open() && !Listed::new(&[]).is_open(0));
    }
}
