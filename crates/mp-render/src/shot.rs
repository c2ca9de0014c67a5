//! Scenes drawn at many moments: a camera that stands, turns or follows, and the robot on its way.

use crate::body::Body;
use crate::camera::{Camera, seen_from};
use crate::canvas::{self, Colour, Layer, Veil, mix, scaled, srgb};
use crate::cutaway::Cutaway;
use crate::error::{RenderError, check_range};
use crate::lights::Lights;
use crate::palette::{GOAL, INK, OBSTACLES, START, gradient};
use crate::picture::Picture;
use crate::scene::{SUPERSAMPLING, Scene, corners, extent};
use crate::view::{Mode, View};
use crate::{ambient_occlusion, decorate, path, viewpoint};
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

/// The margins on the left, top, right and bottom, as fractions of the picture.
const MARGINS: [f64; 4] = [0.04, 0.1, 0.04, 0.09];
/// The opacity of an obstacle where it hides the path; around there it fades.
const GHOST: f32 = 0.09;
/// The opacity of a surface that is seen through.
const GLASS: f32 = 0.2;

/// What moves in a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Animation {
    /// The robot: each moment shows one configuration, with start and goal translucent. Otherwise all
    /// configurations are shown at once.
    pub step: bool,
    /// The camera turns around the vertical axis.
    pub turntable: bool,
    /// The camera moves with the robot.
    pub follow: bool,
}

/// A moment of a film.
#[derive(Clone, Debug, Default)]
pub struct Moment {
    /// The bodies of the robot where they are now; shown if the robot [steps](Animation::step).
    pub robot: Vec<Body>,
    /// How far along the path the robot is, 0 to 1: its colour.
    pub progress: f64,
    /// The angle (radians) by which the camera is turned, counter-clockwise seen from above.
    pub turn: f64,
    /// The point (metres) in the middle of the picture, if the camera [follows](Animation::follow).
    pub centre: Point3<f64>,
}

/// A scene made ready to be drawn at many moments.
#[derive(Debug)]
pub struct Shot<'s> {
    scene: &'s Scene,
    /// Width and height in samples.
    size: (usize, usize),
    animation: Animation,
    /// The points that the picture must show.
    frame: Vec<Point3<f64>>,
    camera: Camera,
    /// The point that the camera turns around and moves with.
    centre: Point3<f64>,
    /// The half angle of the cones that open the view onto the path, radians.
    half_angle: f64,
    /// Whether the scene is drawn as a map.
    map: bool,
    /// Everything behind the robot, if it is the same at all moments.
    still: OnceLock<Backdrop>,
}

/// What is drawn before the robot.
#[derive(Clone, Debug)]
struct Backdrop {
    layer: Layer,
    /// Translucent obstacles.
    ghosts: Arc<Veil>,
}

impl<'s> Shot<'s> {
    /// A shot of a scene that has been checked; `size` is in samples.
    pub(crate) fn new(scene: &'s Scene, size: (usize, usize), animation: Animation) -> Self {
        let shown: Vec<&Body> = scene.robots().collect();
        let frame = scene.frame();
        let map = scene.planar && scene.view == View::Best;
        let (low, high) = corners(&frame);
        let mut centre = low + (high - low) * 0.5;
        let around = if animation.follow {
            near_robot(scene, &frame, &centre)
        } else if animation.turntable {
            rotated(&frame, &centre)
        } else {
            frame.clone()
        };
        let opening = |elevation: f64, camera: &Camera| {
            let visible = viewpoint::visible(camera, &scene.obstacles, &shown);
            (elevation.abs().min(1.0) - 0.1).max(0.2) * (1.0 - 0.7 * visible)
        };
        let (camera, half_angle) = match scene.view {
            View::Best if map => (Camera::top(&around, size, MARGINS), 0.4),
            View::Best => {
                let viewpoint = viewpoint::choose(&frame, &scene.obstacles, &shown);
                // The less of the path is visible, the wider the opening, but a level floor stays opaque.
                let half_angle = (viewpoint.elevation - 0.1) * (1.0 - 0.7 * viewpoint.visible);
                let (azimuth, elevation) = (viewpoint.azimuth, viewpoint.elevation);
                (Camera::three_quarter(&around, azimuth, elevation, size, MARGINS), half_angle)
            }
            View::From { azimuth, elevation, parallel } => {
                let rotation = seen_from(azimuth, elevation);
                let make = if parallel { Camera::parallel } else { Camera::perspective };
                let coarse = make(rotation, &frame, viewpoint::COARSE, MARGINS);
                (make(rotation, &around, size, MARGINS), opening(elevation, &coarse))
            }
            View::At { eye, target, field_of_view, parallel } => {
                centre = target;
                let place = |size| Camera::placed([eye, target], field_of_view, parallel, &frame, size);
                let elevation = mp_math::atan2(eye.z - target.z, (eye - target).xy().norm());
                (place(size), opening(elevation, &place(viewpoint::COARSE)))
            }
        };
        Self { scene, size, animation, frame, camera, centre, half_angle, map, still: OnceLock::new() }
    }

