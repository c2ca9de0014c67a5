//! Shapes in problem files: the members of a table that say what a body is like, the same for all kinds of bodies.

use crate::toml_problem::TomlText;
use mp_formats::error::Error;
use mp_formats::files::Files;
use mp_formats::mesh::{Axes, MAX_COORDINATE, read_mesh_with, solid_mesh, stand_in, vertex_beyond};
use mp_formats::points::{balls, read_points};
use mp_formats::text::clipped;
use mp_geom::{HeightField, PRIMITIVES, Points, PrimitiveError, Shape, TriMesh};
use nalgebra::Point3;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error as _, IntoDeserializer, MapAccess, Visitor};
use std::collections::HashMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::{Spanned, Value};

/// The members beside the primitives that are shapes.
const OTHERS: [&str; 4] = ["mesh", "hull", "height_field", "points"];
/// What else is said of a shape.
const SOLID: &str = "solid";
/// How it is scaled along its own axes.
const SCALE: &str = "scale";

/// The names of all shapes.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    OTHERS
        .into_iter()
        .take(1)
        .chain(PRIMITIVES.iter().map(|kind| kind.name))
        .chain(OTHERS.into_iter().skip(1))
}

/// A table with members of its own, and those of a shape.
#[derive(Debug)]
pub(crate) struct Shaped<T> {
    /// The members of its own.
    pub(crate) own: T,
    /// The members that are shapes, or say something of them.
    members: Vec<(&'static str, Spanned<Value>)>,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Shaped<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Table(PhantomData))
    }
}

struct Table<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Table<T> {
    type Value = Shaped<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let mut members = Vec::new();
        let others = Others { map, members: &mut members };
        let own = T::deserialize(serde::de::value::MapAccessDeserializer::new(others))?;
        Ok(Shaped { own, members })
    }
}

/// The members of a table that are no shapes; shapes are put aside.
struct Others<'m, A> {
    map: A,
    members: &'m mut Vec<(&'static str, Spanned<Value>)>,
}

/// The name of a member.
enum Name<V> {
    OfShape(&'static str),
    Other(V),
}

/// Reads a [`Name`]; takes the seed for one of no shape.
struct NameSeed<'s, K>(&'s mut Option<K>);

impl<'de, K: DeserializeSeed<'de>> DeserializeSeed<'de> for NameSeed<'_, K> {
    type Value = Name<K::Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        let name = String::deserialize(deserializer)?;
        if let Some(known) = names().chain([SOLID, SCALE]).find(|known| *known == name) {
            return Ok(Name::OfShape(known));
        }
        let seed = self.0.take().ok_or_else(|| D::Error::custom("a name is read twice"))?;
        seed.deserialize(name.into_deserializer()).map(Name::Other)
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Others<'_, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        let mut seed = Some(seed);
        loop {
            match self.map.next_key_seed(NameSeed(&mut seed))? {
                Some(Name::OfShape(name)) => self.members.push((name, self.map.next_value()?)),
                Some(Name::Other(name)) => return Ok(Some(name)),
                None => return Ok(None),
            }
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.map.next_value_seed(seed)
    }
}

/// A shape as a file gives it: other files that it names are not yet read.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeEntry {
    /// A mesh in a file of this name, and whether it is a solid.
    MeshFile(String, bool),
    /// Points in a file of this name, the radius (m) of the ball around each, and the side (m) of the cells on which they are thinned.
    PointFile(String, [f64; 2]),
    /// A shape without a file: all of it is in the entry.
    Whole(Shape),
    /// Another one, scaled along its own axes.
    Scaled(Box<Self>, [f64; 3]),
}

/// A set of points, in the file or in one that it names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PointTable {
    radius: f64,
    cell: Option<f64>,
    file: Option<String>,
    at: Option<Vec<[f64; 3]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HeightTable {
    cell: [f64; 2],
    heights: Vec<Vec<f64>>,
    bottom: Option<f64>,
}

