//! `alpha-1.0` … `alpha-1.5`: two tubes bent like the letter α, interlocked.
//!
//! The two arms of an α pass each other at a distance; the tubes come apart when one slips through the
//! crossing of the other. At scale s the crossing of the obstacle is 1.05 s times as wide as a tube is thick;
//! that of the robot is always as narrow as at scale 1.

use super::scene::{Files, HOME, Scene, Six, configurations};
use super::shape::{on_grid, shifted, tube};
use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI, SQRT_2};

/// Radius of the tubes.
const THICK: f64 = 0.5;
/// Radius of the loop.
const LOOP: f64 = 1.8;
/// Length of an arm from the crossing to its end.
const ARM: f64 = 5.0;
/// The x of the middle of an α, seen from the crossing: the origin of the robot.
const MIDDLE: f64 = -0.4;
/// Segments of the loop, and corners of the tube.
const STEPS: u32 = 36;
const SIDES: u32 = 12;

/// Adds the six scenes and the path.
pub(super) fn add(files: &mut Files) {
    let robot = shifted(&alpha(1.0), [-MIDDLE, 0.0, 0.0]);
    let path = separation();
    let (start, goal) = (path[0], path[path.len() - 1]);
    for (name, scale) in [
        ("alpha-1.0", 1.0),
        ("alpha-1.1", 1.1),
        ("alpha-1.2", 1.2),
        ("alpha-1.3", 1.3),
        ("alpha-1.4", 1.4),
        ("alpha-1.5", 1.5),
    ] {
        Scene::new(name, [[-10.0, -8.0, -8.0], [10.0, 8.0, 8.0]], "alpha/robot.off", &robot)
            .query(start, goal)
            .obstacle(&format!("alpha/obstacle-{scale:.1}.off"), &alpha(scale), &[HOME])
            .finish(files);
    }
    files.insert("paths/alpha.txt".to_owned(), configurations(&path));
}

/// How far the centre line of either arm is from the plane z = 0 at the crossing.
fn level(scale: f64) -> f64 {
    THICK * (2.05 + 0.7 * (scale - 1.0))
}

/// An α along the plane z = 0 with its crossing at the origin and its loop towards -x: along the lower
/// arm, around the loop, along the upper arm.
fn alpha(scale: f64) -> TriMesh {
    let (end, z) = (ARM * FRAC_1_SQRT_2, level(scale));
    let mut line = vec![Point3::new(end, -end, -z)];
    line.extend((0..=STEPS).map(|i| on_loop(FRAC_PI_4 + 1.5 * PI * f64::from(i) / f64::from(STEPS), scale)));
    line.push(Point3::new(end, end, z));
    tube(&line, |_| THICK, SIDES, Vector3::z())
}

/// The point of the loop at an angle about its centre, from π/4 to 7π/4. The loop rises from the level of
/// the lower arm to that of the upper, slowly at both ends.
fn on_loop(angle: f64, scale: f64) -> Point3<f64> {
    let t = (angle - PI) / (0.75 * PI);
    let (s, c) = mp_math::sin_cos(angle);
    Point3::new(LOOP * (c - SQRT_2), LOOP * s, 0.5 * level(scale) * t * (3.0 - t * t))
}

/// A path that separates the two, the same at every scale: like a ring along a wire, the loop of the
/// robot follows the loop of the obstacle, then the upper arm to its end and beyond.
fn separation() -> Vec<Six> {
    let mut path = Vec::new();
    let turn = 24;
    for i in 0..=turn {
        let u = f64::from(i) / f64::from(turn);
        let angle = PI + 0.75 * PI * u;
        let ease = u * u * (3.0 - 2.0 * u);
        path.push(ring(on_loop(angle, 1.0), LOOP + (level(1.0) - LOOP) * ease, angle, 0.5 * PI * ease));
    }
    // Along the arm, the strand half-way between the two arms.
    for i in 1..=8 {
        let along = (-LOOP + (LOOP + ARM + 4.0) * f64::from(i) / 8.0) * FRAC_1_SQRT_2;
        path.push(ring(Point3::new(along, along, level(1.0)), level(1.0), 1.75 * PI, 0.5 * PI));
    }
    path.push([7.0, 1.5, 3.5, -0.8, -0.9, -1.2]);
    path
}

/// The robot around the wire of the obstacle at `wire`, where the wire runs in the direction
/// `angle` + π/2. The far end of the robot's loop is at `distance` from there, on the side of the loop's
/// centre for `tilt` 0 and below for π/2; the robot's crossing is on the other side.
fn ring(wire: Point3<f64>, distance: f64, angle: f64, tilt: f64) -> Six {
    let ((s, c), (up, horizontal)) = (mp_math::sin_cos(angle), mp_math::sin_cos(tilt));
    let out = Vector3::new(c * horizontal, s * horizontal, up);
    let origin = wire + out * (LOOP * (SQRT_2 + 1.0) + MIDDLE - distance);
    [origin.x, origin.y, origin.z, angle - 2.0 * PI, -tilt, -0.5 * PI].map(on_grid)
}
