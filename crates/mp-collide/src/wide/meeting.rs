//! Eight triangles against eight others: a filter that never loses a pair that meets, and never finds one that
//! does not.

use super::boxes::{cross, dot, sub};
use super::frames::Frames;
use super::leaves::{Corners, Near, TINY, U};
use super::{Lane, Leaf, WIDTH};
use crate::simd::Lanes;

/// How wrong heights over the planes of the first leaf, over those of the second, and volumes may be.
struct Bounds {
    height_a: f32,
    height_b: f32,
    volume: f32,
}

impl Bounds {
    /// With corners up to `far` apart and coordinates up to `g`, the height of a corner over a plane of the other leaf
    /// is wrong by the error of the normal over that distance, by the errors of two corners, and by 20u·g·e² for
    /// sums; a volume (p − v)·(e × f) by the errors of corners and edges, and by 40u·g·e·f for sums.
    #[inline(always)]
    fn new(leaf_a: &Leaf, leaf_b: &Leaf, near: &Near) -> Self {
        let (m, reach) = (leaf_a.magnitude, near.t + 1.74 * leaf_b.magnitude);
        let (far, corner) = (1.74 * (m + reach), 1.75 * near.wrong);
        let g = m.max(reach);
        let (a, b) = (Size::of(leaf_a), Size::of(leaf_b));
        let height = |s: &Size| s.wrong_normal * far + s.edge * s.edge * (corner + 20.0 * U * g) + TINY;
        let edges = a.wrong_edge * b.edge + b.wrong_edge * a.edge;
        Self {
            height_a: height(&a),
            height_b: height(&b),
            volume: edges * far + a.edge * b.edge * (corner + 40.0 * U * g) + TINY,
        }
    }
}

/// The longest edge of a leaf; how wrong edges (in length) and normals, products of two, may be.
struct Size {
    edge: f32,
    wrong_edge: f32,
    wrong_normal: f32,
}

impl Size {
    /// An edge as the difference of two corners is wrong by 2√3·u·m and √3·u·e; turned, by 7u·e more. A product of
    /// two is wrong by 2e times that and by 3√3·u·e² for its sums.
    #[inline(always)]
    fn of(leaf: &Leaf) -> Self {
        let (m, e) = (leaf.magnitude, leaf.edge);
        let wrong_edge = U * (3.5 * m + 9.0 * e);
        Self { edge: e, wrong_edge, wrong_normal: e * (2.0 * wrong_edge + 5.2 * U * e) }
    }
}

/// Edge `k` leads from corner `k` to the next.
#[inline(always)]
fn edges<L: Lanes>(v: &Corners<L>) -> Corners<L> {
    [sub(&v[1], &v[0]), sub(&v[2], &v[1]), sub(&v[0], &v[2])]
}

/// Edges of the second leaf, turned into the frame of the first.
#[inline(always)]
fn turn<L: Lanes>(e: &Corners<L>, frames: &Frames) -> Corners<L> {
    let r = &frames.into_a.r;
    three!(k => three!(d => {
        let x = e[k][2].mul(L::splat(r[d][2]));
        e[k][0].mul_add(L::splat(r[d][0]), e[k][1].mul_add(L::splat(r[d][1]), x))
    }))
}

/// Eight triangles with what sides and volumes are computed from.
struct Eight<L> {
    corner: Corners<L>,
    edge: Corners<L>,
    /// Corner × edge: with the edge, Plücker's coordinates of the line.
    moment: Corners<L>,
    normal: [L; 3],
    /// Normal · corner.
    height: L,
}

impl<L: Lanes> Eight<L> {
    #[inline(always)]
    fn new(v: &Corners<L>, edge: &Corners<L>) -> Self {
        let normal = cross(&edge[0], &edge[1]);
        Self {
            corner: *v,
            moment: three!(k => cross(&v[k], &edge[k])),
            edge: *edge,
            height: dot(&normal, &v[0]),
            normal,
        }
    }

    #[inline(always)]
    fn store(&self) -> Singles {
        let lanes = |v: &Corners<L>| three!(k => three!(d => lane(v[k][d])));
        Singles {
            corner: lanes(&self.corner),
            edge: lanes(&self.edge),
            moment: lanes(&self.moment),
            normal: three!(d => lane(self.normal[d])),
            height: lane(self.height),
        }
    }
}

