//! Saved states of a world, in memory and as plain data that can be pickled.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use impinge::Mesh;
use impinge::query::Proximity;
use impinge::shape::Shape;
use impinge::world::{
    Body, BodyId, Change, Options, PairKey, Realignment, Record, RecordedBody, RecordedPair, Snapshot, Traits, World,
};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays::{array, plain_column, row_array};
use crate::contacts;
use crate::errors::{Fault, message};
use crate::mesh::MeshBase;
use crate::motions::matrix;
use crate::poses;
use crate::shapes::read_shape;
use crate::world_bodies::{BROAD_PHASES, KINDS, NARROW_PHASES, REALIGNMENTS, chosen};

/// Version of the pickled data. Data of another version is rejected.
const VERSION: u32 = 4;

/// Proximities of pairs as data. Pairs that are apart have no proximity.
const PROXIMITIES: [Option<Proximity>; 3] = [None, Some(Proximity::Intersects), Some(Proximity::Undecided)];

const CHANGES: [Change; 4] = [Change::No, Change::Moved, Change::Place, Change::Traits];

/// Source of a shape in a world, from which the shape can be made again.
#[derive(Clone)]
pub(crate) enum Source {
    /// An `impinge.Shape`, which never changes.
    Object(Arc<Py<PyAny>>),
    /// A mesh that the world itself refitted, and whether it is solid.
    Refitted(Mesh, bool),
}

impl Source {
    pub(crate) fn object(shape: &Bound<'_, PyAny>) -> Self {
        Self::Object(Arc::new(shape.clone().unbind()))
    }

    /// Returns the source of a shape that is a mesh, or `None` for other shapes.
    pub(crate) fn of_mesh(shape: &Shape) -> Option<Self> {
        shape.as_mesh().map(|(mesh, is_solid)| Self::Refitted(mesh.clone(), is_solid))
    }
}

/// Sources of the shapes of bodies. A copy is free until one of the two copies changes.
#[derive(Clone, Default)]
pub(crate) struct Shapes(Arc<Vec<Option<Source>>>);

impl Shapes {
    /// Sets the source of a body's shape. The index is the high half of the body's handle.
    pub(crate) fn set(&mut self, body: BodyId, source: Option<Source>) {
        let (shapes, place) = (Arc::make_mut(&mut self.0), (body.to_bits() >> 32) as usize);
        if shapes.len() <= place {
            shapes.resize(place + 1, None);
        }
        shapes[place] = source;
    }

    fn get(&self, body: BodyId) -> Option<&Source> {
        self.0.get((body.to_bits() >> 32) as usize)?.as_ref()
    }
}

/// State of a world that `World.save` returned. It never changes, and can be pickled.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct WorldState {
    snapshot: Snapshot,
    shapes: Shapes,
    options: Options,
}

impl WorldState {
    pub(crate) fn of(world: &World, shapes: &Shapes) -> Self {
        Self { snapshot: world.save(), shapes: shapes.clone(), options: *world.options() }
    }

    /// Restores the state. Returns `false` and changes nothing if the world has other options than
    /// the saved one.
    #[must_use]
    pub(crate) fn restore(&self, world: &mut World, shapes: &mut Shapes) -> bool {
        let is_alike = *world.options() == self.options;
        if is_alike {
            world.restore(&self.snapshot);
            *shapes = self.shapes.clone();
        }
        is_alike
    }
}

/// Table of shapes: the source of each shape, once, and the index of the shape of each body.
type ShapeTable<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Table of bodies: poses, (n, 4, 4); traits, (n, 5), which are kind, layers, layers to intersect,
/// change and realignment; owners and surfaces, (n, 2); whether there is an owner and a surface,
/// (n, 2); tags, (n,); and margins, (n,).
type BodyTable<'py> =
    (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Table of pairs: handles, (p, 2), proximities, (p,), and the contacts as `contacts::columns`
/// makes them.
type PairTable<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Table of places: handles, (n,), the generations of all places, and the free places.
type Places<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Data of a state: the version, the names of the options, and the tables. The last table has the
/// tags and handles of pairs that are gone, (d, 4).
type Data<'py> = (
    u32,
    (Bound<'py, PyAny>, Bound<'py, PyAny>),
    Places<'py>,
    ShapeTable<'py>,
    BodyTable<'py>,
    PairTable<'py>,
    Bound<'py, PyAny>,
);