    /// The picture of a moment. Moments may be drawn in any order and in several threads: each has the same
    /// pixels.
    ///
    /// # Errors
    /// When a coordinate of the moment is not finite or beyond 10⁶⁰ m.
    pub fn picture(&self, moment: &Moment) -> Result<Picture, RenderError> {
        let Animation { step, turntable, follow } = self.animation;
        for body in &moment.robot {
            body.check(|| "the robot".into())?;
        }
        let centre = if follow { moment.centre } else { self.centre };
        let turn = if turntable { moment.turn } else { 0.0 };
        check_range(centre.iter().copied().chain([turn, moment.progress]), || "the moment".into())?;
        let moved = follow || turntable;
        let camera = if moved { self.camera.moved(&self.centre, &centre, turn) } else { self.camera.clone() };

        let ends: Vec<(&Body, Colour)> = [(&self.scene.start, START), (&self.scene.goal, GOAL)]
            .into_iter()
            .filter_map(|(body, colour)| Some((body.as_ref()?, srgb(colour))))
            .collect();
        let colour = gradient(moment.progress.clamp(0.0, 1.0) as f32);
        let (solid, copies) = match step {
            true => (moment.robot.iter().map(|body| (body, colour)).collect(), ends),
            false => (ends, path::coloured(&self.scene.copies)),
        };
        let layer = match self.scene.mode {
            Mode::Wire => self.wire(&camera, &solid, &copies),
            _ => self.filled(&camera, &solid, &copies),
        };
        Ok(canvas::resolve(&layer.colour, self.size, SUPERSAMPLING))
    }

    /// Faces and edges: `solid` bodies are opaque, `copies` translucent.
    fn filled(&self, camera: &Camera, solid: &[(&Body, Colour)], copies: &[(&Body, Colour)]) -> Layer {
        let Animation { step, turntable, follow } = self.animation;
        let lights = Lights::of(camera);
        let Backdrop { mut layer, ghosts } = match (step, self.scene.mode) {
            // Obstacles that are seen through depend on what is behind them, the robot.
            (true, Mode::Transparent) | (false, _) => self.backdrop(camera, solid),
            (true, _) => {
                let mut backdrop = match turntable || follow {
                    true => self.backdrop(camera, &[]),
                    false => self.still.get_or_init(|| self.backdrop(camera, &[])).clone(),
                };
                put(&mut backdrop.layer, camera, &lights, solid);
                outline(&mut backdrop.layer, camera, solid);
                backdrop
            }
        };
        // What one wants to see through glass is drawn over it.
        let transparent = self.scene.mode == Mode::Transparent;
        if transparent {
            ghosts.over(&mut layer.colour, 0.8);
        }
        path::draw_copies(&mut layer, camera, &lights, copies);
        path::draw_trace(&mut layer, camera, &self.scene.trace);
        if !transparent {
            ghosts.over(&mut layer.colour, 0.5);
        }
        decorate::labels(&mut layer, self.size, self.scene);
        layer
    }

    /// The obstacles, the floor, and `solid` bodies.
    fn backdrop(&self, camera: &Camera, solid: &[(&Body, Colour)]) -> Backdrop {
        let (scene, samples) = (self.scene, self.size.0 * self.size.1);
        let lights = Lights::of(camera);
        let transparent = scene.mode == Mode::Transparent;
        let cut = self.cut(camera, &lights);
        let mut layer = Layer::new(samples);
        decorate::background(&mut layer, self.size);
        if transparent {
            put(&mut layer, camera, &lights, solid);
        }
        let mut ghosts = Veil::new(samples);
        for (n, o) in scene.obstacles.iter().enumerate() {
            let colour = srgb(OBSTACLES[n % OBSTACLES.len()]);
            // From above only the tops are visible, all equally bright.
            let colour = if self.map { scaled(colour, 0.6) } else { colour };
            o.model.faces(camera, &o.pose_wb, &lights, |i, key, light| {
                if transparent {
                    if key < layer.key[i] {
                        ghosts.add(i, scaled(colour, light), GLASS, camera.prominence(key));
                    }
                    return;
                }
                match cut.at(i, camera.depth(key)) {
                    0.0 => layer.put(i, key, scaled(colour, light)),
                    open => ghosts.add(i, scaled(colour, light), 1.0 - open * (1.0 - GHOST), 1.0),
                }
            });
        }
        put(&mut layer, camera, &lights, solid);
        ambient_occlusion::darken_creases(&mut layer, camera, extent(&self.frame));
        decorate::outlines(&mut layer, &mut ghosts, camera, &scene.obstacles, &cut);
        outline(&mut layer, camera, solid);
        self.ground(&mut layer, camera);
        Backdrop { layer, ghosts: Arc::new(ghosts) }
    }