impl<T> Shaped<T> {
    /// The shape of a body, which messages call `name`, and where the shape is in the text: `span`, the table of the body, if
    /// the shape has no place of its own.
    ///
    /// # Errors
    /// [`Error`] when it has none or several, or one that makes no sense.
    pub(crate) fn shape(
        &self,
        source: &TomlText<'_>,
        name: &str,
        span: &Range<usize>,
    ) -> Result<(ShapeEntry, Range<usize>), Error> {
        let said =
            |what: &str| self.members.iter().find(|(member, _)| *member == what).map(|(_, value)| value);
        let solid = said(SOLID);
        let shapes: Vec<_> =
            self.members.iter().filter(|(member, _)| ![SOLID, SCALE].contains(member)).collect();
        let &[(member, value)] = shapes.as_slice() else {
            // The last one in the text.
            let last = shapes.iter().map(|(_, value)| value.span()).max_by_key(|span| span.start);
            let span = last.unwrap_or_else(|| span.clone());
            let message = format!("{} has {} shapes", clipped(name), shapes.len());
            let all: Vec<_> = names().map(|name| format!("`{name}`")).collect();
            return Err(source.error(&span, message).expected(format!("one of {}", all.join(", "))));
        };
        let is_solid = match solid {
            Some(solid) if *member != "mesh" => {
                let message = format!("{} has `solid`, and no mesh", clipped(name));
                let expected = "`solid` beside `mesh`: all other shapes are solids";
                return Err(source.error(&solid.span(), message).expected(expected));
            }
            Some(solid) => source.value(solid)?,
            None => false,
        };
        let shape = match *member {
            "mesh" => ShapeEntry::MeshFile(source.value(value)?, is_solid),
            "hull" => {
                let points: Vec<[f64; 3]> = source.value(value)?;
                source.check("the hull", points.as_flattened(), &value.span())?;
                ShapeEntry::Whole(Shape::Hull(points.into_iter().map(Point3::from).collect()))
            }
            "height_field" => {
                let HeightTable { cell, heights, bottom } = source.value(value)?;
                source.positive("the length of a cell", &cell, &value.span())?;
                source.check("the height field", &heights.concat(), &value.span())?;
                let bottom = bottom.unwrap_or_else(|| HeightField::default_bottom(cell, &heights));
                source.check("the bottom", &[bottom], &value.span())?;
                ShapeEntry::Whole(Shape::HeightField(HeightField { cell, heights, bottom }))
            }
            "points" => points(source, value)?,
            primitive => self::primitive(source, primitive, value)?,
        };
        let Some(scale) = said(SCALE) else { return Ok((shape, value.span())) };
        if matches!(shape, ShapeEntry::PointFile(..) | ShapeEntry::Whole(Shape::Points(_))) {
            let message = format!("{} has `scale`, and is a set of points", clipped(name));
            return Err(source
                .error(&scale.span(), message)
                .expected("no `scale` beside `points`: scale their coordinates"));
        }
        let factors: [f64; 3] = source.value(scale)?;
        source.positive(&format!("the scale of {}", clipped(name)), &factors, &scale.span())?;
        Ok((ShapeEntry::Scaled(Box::new(shape), factors), value.span()))
    }
}

fn points(source: &TomlText<'_>, value: &Spanned<Value>) -> Result<ShapeEntry, Error> {
    let PointTable { radius, cell, file, at } = source.value(value)?;
    source.positive("the radius", &[radius], &value.span())?;
    let cell = cell.unwrap_or(0.5 * radius);
    source.positive("the side of a cell", &[cell], &value.span())?;
    match (file, at) {
        (Some(file), None) => Ok(ShapeEntry::PointFile(file, [radius, cell])),
        (None, Some(at)) => {
            source.check("the points", at.as_flattened(), &value.span())?;
            let at = at.into_iter().map(Point3::from).collect();
            Ok(ShapeEntry::Whole(Shape::Points(Points { at, radius, cell })))
        }
        _ => Err(source.error(&value.span(), "points are in two places, or in none").expected(
            "`{ radius = R, file = \"cloud.xyz\" }`, or `{ radius = R, at = [[x, y, z], …] }`, lengths in metres",
        )),
    }
}

/// One of the [`PRIMITIVES`]: a number, or some in brackets.
fn primitive(source: &TomlText<'_>, name: &'static str, value: &Spanned<Value>) -> Result<ShapeEntry, Error> {
    let kind = PRIMITIVES.iter().find(|kind| kind.name == name);
    let (span, lengths) = (value.span(), kind.map_or(&[][..], |kind| kind.lengths));
    let given: Vec<f64> = match value.get_ref() {
        Value::Array(_) if lengths.len() > 1 => source.value(value)?,
        _ if lengths.len() == 1 => vec![source.value(value)?],
        _ => Vec::new(),
    };
    if given.len() != lengths.len() {
        let message = format!("a {name} has {} lengths", lengths.len());
        return Err(source
            .error(&span, message)
            .expected(format!("{name} = [{}], metres", lengths.join(", "))));
    }
    for (length, value) in lengths.iter().zip(&given) {
        source.positive(&format!("the {length} of the {name}"), &[*value], &span)?;
    }
    let shape = Shape::primitive(name, &given);
    Ok(ShapeEntry::Whole(shape.ok_or_else(|| source.error(&span, format!("`{name}` is no shape")))?))
}

/// Makes the meshes of shapes: equal primitives, and bodies of the same mesh file, share one.
pub(crate) struct Meshes<'a> {
    files: &'a dyn Files,
    /// The file of the problem.
    path: &'a Path,
    /// The meshes read so far, with their files, and whether they are solids.
    read: Vec<((PathBuf, bool), TriMesh)>,
    /// The primitives made so far, by the bits of their lengths.
    made: HashMap<(&'static str, Vec<u64>), TriMesh>,
}

