//! Statuses against a previous report, on a model with one wall moved, one removed, one renamed.

use impinge::clash::{Clash, DuplicateSet, Known, Member, Options, Previous, Report, Status};

use super::models::{block, house, report};

/// Returns a report as the previous one of the next search.
fn previous(report: &Report, status: impl Fn(&str) -> Status) -> Previous {
    let texts = |parts: &[&Member]| {
        let identities = parts.iter().map(|part| part.identity()).collect();
        (identities, parts.iter().map(|part| part.name.clone()).collect())
    };
    let clash = |clash: &Clash| {
        let (parts, names) = texts(&[&clash.a, &clash.b]);
        Known {
            id: clash.id.clone(),
            kind: clash.kind.name().to_owned(),
            status: status(&clash.id),
            depth: clash.depth,
            gap: clash.gap,
            accepted: clash.accepted,
            note: clash.note.clone(),
            parts,
            names,
        }
    };
    let set = |set: &DuplicateSet| {
        let (parts, names) = texts(&set.parts.iter().map(AsRef::as_ref).collect::<Vec<_>>());
        let (id, kind) = (set.id.clone(), "duplicate".to_owned());
        Known { id, kind, status: status(&set.id), parts, names, ..Known::default() }
    };
    let clashes = report.clashes.iter().map(clash).chain(report.duplicates.iter().map(set)).collect();
    Previous { clashes, ..Previous::default() }
}

fn id_of(report: &Report, a: &str, b: &str) -> String {
    let names = |clash: &&Clash| [clash.a.name.as_str(), clash.b.name.as_str()] == [a, b];
    report.clashes.iter().find(names).unwrap_or_else(|| panic!("no clash of {a} and {b}")).id.clone()
}

#[test]
fn a_moved_a_removed_and_a_renamed_wall_have_the_right_statuses() {
    let mut model = house();
    model.push(block("IfcWall", "W-3", [0.0, 3.5, 0.0], [5.0, 3.75, 3.0]));
    let first = report(&model, Options::new(1e-4));
    assert!(first.clashes.iter().all(|clash| clash.status == Status::New) && first.gone.is_none());
    let approved = [id_of(&first, "P-1", "W-3"), id_of(&first, "P-1", "W-2")];
    let old =
        previous(&first, |id| if approved.iter().any(|known| known == id) { Status::Approved } else { Status::New });

    // W-1 moves away from P-2, but stays around P-1. W-2 is removed. W-3 is renamed.
    model[0].corners = [[0.0, -0.5, 0.0], [5.0, -0.25, 3.0]];
    model.remove(1);
    let renamed = model.last_mut().unwrap();
    renamed.name = "North wall".to_owned();
    model.push(block("IfcPipeSegment", "P-3", [3.0, 3.0, 1.0], [3.125, 4.0, 1.125]));
    let second = report(&model, Options { previous: Some(&old), ..Options::new(1e-4) });

    let status = |a: &str, b: &str| {
        second.clashes.iter().find(|clash| [clash.a.name.as_str(), clash.b.name.as_str()] == [a, b]).map(|c| c.status)
    };
    assert_eq!(status("P-1", "W-1"), Some(Status::Active));
    assert_eq!(status("P-1", "North wall"), Some(Status::Approved));
    assert_eq!(status("P-3", "North wall"), Some(Status::New));
    assert_eq!(second.duplicates[0].status, Status::Active);
    let gone = second.gone.as_ref().unwrap();
    let mut gone: Vec<_> = gone.iter().map(|gone| (gone.clash.names.join(" "), gone.removed.clone())).collect();
    gone.sort();
    let removed = || vec!["house/key-W-2".to_owned()];
    assert_eq!(
        gone,
        [("B-1 W-2".to_owned(), removed()), ("P-1 W-2".to_owned(), removed()), ("P-2 W-1".to_owned(), vec![]),]
    );
    assert!(second.gone.as_ref().unwrap().iter().all(|gone| gone.clash.status == Status::Resolved));
}

#[test]
fn an_approved_clash_that_grows_becomes_active() {
    let mut model = vec![
        block("IfcWall", "W", [0.0; 3], [4.0, 1.0, 4.0]),
        block("IfcSlab", "S", [0.0, 0.75, 0.0], [4.0, 4.0, 4.0]),
    ];
    let first = report(&model, Options::new(0.01));
    let old = previous(&first, |_| Status::Approved);
    let again = |model: &[_], old: &Previous| report(model, Options { previous: Some(old), ..Options::new(0.01) });
    assert!(again(&model, &old).is_clear());
    // It creeps by less than the tolerance, twice.
    model[1].corners[0][1] = 0.742;
    let crept = again(&model, &old);
    assert_eq!(crept.clashes[0].status, Status::Approved);
    model[1].corners[0][1] = 0.734;
    assert_eq!(again(&model, &previous(&crept, |_| Status::Approved)).clashes[0].status, Status::Active);
}