#[pymethods]
impl WorldState {
    /// Makes a state from the data that `data` returned.
    #[new]
    fn new(py: Python<'_>, data: Data<'_>) -> PyResult<Self> {
        let (version, (broad_phase, narrow_phase), places, shapes, bodies, pairs, departed) = data;
        if version != VERSION {
            return Err(Fault::new(
                "version",
                "state",
                format!("has version {version}, but version {VERSION} is expected: save it again"),
            )
            .raised(py));
        }
        let broken = |what: &str| Fault::new("state", "state", format!("{what} contradict each other")).raised(py);
        let options = Options {
            broad_phase: chosen(&broad_phase, "broad_phase", &BROAD_PHASES)?,
            narrow_phase: chosen(&narrow_phase, "narrow_phase", &NARROW_PHASES)?,
        };
        let ids: Vec<BodyId> = plain_column(&places.0)?.into_iter().map(BodyId::from_bits).collect();
        let (generations, free) = (plain_column(&places.1)?, plain_column(&places.2)?);
        let objects: Vec<Bound<'_, PyAny>> = shapes.0.try_iter()?.collect::<PyResult<_>>()?;
        let made: Vec<(Source, Shape)> = objects
            .iter()
            .map(|object| Ok((Source::object(object), read_shape(object, "state", false)?.shape)))
            .collect::<PyResult<_>>()?;
        let shape_of: Vec<u32> = plain_column(&shapes.1)?;
        let traits = traits_of(&bodies)?;
        let poses = poses::read_all(&bodies.0, "state")?.1;
        let margins: Vec<f64> = plain_column(&bodies.5)?;
        if [shape_of.len(), traits.len(), poses.len(), margins.len()] != [ids.len(); 4] {
            return Err(broken("the numbers of bodies"));
        }
        let mut recorded = Vec::with_capacity(ids.len());
        let mut objects_of = Vec::with_capacity(ids.len());
        // Bodies of one shape share its bounds.
        let mut plain: HashMap<(u32, Realignment), Body> = HashMap::new();
        let rows = ids.into_iter().zip(shape_of).zip(poses).zip(traits).zip(margins);
        for ((((id, shape), pose), (traits, change, way)), margin) in rows {
            let (source, own) = made.get(shape as usize).ok_or_else(|| broken("the numbers of shapes"))?;
            objects_of.push((id, source.clone()));
            let body = match plain.entry((shape, way)) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(free) => {
                    let body = Body::new(own.clone()).realigned_by(way);
                    free.insert(body.map_err(|error| Fault::new("state", "state", message(&error)).raised(py))?)
                }
            };
            let body =
                body.clone().at(pose).kind(traits.kind).layers(traits.layers).tag(traits.tag).with_margin(margin);
            let body = if let Some(owner) = traits.owner { body.owner(owner) } else { body };
            let body = if let Some(surface) = traits.surface { body.surface(surface) } else { body };
            recorded.push(RecordedBody { id, body, change });
        }
        let pairs = pairs_of(&pairs)?.ok_or_else(|| broken("the numbers of pairs"))?;
        let departed: Vec<u64> = plain_column(&departed)?;
        let departed = departed.as_chunks().0.iter().map(|&[tag_a, tag_b, a, b]| {
            let [a, b] = [a, b].map(BodyId::from_bits);
            PairKey { tag_a, tag_b, a, b }
        });
        let record = Record { bodies: recorded, generations, free, pairs, departed: departed.collect() };
        let snapshot = py.detach(|| Snapshot::from_record(&record, &options));
        let snapshot = snapshot.map_err(|flaw| Fault::new("state", "state", flaw.to_string()).raised(py))?;
        // The snapshot is valid, so no handle is larger than the number of places.
        let mut sources = Shapes::default();
        objects_of.into_iter().for_each(|(id, source)| sources.set(id, Some(source)));
        Ok(Self { snapshot, shapes: sources, options })
    }

    /// Returns all data, as arrays and the sources of shapes. A source is an `impinge.Shape`, or a
    /// mesh without its Python class and whether it is solid.
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Data<'py>> {
        let record = py.detach(|| self.snapshot.to_record());
        let bodies = &record.bodies;
        let count = bodies.len();
        let body_column = |of: fn(&RecordedBody) -> u64| array(py, bodies.iter().map(of).collect(), &[count]);
        let traits = bodies.iter().map(|RecordedBody { body, change, .. }| {
            let Traits { kind, layers, .. } = *body.traits();
            let way = place(&REALIGNMENTS.map(|(_, way)| way), body.realignment());
            [place(&KINDS.map(|(_, kind)| kind), kind), layers.on, layers.meets, place(&CHANGES, *change), way]
        });
        let keys = bodies.iter().map(|recorded| [recorded.body.traits().owner, recorded.body.traits().surface]);
        let has = keys.clone().map(|keys| keys.map(|key| key.is_some()));
        let poses = bodies.iter().map(|recorded| matrix(recorded.body.world_from_body()));
        let (options, pairs) = (&self.options, &record.pairs);
        let handles = pairs.iter().map(|pair| pair.bodies.map(BodyId::to_bits)).collect();
        let found = pairs.iter().map(|pair| place(&PROXIMITIES, pair.meeting.as_ref().map(|meeting| meeting.0)));
        let manifolds = pairs.iter().map(|pair| pair.meeting.as_ref().map_or(&[][..], |meeting| &meeting.1));
        let departed: Vec<[u64; 4]> =
            record.departed.iter().map(|key| [key.tag_a, key.tag_b, key.a.to_bits(), key.b.to_bits()]).collect();
        let gone = departed.len();
        let (places, frees) = (record.generations.len(), record.free.len());
        Ok((
            VERSION,
            (name(py, &BROAD_PHASES, options.broad_phase)?, name(py, &NARROW_PHASES, options.narrow_phase)?),
            (
                body_column(|recorded| recorded.id.to_bits())?,
                array(py, record.generations, &[places])?,
                array(py, record.free, &[frees])?,
            ),
            self.shape_table(py, bodies)?,
            (
                array(py, poses.collect::<Vec<_>>().into_flattened(), &[count, 4, 4])?,
                row_array(py, traits.collect(), &[count])?,
                row_array(py, keys.map(|keys| keys.map(|key| key.unwrap_or(0))).collect(), &[count])?,
                row_array(py, has.collect(), &[count])?,
                body_column(|recorded| recorded.body.traits().tag)?,
                array(py, bodies.iter().map(|recorded| recorded.body.margin()).collect(), &[count])?,
            ),
            (
                row_array(py, handles, &[pairs.len()])?,
                array(py, found.collect(), &[pairs.len()])?,
                contacts::columns(py, manifolds)?,
            ),
            row_array(py, departed, &[gone])?,
        ))
    }

    /// Returns itself, because a state never changes.
    fn __copy__(own: PyRef<'_, Self>) -> PyRef<'_, Self> {
        own
    }

    /// Returns itself, because a state never changes.
    fn __deepcopy__<'py>(own: PyRef<'py, Self>, memo: &Bound<'py, PyAny>) -> PyRef<'py, Self> {
        let _ = memo;
        own
    }
}

