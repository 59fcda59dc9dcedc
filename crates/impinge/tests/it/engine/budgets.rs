//! Budgets: each limit ends a query with the safe answer and is named, rows of a batch that are not
//! complete are marked, and a limit that is not reached changes nothing.

use std::time::{Duration, Instant};

use impinge::budget::{Budget, Stopped};
use impinge::query::batch::{Batch, Execution, Status};
use impinge::query::{self, Penetrates, Proximity, Query};
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_testkit::generate::knots::{Knot, TREFOIL, torus_knot};

fn knot() -> Mesh {
    let knot = torus_knot(400, 40, TREFOIL);
    Mesh::new(Positions::F64(knot.vertices), knot.faces).expect("a mesh")
}

/// Returns a knot, and a thin one inside it, close to it everywhere.
fn nested_knots() -> [Mesh; 2] {
    [1.0, 0.9].map(|thickness| {
        let knot = torus_knot(2000, 100, Knot { radius: thickness * TREFOIL.radius, ..TREFOIL });
        Mesh::new(Positions::F64(knot.vertices), knot.faces).expect("a mesh")
    })
}

/// Copies of two triangles that cross: each face of one kind intersects each of the other.
fn piles(count: usize) -> [Mesh; 2] {
    let ground = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let wall = vec![[0.25, 0.25, -1.0], [0.25, 0.25, 1.0], [2.0, 0.5, 0.0]];
    [ground, wall].map(|corners| Mesh::new(Positions::F32(corners), vec![[0, 1, 2]; count]).expect("a mesh"))
}

fn ask<'b>(budget: &'b Budget<'b>) -> Query<'b> {
    Query::new().with_budget(budget)
}

