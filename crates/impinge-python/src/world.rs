//! Worlds of many bodies in Python: handles of bodies and arrays of poses are arguments, and arrays
//! of pairs are results.
//!
//! A step may call a filter that is a Python function, from threads that then need the interpreter.
//! So a call that waits for the world detaches from the interpreter first.

use std::cell::Cell;
use std::sync::{Arc, Mutex, PoisonError};

use impinge::query::Proximity;
use impinge::world::{Body, BodyId, Options, PairKey, Traits, World, WorldError};
use impinge::{Pose, Positions};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::contacts;
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::read_positions;
use crate::motions::matrix;
use crate::pace::Pace;
use crate::poses;
use crate::shapes::read_shape;
use crate::workers;
use crate::world_bodies::{
    BROAD_PHASES, Handles, NARROW_PHASES, Placement, REALIGNMENTS, TraitArguments, chosen, ids, keys, numbers,
    of_bodies, refused, traits,
};
use crate::world_state::{Shapes, Source, WorldState};
use crate::world_turn::{Shared, Turn};

/// Contents of `impinge.World`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct WorldCore {
    /// The lock is held only while the thread is attached to the interpreter, so no fork leaves it
    /// locked.
    shared: Mutex<Arc<Shared>>,
    /// Exception that a filter raised in the current step.
    raised: Arc<Mutex<Option<PyErr>>>,
    pace: Pace,
}

thread_local! {
    /// Whether this thread is calling a filter of Python.
    static IN_FILTER: Cell<bool> = const { Cell::new(false) };
}

impl WorldCore {
    /// Waits until no other call uses the world, without holding the interpreter. Returns the
    /// exclusive turn.
    ///
    /// # Errors
    /// A `RuntimeError` within a filter, because the world is changing then. If a signal handler
    /// raises during the wait, its exception.
    pub(crate) fn turn(&self, py: Python<'_>) -> PyResult<Turn> {
        if IN_FILTER.get() {
            let message = "a filter cannot query the world, which is changing while the filter runs";
            return Err(PyRuntimeError::new_err(message));
        }
        let shared = Shared::of_this_process(&self.shared)?;
        loop {
            if let Some(turn) = py.detach(|| shared.take()) {
                return Ok(turn);
            }
            py.check_signals()?;
        }
    }

    /// Returns the result of `look` for the world, without holding the interpreter.
    ///
    /// # Errors
    /// As for [`turn`](Self::turn).
    fn look<T: Send>(&self, py: Python<'_>, look: impl FnOnce(&World) -> T + Send) -> PyResult<T> {
        let turn = self.turn(py)?;
        Ok(py.detach(move || look(&turn.read())))
    }

    /// Returns the result of `change`, which may change the world, without holding the interpreter.
    ///
    /// # Errors
    /// As for [`turn`](Self::turn).
    pub(crate) fn change<T: Send>(&self, py: Python<'_>, change: impl FnOnce(&mut World) -> T + Send) -> PyResult<T> {
        self.reshape(py, |world, _| change(world))
    }

    /// Changes the world and the table of its shapes, without holding the interpreter.
    ///
    /// # Errors
    /// As for [`turn`](Self::turn).
    fn reshape<T: Send>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut World, &mut Shapes) -> T + Send,
    ) -> PyResult<T> {
        let turn = self.turn(py)?;
        Ok(py.detach(move || change(&mut turn.write(), &mut turn.shapes())))
    }
}

#[pymethods]
impl WorldCore {
    #[new]
    fn new(broad_phase: &Bound<'_, PyAny>, narrow_phase: &Bound<'_, PyAny>) -> PyResult<Self> {
        let options = Options {
            broad_phase: chosen(broad_phase, "broad_phase", &BROAD_PHASES)?,
            narrow_phase: chosen(narrow_phase, "narrow_phase", &NARROW_PHASES)?,
        };
        let shared = Shared::new(World::with_options(options));
        Ok(Self { shared: Mutex::new(Arc::new(shared)), raised: Arc::default(), pace: Pace::new() })
    }

    fn count(&self, py: Python<'_>) -> PyResult<usize> {
        self.look(py, World::len)
    }

