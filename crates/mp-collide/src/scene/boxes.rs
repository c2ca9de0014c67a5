//! Lower bounds on the distance of covers from the bodies of a scene, by the box and the cylinder around each: a tight broad phase.

use super::{Body, Scene};
use crate::broad;
use crate::cover::{Cover, LARGEST, PlacedCover, ROUNDING, WideCover};
use mp_geom::Aabb;
use mp_simd::wide::{LANES, Wide, WideKernel, on_widest};
use nalgebra::Point3;
use std::cell::Cell;

impl Scene {
    /// A lower bound (m) on the distance of the mesh of `cover` from all bodies, if that is at least `enough` (m), by balls against what is
    /// around bodies: by the ball around the mesh, else by the smaller balls. Infinite without bodies; `None` where balls leave it undecided.
    pub fn apart(&self, cover: &Cover, placed: &mut PlacedCover, enough: f64) -> Option<f64> {
        let ball = placed.around;
        let rounding = |size: f64| ROUNDING * (size + ball.center.coords.amax() + ball.radius);
        let least = Cell::new(f64::INFINITY);
        // Comparisons are written so that NaN is undecided.
        let enter = |bounds: &Aabb| {
            let size = bounds.min.coords.amax().max(bounds.max.coords.amax());
            let bound = bounds.distance(&ball.center) - ball.radius - rounding(size);
            let is_far = bound >= enough;
            if is_far {
                least.set(least.get().min(bound));
            }
            !is_far
        };
        let mut undecided = |index: u32| {
            let around = &self.bodies[index as usize].as_ref()?.around;
            let rounding = rounding(around.size());
            match placed.apart_from(cover, enough + rounding, |ball| around.gap(ball)) {
                Some(bound) => least.set(least.get().min(bound - rounding)),
                None => return Some(()),
            }
            None
        };
        let both =
            self.fixed.find(enter, &mut undecided).or_else(|| self.movable.find(enter, &mut undecided));
        both.is_none().then(|| least.get())
    }

    /// Lower bounds (m) on the distance of a mesh at eight places from all bodies: by the balls around it against what is around bodies,
    /// and where that is less than `enough`, by smaller balls, until all of these are less than `some`.
    pub fn wide_apart(&self, cover: &Cover, placed: &mut WideCover, enough: Wide, some: Wide) -> Wide {
        // Bodies are no larger. Written so that NaN is refused.
        let is_usual = placed.size < LARGEST;
        if !is_usual {
            return Wide::splat(f64::NEG_INFINITY);
        }
        let most = enough.largest() * (1.0 + 1e-9);
        let at = |i: usize| Point3::from(placed.center().map(|x| x.0[i]));
        let (low, high) = (1..LANES).fold((at(0), at(0)), |(l, h), i| (l.inf(&at(i)), h.sup(&at(i))));
        let (own, least) = (Aabb { min: low, max: high }, Cell::new(f64::INFINITY));
        let radius = placed.radius() + ROUNDING * placed.size;
        // Comparisons are written so that NaN is near.
        let enter = |bounds: &Aabb| {
            let size = bounds.min.coords.amax().max(bounds.max.coords.amax());
            let bound = broad::distance(&own, bounds) - radius - ROUNDING * size;
            let is_far = bound >= most;
            if is_far {
                least.set(least.get().min(bound));
            }
            !is_far
        };
        let mut near = std::mem::take(&mut placed.near);
        near.clear();
        for broad in [&self.fixed, &self.movable] {
            let _: Option<()> = broad.find(enter, |index| {
                near.push(index);
                None
            });
        }
        let found = on_widest(FromBodies { cover, placed, near: &near, bodies: &self.bodies, enough, some });
        placed.near = near;
        found.min(Wide::splat(least.get()))
    }
}

/// Of several bodies.
struct FromBodies<'a> {
    cover: &'a Cover,
    placed: &'a mut WideCover,
    near: &'a [u32],
    bodies: &'a [Option<Body>],
    enough: Wide,
    some: Wide,
}

impl WideKernel for FromBodies<'_> {
    type Output = Wide;
    #[inline(always)]
    fn run(self) -> Wide {
        let own = self.placed.size;
        let mut least = Wide::splat(f64::INFINITY);
        for index in self.near {
            let Some(body) = &self.bodies[*index as usize] else { continue };
            let around = &body.around;
            let rounding = ROUNDING * (own + around.size());
            let wanted = self.enough + rounding;
            let apart = self.placed.apart_from(self.cover, around, wanted, self.some) - rounding;
            least = apart.min(least);
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CollisionMesh, Query};
    use mp_geom::{Sphere, TriMesh, primitives};
    use nalgebra::{Isometry3, Vector3};

    /// What balls decide, trees say too, at random places among boxes, cylinders and a cloud, all turned.
    #[test]
    fn nothing_is_nearer_than_balls_say() {
        let pose = |t: f64, reach: f64| {
            let shift = Vector3::new(mp_math::sin(3.1 * t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t));
            Isometry3::new(shift * reach, Vector3::new(t, 0.3 * t, -t))
        };
        let points = (0..40).map(|i| Point3::from(pose(f64::from(i), 0.2).translation.vector)).collect();
        let shapes = [
            primitives::cuboid(0.1, 0.5, 0.9).unwrap(),
            primitives::cylinder(0.1, 0.4, 32).unwrap(),
            TriMesh::of_balls(points, 0.02).unwrap(),
        ];
        let link = primitives::cylinder(0.06, 0.5, 24).unwrap();
        let (cover, tree) = (Cover::new(&link), CollisionMesh::new(&link));
        let (mut scene, mut query, mut placed) = (Scene::new(), Query::default(), PlacedCover::default());
        assert_eq!(scene.apart(&cover, &mut placed, 1.0), Some(f64::INFINITY));
        for i in 0..9 {
            let shape = CollisionMesh::new(&shapes[i % 3]);
            scene.insert(i.to_string(), shape, pose(1.7 * i as f64, 1.5)).unwrap();
        }
        let mut decided = 0;
        for merged in [false, true] {
            for i in 0..600 {
                let at = pose(0.37 * f64::from(i), 1.8);
                let distance = scene.clearance(&mut query, &tree, &at, f64::INFINITY).0;
                for enough in [0.0, 0.05, 0.2] {
                    let around = link.bounding_sphere();
                    placed.place(Sphere { center: at * around.center, ..around }, &at);
                    let Some(bound) = scene.apart(&cover, &mut placed, enough) else { continue };
                    assert!(bound <= distance && bound >= enough - 1e-9, "{bound} {distance}");
                    decided += 1;
                }
            }
            if !merged {
                scene.merge_static();
            }
        }
        assert!(decided > 1500, "{decided}");
    }
}
