//! Lower bounds on the distance of covers from the bodies of a scene, by the box and the cylinder around each: a tight broad phase.

use super::Scene;
use crate::broad::{self, BroadPhase};
use crate::cover::{ALL, Contacts, Cover, LARGEST, PlacedCover, ROUNDING, WideCover};
use mp_geom::Aabb;
use mp_simd::wide::{Doubles, Wide, WideKernel, load3, on_widest};
use std::cell::Cell;

impl Scene {
    /// A lower bound (m) on the distance of the mesh of `cover` from all bodies, if that is at least `enough` (m), by balls against what is
    /// around bodies: by the ball around the mesh, else by the smaller balls. Infinite without bodies; `None` where balls leave it undecided.
    pub fn apart(&self, cover: &Cover, placed: &mut PlacedCover, enough: f64) -> Option<f64> {
        let ball = placed.around;
        let own = ball.center.coords.amax() + ball.radius;
        let center = <[f64; 3]>::from(ball.center);
        let mut near = std::mem::take(&mut placed.near);
        near.clear();
        let far = on_widest(NearBodies {
            scene: self,
            low: center,
            high: center,
            radius: ball.radius + ROUNDING * own,
            most: enough,
            is_bounded: true,
            near: &mut near,
        });
        let mut bodies = near.iter().filter_map(|index| self.bodies[*index as usize].as_ref());
        let least = bodies.try_fold(far, |least: f64, body| {
            let rounding = ROUNDING * (body.around.size() + own);
            let apart = placed.apart_from(cover, enough + rounding, |ball| body.around.gap(ball))?;
            Some(least.min(apart - rounding))
        });
        placed.near = near;
        least
    }

    /// Lower bounds (m) on the distance of a mesh at eight places from all bodies: by the balls around it against what is around bodies,
    /// and where that is less than `enough`, by smaller balls, until all of these are less than `some`. And whether they are nearly the
    /// distances where they are less than `enough`: the cover is [exact](Cover::is_exact), and bodies that are near are as good as what is
    /// around them; then `some` is not asked for.
    pub fn wide_apart(
        &self,
        cover: &Cover,
        placed: &mut WideCover,
        enough: Wide,
        some: Wide,
    ) -> (Wide, bool) {
        on_widest(FromBodies { scene: self, cover, placed, enough, some })
    }

    /// As [`wide_apart`](Self::wide_apart), for what is compiled for the widest instructions already.
    #[inline(always)]
    pub fn wide_apart_here<D: Doubles>(
        &self,
        cover: &Cover,
        placed: &mut WideCover,
        enough: D,
        some: D,
    ) -> (D, bool) {
        let own = placed.size;
        // Bodies are no larger. Written so that NaN is refused.
        let is_usual = own < LARGEST;
        if !is_usual {
            return (D::splat(f64::NEG_INFINITY), false);
        }
        let (near, least) = self.near_places::<D>(placed, enough.largest() * (1.0 + 1e-9), true);
        let mut around = near.iter().filter_map(|index| self.bodies[*index as usize].as_ref());
        let is_tight = cover.is_exact() && around.all(|body| body.around.is_tight());
        let some = if is_tight { D::splat(f64::NEG_INFINITY) } else { some };
        let mut least = D::splat(least);
        for index in &near {
            let Some(body) = &self.bodies[*index as usize] else { continue };
            let around = &body.around;
            let rounding = ROUNDING * (own + around.size());
            let apart = placed.apart_from(cover, around, enough + rounding, some) - rounding;
            least = apart.min(least);
        }
        placed.near = near;
        (least, is_tight)
    }

    /// Whether a mesh at eight places touches bodies, or is within `kept` (m) of them: at which places it does, and at which balls leave it
    /// open. The search ends where it touches at one place. Where the cover is not [exact](Cover::is_exact) balls never tell that it touches.
    pub fn wide_contact(&self, cover: &Cover, placed: &mut WideCover, kept: f64) -> Contacts {
        on_widest(ContactWithBodies { scene: self, cover, placed, kept })
    }

    /// As [`wide_contact`](Self::wide_contact), for what is compiled for the widest instructions already.
    #[inline(always)]
    pub fn wide_contact_here<D: Doubles>(
        &self,
        cover: &Cover,
        placed: &mut WideCover,
        kept: f64,
    ) -> Contacts {
        let own = placed.size;
        // Bodies are no larger. Written so that NaN is refused.
        let is_usual = own < LARGEST;
        if !is_usual {
            return Contacts { touching: 0, open: ALL };
        }
        let (near, _) = self.near_places::<D>(placed, kept.max(f64::MIN_POSITIVE) * (1.0 + 1e-9), false);
        let mut all = Contacts::default();
        for index in &near {
            let Some(body) = &self.bodies[*index as usize] else { continue };
            let rounding = ROUNDING * (own + body.around.size());
            all.add(placed.contact::<D>(cover, &body.around, kept, rounding));
            if all.touching != 0 {
                break;
            }
        }
        placed.near = near;
        all
    }