#[test]
fn a_spent_budget_gives_the_safe_answer_of_each_query() {
    let [mesh, thin] = nested_knots();
    let passed = || Budget::new().with_deadline(Instant::now());
    let no_steps = || Budget::new().with_steps(0);
    for (budget, reason) in [(passed as fn() -> Budget<'static>, Stopped::Time), (no_steps, Stopped::Steps)] {
        let budgets: [Budget<'_>; 6] = std::array::from_fn(|_| budget());
        assert_eq!(ask(&budgets[0]).proximity(&mesh, &thin), Proximity::Undecided);
        let found = ask(&budgets[1]).distance(&mesh, &thin);
        assert_eq!((found.lower, found.proximity), (0.0, Proximity::Undecided));
        assert_eq!(ask(&budgets[2]).nearness(&mesh, &thin, 1e-9), Proximity::Undecided);
        assert_eq!(ask(&budgets[3]).penetrates(mesh.solid(), &thin), Penetrates::Undecided);
        assert!(
            ask(&budgets[4]).intersecting_pairs(&mesh, &mesh).len() < query::intersecting_pairs(&mesh, &mesh).len()
        );
        assert!(ask(&budgets[5]).intersection_curves(&mesh, &mesh).polylines.is_empty());
        for budget in &budgets {
            assert_eq!(budget.stopped(), Some(reason));
        }
    }
}

#[test]
fn a_spent_budget_ends_queries_of_compounds() {
    let apart = Pose::from_translation([0.0, 0.0, 100.0]).expect("a pose");
    let [thick, thin] = nested_knots().map(|mesh| {
        let parts = [(Shape::mesh(&mesh), Pose::IDENTITY), (Shape::mesh(&mesh), apart)];
        Shape::compound(&parts).and_then(|compound| compound.at(Pose::IDENTITY)).expect("a compound")
    });
    let budgets: [Budget<'_>; 3] = std::array::from_fn(|_| Budget::new().with_steps(0));
    assert_eq!(ask(&budgets[0]).proximity(&thick, &thin), Proximity::Undecided);
    assert_eq!(ask(&budgets[1]).nearness(&thick, &thin, 1e-9), Proximity::Undecided);
    let found = ask(&budgets[2]).distance(&thick, &thin);
    assert_eq!((found.lower, found.proximity), (0.0, Proximity::Undecided));
    for budget in &budgets {
        assert_eq!(budget.stopped(), Some(Stopped::Steps));
    }
}

#[test]
fn lists_take_no_more_memory_than_the_budget() {
    const COUNT: usize = 700;
    let [ground, wall] = piles(COUNT);
    let both = Mesh::new(
        Positions::F64(
            (0..3).map(|i| ground.positions().get(i)).chain((0..3).map(|i| wall.positions().get(i))).collect(),
        ),
        (0..2 * COUNT).map(|i| if i % 2 == 0 { [0, 1, 2] } else { [3, 4, 5] }).collect::<Vec<_>>(),
    )
    .expect("a mesh");
    let all = COUNT * COUNT;
    for megabytes in [1, 2, 3, 100] {
        let budgets: [Budget<'_>; 3] = std::array::from_fn(|_| Budget::new().with_memory(megabytes << 20));
        let pairs = ask(&budgets[0]).intersecting_pairs(&ground, &wall).len();
        let own = ask(&budgets[1]).self_intersecting_pairs(&both).len();
        let curves = ask(&budgets[2]).intersection_curves(&ground, &wall);
        let is_enough = megabytes == 100;
        assert_eq!([pairs, own].map(|found| found == all), [is_enough; 2], "{megabytes}: {pairs}, {own} of {all}");
        assert_eq!(budgets[0].stopped(), (!is_enough).then_some(Stopped::Memory));
        assert_eq!(budgets[1].stopped(), (!is_enough).then_some(Stopped::Memory));
        // The ends of the curves take more memory than the pairs.
        assert_eq!(curves.polylines.is_empty(), budgets[2].stopped() == Some(Stopped::Memory));
        assert!(is_enough || curves.polylines.is_empty());
    }
}

#[test]
fn the_same_steps_end_the_same_query_in_the_same_place() {
    let mesh = knot();
    let turned = mesh.at(Pose::from_translation([0.003, 0.001, 0.002]).expect("a pose"));
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let found = |steps| {
        let budget = Budget::new().with_steps(steps);
        let pairs = alone.install(|| Query::new().with_budget(&budget).intersecting_pairs(&mesh, turned));
        (pairs, budget.stopped())
    };
    let all = query::intersecting_pairs(&mesh, turned);
    let counts = [0, 1, 2, 4, 1000].map(|steps| {
        let (pairs, stopped) = found(steps);
        assert_eq!((pairs.clone(), stopped), found(steps), "{steps}");
        assert_eq!(stopped.is_none(), pairs == all, "{steps}");
        pairs.len()
    });
    assert!(
        counts.is_sorted() && counts[1] > counts[0] && counts[3] < all.len() && counts[4] == all.len(),
        "{counts:?}"
    );
}

#[test]
fn rows_that_are_not_complete_are_marked() {
    let mesh = knot();
    let poses: Vec<Pose> =
        (0..300).map(|i| Pose::from_translation([f64::from(i), 0.0, 0.0]).expect("a pose")).collect();
    let batch = Batch::new(&mesh, &mesh, Pose::IDENTITY, poses).expect("a batch");
    let all = batch.distance().expect("answers");
    for is_sequential in [false, true] {
        let budget = Budget::new().with_steps(40);
        let execution = Execution::default().with_budget(&budget);
        let execution = if is_sequential { execution.sequentially() } else { execution };
        let some = batch.clone().with_execution(execution).distance().expect("answers");
        assert_eq!(budget.stopped(), Some(Stopped::Steps));
        let mut marked = 0;
        for (row, (found, status)) in some.values.iter().zip(&some.status).enumerate() {
            if *status == Status::OutOfBudget {
                assert_eq!((found.lower, found.proximity), (0.0, Proximity::Undecided));
                marked += 1;
            } else {
                assert_eq!((found, *status), (&all.values[row], all.status[row]));
            }
        }
        assert!((100..300).contains(&marked), "{marked}");
    }
    let enough = Budget::new().with_timeout(Duration::from_secs(3600)).with_steps(1 << 40).with_memory(1 << 40);
    let execution = Execution::default().with_budget(&enough);
    assert_eq!(batch.with_execution(execution).distance(), Ok(all));
    assert_eq!(enough.stopped(), None);
}

/// Placing all parts for all rows would take more than a minute.
#[test]
fn a_spent_budget_places_no_compound() {
    let sphere = Shape::sphere([0.0; 3], 0.25).expect("a sphere");
    let parts: Vec<_> = (0..20_000)
        .map(|at| (sphere.clone(), Pose::from_translation([f64::from(at), 0.0, 0.0]).expect("a pose")))
        .collect();
    let compound = Shape::compound(&parts).expect("a compound");
    let poses = vec![Pose::IDENTITY; 20_000];
    let begun = Instant::now();
    let batch = Batch::new(&compound, &sphere, poses.clone(), Pose::IDENTITY).expect("rows");
    let budget = Budget::new().with_steps(0);
    let answers = batch.clone().with_execution(Execution::default().with_budget(&budget)).intersects();
    let answers = answers.expect("only a canceled batch ends without answers");
    assert!(answers.values.iter().all(|&found| found));
    assert!(answers.status.iter().all(|&status| status == Status::OutOfBudget));
    assert!(begun.elapsed() < Duration::from_secs(8), "{:?}", begun.elapsed());
}