impl<'a> Meshes<'a> {
    /// For the problem in the file `path`, to which names are relative.
    pub(crate) fn new(files: &'a dyn Files, path: &'a Path) -> Self {
        Self { files, path, read: Vec::new(), made: HashMap::new() }
    }

    /// The file and the mesh of the body `name`, whose shape is at `span`.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read, or the shape has no mesh.
    pub(crate) fn of(
        &mut self,
        source: &TomlText<'_>,
        name: &str,
        (shape, span): &(ShapeEntry, Range<usize>),
    ) -> Result<(PathBuf, TriMesh), Error> {
        let fault = |message: &str, help: &str| source.error(span, message).help(help);
        let place = |file: &str| self.path.parent().unwrap_or(Path::new("")).join(file);
        let unusable = |what: &str, e: Error| {
            let message = format!("the {what} of {name} is not usable: {e}");
            fault(&message, e.remedy_of_named_file()).with_kind(e.kind())
        };
        let impossible = |e: PrimitiveError| fault(&e.to_string(), "give sizes in metres, not too small");
        let useless = |e: String| {
            let help = "write finite coordinates, and cells about as large as the radius";
            fault(&format!("the points of {name} are not usable: {e}"), help)
        };
        let (from, mesh) = match shape {
            ShapeEntry::MeshFile(file, solid) => {
                let place = place(file);
                let mesh = self.of_file(&place, *solid).map_err(|e| unusable("mesh", e))?;
                (place, mesh)
            }
            ShapeEntry::PointFile(file, [radius, cell]) => {
                let place = place(file);
                let at = read_points(self.files, &place).map_err(|e| unusable("file of points", e))?;
                let mesh =
                    self.balls(&place, &Points { at, radius: *radius, cell: *cell })?.map_err(useless)?;
                (place, mesh)
            }
            ShapeEntry::Whole(Shape::Points(points)) => {
                (self.path.to_owned(), self.balls(self.path, points)?.map_err(useless)?)
            }
            ShapeEntry::Whole(shape) => (self.path.to_owned(), self.whole(shape)?.map_err(impossible)?),
            ShapeEntry::Scaled(shape, scale) => {
                let (place, mesh) = self.of(source, name, &((**shape).clone(), span.clone()))?;
                let scaled = mesh.scaled(*scale);
                let scaled = scaled
                    .map_err(|e| fault(&format!("{name} cannot be scaled: {e}"), "take factors nearer to 1"));
                (place, scaled?)
            }
        };
        if vertex_beyond(&mesh).is_some() {
            let message = format!("{name} has a vertex beyond {MAX_COORDINATE:e} m");
            return Err(fault(&message, "coordinates are metres: scale the mesh"));
        }
        Ok((from, mesh))
    }

    /// Balls around the points of a file.
    fn balls(&self, place: &Path, points: &Points) -> Result<Result<TriMesh, String>, Error> {
        if self.files.only_reads() {
            return stand_in(&place.display().to_string()).map(Ok);
        }
        Ok(balls(points, |note| self.files.note(place, note)))
    }

    /// The mesh of a file, read once.
    fn of_file(&mut self, place: &Path, solid: bool) -> Result<TriMesh, Error> {
        let solid = solid && !self.files.only_reads();
        let key = (place.to_owned(), solid);
        let seen =
            |key: &(PathBuf, bool)| self.read.iter().find(|(known, _)| known == key).map(|(_, mesh)| mesh);
        if let Some(known) = seen(&key) {
            return Ok(known.clone());
        }
        let mesh = match seen(&(place.to_owned(), false)) {
            Some(known) => known.clone(),
            None => read_mesh_with(self.files, place, Axes::OfFile)?,
        };
        if !solid {
            self.read.push((key, mesh.clone()));
            return Ok(mesh);
        }
        self.read.push(((place.to_owned(), false), mesh.clone()));
        let mesh = solid_mesh(&place.display().to_string(), mesh)?;
        self.read.push((key, mesh.clone()));
        Ok(mesh)
    }

    /// The mesh of a shape that needs no other file.
    fn whole(&mut self, shape: &Shape) -> Result<Result<TriMesh, PrimitiveError>, Error> {
        if self.files.interrupt().ask() {
            return Err(Error::interrupted(self.path.display()));
        }
        if self.files.only_reads() {
            return stand_in(&self.path.display().to_string()).map(Ok);
        }
        let Shape::Primitive(kind, lengths) = shape else { return Ok(shape.mesh()) };
        let key = (kind.name, lengths.iter().map(|length| length.to_bits()).collect());
        if let Some(known) = self.made.get(&key) {
            return Ok(Ok(known.clone()));
        }
        let made = shape.mesh();
        if let Ok(mesh) = &made {
            self.made.insert(key, mesh.clone());
        }
        Ok(made)
    }
}
