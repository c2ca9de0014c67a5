//! Scenes in space, and their drawing.

use crate::body::Body;
use crate::error::{RenderError, check_range, check_size};
use crate::picture::Picture;
use crate::shot::{Animation, Moment, Shot};
use crate::view::{Mode, View};
use mp_geom::Aabb;
use nalgebra::Point3;

/// Samples per pixel in each direction.
pub(crate) const SUPERSAMPLING: usize = 2;
/// A scene in space: obstacles, and a robot that moves among them. z is up.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The title, in large letters.
    pub title: String,
    /// The subtitle, in small letters below the title.
    pub subtitle: String,
    /// Whether the best view is from above, as a map; otherwise it is from where the path is seen best,
    /// through obstacles.
    pub planar: bool,
    /// Everything that stands still; the cutaway opens it in front of the path.
    pub obstacles: Vec<Body>,
    /// The robot at the start, if there is one.
    pub start: Option<Body>,
    /// The robot at the goal, if there is one.
    pub goal: Option<Body>,
    /// Copies of the robot along the path, as [`Body::along`] or [`evenly`](crate::evenly) space them; none
    /// without a path.
    pub copies: Vec<Body>,
    /// The line along which a point of the robot moves, metres.
    pub trace: Vec<Point3<f64>>,
    /// Bounds of the robot's position, if there are any.
    pub bounds: Option<Aabb>,
    /// How bodies are drawn.
    pub mode: Mode,
    /// From where the scene is seen.
    pub view: View,
}

impl Scene {
    /// The picture, `width` × `height` pixels, with all configurations of the path at once.
    ///
    /// # Errors
    /// When a side is not from 1 to [`MAX_SIDE`](crate::MAX_SIDE) pixels, the view makes no picture, or a
    /// coordinate is not finite or beyond 10⁶⁰ m.
    pub fn draw(&self, (width, height): (usize, usize)) -> Result<Picture, RenderError> {
        self.shot((width, height), Animation::default())?.picture(&Moment::default())
    }

    /// The scene made ready to be drawn at many moments, as the frames of a film, `width` × `height` pixels.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn shot(
        &self,
        (width, height): (usize, usize),
        animation: Animation,
    ) -> Result<Shot<'_>, RenderError> {
        check_size((width, height))?;
        self.view.check()?;
        self.check()?;
        Ok(Shot::new(self, (width * SUPERSAMPLING, height * SUPERSAMPLING), animation))
    }

    /// Refuses coordinates out of range.
    fn check(&self) -> Result<(), RenderError> {
        for (n, body) in self.obstacles.iter().enumerate() {
            body.check(|| format!("obstacle {}", n + 1))?;
        }
        for (body, place) in [(&self.start, "start"), (&self.goal, "goal")] {
            body.as_ref().map_or(Ok(()), |body| body.check(|| format!("the robot at its {place}")))?;
        }
        for (n, body) in self.copies.iter().enumerate() {
            body.check(|| format!("copy {} of the robot", n + 1))?;
        }
        check_range(self.trace.iter().flat_map(|p| [p.x, p.y, p.z]), || "the trace of the path".into())?;
        let bounds =
            self.bounds.iter().flat_map(|b| b.min.iter().chain(b.max.iter()).copied().collect::<Vec<_>>());
        check_range(bounds, || "the bounds of the robot".into())
    }

    /// The robot at its start, its goal, and along the path.
    pub(crate) fn robots(&self) -> impl Iterator<Item = &Body> {
        self.start.iter().chain(&self.goal).chain(&self.copies)
    }

    /// The points that the picture must show.
    pub(crate) fn frame(&self) -> Vec<Point3<f64>> {
        let placed = |body: &Body| {
            let (points, pose_wb) = (body.model.points(), body.pose_wb);
            // Those of large meshes are nearer to each other than pixels; what sticks out is not left out.
            let step = points.len().div_ceil(MOST_OF_BODY).max(1);
            let ends = (0..3).flat_map(|k| {
                let by = |p: &&Point3<f64>, q: &&Point3<f64>| p[k].total_cmp(&q[k]);
                [points.iter().min_by(by), points.iter().max_by(by)]
            });
            let ends = ends.flatten().take(if step > 1 { 6 } else { 0 });
            points.iter().step_by(step).chain(ends).map(|p| pose_wb * p).collect::<Vec<_>>()
        };
        let mut points: Vec<Point3<f64>> = self.robots().flat_map(placed).collect();
        let of_robot = points.len();
        points.extend(self.obstacles.iter().flat_map(placed));
        let bounds = self.bounds.map(|b| (b.min, b.max));
        if let (true, Some((lo, hi))) = (self.planar, bounds) {
            points.extend([lo, hi]);
        }
        if of_robot == 0 {
            return points;
        }
        // Very large obstacles, such as floors, are shown only near the path.
        let (lo, hi) = corners(&points[..of_robot]);
        let reach = 3.0 * (hi - lo).norm();
        let (lo, hi) = bounds.map_or((lo, hi), |(a, b)| (lo.inf(&a), hi.sup(&b)));
        for p in &mut points {
            for k in 0..3 {
                p[k] = p[k].clamp(lo[k] - reach, hi[k] + reach);
            }
        }
        points
    }
}

/// The most points of a body that are looked at for the frame of a picture.
const MOST_OF_BODY: usize = 1 << 19;

/// The box around `points`.
pub(crate) fn corners(points: &[Point3<f64>]) -> (Point3<f64>, Point3<f64>) {
    let first = points.first().copied().unwrap_or_else(Point3::origin);
    points.iter().fold((first, first), |(lo, hi), p| (lo.inf(p), hi.sup(p)))
}

