//! Pictures of a scene and a path through it, made on the CPU: no window, no driver, the same pixels
//! everywhere.

mod camera;
mod canvas;
mod command;
mod cutaway;
mod decorate;
mod drawing;
mod model;
mod plot;
mod raster;
mod sweep;
mod text;
mod view;

pub(crate) use command::{SIZE, run, subject, wanted, write};
pub(crate) use drawing::{Drawing, Item};
pub(crate) use plot::{Series, plot};
pub(crate) use sweep::evenly;

use camera::Camera;
use canvas::{Colour, Layer, Veil, mix, scaled, srgb};
use model::{Lights, Model};
use mp::geom::TriMesh;
use nalgebra::{Isometry3, Point3};
use std::sync::Arc;

/// Samples per pixel in each direction.
const SUPERSAMPLING: usize = 2;
/// What the margins leave free on the left, top, right and bottom, as fractions of the picture.
const MARGINS: [f64; 4] = [0.04, 0.1, 0.04, 0.09];
/// How opaque an obstacle is where it has been opened.
const GHOST: f32 = 0.09;
const OBSTACLES: [u32; 6] = [0xb4bdc9, 0xc9bda9, 0xacbfb3, 0xc2b2bd, 0xa9bcc4, 0xcdc7ae];
const START: u32 = 0x2e9e5b;
const MIDDLE: u32 = 0xe6b422;
const GOAL: u32 = 0xcf3a3a;
const INK: u32 = 0x2b3440;

/// What to draw.
#[derive(Clone, Debug)]
pub(crate) struct Subject<'a> {
    /// Written large.
    pub(crate) title: String,
    /// Written small below it.
    pub(crate) subtitle: String,
    /// Seen from above, as a map.
    pub(crate) planar: bool,
    pub(crate) obstacles: Vec<(&'a TriMesh, Isometry3<f64>)>,
    /// The robot at the start, at the goal, and on its way between; nothing there when there is no path.
    pub(crate) start: Shown,
    pub(crate) goal: Shown,
    pub(crate) copies: Vec<Shown>,
    /// The line that some point of the robot traces.
    pub(crate) trace: Vec<Point3<f64>>,
    /// Bounds of the robot's position, where there are any.
    pub(crate) bounds: Option<(Point3<f64>, Point3<f64>)>,
}

/// The robot somewhere.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    model: Arc<Model>,
    pose: Isometry3<f64>,
}

impl Shown {
    /// The robot `mesh` at `pose`; nothing to be seen when there is no mesh.
    pub(crate) fn new(mesh: Option<&TriMesh>, pose: Isometry3<f64>) -> Self {
        let point = || TriMesh::from_soup(&[[Point3::origin(); 3]]).ok();
        let model = match mesh {
            Some(mesh) => Model::new(mesh),
            None => point().map_or_else(Model::default, |mesh| Model::new(&mesh)),
        };
        Self { model: Arc::new(model), pose }
    }

    /// The same robot elsewhere.
    fn at(&self, pose: Isometry3<f64>) -> Self {
        Self { model: Arc::clone(&self.model), pose }
    }
}

/// A model somewhere.
#[derive(Clone, Debug)]
pub(crate) struct Placed<'a> {
    model: &'a Model,
    pose: Isometry3<f64>,
}

/// The colour of the path at fraction `t` of it.
fn gradient(t: f32) -> Colour {
    let (start, middle, goal) = (srgb(START), srgb(MIDDLE), srgb(GOAL));
    if t < 0.5 { mix(start, middle, 2.0 * t) } else { mix(middle, goal, 2.0 * t - 1.0) }
}