impl WorldState {
    fn shape_table<'py>(&self, py: Python<'py>, bodies: &[RecordedBody]) -> PyResult<ShapeTable<'py>> {
        let (mut objects, mut numbers) = (PyList::empty(py), Vec::with_capacity(bodies.len()));
        let mut number_of = HashMap::new();
        for RecordedBody { id, .. } in bodies {
            let Some(source) = self.shapes.get(*id) else {
                return Err(Fault::new("state", "state", format!("body {id} has no shape")).raised(py));
            };
            let number = match source {
                Source::Object(object) => *number_of.entry(object.as_ptr()).or_insert_with(|| objects.len()),
                Source::Refitted(..) => objects.len(),
            };
            if number == objects.len() {
                append(&mut objects, source)?;
            }
            numbers.push(number as u32);
        }
        let count = numbers.len();
        Ok((objects.into_any(), array(py, numbers, &[count])?))
    }
}

fn append(objects: &mut Bound<'_, PyList>, source: &Source) -> PyResult<()> {
    match source {
        Source::Object(object) => objects.append(object.bind(objects.py())),
        Source::Refitted(mesh, is_solid) => objects.append((MeshBase::of(mesh), *is_solid)),
    }
}

/// Returns the traits, the change and the realignment of each body of a table.
fn traits_of((_, traits, keys, has, tags, _): &BodyTable<'_>) -> PyResult<Vec<(Traits, Change, Realignment)>> {
    let traits: Vec<u32> = plain_column(traits)?;
    let (keys, has, tags): (Vec<u64>, Vec<bool>, Vec<u64>) =
        (plain_column(keys)?, plain_column(has)?, plain_column(tags)?);
    let keys = keys.as_chunks::<2>().0.iter().zip(has.as_chunks::<2>().0);
    let keys = keys.map(|(keys, has)| [0, 1].map(|which: usize| has[which].then_some(keys[which])));
    let rows = traits.as_chunks().0.iter().zip(keys.zip(tags));
    let of = |(&[kind, on, meets, change, way], ([owner, surface], tag)): (&[u32; 5], ([Option<u64>; 2], u64))| {
        let kind = KINDS.get(kind as usize).map_or_else(Default::default, |(_, kind)| *kind);
        let change = CHANGES.get(change as usize).copied().unwrap_or(Change::Traits);
        let way = REALIGNMENTS.get(way as usize).map_or_else(Default::default, |(_, way)| *way);
        let layers = impinge::world::Layers { on, meets };
        (Traits { kind, layers, owner, surface, tag }, change, way)
    };
    Ok(rows.map(of).collect())
}