/// The same in memory, to be taken one by one.
struct Singles {
    corner: [[Lane; 3]; 3],
    edge: [[Lane; 3]; 3],
    moment: [[Lane; 3]; 3],
    normal: [Lane; 3],
    height: Lane,
}

#[inline(always)]
fn lane<L: Lanes>(v: L) -> Lane {
    let mut a = [0.0; WIDTH];
    v.store(&mut a);
    a
}

/// Eight triangles against others one by one.
pub(crate) struct Meeting<L> {
    block: Eight<L>,
    singles: Singles,
    /// How wrong heights over the planes of the eight, over that of the one, and volumes may be.
    wrong_block: f32,
    wrong_single: f32,
    wrong_volume: f32,
}

/// What lanes say of eight pairs of triangles.
pub(crate) struct Verdict {
    /// Those that may meet.
    pub(crate) maybe: u32,
    /// Those among them that surely do.
    pub(crate) sure: u32,
}

impl Verdict {
    const NONE: Self = Self { maybe: 0, sure: 0 };
}

impl<L: Lanes> Meeting<L> {
    /// Leaf `a` with its corners, and leaf `b` with its corners here and in its own frame: the latter's triangles one
    /// by one. Always the latter's: taking those of the leaf with fewer that matter is slower, as the choice is
    /// hard to predict and what it chooses is copied.
    #[inline(always)]
    pub(crate) fn new(
        (leaf_a, corners_a): (&Leaf, &Corners<L>),
        (leaf_b, corners_b, own_b): (&Leaf, &Corners<L>, &Corners<L>),
        (near, frames): (&Near, &Frames),
    ) -> Self {
        let Bounds { height_a, height_b, volume } = Bounds::new(leaf_a, leaf_b, near);
        let a = Eight::new(corners_a, &edges(corners_a));
        let b = Eight::new(corners_b, &turn(&edges(own_b), frames));
        Self {
            block: a,
            singles: b.store(),
            wrong_block: height_a,
            wrong_single: height_b,
            wrong_volume: volume,
        }
    }

    /// Compares single `l` with the lanes in `mask`: sides of planes first, then the signed volumes of the nine
    /// pairs of edges. An edge passes through a triangle when it crosses its plane and runs past all three of its
    /// edges on the same side.
    #[inline(always)]
    pub(crate) fn of(&self, l: usize, mask: u32) -> Verdict {
        let (block, singles, l) = (&self.block, &self.singles, l & (WIDTH - 1));
        // Corners of the one against the planes of the eight.
        let corner: Corners<L> = three!(k => splat3(&singles.corner[k], l));
        let mut sides = Sides::NONE;
        for k in 0..3 {
            sides.set::<L>(k, dot(&corner[k], &block.normal).sub(block.height), self.wrong_block);
        }
        if mask & sides.both() == 0 {
            return Verdict::NONE;
        }
        // Corners of the eight against the plane of the one.
        let normal = splat3(&singles.normal, l);
        let height = L::splat(singles.height[l]);
        let mut others = Sides::NONE;
        for k in 0..3 {
            others.set::<L>(k, dot(&block.corner[k], &normal).sub(height), self.wrong_single);
        }
        let mask = mask & sides.both() & others.both();
        if mask == 0 {
            return Verdict::NONE;
        }
        let mut volumes = [Sides::NONE; 3];
        for i in 0..3 {
            let (e, m): ([L; 3], [L; 3]) = (splat3(&singles.edge[i], l), splat3(&singles.moment[i], l));
            for j in 0..3 {
                let (f, n) = (&block.edge[j], &block.moment[j]);
                let past = e[0].mul_add(n[0], e[1].mul_add(n[1], e[2].mul(n[2])));
                let volume = m[0].mul_add(f[0], m[1].mul_add(f[1], m[2].mul_add(f[2], past)));
                volumes[i].set::<L>(j, volume, self.wrong_volume);
            }
        }
        let (mut maybe, mut sure) = (0, 0);
        for i in 0..3 {
            let across = Sides { up: three!(j => volumes[j].up[i]), down: three!(j => volumes[j].down[i]) };
            maybe |= sides.crossed(i) & volumes[i].agree() | others.crossed(i) & across.agree();
            sure |= sides.surely_crossed(i) & volumes[i].surely_agree()
                | others.surely_crossed(i) & across.surely_agree();
        }
        Verdict { maybe: mask & maybe, sure: mask & maybe & sure }
    }
}