    /// Returns the handles of all bodies, (n,).
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bodies = self.look(py, |world| world.bodies().map(BodyId::to_bits).collect::<Vec<u64>>())?;
        let count = bodies.len();
        array(py, bodies, &[count])
    }

    /// Inserts a body of one shape at each of the poses, with owners and tags of their own. If one
    /// body is invalid, no body is inserted. There is one owner for each pose, or there are no
    /// owners.
    fn insert<'py>(
        &self,
        py: Python<'py>,
        placement: Placement<'py>,
        standing: (TraitArguments<'_>, f64),
        owners: Option<&Handles<'py>>,
        tags: &Handles<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (shape, way, poses) = placement;
        let (body, made_of) = (Body::new(read_shape(&shape, "shape", false)?.shape), Source::object(&shape));
        let way = chosen(&way, "realigned_by", &REALIGNMENTS)?;
        let (Traits { kind, layers, surface, .. }, margin) = (traits(&standing.0)?, standing.1);
        let (lead, poses) = poses::read_all(&poses, "pose")?;
        let body = py.detach(|| body.realigned_by(way)).map_err(|error| {
            Fault::new(kind_and_place(&error).0, "shape", message(&error)).hint(error.hint()).raised(py)
        })?;
        let owners = owners.map(numbers).transpose()?;
        let tags = numbers(tags)?;
        let inserted = self.reshape(py, move |world, shapes| {
            let mut inserted = Vec::with_capacity(poses.len());
            for (row, pose) in poses.into_iter().enumerate() {
                let mut one = body.clone().at(pose).kind(kind).layers(layers).tag(tags[row]).with_margin(margin);
                if let Some(owners) = &owners {
                    one = one.owner(owners[row]);
                }
                if let Some(surface) = surface {
                    one = one.surface(surface);
                }
                match world.insert(one) {
                    Ok(id) => inserted.push(id),
                    Err(error) => {
                        for id in inserted {
                            world.remove(id).ok(); // it exists, as it was inserted above
                        }
                        return Err((row, error));
                    }
                }
            }
            inserted.iter().for_each(|&id| shapes.set(id, Some(made_of.clone())));
            Ok(inserted)
        })?;
        let inserted = inserted.map_err(|(row, error)| refused(&error, "pose", row).raised(py))?;
        array(py, inserted.into_iter().map(BodyId::to_bits).collect(), &lead)
    }

    /// Removes bodies. If one handle is invalid, no body is removed.
    fn remove(&self, bodies: &Handles<'_>) -> PyResult<()> {
        let ids = ids(bodies)?;
        let mut once = ids.clone();
        once.sort_unstable();
        once.dedup();
        let removed = self.reshape(bodies.py(), |world, shapes| {
            ids.iter().try_for_each(|&id| world.traits(id).map(drop))?;
            once.into_iter().try_for_each(|id| {
                shapes.set(id, None);
                world.remove(id).map(drop)
            })
        })?;
        removed.map_err(|error| of_bodies(&error, &ids, "bodies").raised(bodies.py()))
    }

    /// Moves bodies to poses in the world and returns the changes: pairs that began, (k, 2), pairs
    /// that ended, (k, 2), the other pairs, (k, 2), if they are wanted, and five counters of work.
    fn step<'py>(
        &self,
        bodies: &Handles<'py>,
        poses: &Bound<'py, PyAny>,
        persisting: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = bodies.py();
        let ids = ids(bodies)?;
        let poses = poses::read_all(poses, "poses")?.1;
        let moves: Vec<(BodyId, Pose)> = ids.iter().copied().zip(poses).collect();
        let turn = self.turn(py)?;
        drop(self.raised());
        let events = self.pace.run(py, move |budget| {
            let mut world = turn.write();
            let events = world.step_with_budget(&moves, budget)?.clone();
            let is_persisting = |pair: &PairKey| events.began.binary_search(pair).is_err();
            let stay = persisting.then(|| world.pairs().map(|pair| pair.key).filter(is_persisting).collect::<Vec<_>>());
            Ok((events, stay))
        })?;
        if let Some(raised) = self.raised() {
            return Err(raised);
        }
        let (events, stay) = events.map_err(|error| of_bodies(&error, &ids, "poses").raised(py))?;
        let work = events.work;
        let counters = (work.changed, work.gained, work.lost, work.examined, work.candidates);
        let stay = stay.map(|stay| keys(py, &stay)).transpose()?;
        Ok((keys(py, &events.began)?, keys(py, &events.ended)?, stay, counters).into_pyobject(py)?.into_any())
    }

    /// Returns the pairs that intersect, (p, 2), and whether each is undecided, (p,). If a body is
    /// given, only the pairs of that body are returned.
    fn pairs<'py>(&self, py: Python<'py>, body: Option<u64>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.look(py, |world| {
            let of = |pair: impinge::world::Pair<'_>| (pair.key, pair.proximity == Proximity::Undecided);
            match body {
                Some(body) => world.pairs_of(BodyId::from_bits(body)).map(|pairs| pairs.map(of).collect()),
                None => Ok(world.pairs().map(of).collect::<Vec<_>>()),
            }
        })?;
        let found = found.map_err(|error| refused(&error, "body", 0).at(Vec::new()).raised(py))?;
        let (pairs, undecided): (Vec<PairKey>, Vec<bool>) = found.into_iter().unzip();
        let count = undecided.len();
        Ok((keys(py, &pairs)?, array(py, undecided, &[count])?).into_pyobject(py)?.into_any())
    }

    /// Returns the contacts of the pairs that intersect, as `contacts::columns` makes them.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.look(py, |world| world.pairs().map(|pair| pair.manifolds.to_vec()).collect::<Vec<_>>())?;
        contacts::columns(py, found.iter().map(Vec::as_slice))
    }

    /// Returns the poses of bodies, (n, 4, 4), which map body frames to the world frame.
    fn poses<'py>(&self, bodies: &Handles<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.of_each(bodies, |world, id| world.pose(id).map(matrix))?;
        let count = found.len();
        array(bodies.py(), found.into_flattened(), &[count, 4, 4])
    }

    /// Returns the tags of bodies, (n,).
    fn tags<'py>(&self, bodies: &Handles<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.of_each(bodies, |world, id| world.traits(id).map(|traits| traits.tag))?;
        let count = found.len();
        array(bodies.py(), found, &[count])
    }

    /// Returns the lower and upper corners of boxes around bodies in the world frame, (n, 2, 3).
    /// They are infinite for unbounded bodies.
    fn bounds<'py>(&self, bodies: &Handles<'py>) -> PyResult<Bound<'py, PyAny>> {
        const EVERYWHERE: [[f64; 3]; 2] = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
        let found = self.of_each(bodies, |world, id| {
            Ok(world.bounds(id)?.map_or(EVERYWHERE, |bounds| [bounds.min(), bounds.max()]))
        })?;
        let count = found.len();
        array(bodies.py(), found.into_flattened().into_flattened(), &[count, 2, 3])
    }

    /// Sets the poses of bodies at once, static bodies included. If one pose is invalid, no body is
    /// moved.
    fn set_poses<'py>(&self, bodies: &Handles<'py>, poses: &Bound<'py, PyAny>) -> PyResult<()> {
        let py = bodies.py();
        let ids = ids(bodies)?;
        let poses = poses::read_all(poses, "poses")?.1;
        let set = self.change(py, |world| {
            let before: Result<Vec<Pose>, WorldError> = ids.iter().map(|&id| world.pose(id).copied()).collect();
            let before = before?;
            for (row, (&id, &pose)) in ids.iter().zip(&poses).enumerate() {
                if let Err(error) = world.set_pose(id, pose) {
                    for (&id, &pose) in ids.iter().zip(&before).take(row).rev() {
                        world.set_pose(id, pose).ok(); // valid, as it was the pose before
                    }
                    return Err(error);
                }
            }
            Ok(())
        })?;
        set.map_err(|error| of_bodies(&error, &ids, "poses").raised(py))
    }

    /// Sets the kind, layers, owner and surface of bodies. If one handle is invalid, nothing
    /// changes.
    fn set_traits(
        &self,
        bodies: &Handles<'_>,
        standing: TraitArguments<'_>,
        owners: Option<&Handles<'_>>,
    ) -> PyResult<()> {
        let ids = ids(bodies)?;
        let made = traits(&standing)?;
        let owners = owners.map(numbers).transpose()?;
        let set = self.change(bodies.py(), |world| {
            ids.iter().try_for_each(|&id| world.traits(id).map(drop))?;
            ids.iter().enumerate().try_for_each(|(row, &id)| {
                let owner = owners.as_ref().map(|owners| owners[row]);
                world.set_traits(id, Traits { owner, ..made })
            })
        })?;
        set.map_err(|error| of_bodies(&error, &ids, "bodies").raised(bodies.py()))
    }

    /// Replaces the shape of a body.
    fn set_shape(&self, body: u64, shape: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = shape.py();
        let (made_of, shape) = (Source::object(shape), read_shape(shape, "shape", false)?.shape);
        let set = self.reshape(py, move |world, shapes| {
            let body = BodyId::from_bits(body);
            world.set_shape(body, &shape)?;
            shapes.set(body, Some(made_of));
            Ok(())
        })?;
        set.map_err(|error| refused(&error, "body", 0).at(Vec::new()).raised(py))
    }

    /// Moves the vertices of a body that is a mesh, to positions in the mesh frame. Returns the
    /// cost of its hierarchy relative to its cost when it was built.
    fn refit(&self, body: u64, vertices: &Bound<'_, PyAny>) -> PyResult<f64> {
        let py = vertices.py();
        let positions: Positions = read_positions(vertices)?;
        let turn = self.turn(py)?;
        let refitted = workers::run(py, move |_| {
            let (mut world, body) = (turn.write(), BodyId::from_bits(body));
            let aging = world.refit(body, positions)?;
            turn.shapes().set(body, Source::of_mesh(world.body(body)?.shape()));
            Ok(aging)
        })?;
        let aging = refitted.map_err(|error| match &error {
            WorldError::Input { error, .. } => {
                let (kind, at) = kind_and_place(error);
                Fault::new(kind, "vertices", message(error)).at(at).hint(error.hint()).raised(py)
            }
            _ => refused(&error, "body", 0).at(Vec::new()).raised(py),
        })?;
        Ok(aging.ratio())
    }

    /// Sets the filter: from now on `filter(a, b)` is called with pairs of handles. `None` removes
    /// it.
    fn set_filter(&self, py: Python<'_>, filter: Option<Py<PyAny>>) -> PyResult<()> {
        let raised = self.raised.clone();
        self.change(py, move |world| match filter {
            None => world.clear_filter(),
            Some(filter) => world.set_filter(move |a: (BodyId, &Traits), b: (BodyId, &Traits)| {
                Python::attach(|py| {
                    IN_FILTER.set(true);
                    let asked = filter.bind(py).call1((a.0.to_bits(), b.0.to_bits()));
                    let answer = asked.and_then(|answer| answer.is_truthy());
                    IN_FILTER.set(false);
                    answer.unwrap_or_else(|error| {
                        raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                        true
                    })
                })
            }),
        })
    }

    fn save(&self, py: Python<'_>) -> PyResult<WorldState> {
        let turn = self.turn(py)?;
        Ok(py.detach(move || WorldState::of(&turn.read(), &turn.shapes())))
    }

    fn restore(&self, py: Python<'_>, state: &WorldState) -> PyResult<()> {
        if self.reshape(py, |world, shapes| state.restore(world, shapes))? {
            return Ok(());
        }
        let message = "belongs to a world with another broad_phase or narrow_phase";
        Err(Fault::new("option", "state", message).raised(py))
    }
}

impl WorldCore {
    /// Returns the exception that a filter raised in the last step.
    fn raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Returns the result of `of` for each body.
    pub(crate) fn of_each<T: Send>(
        &self,
        bodies: &Handles<'_>,
        of: impl Fn(&World, BodyId) -> Result<T, WorldError> + Sync,
    ) -> PyResult<Vec<T>> {
        let ids = ids(bodies)?;
        let found: Result<Vec<T>, WorldError> =
            self.look(bodies.py(), |world| ids.iter().map(|&id| of(world, id)).collect())?;
        found.map_err(|error| of_bodies(&error, &ids, "bodies").raised(bodies.py()))
    }
}
