//! The fields that push snakes: made by name, and as an image of a world of the plane.

use crate::motion::Counting;
use crate::{Error, RelaxField, Robot};
use mp_cspace::erased::AnyGradient;
use mp_cspace::{Configuration, Path, PushingField, Space, Validity};
use mp_io::GridMap;
use mp_snake::plane::{BLUR, MOST_CELLS, STRIDE, occupancy, paper_energy, risk_energy};
use mp_snake::risk::{MotionNoise, RangeNoise, RiskMaps};
use mp_snake::{Field, Grid, Repulsion, With, blurred};
use nalgebra::Vector2;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// The energy of a field that pushes snakes, where the robot of a world of the plane may be.
/// `Scene::field` of mp-plan makes it.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldImage {
    /// The lower left corner of the first cell (m).
    pub origin: [f64; 2],
    /// The size of a cell (m).
    pub cell: f64,
    /// How many cells a row has.
    pub width: usize,
    /// The energy at the middle of each cell, row after row from the lowest. That of
    /// [`RelaxField::Clearance`] is ½ where the robot touches an obstacle, and 0 where it is farther away than the range.
    pub energy: Vec<f64>,
    /// The clearance (m) below which obstacles push.
    pub range: f64,
}

/// A field behind a pointer, so that its type needs no name.
#[allow(missing_debug_implementations, reason = "a pointer has nothing to print")]
pub struct AnyField<'a>(Box<dyn Field<Configuration> + 'a>);

impl Field<Configuration> for AnyField<'_> {
    fn energy(&mut self, q: &Configuration, gradient: &mut [f64]) -> f64 {
        self.0.energy(q, gradient)
    }
    fn clearance(&self) -> Option<f64> {
        self.0.clearance()
    }
}

/// An image as the energy of states that begin with x and y (m).
struct OnPlane(Grid);

impl Field<Configuration> for OnPlane {
    fn energy(&mut self, q: &Configuration, gradient: &mut [f64]) -> f64 {
        on_plane(&self.0, q, gradient)
    }
}

fn on_plane(image: &Grid, q: &Configuration, gradient: &mut [f64]) -> f64 {
    let (energy, slope) = image.at(&Vector2::new(q[0], q[1]));
    gradient.fill(0.0);
    gradient.iter_mut().zip(slope.iter()).for_each(|(g, s)| *g = *s);
    energy
}

/// Checks that a field suits the robot.
///
/// # Errors
/// When it does not, or its file cannot be read.
pub fn check(kind: &dyn Robot, field: &RelaxField) -> Result<(), Error> {
    let names: Vec<_> = kind.columns().into_iter().map(|column| column.name).collect();
    let place = matches!(kind.limits()[..], [Some(_), Some(_), ..]);
    if *field == RelaxField::Clearance {
        return Ok(());
    }
    let suits = names == ["x", "y"] || names == ["x", "y", "yaw"];
    if !(suits && place) {
        let whom = kind.space_name();
        return Err(Error::new(format!(
            "the field `{field}` is for discs and polygons in worlds, not for {whom}"
        ))
        .help("take the field `clearance`, which pushes all robots that know their clearance"));
    }
    if let RelaxField::Image(file) = field {
        read_image(file, bounds(kind)?)?;
    }
    Ok(())
}

/// The field `name` with a range (m). That of risk is the landscape of `path`.
///
/// # Errors
/// When the range is not above zero, or the file of the field cannot be read.
pub fn make<'k>(
    kind: &'k dyn Robot,
    name: &RelaxField,
    range: f64,
    path: Option<&Path<Configuration>>,
    gradient: AnyGradient<'k, Configuration>,
) -> Result<AnyField<'k>, Error> {
    let repulsion = Repulsion::new(gradient, range)?;
    let Some(image) = image(kind, name, range, path)? else { return Ok(AnyField(Box::new(repulsion))) };
    let image = OnPlane(image);
    Ok(match name {
        RelaxField::Paper => AnyField(Box::new(image)),
        _ => AnyField(Box::new(With::new(repulsion, image, 1.0)?)),
    })
}

/// The rotations at which a robot that turns must touch something for its place to be occupied.
const ROTATIONS: u32 = 16;

/// What pushes the edges of trees, beside the repulsion of obstacles or alone. It is made once for each run.
#[derive(Clone, Debug)]
pub struct TreeField {
    image: Arc<Grid>,
    alone: bool,
}

impl TreeField {
    /// The field that `settings` name, for a robot whose obstacles repel within `range` (m). `None` where that is the clearance.
    ///
    /// # Errors
    /// When the field does not suit the robot, or its file cannot be read.
    pub fn new(kind: &dyn Robot, name: &RelaxField, range: f64) -> Result<Option<Self>, Error> {
        check(kind, name)?;
        let image = image(kind, name, range, None)?;
        Ok(image.map(|image| Self { image: Arc::new(image), alone: *name == RelaxField::Paper }))
    }

    /// The same for a problem.
    pub fn pushing<'c>(&self) -> PushingField<'c, Configuration> {
        let image = Arc::clone(&self.image);
        let energy = move |q: &Configuration, gradient: &mut [f64]| on_plane(&image, q, gradient);
        PushingField { energy: Box::new(energy), alone: self.alone }
    }
}

