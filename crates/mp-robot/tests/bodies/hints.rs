//! Hints lead along what is hit, and gradients away from what is near.

use crate::common::{clutter, robot};
use mp_collide::reference::triangle_distance;
use mp_cspace::testkit::check_clearance_gradient;
use mp_cspace::{
    Rn, Rng, Se2, Se3, Space, Validity,
    angle::rotation_angle,
    obstacles::{ClearanceGradient, ObstacleGeometry, ObstacleHints, PointOf},
};
use mp_geom::{TriMesh, primitives::cuboid};
use mp_robot::{FreeFlyer, Placement, PlanarFlyer, PointRobot, RigidBody};
use nalgebra::{Isometry3, Point3, Vector3};

fn world_triangles() -> Vec<[Point3<f64>; 3]> {
    let meshes = clutter().into_iter().map(|(_, mesh, pose)| mesh.transformed(&pose));
    meshes.flat_map(|m| (0..m.triangles().len()).map(|i| m.triangle(i)).collect::<Vec<_>>()).collect()
}

fn parallel(direction: &Vector3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> bool {
    (b - a).cross(&(c - a)).normalize().dot(direction).abs() < 1e-9
}

/// Each hint at a hit is parallel to a triangle of an obstacle that the robot touches there, as long as asked, and
/// turns nothing; each without a hit is parallel to some triangle.
fn hints<P: Placement, C: Space<State = P::State>>(space: &C, mut body: RigidBody<P>) {
    let (mut rng, triangles) = (Rng::seed(5), world_triangles());
    let mut hit = 0;
    for _ in 0..400 {
        let [from, toward, q] = [(); 3].map(|()| space.sample_uniform(&mut rng));
        let touching = body.touches(&q);
        assert_eq!(touching, !body.is_valid(&q));
        let offset = |to: &P::State| P::pose(to).translation.vector - P::pose(&from).translation.vector;
        let checked = |to: &P::State| {
            assert!((offset(to).norm() - offset(&toward).norm()).abs() < 1e-12);
            assert!(rotation_angle(&P::pose(to).rotation, &P::pose(&from).rotation) < 1e-7);
            offset(to).normalize()
        };
        let any = body.slide_along(&from, &toward, None, &mut rng).unwrap();
        let direction = checked(&any);
        assert!(triangles.iter().any(|t| parallel(&direction, t)));
        let along = body.slide_along(&from, &toward, Some(&q), &mut rng);
        assert_eq!(along.is_some(), touching);
        let Some(along) = along else { continue };
        let direction = checked(&along);
        let placed = body.mesh().transformed(&P::pose(&q));
        let touched = |t: &&[Point3<f64>; 3]| {
            (0..placed.triangles().len()).any(|i| triangle_distance(&placed.triangle(i), t) < 1e-9)
        };
        assert!(triangles.iter().filter(touched).any(|t| parallel(&direction, t)), "{direction:?}");
        hit += 1;
    }
    assert!(hit > 20, "{hit}");
}

#[test]
fn hints_are_parallel_to_what_is_hit() {
    hints(&Se3::new([-2.0; 3], [2.0; 3]).unwrap(), FreeFlyer::new(&robot(), clutter()).unwrap());
    hints(&Se2::new([-2.0; 2], [2.0; 2]).unwrap(), PlanarFlyer::new(&robot(), clutter()).unwrap());
}

#[test]
fn what_leads_from_one_to_the_other_is_carried_over() {
    let body = FreeFlyer::new(&robot(), []).unwrap();
    let space = Se3::new([-2.0; 3], [2.0; 3]).unwrap();
    let mut rng = Rng::seed(8);
    for _ in 0..100 {
        let [p, q, r] = [(); 3].map(|()| space.sample_uniform(&mut rng));
        assert!(space.distance(&body.moved_by(&p, &p, &q), &q) < 1e-7);
        assert!(space.distance(&body.moved_by(&r, &q, &q), &r) < 1e-7);
        // There and back.
        let there = body.moved_by(&r, &p, &q);
        assert!(space.distance(&body.moved_by(&there, &q, &p), &r) < 1e-6);
        assert!(body.clone().slide_along(&p, &q, None, &mut rng).is_none(), "there is no obstacle");
    }
    let mut point = PointRobot::new(clutter()).unwrap();
    let space = Rn::<3>::new([-2.0; 3], [2.0; 3]).unwrap();
    let [p, q] = [(); 2].map(|()| space.sample_uniform(&mut rng));
    assert_eq!(point.moved_by(&p, &p, &q), p + (q - p));
    assert!(point.slide_along(&p, &q, None, &mut rng).is_some());
}

/// By central differences, where free; in collision what is told is rough, yet mostly leads out.
fn gradients<P: Placement, C: Space<State = P::State>>(space: &C, mut body: RigidBody<P>) {
    check_clearance_gradient(space, &mut body, 1.5, (400, 1e-5, 1e-3), 3);
    let (mut rng, mut gradient) = (Rng::seed(4), vec![0.0; space.dim()]);
    let (mut touching, mut out) = (0, 0);
    for _ in 0..400 {
        let mut q = space.sample_uniform(&mut rng);
        touching += u32::from(!body.is_valid(&q));
        for _ in 0..if body.is_valid(&q) { 0 } else { 60 } {
            let depth = body.clearance_gradient(&q, f64::INFINITY, &mut gradient);
            assert!(depth <= 0.0, "{depth}");
            let square: f64 = gradient.iter().map(|g| g * g).sum();
            if square == 0.0 {
                break;
            }
            q = space.moved(&q, &gradient, (0.02 - depth).min(0.2) / square).unwrap();
            if body.is_valid(&q) {
                out += 1;
                break;
            }
        }
    }
    assert!(touching > 5 && out * 10 > touching * 6, "{out} of {touching} found a way out");
}

#[test]
fn gradients_lead_away_from_obstacles() {
    gradients(&Se3::new([-2.0; 3], [2.0; 3]).unwrap(), FreeFlyer::new(&robot(), clutter()).unwrap());
    gradients(&Se2::new([-2.0; 2], [2.0; 2]).unwrap(), PlanarFlyer::new(&robot(), clutter()).unwrap());
    gradients(&Rn::<3>::new([-2.0; 3], [2.0; 3]).unwrap(), PointRobot::new(clutter()).unwrap());
    let mut alone = FreeFlyer::new(&robot(), []).unwrap();
    let mut gradient = [f64::NAN; 6];
    let far = alone.clearance_gradient(&nalgebra::Isometry3::identity(), 1.0, &mut gradient);
    assert_eq!((far, gradient), (f64::INFINITY, [0.0; 6]));
}

/// Each part among which the clutter falls, and another part in one mesh with the last.
fn parted() -> Vec<crate::common::Obstacle> {
    let mut all = clutter();
    let (name, sheet, pose) = all.pop().unwrap();
    let two = TriMesh::merged([
        &sheet,
        &cuboid(0.2, 0.3, 0.9).unwrap().transformed(&Isometry3::translation(0.0, 0.0, 2.0)),
    ]);
    all.push((name, two.unwrap(), pose));
    all
}

/// What is touched is touched with nothing else around, and nothing is where the robot is free; the far are free, turned
/// anyhow.
fn obstacle_geometry<P: Placement, C: Space<State = P::State>>(space: &C, mut body: RigidBody<P>) {
    let parts: Vec<TriMesh> =
        parted().iter().flat_map(|(_, mesh, pose)| mesh.transformed(pose).parts()).collect();
    assert_eq!(body.obstacles().len(), parts.len());
    for (seen, part) in body.obstacles().iter().zip(&parts) {
        assert!(part.vertices().iter().all(|p| (p.coords - seen.center).norm() <= seen.radius + 1e-9));
    }
    let alone = |part: &TriMesh| {
        RigidBody::<P>::among(&robot(), [("it".to_owned(), part.clone(), Isometry3::identity())]).unwrap()
    };
    let mut alone: Vec<_> = parts.iter().map(alone).collect();
    let (mut rng, mut hits, mut far) = (Rng::seed(11), vec![0; parts.len()], 0);
    for _ in 0..4000 {
        let (q, other) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        let touched = body.touched_obstacle(&q);
        assert_eq!(touched.is_some(), !body.is_valid(&q));
        if let Some(part) = touched {
            assert!(!alone[part].is_valid(&q));
            hits[part] += 1;
        }
        if body.is_far(&q) {
            far += 1;
            let center = body.robot().center;
            let turned = body.moved_to(&other, &center, &body.world_point(&q, &center));
            assert!(body.is_valid(&q) && body.is_valid(&turned));
        }
    }
    assert!(far > 20, "{far}");
    assert!(hits.iter().filter(|hits| **hits > 5).count() >= 4, "{hits:?}");
}

#[test]
fn outlines_tell_what_is_touched_and_what_is_far() {
    let (low, high) = ([-4.0; 3], [4.0; 3]);
    obstacle_geometry(&Se3::new(low, high).unwrap(), FreeFlyer::new(&robot(), parted()).unwrap());
    obstacle_geometry(&Se2::new([-4.0; 2], [4.0; 2]).unwrap(), PlanarFlyer::new(&robot(), parted()).unwrap());
}

#[test]
fn the_robot_is_put_where_it_is_asked() {
    let space = Se3::new([-2.0; 3], [2.0; 3]).unwrap();
    let mut rng = Rng::seed(3);
    let body = FreeFlyer::new(&robot(), parted()).unwrap();
    let planar = PlanarFlyer::new(&robot(), parted()).unwrap();
    let mut sides = [0; 3];
    for i in 0..200 {
        let (q, place) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng).translation.vector);
        let of = [PointOf::Center, PointOf::Vertex, PointOf::Surface][i % 3];
        let point = body.robot_point(of, &mut rng);
        let there = body.moved_to(&q, &point, &place);
        assert!((body.world_point(&there, &point) - place).norm() < 1e-12 && there.rotation == q.rotation);

        let (robot, axis) = (body.robot(), body.robot_features().axis);
        let direction = q.rotation * Vector3::x();
        let [a, b] = [0.0, 0.7].map(|angle| body.aligned(&place, &(direction * 3.0), angle));
        for q in [&a, &b] {
            assert!((body.world_point(q, &robot.center) - place).norm() < 1e-12);
            assert!((q.rotation * axis - direction).norm() < 1e-9);
        }
        assert!((rotation_angle(&a.rotation, &b.rotation) - 0.7).abs() < 1e-7);

        let turned = planar.aligned(&place, &direction, 0.0);
        assert!((planar.world_point(&turned, &robot.center) - place).xy().norm() < 1e-12);
        let along = (turned.to_isometry3(0.0).rotation * axis).xy().normalize();
        assert!((along - direction.xy().normalize()).norm() < 1e-6);

        // On the box of the clutter, 1 by 0.5 by 2.
        let (_, _, pose) = &clutter()[0];
        let on = body.obstacle_point(0, PointOf::Surface, &mut rng).unwrap();
        let local = pose.inverse_transform_point(&Point3::from(on)).coords.abs();
        let part = local.component_div(&Vector3::new(0.5, 0.25, 1.0));
        assert!((part.max() - 1.0).abs() < 1e-9);
        sides[part.imax()] += 1;
        assert!(body.obstacle_point(99, of, &mut rng).is_none());
    }
    // By area: 1, 2 and 0.5.
    assert!(sides[1] > sides[0] && sides[0] > sides[2] && sides[2] > 5, "{sides:?}");
    let long = body.obstacle_features(0).unwrap().axis;
    assert!(body.obstacle_features(99).is_none());
    assert!((clutter()[0].2.rotation * Vector3::z()).dot(&long).abs() > 1.0 - 1e-9);
    let point = PointRobot::new(parted()).unwrap();
    assert_eq!(point.aligned(&Vector3::new(1.0, 2.0, 3.0), &Vector3::x(), 1.0), Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(point.robot().radius, 0.0);
}
