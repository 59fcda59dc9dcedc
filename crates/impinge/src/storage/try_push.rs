//! Lists that grow with an answer, and report that memory ran out.

use std::collections::TryReserveError;

/// A list that can grow without ending the process if memory runs out.
pub(crate) trait TryPush<T> {
    /// Appends an element.
    ///
    /// # Errors
    /// Returns an error if the memory cannot be allocated. The list is then unchanged.
    fn try_push(&mut self, element: T) -> Result<(), TryReserveError>;
}

impl<T> TryPush<T> for Vec<T> {
    #[inline]
    fn try_push(&mut self, element: T) -> Result<(), TryReserveError> {
        if self.len() == self.capacity() {
            self.try_reserve(1)?;
        }
        self.push(element);
        Ok(())
    }
}

/// Returns the concatenation of lists. Each list is freed after it was copied.
///
/// # Errors
/// Returns an error if the memory cannot be allocated.
pub(crate) fn try_concat<T>(lists: Vec<Vec<T>>) -> Result<Vec<T>, TryReserveError> {
    let mut all = Vec::new();
    all.try_reserve_exact(lists.iter().map(Vec::len).sum())?;
    lists.into_iter().for_each(|mut list| all.append(&mut list));
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushed_and_concatenated_elements_keep_their_order() {
        let mut list = Vec::new();
        (0..100).try_for_each(|element| list.try_push(element)).unwrap();
        assert!(list.iter().copied().eq(0..100));
        assert_eq!(try_concat(vec![list[..40].to_vec(), Vec::new(), list[40..].to_vec()]).unwrap(), list);
    }
}