/// The image of a field that has one. Without a path the risk is that of passing everywhere.
fn image(
    kind: &dyn Robot,
    name: &RelaxField,
    range: f64,
    path: Option<&Path<Configuration>>,
) -> Result<Option<Grid>, Error> {
    if *name == RelaxField::Clearance {
        return Ok(None);
    }
    let bounds = bounds(kind)?;
    let turns = kind.columns().len() > 2;
    let occupied = || {
        let mut checker = kind.any_checker();
        let mut free = |row: &[f64]| checker.is_valid(&kind.state(row));
        let yaw =
            |i: u32| f64::from(i) * (std::f64::consts::TAU / f64::from(ROTATIONS)) - std::f64::consts::PI;
        occupancy(bounds, range, |p| match turns {
            true => !(0..ROTATIONS).any(|i| free(&[p.x, p.y, yaw(i)])),
            false => !free(p.as_slice()),
        })
    };
    Ok(Some(match name {
        RelaxField::Clearance => return Ok(None),
        RelaxField::Paper => paper_energy(&occupied()?, range)?,
        RelaxField::Risk(factor) if path.is_none() => risk_energy(&occupied()?, range, *factor)?,
        RelaxField::Image(file) => blurred(&read_image(file, bounds)?, BLUR * range)?,
        RelaxField::Risk(factor) => {
            let Some(path) = path else { return Ok(None) };
            // Steps of one length, however many states the path has.
            let length = path.length(&kind.any_space());
            let steps = (length / (STRIDE * range)).ceil().clamp(1.0, 1e5);
            let at = |i: u32| path.at(&kind.any_space(), length * f64::from(i) / steps);
            let places =
                (0..=steps as u32).filter_map(at).map(|q| Vector2::from_row_slice(&kind.row(&q)[..2]));
            let path = Path::straight(places.collect());
            let (motion, sensor) =
                (MotionNoise::default().times(*factor), RangeNoise::default().times(*factor));
            let risk = RiskMaps::of_path(&path, &occupied()?, motion, sensor)?.risk;
            let most = risk.values().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            risk.map(|v| v / most)
        }
    }))
}

/// The bounds of x and y (m).
fn bounds(kind: &dyn Robot) -> Result<[[f64; 2]; 2], Error> {
    match kind.limits()[..] {
        [Some(x), Some(y), ..] => Ok([x, y]),
        _ => Err(not_drawn(kind).help("its robot has no bounds of x and y")),
    }
}

/// The energy of an image over `bounds` (m): 0 where it is white, 1 where it is black.
fn read_image(file: &std::path::Path, bounds: [[f64; 2]; 2]) -> Result<Grid, Error> {
    let name = file.display().to_string();
    let map = GridMap::parse(&name, &mp_io::Files::read(&mp_io::Disk, file, mp_io::MAX_TEXT_BYTES)?)?;
    let [width, height] = map.size;
    let [across, up] = bounds.map(|[low, high]| high - low);
    let cell = across / width as f64;
    let wrong = |why: String, help: String| Err(Error::new(format!("the image {name} {why}")).help(help));
    if !(2..=MOST_CELLS).contains(&width) || !(2..=MOST_CELLS).contains(&height) {
        let why = format!("has {width} × {height} pixels");
        return wrong(why, format!("scale it: a field has 2 to {MOST_CELLS} each way"));
    }
    if (cell * height as f64 - up).abs() > 0.5 * cell.max(0.01 * up) {
        let brief = crate::brief;
        let why = format!("has {width} × {height} pixels, but covers {} × {} m", brief(across), brief(up));
        let height = (up / cell).round();
        return wrong(
            why,
            format!("scale it to {width} × {height} pixels: it covers the bounds of the robot"),
        );
    }
    // The first row of an image is its highest.
    let rows = map.brightness.chunks_exact(width).rev().flatten();
    let energy = rows.map(|brightness| 1.0 - f64::from(*brightness) / 255.0).collect();
    Ok(Grid::new(bounds.map(|[low, _]| low), cell, width, energy)?)
}

fn not_drawn(kind: &dyn Robot) -> Error {
    Error::new(format!("the field of {} is not drawn", kind.name()))
}

/// The image of the field `name` with a range (m), about `cells` pixels along its longer side. Each pixel is a position of the robot; its
/// other numbers are those of `row`, which has one for each column of the robot.
///
/// # Errors
/// When the field does not suit the robot, or its file cannot be read.
pub fn field(
    kind: &dyn Robot,
    name: &RelaxField,
    row: &[f64],
    path: Option<&Path<Configuration>>,
    range: f64,
    cells: usize,
) -> Result<FieldImage, Error> {
    let [x, y] = bounds(kind)?;
    check(kind, name)?;
    if path.is_none() && matches!(name, RelaxField::Risk(_)) {
        return Err(
            Error::new("the landscape of risk is that of a path, and there is none").help("name a path")
        );
    }
    let unused = AtomicU64::new(0);
    let knowledge = kind.any_obstacles(&Counting::new(&unused, mp_cspace::Interrupt::never()));
    let gradient =
        knowledge.gradient.ok_or_else(|| not_drawn(kind).help("this robot knows no clearance gradient"))?;
    let mut field = make(kind, name, range, path, gradient)?;
    let sides = [x, y].map(|[low, high]| high - low);
    let cell = sides[0].max(sides[1]) / cells.clamp(2, 4096) as f64;
    let [width, height] = sides.map(|side| (side / cell).round().max(1.0) as usize);
    let (mut place, mut slope) = (row.to_vec(), vec![0.0; kind.any_space().dim()]);
    let mut energy = Vec::with_capacity(width * height);
    for i in 0..width * height {
        let at = [x[0] + ((i % width) as f64 + 0.5) * cell, y[0] + ((i / width) as f64 + 0.5) * cell];
        place.iter_mut().zip(at).for_each(|(value, at)| *value = at);
        energy.push(field.energy(&kind.state(&place), &mut slope));
    }
    Ok(FieldImage { origin: [x[0], y[0]], cell, width, energy, range })
}
