//! Implementations for public partitions that differ only in their constructors.

/// Implements all traits of a dynamic partition for a tuple struct that wraps another dynamic
/// partition.
macro_rules! forward_to_inner {
    ($partition:ident) => {
        impl Holds for $partition {
            fn items(&self) -> &Items {
                self.0.items()
            }
        }

        impl Partition for $partition {
            fn cells(&self) -> Cells {
                self.0.cells()
            }

            fn overlapping_counted(
                &self,
                bounds: &MinMax,
                work: &mut Work,
                visit: &mut Visitor<'_>,
            ) -> ControlFlow<()> {
                self.0.overlapping_counted(bounds, work, visit)
            }

            fn for_each_pair(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
                self.0.for_each_pair(visit)
            }
        }

        impl Dynamic for $partition {
            fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
                self.0.insert(key, bounds)
            }

            fn remove(&mut self, key: u32) -> Option<MinMax> {
                self.0.remove(key)
            }

            fn step(&mut self, moves: &[Move], changes: &mut Changes) {
                self.0.step(moves, changes);
            }
        }
    };
}

pub(super) use forward_to_inner;