    /// Where obstacles are translucent.
    fn cut(&self, camera: &Camera, lights: &Lights) -> Cutaway {
        let transparent = self.scene.mode == Mode::Transparent;
        if transparent || self.map {
            return Cutaway::everywhere(transparent);
        }
        // The depth of the path at each sample.
        let mut nearest = vec![f32::INFINITY; self.size.0 * self.size.1];
        for robot in self.scene.robots() {
            robot.model.faces(camera, &robot.pose_wb, lights, |i, key, _| nearest[i] = nearest[i].min(key));
        }
        let slack = 0.02 * self.scene.robots().next().map_or(0.0, Body::radius) as f32;
        Cutaway::before(camera, &nearest, 1.0 / mp_math::tan(self.half_angle) as f32, slack)
    }

    /// Edges only: `solid` bodies strong, `copies` faint.
    fn wire(&self, camera: &Camera, solid: &[(&Body, Colour)], copies: &[(&Body, Colour)]) -> Layer {
        let scene = self.scene;
        let lights = Lights::of(camera);
        let mut layer = Layer::new(self.size.0 * self.size.1);
        decorate::background(&mut layer, self.size);
        // Surfaces are not painted, but hide what is behind them.
        for body in scene.obstacles.iter().chain(solid.iter().map(|(body, _)| *body)) {
            body.model
                .faces(camera, &body.pose_wb, &lights, |i, key, _| layer.key[i] = layer.key[i].min(key));
        }
        self.ground(&mut layer, camera);
        for (n, o) in scene.obstacles.iter().enumerate() {
            let colour = mix(srgb(INK), srgb(OBSTACLES[n % OBSTACLES.len()]), 0.25);
            decorate::wires(&mut layer, camera, o, colour, [0.9, 0.1]);
        }
        let faint = if self.animation.step { [0.7, 0.25] } else { [0.45, 0.15] };
        for (body, colour) in copies {
            decorate::wires(&mut layer, camera, body, scaled(*colour, 0.8), faint);
        }
        for (body, colour) in solid {
            decorate::wires(&mut layer, camera, body, scaled(*colour, 0.8), [1.0, 0.45]);
        }
        path::draw_trace(&mut layer, camera, &scene.trace);
        decorate::labels(&mut layer, self.size, scene);
        layer
    }

    /// The grid under the scene, or the border of a map.
    fn ground(&self, layer: &mut Layer, camera: &Camera) {
        if !self.map {
            decorate::floor(layer, camera, &self.frame);
        } else if let Some(bounds) = &self.scene.bounds {
            decorate::border(layer, camera, bounds);
        }
    }
}

/// Draws the faces of opaque bodies.
fn put(layer: &mut Layer, camera: &Camera, lights: &Lights, solid: &[(&Body, Colour)]) {
    for (body, colour) in solid {
        body.model.faces(camera, &body.pose_wb, lights, |i, key, light| {
            layer.put(i, key, scaled(*colour, light));
        });
    }
}

/// Draws dark lines along the edges of opaque bodies.
fn outline(layer: &mut Layer, camera: &Camera, solid: &[(&Body, Colour)]) {
    for (body, _) in solid {
        decorate::outline(layer, camera, body, 0.55);
    }
}

/// The corners of a cube around `centre`, as large as the surroundings of a robot in the middle should be.
fn near_robot(scene: &Scene, frame: &[Point3<f64>], centre: &Point3<f64>) -> Vec<Point3<f64>> {
    let robot: Vec<_> =
        scene.start.iter().flat_map(|b| b.model.points().iter().map(|p| b.pose_wb * p)).collect();
    let half = (1.2 * extent(&robot)).max(extent(frame) / 8.0).max(1e-9);
    let corner = |i: u32| {
        let side = |k: u32| if (i >> k) & 1 == 1 { half } else { -half };
        centre + Vector3::new(side(0), side(1), side(2))
    };
    (0..8).map(corner).collect()
}