#[inline(always)]
fn splat3<L: Lanes>(v: &[Lane; 3], l: usize) -> [L; 3] {
    [L::splat(v[0][l]), L::splat(v[1][l]), L::splat(v[2][l])]
}

/// The signs of three numbers, eight times: those that may be at least zero, those that may be at most zero.
#[derive(Clone, Copy)]
struct Sides {
    up: [u32; 3],
    down: [u32; 3],
}

impl Sides {
    const NONE: Self = Self { up: [0; 3], down: [0; 3] };

    #[inline(always)]
    fn set<L: Lanes>(&mut self, k: usize, x: L, wrong: f32) {
        self.up[k] = L::splat(-wrong).le(x);
        self.down[k] = x.le(L::splat(wrong));
    }

    /// Some of the three may be at least zero, some at most.
    #[inline(always)]
    fn both(&self) -> u32 {
        (self.up[0] | self.up[1] | self.up[2]) & (self.down[0] | self.down[1] | self.down[2])
    }

    /// Numbers `i` and its successor may have different signs.
    #[inline(always)]
    fn crossed(&self, i: usize) -> u32 {
        let j = (i + 1) % 3;
        self.up[i] & self.down[j] | self.down[i] & self.up[j]
    }

    /// They have.
    #[inline(always)]
    fn surely_crossed(&self, i: usize) -> u32 {
        let j = (i + 1) % 3;
        !(self.down[i] | self.up[j]) | !(self.up[i] | self.down[j])
    }

    /// All three may have the same sign.
    #[inline(always)]
    fn agree(&self) -> u32 {
        self.up[0] & self.up[1] & self.up[2] | self.down[0] & self.down[1] & self.down[2]
    }

    /// They have.
    #[inline(always)]
    fn surely_agree(&self) -> u32 {
        !(self.down[0] | self.down[1] | self.down[2]) | !(self.up[0] | self.up[1] | self.up[2])
    }
}

#[cfg(test)]
mod tests {
    use crate::simd::Isa;
    use crate::triangle::{Triangle, intersect};
    use crate::{CollisionMesh, Query};
    use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Up to eight triangles about the origin, of very different sizes, slivers among them.
    fn some(rng: &mut Pcg64) -> Vec<Triangle> {
        (0..rng.random_range(1..=8))
            .map(|_| {
                let mut at = |r: f64| Vector3::from_fn(|_, _| rng.random_range(-r..r));
                let (middle, long, wide) = (at(1.0), at(1.0), at(1.0));
                let (long, wide) =
                    (long * 10f64.powf(at(1.0).x * 1.5), wide * 10f64.powf(at(1.0).x * 1.5 - 1.0));
                [Point3::from(middle), Point3::from(middle + long), Point3::from(middle + wide)]
            })
            .collect()
    }

    /// Lanes neither lose a pair that meets nor find one that does not, down to the last digit.
    #[test]
    fn eight_against_eight_near_contact() {
        let mut rng = Pcg64::seed_from_u64(3);
        let (mut hits, mut misses) = (0, 0);
        let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
        for _ in 0..150 {
            let (a, b) = (some(&mut rng), some(&mut rng));
            let meshes = [CollisionMesh::from_triangles(a.clone()), CollisionMesh::from_triangles(b.clone())];
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0)));
            let way = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize();
            let mut check = |x: f64| {
                let pose = Isometry3::from_parts((way * x).into(), turn);
                let here = Isometry3::identity();
                let relative = crate::pose::Relative::between(&here, 1.0, &pose, 1.0).unwrap();
                let exact = b.iter().any(|t| a.iter().any(|s| intersect(s, &relative.triangle(t))));
                for query in &mut queries {
                    let found = query.intersects(&meshes[0], &here, &meshes[1], &pose);
                    assert_eq!(found, exact, "{:?} {a:?} {b:?} {pose}", query.isa);
                }
                if exact {
                    hits += 1;
                } else {
                    misses += 1;
                }
                exact
            };
            let (mut free, mut hit) = (200.0, (0..40).map(|i| 0.1 * f64::from(i)).find(|x| check(*x)));
            while let Some(inside) = hit {
                let middle = 0.5 * (free + inside);
                if middle <= inside || middle >= free {
                    break;
                }
                if check(middle) {
                    hit = Some(middle);
                } else {
                    free = middle;
                }
            }
        }
        assert!(hits > 1000 && misses > 1000, "{hits} {misses}");
    }
}
