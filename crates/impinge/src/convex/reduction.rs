//! The few contacts of a manifold that hold as much as all of them.
//!
//! The first contact is the deepest. If several are as deep, as those of a box that lies flat are,
//! it is the one farthest from the middle of all contacts, which is a corner of their polygon.
//! Which contact is deepest by rounding does not count. The next contacts are the farthest from the
//! first, and then those that add the most area.
//!
//! The tests are in `tests/it/shapes/mesh_contacts.rs` and `tests/it/shapes/contacts.rs`.

use super::manifold::{Contact, Contacts};
use super::overlap::Feature;
use crate::math::vec3::{cross, dot, length, sub};

/// Difference of depths that count as equal, relative to the distances between the contacts: 2^-20.
const SAME_DEPTH: f64 = 1.0 / (1 << 20) as f64;

impl Contacts {
    /// Keeps at most `max_contacts` contacts, and at least one, sorted by features.
    pub(crate) fn keep(&mut self, max_contacts: usize) {
        if self.contacts.len() > max_contacts {
            let mut rest = std::mem::take(&mut self.contacts);
            let first = first(&rest);
            self.contacts.push(rest.swap_remove(first));
            while self.contacts.len() < max_contacts && !rest.is_empty() {
                let worth = |contact: &Contact| self.worth(contact);
                let best = best(&rest, worth);
                self.contacts.push(rest.swap_remove(best));
            }
        }
        self.contacts.sort_by_key(|contact| contact.features);
    }

    /// Returns the value of a contact beside the kept ones. It is the same for the shapes in either
    /// order.
    fn worth(&self, contact: &Contact) -> f64 {
        let at = middle(contact);
        match &self.contacts[..] {
            [] => contact.upper,
            [first] => {
                let from = sub(&at, &middle(first));
                dot(&from, &from)
            }
            [first, second] => {
                let (p, q) = (middle(first), middle(second));
                dot(&cross(&sub(&at, &p), &sub(&at, &q)), &self.normal).abs()
            }
            [first, second, third, ..] => {
                // Distance beyond the side of the triangle for which it is largest.
                let corners = [first, second, third].map(middle);
                let side = |i: usize| sub(&corners[(i + 1) % 3], &corners[i]);
                let turn = dot(&cross(&side(0), &sub(&corners[2], &corners[0])), &self.normal).signum();
                let beyond = |i: usize| -turn * dot(&cross(&side(i), &sub(&at, &corners[i])), &self.normal);
                beyond(0).max(beyond(1)).max(beyond(2))
            }
        }
    }
}

/// Returns the contact to start with. There must be one.
fn first(contacts: &[Contact]) -> usize {
    let count = contacts.len() as f64;
    let center: [f64; 3] = std::array::from_fn(|k| contacts.iter().map(|contact| middle(contact)[k] / count).sum());
    let away = |contact: &Contact| length(&sub(&middle(contact), &center));
    let spread = contacts.iter().map(away).fold(0.0, f64::max);
    let deepest = contacts.iter().map(|contact| contact.lower).fold(f64::NEG_INFINITY, f64::max);
    best(contacts, |contact| {
        let is_deepest = contact.upper >= deepest - SAME_DEPTH * spread;
        if is_deepest { away(contact) } else { f64::NEG_INFINITY }
    })
}

/// Returns the contact with the greatest value; of equal ones the one with the least features.
fn best(contacts: &[Contact], value: impl Fn(&Contact) -> f64) -> usize {
    let values: Vec<f64> = contacts.iter().map(value).collect();
    let order = |&i: &usize, &j: &usize| {
        values[i].total_cmp(&values[j]).then_with(|| unordered(&contacts[j]).cmp(&unordered(&contacts[i])))
    };
    (0..contacts.len()).max_by(order).unwrap_or(0)
}

/// Returns twice the midpoint of the two points of a contact.
fn middle(contact: &Contact) -> [f64; 3] {
    std::array::from_fn(|k| contact.points[0][k] + contact.points[1][k])
}

/// Returns a contact's features, the lesser first.
fn unordered(contact: &Contact) -> [Feature; 2] {
    let mut features = contact.features;
    features.sort();
    features
}