/// The diagonal of the box around `points`, metres.
pub(crate) fn extent(points: &[Point3<f64>]) -> f64 {
    let (lo, hi) = corners(points);
    (hi - lo).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives::cuboid;
    use nalgebra::{Isometry3, Vector3};
    use proptest::prelude::*;

    /// A box on its way over a slab.
    fn scene() -> Scene {
        let robot = Body::new(&cuboid(0.4, 0.2, 0.2).unwrap(), Isometry3::translation(-2.0, 0.0, 1.0));
        let path = [*robot.pose(), Isometry3::translation(2.0, 0.0, 1.0)];
        Scene {
            title: "A box".into(),
            obstacles: vec![Body::new(&cuboid(0.5, 3.0, 0.5).unwrap(), Isometry3::identity())],
            goal: Some(robot.at(path[1])),
            copies: robot.along(&path),
            trace: path.iter().map(|pose| Point3::from(pose.translation.vector)).collect(),
            start: Some(robot),
            ..Scene::default()
        }
    }

    /// How many pixels have more of one of red and green than of the other, and of blue.
    fn tinted(picture: &Picture, more: usize, less: usize) -> usize {
        let strong = |p: &&[u8]| p[more] > p[less].saturating_add(60) && p[more] > p[2].saturating_add(30);
        picture.rgb().chunks(3).filter(strong).count()
    }

    #[test]
    fn the_start_is_green_and_the_goal_red() {
        for planar in [false, true] {
            let whole = Scene { planar, ..scene() };
            let picture = whole.draw((200, 150)).unwrap();
            assert_eq!(picture.rgb().len(), 3 * 200 * 150);
            let bare =
                Scene { start: None, goal: None, copies: Vec::new(), trace: Vec::new(), ..whole.clone() };
            let empty = bare.draw((200, 150)).unwrap();
            for (more, less) in [(0, 1), (1, 0)] {
                assert!(tinted(&picture, more, less) > 40, "{planar} {more}");
                assert_eq!(tinted(&empty, more, less), 0, "{planar} {more}");
            }
            assert_eq!(whole.draw((200, 150)).unwrap(), picture, "the same pixels again");
        }
    }

    #[test]
    fn little_or_nothing_can_be_drawn() {
        let point = Body::point(Isometry3::identity());
        for planar in [false, true] {
            let nothing = Scene { planar, ..Scene::default() };
            let one = Scene { start: Some(point.clone()), goal: Some(point.clone()), ..nothing.clone() };
            let boxed = Scene {
                bounds: Some(Aabb { min: [0.0; 3].into(), max: [1.0; 3].into() }),
                ..nothing.clone()
            };
            for scene in [nothing, one, boxed, Scene { planar, ..scene() }] {
                for size in [(1, 1), (1, 50), (50, 1), (64, 64)] {
                    let picture = scene.draw(size).unwrap();
                    assert_eq!((picture.width(), picture.height()), size);
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
        let far = Point3::new(0.0, 1e61, 0.0);
        type Change<'a> = &'a dyn Fn(&mut Scene);
        let changes: [(&str, Change<'_>); 6] = [
            ("obstacle 1:", &|s| s.obstacles[0] = s.obstacles[0].at(nan)),
            ("the robot at its start:", &|s| s.start = s.start.as_ref().map(|b| b.at(nan))),
            ("the robot at its goal:", &|s| s.goal = s.goal.as_ref().map(|b| b.at(nan))),
            ("copy 2 of the robot:", &|s| s.copies[1] = s.copies[1].at(nan)),
            ("the trace", &|s| s.trace.push(far)),
            ("the bounds", &|s| s.bounds = Some(Aabb { min: Point3::origin(), max: far })),
        ];
        for (words, change) in changes {
            let mut scene = scene();
            change(&mut scene);
            let error = scene.draw((64, 64)).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("expected finite"), "{error}");
        }
        for size in [(0, 64), (64, 0), (8193, 64)] {
            let error = scene().draw(size).unwrap_err().to_string();
            assert!(error.contains("expected 1 to 8192"), "{error}");
        }
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            -3.0..3.0,
            -1e-300..1e-300,
            -1e20..1e20,
            prop::sample::select(vec![0.0, 1e60, -1e60, 1e-60, 5e-324, 1e19, 3.4e38, -3.5e38]),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn finite_scenes_can_be_drawn(
            c in prop::collection::vec(coordinate(), 12),
            q in prop::array::uniform3(-4.0..4.0),
            planar: bool,
            bounded: bool,
            size in prop::array::uniform3(prop_oneof![1e-12..1e-3, 0.1..3.0, 1e6..1e40]),
        ) {
            let mesh = cuboid(size[0], size[1], size[2]).unwrap();
            let at = |i: usize| Isometry3::new(Vector3::new(c[i], c[i + 1], c[i + 2]) * 0.1, q.into());
            let robot = Body::new(&mesh, at(0));
            let corner = |i: usize| Point3::new(c[i], c[i + 1], c[i + 2]);
            let scene = Scene {
                planar,
                obstacles: vec![robot.at(at(3))],
                goal: Some(robot.at(at(6))),
                copies: robot.along(&[at(0), at(6)]),
                trace: vec![corner(0), corner(6)],
                start: Some(robot),
                bounds: bounded.then(|| Aabb { min: corner(6), max: corner(9) }),
                ..Scene::default()
            };
            prop_assert!(scene.draw((24, 16)).is_ok());
        }
    }
}
