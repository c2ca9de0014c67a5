//! Clouds of 10^4, 10^5 and 10^6 points: thinning, building, queries, memory, and answers against the plain distance to all points.
//!
//! ```sh
//! cargo run --release -p mp-collide --example clouds
//! cargo run --release -p mp-collide --example clouds -- 1000000   # so many poses compared
//! ```

#![allow(clippy::print_stdout)] // examples talk

use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Query};
use mp_geom::{Points, Shape, TriMesh, primitives};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use std::time::Instant;

/// Numbers from −1 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from_fn(|_, _| 3.0 * self.next()));
        Isometry3::from_parts(Vector3::from_fn(|_, _| 2.0 * self.next()).into(), turn)
    }
}

/// What a camera sees of a room 4 m wide: floor, walls and boxes in it, with noise.
fn scan(count: usize, numbers: &mut Numbers) -> Vec<Point3<f64>> {
    let point = |i: usize| {
        let (x, y, noise) = (2.0 * numbers.next(), 2.0 * numbers.next(), 0.002 * numbers.next());
        match i % 4 {
            0 => Point3::new(x, y, noise - 2.0),
            1 => Point3::new(x, noise - 2.0, y),
            2 => Point3::new(noise - 2.0, x, y),
            _ => Point3::new(0.25 * x, 0.25 * y, noise + 0.2 * (3.0 * x).round()),
        }
    };
    (0..count).map(point).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let poses: usize = std::env::args().nth(1).map_or(Ok(20_000), |n| n.parse())?;
    let mut numbers = Numbers(1);
    let body = primitives::capsule(0.05, 0.3, 16, 4)?;
    let (robot, here, mut query) = (CollisionMesh::new(&body), Isometry3::identity(), Query::default());
    println!(
        "| points | kept | thinning, ms | tree, ms | verifier, ms | MB | collision, µs | clearance, µs | colliding |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for count in [10_000, 100_000, 1_000_000] {
        let points = Points::new(scan(count, &mut numbers), 0.01);
        let [thinned, built, reference];
        let begun = Instant::now();
        let mesh = Shape::Points(points).mesh()?;
        thinned = begun.elapsed();
        let begun = Instant::now();
        let tree = CollisionMesh::new(&mesh);
        built = begun.elapsed();
        let begun = Instant::now();
        std::hint::black_box(RefMesh::new(&mesh));
        reference = begun.elapsed();
        let all: Vec<_> = (0..20_000).map(|_| numbers.pose()).collect();
        let begun = Instant::now();
        let hits = all.iter().filter(|pose| query.intersects(&robot, pose, &tree, &here)).count();
        let collision = begun.elapsed();
        let begun = Instant::now();
        let sum: f64 = all.iter().map(|pose| query.clearance(&robot, pose, &tree, &here, 0.5)).sum();
        let clearance = begun.elapsed();
        std::hint::black_box(sum);
        let (ms, each) = (1e3, 1e6 / all.len() as f64);
        println!(
            "| {count} | {} | {:.1} | {:.1} | {:.1} | {:.1} | {:.2} | {:.2} | {:.0}% |",
            mesh.vertices().len(),
            thinned.as_secs_f64() * ms,
            built.as_secs_f64() * ms,
            reference.as_secs_f64() * ms,
            tree.memory() as f64 / 1e6,
            collision.as_secs_f64() * each,
            clearance.as_secs_f64() * each,
            100.0 * hits as f64 / all.len() as f64,
        );
    }
    compare(poses, &mut numbers)
}

/// Compares answers with the plain distance of a segment, as a mesh of one triangle, to all thinned points.
fn compare(poses: usize, numbers: &mut Numbers) -> Result<(), Box<dyn std::error::Error>> {
    let mesh = Shape::Points(Points::new(scan(2_000, numbers), 0.1)).mesh()?;
    let (radius, ends) = (mesh.rounding().unwrap_or(0.0), [-0.2, 0.2].map(|x| Point3::new(x, 0.0, 0.0)));
    let segment = TriMesh::new(ends.to_vec(), vec![[0, 1, 1]])?;
    let (tree, robot) = (CollisionMesh::new(&mesh), CollisionMesh::new(&segment));
    let (mut query, mut wrong, mut hits, mut off) = (Query::default(), 0, 0, 0.0_f64);
    for _ in 0..poses {
        let pose = numbers.pose();
        let [from, to] = ends.map(|p| pose * p);
        let along = to - from;
        let distance = |p: &Point3<f64>| {
            let share = ((p - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (p - from - along * share).norm_squared()
        };
        let plain = mesh.vertices().iter().map(distance).fold(f64::INFINITY, f64::min).sqrt() - radius;
        let hit = query.intersects(&robot, &pose, &tree, &Isometry3::identity());
        let found = query.clearance(&robot, &pose, &tree, &Isometry3::identity(), f64::INFINITY);
        let error = (found - plain.max(0.0)).abs();
        wrong += usize::from((hit != (plain <= 0.0) && plain.abs() > 1e-12) || error > 1e-12);
        hits += usize::from(hit);
        off = off.max(error);
    }
    let count = mesh.vertices().len();
    println!(
        "{poses} poses among {count} points: {wrong} wrong, {hits} collide, distances off by at most {off:.1e} m"
    );
    Ok(())
}