/// The box around `points`, turned around the vertical axis through `centre` by many angles.
fn rotated(points: &[Point3<f64>], centre: &Point3<f64>) -> Vec<Point3<f64>> {
    const ANGLES: u32 = 24;
    let (low, high) = corners(points);
    let radius = (high - low).xy().norm() / 2.0;
    let at = |k: u32, z: f64| {
        let (s, c) = mp_math::sin_cos(TAU * f64::from(k) / f64::from(ANGLES));
        Point3::new(centre.x + radius * c, centre.y + radius * s, z)
    };
    (0..ANGLES).flat_map(|k| [at(k, low.z), at(k, high.z)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives::cuboid;
    use nalgebra::Isometry3;

    /// A box that goes around behind a wall.
    fn scene(mode: Mode) -> Scene {
        let at = |x: f64| Isometry3::translation(x, 2.0, 0.5);
        let robot = Body::new(&cuboid(0.5, 0.5, 0.5).unwrap(), at(-2.0));
        Scene {
            obstacles: vec![Body::new(
                &cuboid(6.0, 0.2, 3.0).unwrap(),
                Isometry3::translation(0.0, 0.0, 1.0),
            )],
            goal: Some(robot.at(at(2.0))),
            trace: vec![Point3::new(-2.0, 2.0, 0.5), Point3::new(2.0, 2.0, 0.5)],
            start: Some(robot),
            mode,
            view: "front".parse().unwrap(),
            ..Scene::default()
        }
    }

    /// How many pixels are clearly coloured as the start is.
    fn green(picture: &Picture) -> usize {
        let strong = |p: &&[u8]| p[1] > p[0].saturating_add(25) && p[1] > p[2].saturating_add(10);
        picture.rgb().chunks(3).filter(strong).count()
    }

    /// Pixels clearly darker than the background.
    fn filled(mode: Mode) -> usize {
        let picture = scene(mode).draw((160, 120)).unwrap();
        picture.rgb().chunks(3).filter(|p| p[0] < 215).count()
    }

    /// A wall hides what is behind it when it is solid and not cut open, and not when it is of glass or wire.
    #[test]
    fn modes_show_what_they_should() {
        let behind = |mode| {
            let scene = Scene { trace: Vec::new(), ..scene(mode) };
            let bodies = Scene { start: None, goal: None, ..scene.clone() };
            let shot = bodies.shot((160, 120), Animation { step: true, ..Animation::default() }).unwrap();
            green(
                &shot
                    .picture(&Moment { robot: scene.start.into_iter().collect(), ..Moment::default() })
                    .unwrap(),
            )
        };
        let [solid, wire, glass] = [Mode::Solid, Mode::Wire, Mode::Transparent].map(behind);
        assert!(solid == 0 && wire > 10 && glass > 30, "solid {solid}, wire {wire}, glass {glass}");
        let [solid, wire, glass] = [Mode::Solid, Mode::Wire, Mode::Transparent].map(filled);
        assert!(4 * wire < solid && wire > 50, "wire {wire}, solid {solid}");
        assert!(glass > 1000 && glass < solid, "glass {glass}, solid {solid}");
    }

    /// In wire pictures, edges are faint behind a wall, and the grid is not seen through a floor.
    #[test]
    fn wires_are_faint_behind_surfaces() {
        let bare = Scene { trace: Vec::new(), goal: None, ..scene(Mode::Wire) };
        let shown = |scene: &Scene| {
            let picture = scene.draw((320, 240)).unwrap();
            // The green of the start is the only colour above the legend.
            let green = picture.rgb().chunks(3).take(320 * 200).map(|p| i32::from(p[1]) - i32::from(p[0]));
            green.filter(|&more| more > 6).sum::<i32>()
        };
        let beside = |y: f64| Scene {
            obstacles: vec![bare.obstacles[0].at(Isometry3::translation(0.0, y, 1.0))],
            ..bare.clone()
        };
        let (before, behind) = (shown(&beside(4.0)), shown(&beside(0.0)));
        assert!(behind > 500 && 3 * behind < before, "before {before}, behind {behind}");

        let floor = Body::new(&cuboid(6.0, 6.0, 0.1).unwrap(), Isometry3::identity());
        let view = "top".parse().unwrap();
        let floor = Scene { obstacles: vec![floor], view, mode: Mode::Wire, ..Scene::default() };
        let picture = floor.draw((320, 240)).unwrap();
        // A row inside of the floor: white but for the diagonal of its two triangles.
        let dark = (80..240).filter(|&x| picture.pixel(x, 100).unwrap()[0] < 235).count();
        assert!(dark <= 4, "{dark}");
    }

    /// A wall that hides the robot fades out around it: above the robot no pixel is far from the next.
    #[test]
    fn openings_have_soft_rims() {
        let picture = scene(Mode::Solid).draw((640, 480)).unwrap();
        let column = |x: usize| -> Vec<[u8; 3]> { (0..480).map(|y| picture.pixel(x, y).unwrap()).collect() };
        // From the middle of the start upwards.
        let robot =
            (0..640).find(|&x| column(x).iter().any(|p| p[1] > p[0].saturating_add(60))).unwrap() + 20;
        let column = column(robot);
        let top = column.iter().position(|p| p[1] > p[0].saturating_add(25)).unwrap() - 3;
        let wall = column.iter().position(|p| p[0] < 215 && p[0].abs_diff(p[2]) > 8).unwrap() + 4;
        let jump = |w: &[[u8; 3]]| (0..3).map(|k| w[0][k].abs_diff(w[1][k])).max().unwrap();
        let steepest = column[wall..top].windows(2).map(jump).max().unwrap();
        let whole = (0..3).map(|k| column[wall][k].abs_diff(column[top][k])).max().unwrap();
        assert!(whole > 60 && 4 * u32::from(steepest) < u32::from(whole), "{whole}, {steepest} at once");
    }

    /// In each mode and with each movement of the camera, a moment has the same pixels whenever it is drawn.
    #[test]
    fn moments_do_not_depend_on_each_other() {
        for mode in Mode::ALL.map(|(mode, _)| mode) {
            for (turntable, follow) in [(false, false), (true, false), (false, true), (true, true)] {
                let scene = Scene { view: View::Best, ..scene(mode) };
                let animation = Animation { step: true, turntable, follow };
                let moment = |x: f64, turn: f64| {
                    let pose = Isometry3::translation(x, 2.0, 0.5);
                    let robot = vec![scene.start.as_ref().unwrap().at(pose)];
                    Moment { robot, progress: 0.5, turn, centre: Point3::from(pose.translation.vector) }
                };
                let (a, b) = (moment(-1.0, 0.0), moment(1.0, 1.0));
                let shot = scene.shot((64, 48), animation).unwrap();
                let [first, other, again] = [&a, &b, &a].map(|m| shot.picture(m).unwrap());
                assert!(first == again && first != other, "{mode:?} {turntable} {follow}");
                let fresh = scene.shot((64, 48), animation).unwrap();
                assert_eq!(fresh.picture(&b).unwrap(), other, "{mode:?} {turntable} {follow}");
            }
        }
    }

    /// A camera that follows keeps the robot in the middle.
    #[test]
    fn the_robot_that_is_followed_is_in_the_middle() {
        let mut scene = scene(Mode::Solid);
        scene.obstacles.clear();
        (scene.goal, scene.trace) = (None, Vec::new());
        for view in ["best", "top", "iso ortho", "eye=5,-9,4 target=0,0,0"] {
            scene.view = view.parse().unwrap();
            let shot =
                scene.shot((120, 90), Animation { step: true, turntable: true, follow: true }).unwrap();
            for (x, turn) in [(0.0, 0.0), (40.0, 2.0)] {
                let pose = Isometry3::translation(x, 3.0, 0.5);
                let robot = vec![scene.start.as_ref().unwrap().at(pose)];
                let centre = Point3::from(pose.translation.vector);
                let picture = shot.picture(&Moment { robot, progress: 0.0, turn, centre }).unwrap();
                let [r, g, b] = picture.pixel(60, 45).unwrap();
                assert!(g > r.saturating_add(30) && g > b, "{view} at {x}: {r} {g} {b}");
            }
        }
    }

    /// A turntable never loses a part of the scene, and the standard views show all of it.
    #[test]
    fn everything_stays_on_the_picture() {
        for view in ["best", "front", "left", "top", "bottom ortho", "iso"] {
            let scene = Scene { view: view.parse().unwrap(), ..scene(Mode::Solid) };
            let shot = scene.shot((128, 96), Animation { turntable: true, ..Animation::default() }).unwrap();
            for turn in [0.0, 0.7, 1.6, 3.0, 5.0] {
                let camera = shot.camera.moved(&shot.centre, &shot.centre, turn);
                for p in &shot.frame {
                    let p = camera.project(&(camera.pose_cw * p));
                    assert!(
                        (0.0..=256.0).contains(&p.x) && (0.0..=192.0).contains(&p.y),
                        "{view} {turn}: {p:?}"
                    );
                }
            }
        }
    }
}