    /// The bodies that may be nearer than `most` (m) to a mesh at one of eight places, and, if it `is_bounded`, a lower bound on the distance of
    /// the others.
    #[inline(always)]
    fn near_places<D: Doubles>(
        &self,
        placed: &mut WideCover,
        most: f64,
        is_bounded: bool,
    ) -> (Vec<u32>, f64) {
        let mut near = std::mem::take(&mut placed.near);
        near.clear();
        let center = load3::<D>(placed.center());
        let [x, y, z] = three!(k => center[k].range());
        let least = NearBodies {
            scene: self,
            low: [x[0], y[0], z[0]],
            high: [x[1], y[1], z[1]],
            radius: placed.radius() + ROUNDING * placed.size,
            most,
            is_bounded,
            near: &mut near,
        };
        let least = least.run::<D>();
        (near, least)
    }
}

/// Finds the bodies that may be nearer than `most` (m) to a ball of a radius with its center in a box. The output is a lower bound on the
/// distance of the others.
struct NearBodies<'a> {
    scene: &'a Scene,
    low: [f64; 3],
    high: [f64; 3],
    radius: f64,
    most: f64,
    /// Whether the bound is asked for.
    is_bounded: bool,
    near: &'a mut Vec<u32>,
}

impl WideKernel for NearBodies<'_> {
    type Output = f64;
    #[inline(always)]
    fn run<D: Doubles>(self) -> f64 {
        let Self { scene, low, high, radius, most, is_bounded, near } = self;
        let mut least = f64::INFINITY;
        for broad in [&scene.fixed, &scene.movable] {
            let Some(list) = broad.few() else {
                let own = Aabb { min: low.into(), max: high.into() };
                least = least.min(near_of_many(broad, &own, [radius, most], near));
                continue;
            };
            for eight in list {
                let square = eight.square_distance::<D>(&low, &high);
                let more = D::load(&eight.size) * ROUNDING + radius;
                let enough = more + most;
                // Written so that NaN is near.
                let far = (enough * enough).less(square);
                let mut close = eight.taken & !far;
                while close != 0 {
                    near.push(eight.items[close.trailing_zeros() as usize]);
                    close &= close - 1;
                }
                if far != 0 && is_bounded {
                    let bound = square.sqrt() - more;
                    let bound = (enough * enough).where_less(square, bound, D::splat(f64::INFINITY));
                    least = least.min(bound.range()[0]);
                }
            }
        }
        least
    }
}

/// The same of more boxes than are listed, by their tree: for the box `own` around the centres of balls of this radius.
#[inline(never)]
fn near_of_many(broad: &BroadPhase, own: &Aabb, [radius, most]: [f64; 2], near: &mut Vec<u32>) -> f64 {
    let least = Cell::new(f64::INFINITY);
    // Comparisons are written so that NaN is near.
    let enter = |bounds: &Aabb| {
        let size = bounds.min.coords.amax().max(bounds.max.coords.amax());
        let bound = broad::distance(own, bounds) - radius - ROUNDING * size;
        let is_far = bound >= most;
        if is_far {
            least.set(least.get().min(bound));
        }
        !is_far
    };
    let _: Option<()> = broad.find(enter, |index| {
        near.push(index);
        None
    });
    least.get()
}

/// Contact with the bodies of a scene.
struct ContactWithBodies<'a> {
    scene: &'a Scene,
    cover: &'a Cover,
    placed: &'a mut WideCover,
    kept: f64,
}

impl WideKernel for ContactWithBodies<'_> {
    type Output = Contacts;
    #[inline(always)]
    fn run<D: Doubles>(self) -> Contacts {
        self.scene.wide_contact_here::<D>(self.cover, self.placed, self.kept)
    }
}

/// Distances from the bodies of a scene.
struct FromBodies<'a> {
    scene: &'a Scene,
    cover: &'a Cover,
    placed: &'a mut WideCover,
    enough: Wide,
    some: Wide,
}