/// Returns the pairs of a table, or `None` if its columns have different lengths.
fn pairs_of((handles, found, contacts): &PairTable<'_>) -> PyResult<Option<Vec<RecordedPair>>> {
    let handles: Vec<u64> = plain_column(handles)?;
    let found: Vec<u32> = plain_column(found)?;
    let Some(manifolds) = contacts::manifolds(contacts)? else { return Ok(None) };
    let rows = handles.as_chunks::<2>().0;
    if rows.len() != found.len() || rows.len() != manifolds.len() {
        return Ok(None);
    }
    let of = |((bodies, found), manifolds): ((&[u64; 2], u32), _)| {
        let proximity = PROXIMITIES.get(found as usize).copied()?;
        let meeting = proximity.map(|proximity| (proximity, manifolds));
        Some(RecordedPair { bodies: bodies.map(BodyId::from_bits), meeting })
    };
    Ok(rows.iter().zip(found).zip(manifolds).map(of).collect())
}

/// Returns the index of a value, or 0 if it is not among the known values.
fn place<T: PartialEq>(values: &[T], value: T) -> u32 {
    values.iter().position(|known| *known == value).unwrap_or(0) as u32
}

/// Returns the name of a value in Python.
fn name<'py, T: PartialEq>(py: Python<'py>, values: &[(&str, T)], value: T) -> PyResult<Bound<'py, PyAny>> {
    let found = values.iter().find(|(_, known)| *known == value);
    Ok(found.map_or("", |(name, _)| name).into_pyobject(py)?.into_any())
}