/// Draws `subject` in `width` × `height` pixels.
pub(crate) fn draw(subject: &Subject<'_>, (width, height): (usize, usize)) -> image::RgbImage {
    let size = (width * SUPERSAMPLING, height * SUPERSAMPLING);
    let models: Vec<Model> = subject.obstacles.iter().map(|(mesh, _)| Model::new(mesh)).collect();
    let obstacles: Vec<Placed<'_>> = models
        .iter()
        .zip(&subject.obstacles)
        .map(|(model, (_, pose))| Placed { model, pose: *pose })
        .collect();
    let shown: Vec<&Shown> = [&subject.start, &subject.goal].into_iter().chain(&subject.copies).collect();

    let frame = frame(subject, &obstacles, &shown);
    let (camera, half_angle) = if subject.planar {
        (Camera::top(&frame, size, MARGINS), 0.4)
    } else {
        let view = view::choose(&frame, &obstacles, &shown);
        // The less of the path is in sight the wider it is opened, but a level floor stays.
        let half_angle = (view.elevation - 0.1) * (1.0 - 0.7 * view.visible);
        (Camera::three_quarter(&frame, view.azimuth, view.elevation, size, MARGINS), half_angle)
    };
    let lights = Lights::of(&camera);
    let samples = size.0 * size.1;

    // Where the path is nearest to the eye, and what must give way to it.
    let mut nearest = vec![f32::INFINITY; samples];
    for robot in &shown {
        robot.model.faces(&camera, &robot.pose, &lights, |i, key, _| nearest[i] = nearest[i].min(key));
    }
    let slack = 0.02 * subject.start.model.radius as f32;
    let cut = match subject.planar {
        true => vec![f32::NEG_INFINITY; samples],
        false => cutaway::thresholds(&camera, &nearest, 1.0 / half_angle.tan() as f32, slack),
    };
    drop(nearest);

    let mut layer = Layer::new(samples);
    decorate::background(&mut layer, size);
    let mut ghosts = Veil::new(samples);
    for (n, o) in obstacles.iter().enumerate() {
        let colour = srgb(OBSTACLES[n % OBSTACLES.len()]);
        // From above nothing but the tops is seen, all equally light.
        let colour = if subject.planar { scaled(colour, 0.6) } else { colour };
        o.model.faces(&camera, &o.pose, &lights, |i, key, light| {
            if key < cut[i] {
                ghosts.add(i, scaled(colour, light), GHOST, 1.0);
            } else {
                layer.put(i, key, scaled(colour, light));
            }
        });
    }
    for (robot, colour) in [(&subject.start, srgb(START)), (&subject.goal, srgb(GOAL))] {
        robot
            .model
            .faces(&camera, &robot.pose, &lights, |i, key, light| layer.put(i, key, scaled(colour, light)));
    }
    decorate::shade_corners(&mut layer, &camera, extent(&frame));
    decorate::outlines(&mut layer, &mut ghosts, &camera, &obstacles, &cut);
    for robot in [&subject.start, &subject.goal] {
        decorate::outline(&mut layer, &camera, &robot.model, &robot.pose, 0.55);
    }
    if !subject.planar {
        decorate::floor(&mut layer, &camera, &frame);
    } else if let Some((lo, hi)) = &subject.bounds {
        decorate::border(&mut layer, &camera, lo, hi);
    }
    sweep::draw(&mut layer, &camera, &lights, &subject.copies);
    sweep::trace(&mut layer, &camera, &subject.trace);
    ghosts.over(&mut layer.colour, 0.5);
    decorate::labels(&mut layer, size, subject);
    canvas::resolve(&layer.colour, size, SUPERSAMPLING)
}

/// The points that the picture must hold.
fn frame(subject: &Subject<'_>, obstacles: &[Placed<'_>], shown: &[&Shown]) -> Vec<Point3<f64>> {
    let mut points: Vec<Point3<f64>> =
        shown.iter().flat_map(|robot| robot.model.points().iter().map(|p| robot.pose * p)).collect();
    let of_robot = points.len();
    let placed = |o: &Placed<'_>| o.model.points().iter().map(|p| o.pose * p).collect::<Vec<_>>();
    points.extend(obstacles.iter().flat_map(placed));
    // Vast obstacles (a floor that never ends) are shown only near the path.
    let (lo, hi) = corners(&points[..of_robot]);
    let reach = 3.0 * (hi - lo).norm();
    let (lo, hi) = subject.bounds.map_or((lo, hi), |(a, b)| (lo.inf(&a), hi.sup(&b)));
    if let (true, Some((lo, hi))) = (subject.planar, subject.bounds) {
        points.extend([lo, hi]);
    }
    for p in &mut points {
        for k in 0..3 {
            p[k] = p[k].clamp(lo[k] - reach, hi[k] + reach);
        }
    }
    points
}

/// The box around `points`.
fn corners(points: &[Point3<f64>]) -> (Point3<f64>, Point3<f64>) {
    let first = points.first().copied().unwrap_or_else(Point3::origin);
    points.iter().fold((first, first), |(lo, hi), p| (lo.inf(p), hi.sup(p)))
}

/// The diagonal of the box around `points`, metres.
fn extent(points: &[Point3<f64>]) -> f64 {
    let (lo, hi) = corners(points);
    (hi - lo).norm()
}
