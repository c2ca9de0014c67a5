//! How far a motion of the joints moves a link.
//!
//! The speed of a point of a link is at most the sum, over the joints above it, of the joint's speed times the distance
//! of the point from the joint's axis. This distance is bounded in two ways:
//!
//! - for all configurations, by the lengths of the chain between: [`Chain::new`];
//! - near one configuration, by the distance there plus how far the joints between have moved the point since:
//!   [`Chain::near`].
//!
//! The second is smaller where the arm is folded. The smaller of the two is used. Where eight intervals are looked at together, a third bound
//! adds the velocities of all joints as vectors: `near` in `wide.rs`.
//!
//! A base that floats moves all links, as one more joint above all others would:
//! [`BaseTravel`](super::kinematics::BaseTravel).

use super::kinematics::Kinematics;
use mp_geom::{Sphere, TriMesh};
use nalgebra::{Isometry3, Point3, Vector3};

/// Bounds are enlarged by this factor against rounding.
pub(super) const ROUND_UP: f64 = 1.0 + 1e-12;

/// The joints above a link, nearest to the link first.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) steps: Vec<Step>,
    /// An upper bound (m) on the distance of a point of the link from the origin of the base in any configuration.
    pub(super) from_base: f64,
}

/// A joint of a chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// The frame behind the joint.
    pub(super) frame: usize,
    pub(super) coordinate: usize,
    /// How far (rad or m) the joint moves for each unit of the coordinate.
    pub(super) rate: f64,
    /// An upper bound on the distance of a point of the link from the axis in any configuration; 1 for a prismatic joint.
    pub(super) reach: f64,
    pub(super) slides: bool,
}

impl Step {
    /// The coordinate, and how far (m) a unit of it moves a point of the link at most.
    pub(super) fn unit_reach(&self) -> (usize, f64) {
        (self.coordinate, self.rate * self.reach)
    }
}

impl Chain {
    /// The joints above `mesh`, which is given in the frame `frame`.
    ///
    /// The distance of its points from the axis of a joint is at most the distance of the next joint's origin from that
    /// axis plus the distance of the points from that origin, and so on along the chain. At the last joint it is computed
    /// from the vertices.
    pub(super) fn new(kinematics: &Kinematics, mesh: &TriMesh, frame: usize) -> Self {
        let vertices = || mesh.vertices().iter().map(|p| p.coords);
        // The largest distances of the points from the origin of the frame and from the axis of the joint.
        let mut from_origin = vertices().map(|v| v.norm()).fold(0.0, f64::max);
        let mut steps = Vec::new();
        let mut at = frame;
        let from_axis = |axis: &Vector3<f64>| vertices().map(|v| v.cross(axis).norm()).fold(0.0, f64::max);
        let mut lower: Option<(Vector3<f64>, f64)> = None;
        while at > 0 {
            let joint = &kinematics.frames[at - 1];
            let reach = match lower {
                None => from_axis(&joint.axis),
                Some((origin, beyond)) => origin.cross(&joint.axis).norm() + beyond,
            };
            steps.push(Step {
                frame: at,
                coordinate: joint.coordinate,
                rate: joint.scale.abs(),
                reach: if joint.slides { 1.0 } else { reach * ROUND_UP },
                slides: joint.slides,
            });
            // Continue in the frame above.
            let beyond = from_origin + joint.slide;
            lower = Some((joint.origin.translation.vector, beyond));
            from_origin = joint.origin.translation.vector.norm() + beyond;
            at = joint.parent;
        }
        Self { steps, from_base: from_origin * ROUND_UP }
    }

    /// Appends bounds (m) on how far the first k joints of the chain move a point of the link over a whole motion, for
    /// k from 0 (a bound of zero) to the length of the chain. `travels` gives how far each coordinate goes.
    pub(super) fn far(&self, travels: impl Fn(usize) -> f64, out: &mut Vec<f64>) {
        let mut sum = 0.0;
        out.push(sum);
        for step in &self.steps {
            sum += travels(step.coordinate) * step.rate * step.reach * ROUND_UP;
            out.push(sum);
        }
    }

    /// As [`far`](Self::far) over an interval of the motion that moves the coordinates by `travels` to either side of a
    /// configuration at which the link is within `ball` and the joints have these axes, all in the world.
    pub(super) fn near(
        &self,
        travels: impl Fn(usize) -> f64,
        ball: &Sphere,
        axes: &[(Point3<f64>, Vector3<f64>)],
        out: &mut Vec<f64>,
    ) {
        let mut sum = 0.0;
        out.push(sum);
        for step in &self.steps {
            let travel = travels(step.coordinate) * step.rate;
            if travel > 0.0 {
                let reach = if step.slides {
                    1.0
                } else {
                    let (origin, axis) = &axes[step.frame - 1];
                    let from_axis = (ball.center - origin).cross(axis).norm() + ball.radius;
                    step.reach.min(from_axis + sum)
                };
                sum += travel * reach * ROUND_UP;
            }
            out.push(sum);
        }
    }

