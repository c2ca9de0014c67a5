use super::super::check::{ProvenPart, is_of_use};
use super::super::robot::{LinkBody, SharedArm};
use super::super::travel::tests::chain;
use super::{LEAST, of_pair};
use crate::{Arm, ArmModel};
use mp_collide::Query;
use mp_cspace::{Configuration, MotionClearance, MotionInterval, Rng, Space};
use mp_geom::{Aabb, TriMesh, primitives};
use nalgebra::{Isometry3, Vector3};
use rand::RngExt;

/// A random motion of an arm, the middles of `count` equal intervals of it, and states of each interval.
type Motion = (Configuration, Configuration, Vec<Configuration>, Vec<Vec<Configuration>>);

fn motion(arm: &Arm, rng: &mut Rng, count: usize) -> Motion {
    fn of<S: Space<State = Configuration>>(space: &S, rng: &mut Rng, count: usize) -> Motion {
        let (from, far) = (space.sample_uniform(rng), space.sample_uniform(rng));
        // Long ones and short ones.
        let to = space.interpolate(&from, &far, [1.0, 0.1, 0.01][rng.random_range(0..3)]);
        let at = |k: usize, part: f64| space.interpolate(&from, &to, (k as f64 + part) / count as f64);
        let middles = (0..count).map(|k| at(k, 0.5)).collect();
        let parts = |k| [0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 0.9, 1.0].map(|part| at(k, part)).to_vec();
        (from.clone(), to.clone(), middles, (0..count).map(parts).collect())
    }
    match arm.floating_space() {
        Ok(space) => of(&space, rng, count),
        Err(_) => of(&arm.space::<Configuration>().unwrap(), rng, count),
    }
}

/// How far the vertices of a link move from where they are at `middle`, seen from frame `base`, until `at`.
fn moved(robot: &SharedArm, body: &LinkBody, base: Option<usize>, [middle, at]: [&Configuration; 2]) -> f64 {
    let place = |q: &Configuration| {
        let mut frames = Vec::new();
        robot.kinematics.frames_into(q.as_slice(), &mut frames);
        base.map_or_else(Isometry3::identity, |base| frames[base].inverse()) * frames[body.frame]
    };
    let [from, to] = [middle, at].map(place);
    body.mesh.vertices().iter().map(|v| (from * v - to * v).norm()).fold(0.0, f64::max)
}

/// The intervals of motions of random arms, some on bases that float: links move no farther than the bounds say, which are no more than
/// those of one interval, and nothing is nearer. Most bounds say something.
#[test]
fn links_stay_within_the_bounds_of_eight_intervals() {
    let mut rng = Rng::seed(4);
    let (mut query, mut known, mut all) = (Query::default(), 0, 0);
    let (mut best, mut less, mut more) = (0.0_f64, 0.0, 0.0);
    for round in 0..40 {
        let floating = (round % 2 == 1).then(|| Aabb::new([-1.0; 3].into(), [1.0, 2.0, 0.5].into()));
        let model = ArmModel { floating, ..chain(&mut rng) };
        let obstacles: Vec<_> = (0..6)
            .map(|i| {
                let mut vector = |scale: f64| Vector3::from_fn(|_, _| rng.random_range(-scale..scale));
                let pose = Isometry3::new(vector(2.0), vector(3.0));
                (i.to_string(), primitives::cuboid(0.1, 0.3, 0.7).unwrap(), pose)
            })
            .collect();
        let mut arm = Arm::new(&model, obstacles).unwrap();
        let count = 1 + round % 8;
        let half = 0.5 / count as f64;
        let (from, to, middles, ends) = motion(&arm, &mut rng, count);
        let intervals: Vec<_> = middles
            .iter()
            .map(|middle| MotionInterval { from: &from, to: &to, middle, half, travel: 0.0, margin: 1e-4 })
            .collect();
        arm.look_ahead(&intervals);
        let Arm { robot, obstacles, scratch, .. } = &mut arm;
        for (k, interval) in intervals.iter().enumerate() {
            assert_eq!(scratch.wide.find(robot, interval), k);
            let travels = |i: usize| half * robot.kinematics.travel(i, from.as_slice(), to.as_slice());
            robot.place_over(interval.middle.as_slice(), travels, scratch);
            for (i, body) in robot.numbered_moving() {
                let near = body.near(&scratch.wide.base.clone(), half, scratch);
                let wide = scratch.wide.near(k, i, body);
                let far = ends[k].iter().map(|q| moved(robot, body, None, [interval.middle, q]));
                let far = far.fold(0.0, f64::max);
                assert!(far <= wide + 1e-12 && wide <= near * (1.0 + 1e-12), "{far} {wide} {near}");
                best = best.max(far / wide);
                (less, more) = (less + wide, more + near);
                let bound = scratch.wide.link_apart(robot, &obstacles.scene, 0.0, i, k).0;
                let pose = &scratch.frames[body.frame];
                let found = obstacles.scene.surface_clearance(&mut query, &body.tree, pose, f64::INFINITY).0;
                assert!(bound <= found, "{bound} {found}");
                (known, all) = (known + usize::from(bound > 0.0), all + usize::from(found > 0.0));
            }
            for (p, pair) in robot.pairs.iter().enumerate() {
                let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
                let near = scratch.near[a.first + pair.steps[0]] + scratch.near[b.first + pair.steps[1]];
                let wide = scratch.wide.near_pair(robot, p, k);
                let far = ends[k].iter().map(|q| {
                    let above = |body: &LinkBody, steps: usize| {
                        Some(body.chain.steps.get(steps).map_or(0, |step| step.frame))
                    };
                    let moved = |body, steps| moved(robot, body, above(body, steps), [interval.middle, q]);
                    moved(a, pair.steps[0]) + moved(b, pair.steps[1])
                });
                let far = far.fold(0.0, f64::max);
                assert!(far <= wide + 1e-12 && wide <= near * (1.0 + 1e-12), "{far} {wide} {near}");
                let bound = scratch.wide.pair_apart(robot, p, k);
                let [at_a, at_b] = [a, b].map(|body| &scratch.frames[body.frame]);
                let found = query.clearance(&a.tree, at_a, &b.tree, at_b, f64::INFINITY);
                assert!(bound <= found, "{bound} {found}");
                (known, all) = (known + usize::from(bound > 0.0), all + usize::from(found > 0.0));
            }
        }
    }
    assert!(all > 1000 && known > all / 2, "{known} of {all}");
    assert!(best > 0.9 && less < 0.9 * more, "{best} {less} {more}");
}

