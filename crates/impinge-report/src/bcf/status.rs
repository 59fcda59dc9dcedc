//! Statuses of topics.

use impinge::clash::Status;

/// Returns the status of a topic.
pub(super) fn topic_status(status: Status) -> &'static str {
    match status {
        Status::New => "New",
        Status::Active => "Active",
        Status::Reviewed => "Reviewed",
        Status::Approved => "Approved",
        Status::Resolved => "Resolved",
    }
}

/// Returns the status that other programs mean by the status of a topic, in any case. A status that
/// is not known is active: somebody works on the topic.
pub(super) fn from_topic(text: &str) -> Status {
    match text.trim().to_lowercase().as_str() {
        "new" => Status::New,
        "reviewed" | "in review" | "for review" => Status::Reviewed,
        "approved" | "accepted" | "ignored" | "rejected" | "void" => Status::Approved,
        "resolved" | "closed" | "done" | "fixed" => Status::Resolved,
        _ => Status::Active,
    }
}

/// Returns the status of a topic of several clashes: that of the clash with the most work left.
pub(super) fn of_all(statuses: impl IntoIterator<Item = Status>) -> Status {
    let place = |status: &Status| Status::ALL.iter().position(|known| known == status);
    statuses.into_iter().min_by_key(place).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_status_comes_back() {
        for status in Status::ALL {
            assert_eq!(from_topic(topic_status(status)), status);
        }
        assert_eq!(from_topic("Closed"), Status::Resolved);
        assert_eq!(from_topic("In Progress"), Status::Active);
        assert_eq!(of_all([Status::Approved, Status::Active, Status::Reviewed]), Status::Active);
        assert_eq!(of_all([]), Status::New);
    }
}
