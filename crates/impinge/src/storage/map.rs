//! Memory in pages of its own. This needs the feature `mmap`.

#[cfg(not(feature = "mmap"))]
pub(super) use absent::{Map, zeroed};
#[cfg(feature = "mmap")]
pub(super) use present::{Map, zeroed};

#[cfg(feature = "mmap")]
mod present {
    pub(in super::super) use memmap2::MmapMut as Map;

    /// Returns `bytes` zeros in pages that the system is asked to make large, or `None` if it
    /// refuses.
    pub(in super::super) fn zeroed(bytes: usize) -> Option<Map> {
        let map = Map::map_anon(bytes).ok()?;
        // If the system declines large pages, everything works and takes longer.
        #[cfg(target_os = "linux")]
        let _ = map.advise(memmap2::Advice::HugePage);
        Some(map)
    }
}

#[cfg(not(feature = "mmap"))]
mod absent {
    use std::ops::{Deref, DerefMut};

    /// A type without values: without the feature there are no such pages.
    pub(in super::super) enum Map {}

    pub(in super::super) fn zeroed(_bytes: usize) -> Option<Map> {
        None
    }

    impl Deref for Map {
        type Target = [u8];

        fn deref(&self) -> &[u8] {
            match *self {}
        }
    }

    impl DerefMut for Map {
        fn deref_mut(&mut self) -> &mut [u8] {
            match *self {}
        }
    }
}