    /// The last bound of [`far`](Self::far): of the whole chain.
    pub(super) fn whole(&self, travels: impl Fn(usize) -> f64) -> f64 {
        self.steps.iter().map(|step| travels(step.coordinate) * step.rate * step.reach * ROUND_UP).sum()
    }

    /// As [`whole`](Self::whole), for the first `count` joints only.
    pub(super) fn part(&self, count: usize, travels: impl Fn(usize) -> f64) -> f64 {
        let steps = &self.steps[..count];
        steps.iter().map(|step| travels(step.coordinate) * step.rate * step.reach * ROUND_UP).sum()
    }
}

/// The origins and directions of the axes of the joints in the world.
pub(super) fn axes_into(
    kinematics: &Kinematics,
    frames: &[Isometry3<f64>],
    out: &mut Vec<(Point3<f64>, Vector3<f64>)>,
) {
    out.clear();
    out.extend(kinematics.frames.iter().zip(&frames[1..]).map(|(joint, pose)| {
        (Point3::from(pose.translation.vector), pose.rotation * joint.axis.into_inner())
    }));
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::{ArmModel, Joint, JointKind, Link};
    use mp_cspace::{Configuration, Joints, Rng, Space};
    use nalgebra::UnitQuaternion;
    use rand::RngExt;

    /// A chain of joints of all kinds, with boxes away from their axes.
    pub(in crate::arm) fn chain(rng: &mut Rng) -> ArmModel {
        let mut next = move || rng.random_range(-1.0..1.0);
        let mut model = ArmModel { links: vec![Link::new("0")], ..ArmModel::default() };
        for i in 1..7 {
            let kind = match i {
                3 => JointKind::Prismatic { low: -0.3, high: 0.2 },
                5 => JointKind::Continuous,
                _ => JointKind::Revolute { low: -2.0, high: 3.0 },
            };
            let mut vector = |scale: f64| Vector3::new(next(), next(), next()) * scale;
            let (place, turn, axis) = (vector(0.4), vector(2.0), vector(1.0));
            let shape = mp_geom::primitives::cuboid(0.1, 0.2, 0.5).unwrap();
            let at = Isometry3::new(vector(0.3), vector(2.0));
            model.links.push(Link::new(i.to_string()).with(&shape, &at));
            let origin = Isometry3::from_parts(place.into(), UnitQuaternion::from_scaled_axis(turn));
            let joint = Joint::new(format!("j{i}"), (i - 1).to_string(), i.to_string(), kind);
            model.joints.push(joint.at(origin).axis(axis));
        }
        model.joints[5] = model.joints[5].clone().mimic("j1", -0.5, 0.1);
        model
    }

    /// No vertex of any link travels farther than the bounds, measured in small steps, and the bounds are close to what is
    /// measured.
    #[test]
    fn no_vertex_moves_farther_than_the_bounds() {
        let mut rng = Rng::seed(1);
        let (mut best_far, mut best_near) = (0.0_f64, 0.0_f64);
        for _ in 0..30 {
            let model = chain(&mut rng);
            let kinematics = Kinematics::new(&model).unwrap();
            let space: Joints<Configuration> = kinematics.space().unwrap();
            for size in [1.0, 0.1, 0.01] {
                let a = space.sample_uniform(&mut rng);
                let b = space.interpolate(&a, &space.sample_uniform(&mut rng), size);
                let half = rng.random_range(0.05..0.5);
                let at = |t: f64| {
                    let mut frames = Vec::new();
                    kinematics.frames_into(space.interpolate(&a, &b, t).as_slice(), &mut frames);
                    frames
                };
                let travels = |i: usize| kinematics.travel(i, a.as_slice(), b.as_slice());
                let middle = at(0.5);
                let mut axes = Vec::new();
                axes_into(&kinematics, &middle, &mut axes);
                for (link, place) in model.links.iter().zip(&kinematics.attached).skip(1) {
                    let mesh = link.shapes[0].transformed(&place.pose);
                    let chain = Chain::new(&kinematics, &mesh, place.frame);
                    let ball = mesh.bounding_sphere();
                    let ball = Sphere { center: middle[place.frame] * ball.center, ..ball };
                    let (mut far, mut near) = (Vec::new(), Vec::new());
                    chain.far(travels, &mut far);
                    chain.near(|i| travels(i) * half, &ball, &axes, &mut near);
                    assert_eq!(*far.last().unwrap(), chain.whole(travels));
                    assert!(near.iter().zip(&far).all(|(near, far)| *near <= far * half * (1.0 + 1e-9)));
                    // Relative to each frame of the chain.
                    for (count, (near, far)) in near.iter().zip(&far).enumerate() {
                        let base = chain.steps.get(count).map_or(0, |step| step.frame);
                        let longest = |from: f64, to: f64| {
                            let steps = 200;
                            let place = |k: i32| {
                                let frames = at(from + (to - from) * f64::from(k) / f64::from(steps));
                                let pose = frames[base].inverse() * frames[place.frame];
                                mesh.vertices().iter().map(|v| pose * v).collect::<Vec<_>>()
                            };
                            let mut travels = vec![0.0; mesh.vertices().len()];
                            let mut last = place(0);
                            for k in 1..=steps {
                                let next = place(k);
                                travels
                                    .iter_mut()
                                    .zip(last.iter().zip(&next))
                                    .for_each(|(w, (p, q))| *w += (q - p).norm());
                                last = next;
                            }
                            travels.into_iter().fold(0.0, f64::max)
                        };
                        let whole = longest(0.0, 1.0);
                        assert!(whole <= far + 1e-12, "{whole} {far}");
                        let sides = longest(0.5, 0.5 + half).max(longest(0.5, 0.5 - half));
                        assert!(sides <= near + 1e-12, "{sides} {near}");
                        if count > 0 {
                            best_far = best_far.max(whole / far);
                            best_near = best_near.max(sides / near);
                        }
                    }
                }
            }
        }
        assert!(best_far > 0.9 && best_near > 0.9, "{best_far} {best_near}");
    }

    /// The same on a base that floats: what the base adds is a bound too, and close to what is measured.
    #[test]
    fn no_vertex_moves_farther_than_the_bounds_on_a_floating_base() {
        let mut rng = Rng::seed(2);
        let (mut best_far, mut best_near) = (0.0_f64, 0.0_f64);
        for _ in 0..20 {
            let bounds = mp_geom::Aabb::new([-1.0; 3].into(), [1.0, 2.0, 0.5].into());
            let model = ArmModel { floating: Some(bounds), ..chain(&mut rng) };
            let kinematics = Kinematics::new(&model).unwrap();
            let space = kinematics.floating_space().unwrap();
            for size in [1.0, 0.1, 0.01] {
                let (a, mut b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
                // At times the base or the joints do not move.
                match rng.random_range(0..3) {
                    0 => b.as_mut_slice()[..7].copy_from_slice(&a.as_slice()[..7]),
                    1 => b.as_mut_slice()[7..].copy_from_slice(&a.as_slice()[7..]),
                    _ => {}
                }
                let b = space.interpolate(&a, &b, size);
                let half = rng.random_range(0.05..0.5);
                let at = |t: f64| {
                    let mut frames = Vec::new();
                    kinematics.frames_into(space.interpolate(&a, &b, t).as_slice(), &mut frames);
                    frames
                };
                let travels = |i: usize| kinematics.travel(i, a.as_slice(), b.as_slice());
                let base = kinematics.base_travel(a.as_slice(), b.as_slice());
                let middle = at(0.5);
                let mut axes = Vec::new();
                axes_into(&kinematics, &middle, &mut axes);
                for (link, place) in model.links.iter().zip(&kinematics.attached).skip(1) {
                    let mesh = link.shapes[0].transformed(&place.pose);
                    let chain = Chain::new(&kinematics, &mesh, place.frame);
                    let ball = mesh.bounding_sphere();
                    let ball = Sphere { center: middle[place.frame] * ball.center, ..ball };
                    let mut near = Vec::new();
                    chain.near(|i| travels(i) * half, &ball, &axes, &mut near);
                    let by_joints = *near.last().unwrap();
                    let origin = Point3::from(middle[0].translation.vector);
                    let near = by_joints + base.near(half, chain.from_base, &ball, &origin, by_joints);
                    let far = chain.whole(travels) + base.far(chain.from_base);
                    let longest = |from: f64, to: f64| {
                        let steps = 200;
                        let place = |k: i32| {
                            let pose = at(from + (to - from) * f64::from(k) / f64::from(steps))[place.frame];
                            mesh.vertices().iter().map(|v| pose * v).collect::<Vec<_>>()
                        };
                        let mut travels = vec![0.0; mesh.vertices().len()];
                        let mut last = place(0);
                        for k in 1..=steps {
                            let next = place(k);
                            let moved = last.iter().zip(&next).map(|(p, q)| (q - p).norm());
                            travels.iter_mut().zip(moved).for_each(|(sum, moved)| *sum += moved);
                            last = next;
                        }
                        travels.into_iter().fold(0.0, f64::max)
                    };
                    let whole = longest(0.0, 1.0);
                    let sides = longest(0.5, 0.5 + half).max(longest(0.5, 0.5 - half));
                    assert!(whole <= far + 1e-12 && sides <= near + 1e-12, "{whole} {far}, {sides} {near}");
                    (best_far, best_near) = (best_far.max(whole / far), best_near.max(sides / near));
                }
            }
        }
        assert!(best_far > 0.8 && best_near > 0.9, "{best_far} {best_near}");
    }
}