/// What covers prove of eight intervals together is what they prove link by link and pair by pair, to the bit; where they leave one link or
/// pair open they prove nothing.
#[test]
fn covers_prove_together_what_they_prove_one_by_one() {
    let mut rng = Rng::seed(8);
    let (mut proved, mut open) = (0, 0);
    for round in 0..80 {
        let mut model = chain(&mut rng);
        if round % 2 == 1 {
            for link in &mut model.links {
                let boxes = std::mem::take(&mut link.shapes);
                let ball = |mesh: &TriMesh| {
                    let around = mesh.bounding_sphere();
                    TriMesh::of_balls(vec![around.center], 0.4 * around.radius).unwrap()
                };
                link.shapes = boxes.iter().map(ball).collect();
            }
        }
        let mut vector = |scale: f64| Vector3::from_fn(|_, _| rng.random_range(-scale..scale));
        let obstacles: Vec<_> = (0..4)
            .map(|i| {
                let pose = Isometry3::new(vector(1.5), vector(3.0));
                (i.to_string(), primitives::cuboid(0.1, 0.3, 0.7).unwrap(), pose)
            })
            .collect();
        let mut arm = Arm::new(&model, obstacles).unwrap();
        let (from, to, middles, _) = motion(&arm, &mut rng, 8);
        let interval = |middle| MotionInterval {
            from: &from,
            to: &to,
            middle,
            half: 1.0 / 16.0,
            travel: 0.0,
            margin: 1e-4,
        };
        let intervals: Vec<_> = middles.iter().map(interval).collect();
        arm.look_ahead(&intervals);
        let Arm { robot, obstacles, scratch, .. } = &mut arm;
        let wide = &mut scratch.wide;
        for (k, interval) in intervals.iter().enumerate() {
            let together = wide.proven(robot, &obstacles.scene, 0.0, k);
            let mut one_by_one =
                ProvenPart { margin: interval.margin, half: interval.half, part: f64::INFINITY };
            let mut add = |near: f64, far: f64, known: f64, is_known: bool| {
                let (near, enough) = one_by_one.wanted(near);
                (is_known || is_of_use(known, enough, interval.margin))
                    && one_by_one.add(near, far, known).is_none()
            };
            let links = robot.numbered_moving().all(|(i, body)| {
                let (known, is_tight) = wide.link_apart(robot, &obstacles.scene, 0.0, i, k);
                let is_known = is_tight && known >= LEAST * interval.margin;
                let far = wide.far[body.last()] + wide.base.far(body.chain.from_base);
                add(wide.near(k, i, body), far, known, is_known)
            });
            let pairs = links
                && (0..robot.pairs.len()).all(|p| {
                    let known = wide.pair_apart(robot, p, k);
                    let [far_a, far_b] = of_pair(robot, p, &wide.far);
                    add(wide.near_pair(robot, p, k), far_a + far_b, known, round % 2 == 1)
                });
            let expected = pairs.then_some(one_by_one.part);
            assert_eq!(together.map(f64::to_bits), expected.map(f64::to_bits), "{together:?} {expected:?}");
            (proved, open) = (proved + usize::from(pairs), open + usize::from(!pairs));
        }
    }
    assert!(proved > 100 && open > 100, "{proved} {open}");
}