impl WideKernel for FromBodies<'_> {
    type Output = (Wide, bool);
    #[inline(always)]
    fn run<D: Doubles>(self) -> (Wide, bool) {
        let Self { scene, cover, placed, enough, some } = self;
        let (least, is_tight) = scene.wide_apart_here(cover, placed, D::load(&enough), D::load(&some));
        (least.store(), is_tight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CollisionMesh, Query};
    use mp_geom::{Sphere, TriMesh, primitives};
    use mp_simd::wide::{LANES, WideFrame};
    use nalgebra::{Isometry3, Point3, Vector3};

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

    /// Eight places at a time: balls that tell whether there is contact tell what trees do. Of balls among boxes, cylinders and capsules they
    /// nearly always tell.
    #[test]
    fn contact_at_eight_places_is_that_of_trees() {
        let way = |t: f64| Vector3::new(mp_math::sin(3.1 * t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t));
        let pose = |t: f64, reach: f64| Isometry3::new(way(t) * reach, Vector3::new(t, 0.3 * t, -t));
        let shape = |name: &str, lengths: &[f64]| {
            CollisionMesh::new(&mp_geom::Shape::primitive(name, lengths).unwrap().mesh().unwrap())
        };
        let balls = |t: f64| {
            let one = |i: i32| {
                let at = Point3::from(way(t + 0.7 * f64::from(i)) * 0.15);
                TriMesh::of_balls(vec![at], 0.02 + 0.003 * f64::from(i)).unwrap()
            };
            TriMesh::merged(&(0..12).map(one).collect::<Vec<_>>()).unwrap()
        };
        let links = [balls(0.1), balls(0.6), primitives::cylinder(0.06, 0.5, 24).unwrap().into_surface()];
        let covers = links.each_ref().map(Cover::new);
        assert_eq!(covers.each_ref().map(Cover::is_exact), [true, true, false]);
        let trees = links.each_ref().map(CollisionMesh::new);
        let (mut scene, mut query) = (Scene::new(), Query::default());
        let shapes =
            [shape("box", &[0.1, 0.5, 0.9]), shape("cylinder", &[0.1, 0.4]), shape("capsule", &[0.1, 0.3])];
        for i in 0..9 {
            scene.insert(i.to_string(), shapes[i % 3].clone(), pose(1.7 * i as f64, 1.2)).unwrap();
        }
        let (mut told, mut open, mut touching) = (0, 0, 0);
        for round in 0..300 {
            let at = |body: usize, lane: usize| {
                pose(0.37 * f64::from(round) + 0.11 * lane as f64 + 2.0 * body as f64, 1.3)
            };
            let mut placed: [WideCover; 3] = Default::default();
            for body in 0..3 {
                let all: [Isometry3<f64>; LANES] = std::array::from_fn(|lane| at(body, lane));
                let turn = all.map(|pose| pose.rotation.to_rotation_matrix().into_inner());
                let frame = WideFrame {
                    turn: std::array::from_fn(|r| {
                        std::array::from_fn(|c| Wide(std::array::from_fn(|lane| turn[lane][(r, c)])))
                    }),
                    origin: std::array::from_fn(|r| {
                        Wide(std::array::from_fn(|lane| all[lane].translation.vector[r]))
                    }),
                };
                placed[body].place::<Wide>(&links[body].bounding_sphere(), &frame);
            }
            for kept in [0.0, 0.05] {
                for body in 0..3 {
                    let found = scene.wide_contact(&covers[body], &mut placed[body], kept);
                    assert_eq!(found.touching & found.open, 0);
                    for lane in 0..LANES {
                        let expected = scene.within(&mut query, &trees[body], &at(body, lane), kept)
                            || scene.nested(&mut query, &trees[body], &at(body, lane)).is_some();
                        if found.touching >> lane & 1 == 1 {
                            assert!(expected && covers[body].is_exact(), "{body} {lane}");
                            touching += 1;
                        } else if found.open >> lane & 1 == 1 {
                            open += usize::from(covers[body].is_exact() && found.touching == 0);
                        } else if found.touching == 0 {
                            assert!(!expected, "{body} {lane}");
                            told += 1;
                        }
                    }
                }
            }
            for (i, j) in [(0, 1), (0, 2)] {
                let [a, b] = placed.get_disjoint_mut([i, j]).unwrap();
                let [found, within] =
                    [0.0, 0.07].map(|d| crate::wide_within((&covers[i], a), (&covers[j], b), d));
                let far = Wide::splat(f64::INFINITY);
                let apart = crate::wide_apart((&covers[i], a), (&covers[j], b), far, Wide::splat(0.0));
                for lane in 0..LANES {
                    let poses = [at(i, lane), at(j, lane)];
                    let distance = query.clearance(&trees[i], &poses[0], &trees[j], &poses[1], f64::INFINITY);
                    let is_open = found.open >> lane & 1 == 1;
                    assert!(apart.0[lane] <= distance, "{} {distance}", apart.0[lane]);
                    match within.open >> lane & 1 == 1 {
                        true => assert!(!covers[j].is_exact()),
                        false => assert_eq!(within.touching >> lane & 1 == 1, distance < 0.07),
                    }
                    if covers[j].is_exact() {
                        assert!((apart.0[lane].max(0.0) - distance).abs() < 1e-9 && !is_open);
                        assert_eq!(found.touching >> lane & 1 == 1, distance == 0.0);
                    } else {
                        assert!(is_open || distance > 0.0);
                    }
                }
            }
        }
        assert!(told > 4000 && touching > 300 && open < 60, "{told} {touching} {open}");
    }
}
