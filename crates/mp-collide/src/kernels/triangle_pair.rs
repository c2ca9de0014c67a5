//! Eight triangles against eight others: a filter that keeps every pair that meets, and calls none sure that does
//! not.

use crate::bvh::frames::Frames;
use crate::bvh::{Lane, Leaf, WIDTH};
use crate::kernels::leaf_pair::{Corners, LeafFrame, TINY, U};
use crate::kernels::separating_axes::{cross, dot, sub};
use mp_simd::{Lanes, Mask};

/// Bounds on the errors of heights over the planes of the first leaf, over those of the second, and of volumes.
struct ErrorBounds {
    height_a: f32,
    height_b: f32,
    volume: f32,
}

impl ErrorBounds {
    /// With corners up to `far` apart and coordinates up to `g`, the height of a corner over a plane of the other leaf
    /// is wrong by the error of the normal over that distance, by the errors of two corners, and by 20u·g·e² for
    /// sums; a volume (p − v)·(e × f) by the errors of corners and edges, and by 40u·g·e·f for sums.
    #[inline(always)]
    fn new(leaf_a: &Leaf, leaf_b: &Leaf, near: &LeafFrame) -> Self {
        let (m, reach) = (leaf_a.magnitude, near.t + 1.74 * leaf_b.magnitude);
        let (far, corner) = (1.74 * (m + reach), 1.75 * near.wrong);
        let g = m.max(reach);
        let (a, b) = (EdgeErrors::of(leaf_a), EdgeErrors::of(leaf_b));
        let height = |s: &EdgeErrors| s.wrong_normal * far + s.edge * s.edge * (corner + 20.0 * U * g) + TINY;
        let edges = a.wrong_edge * b.edge + b.wrong_edge * a.edge;
        Self {
            height_a: height(&a),
            height_b: height(&b),
            volume: edges * far + a.edge * b.edge * (corner + 40.0 * U * g) + TINY,
        }
    }
}

/// The longest edge of a leaf, and bounds on the errors of edges (in length) and of normals, products of two edges.
struct EdgeErrors {
    edge: f32,
    wrong_edge: f32,
    wrong_normal: f32,
}

impl EdgeErrors {
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

/// Eight triangles in memory, read all at once or one by one, with the products from which sides and volumes are computed.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct EightTriangles {
    corner: [[Lane; 3]; 3],
    edge: [[Lane; 3]; 3],
    /// Corner × edge: with the edge, Plücker's coordinates of the line.
    moment: [[Lane; 3]; 3],
    normal: [Lane; 3],
    /// Normal · corner.
    height: Lane,
}

impl EightTriangles {
    const NONE: Self = Self {
        corner: [[[0.0; WIDTH]; 3]; 3],
        edge: [[[0.0; WIDTH]; 3]; 3],
        moment: [[[0.0; WIDTH]; 3]; 3],
        normal: [[0.0; WIDTH]; 3],
        height: [0.0; WIDTH],
    };

    #[inline(always)]
    fn set<L: Lanes>(&mut self, v: &Corners<L>, edge: &Corners<L>) {
        for k in 0..3 {
            let moment = cross(&v[k], &edge[k]);
            for d in 0..3 {
                v[k][d].store(&mut self.corner[k][d]);
                edge[k][d].store(&mut self.edge[k][d]);
                moment[d].store(&mut self.moment[k][d]);
            }
        }
        let normal = cross(&edge[0], &edge[1]);
        for d in 0..3 {
            normal[d].store(&mut self.normal[d]);
        }
        dot(&normal, &v[0]).store(&mut self.height);
    }
}

/// Compares eight triangles with others, one by one.
#[derive(Clone, Debug)]
pub(crate) struct TriangleFilter {
    block: EightTriangles,
    singles: EightTriangles,
    /// Bounds on the errors of heights over the planes of the eight, over the plane of the single one, and of volumes.
    wrong_block: f32,
    wrong_single: f32,
    wrong_volume: f32,
}

/// The answer for eight pairs of triangles.
pub(crate) struct Verdict {
    /// The pairs that may meet.
    pub(crate) maybe: u32,
    /// The pairs among them that surely meet.
    pub(crate) sure: u32,
}

impl Verdict {
    const NONE: Self = Self { maybe: 0, sure: 0 };
}

impl TriangleFilter {
    /// The filter of no triangles.
    pub(crate) const NONE: Self = Self {
        block: EightTriangles::NONE,
        singles: EightTriangles::NONE,
        wrong_block: 0.0,
        wrong_single: 0.0,
        wrong_volume: 0.0,
    };

    /// Takes leaf `a` with its corners, and leaf `b` with its corners in this frame and in its own. The triangles of `b`
    /// are the single ones, always: taking those of the leaf with fewer triangles left is slower, as the choice is
    /// hard to predict and its result is copied.
    #[inline(always)]
    pub(crate) fn set<L: Lanes>(
        &mut self,
        (leaf_a, corners_a): (&Leaf, &Corners<L>),
        (leaf_b, corners_b, own_b): (&Leaf, &Corners<L>, &Corners<L>),
        (near, frames): (&LeafFrame, &Frames),
    ) {
        let ErrorBounds { height_a, height_b, volume } = ErrorBounds::new(leaf_a, leaf_b, near);
        (self.wrong_block, self.wrong_single, self.wrong_volume) = (height_a, height_b, volume);
        self.singles.set(corners_b, &turn(&edges(own_b), frames));
        self.block.set(corners_a, &edges(corners_a));
    }

    /// Compares single `l` with the lanes in `mask`: sides of planes first, then the signed volumes of the nine
    /// pairs of edges. An edge passes through a triangle when it crosses the plane and passes all three edges of
    /// the triangle on the same side.
    #[inline(always)]
    pub(crate) fn of<L: Lanes>(&self, l: usize, mask: u32) -> Verdict {
        let (block, singles, l) = (&self.block, &self.singles, l & (WIDTH - 1));
        // Corners of the single triangle against the planes of the eight.
        let corner: Corners<L> = three!(k => splat3(&singles.corner[k], l));
        let (normal, height) = (load3(&block.normal), L::load(&block.height));
        let sides = three!(k => dot(&corner[k], &normal).sub(height));
        let sides = Signs { x: sides, wrong: self.wrong_block };
        let mask = mask & sides.differ().bits();
        if mask == 0 {
            return Verdict::NONE;
        }
        // Corners of the eight against the plane of the single triangle.
        let normal: [L; 3] = splat3(&singles.normal, l);
        let height = L::splat(singles.height[l]);
        let others = three!(k => dot(&load3(&block.corner[k]), &normal).sub(height));
        let others = Signs { x: others, wrong: self.wrong_single };
        let mask = mask & others.differ().bits();
        if mask == 0 {
            return Verdict::NONE;
        }
        let volumes: Corners<L> = three!(i => {
            let (e, m): ([L; 3], [L; 3]) = (splat3(&singles.edge[i], l), splat3(&singles.moment[i], l));
            three!(j => {
                let (f, n): ([L; 3], [L; 3]) = (load3(&block.edge[j]), load3(&block.moment[j]));
                let past = e[0].mul_add(n[0], e[1].mul_add(n[1], e[2].mul(n[2])));
                m[0].mul_add(f[0], m[1].mul_add(f[1], m[2].mul_add(f[2], past)))
            })
        });
        let wrong = self.wrong_volume;
        let one = three!(i => Signs { x: volumes[i], wrong });
        let eight = three!(j => Signs { x: [volumes[0][j], volumes[1][j], volumes[2][j]], wrong });
        let [x, y, z] = three!(i => sides.crossed(i) & one[i].agree() | others.crossed(i) & eight[i].agree());
        let maybe = mask & (x | y | z).bits();
        if maybe == 0 {
            return Verdict::NONE;
        }
        let [x, y, z] = three!(i => {
            sides.surely_crossed(i) & one[i].surely_agree() | others.surely_crossed(i) & eight[i].surely_agree()
        });
        Verdict { maybe, sure: maybe & (x | y | z).bits() }
    }
}

#[inline(always)]
fn load3<L: Lanes>(v: &[Lane; 3]) -> [L; 3] {
    [L::load(&v[0]), L::load(&v[1]), L::load(&v[2])]
}

#[inline(always)]
fn splat3<L: Lanes>(v: &[Lane; 3], l: usize) -> [L; 3] {
    [L::splat(v[0][l]), L::splat(v[1][l]), L::splat(v[2][l])]
}

/// Three numbers in each lane, with errors up to `wrong`, and what is known of their signs.
struct Signs<L> {
    x: [L; 3],
    wrong: f32,
}

impl<L: Lanes> Signs<L> {
    /// Whether, for the least and the greatest of some numbers, the least may be at most zero and the greatest at least.
    #[inline(always)]
    fn either(&self, (low, high): (L, L)) -> L::Mask {
        low.le(L::splat(self.wrong)) & L::splat(-self.wrong).le(high)
    }

    #[inline(always)]
    fn all(&self) -> (L, L) {
        let [x, y, z] = self.x;
        (x.min(y).min(z), x.max(y).max(z))
    }

    /// Number `i` and its successor.
    #[inline(always)]
    fn two(&self, i: usize) -> (L, L) {
        let (x, y) = (self.x[i], self.x[(i + 1) % 3]);
        (x.min(y), x.max(y))
    }

    /// Whether the three may differ in sign.
    #[inline(always)]
    fn differ(&self) -> L::Mask {
        self.either(self.all())
    }

    /// Whether number `i` and its successor may have different signs.
    #[inline(always)]
    fn crossed(&self, i: usize) -> L::Mask {
        self.either(self.two(i))
    }

    /// Whether number `i` and its successor surely have different signs.
    #[inline(always)]
    fn surely_crossed(&self, i: usize) -> L::Mask {
        let (low, high) = self.two(i);
        low.lt(L::splat(-self.wrong)) & L::splat(self.wrong).lt(high)
    }

    /// Whether all three may have the same sign.
    #[inline(always)]
    fn agree(&self) -> L::Mask {
        let (low, high) = self.all();
        L::splat(-self.wrong).le(low) | high.le(L::splat(self.wrong))
    }

    /// Whether all three surely have the same sign.
    #[inline(always)]
    fn surely_agree(&self) -> L::Mask {
        let (low, high) = self.all();
        L::splat(self.wrong).lt(low) | high.lt(L::splat(-self.wrong))
    }
}

#[cfg(test)]
mod tests {
    use crate::triangle::{Triangle, intersect};
    use crate::{CollisionMesh, Query};
    use mp_geom::TriMesh;
    use mp_simd::Isa;
    use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Up to eight triangles about the origin, of very different sizes, slivers among them.
    fn some(rng: &mut Pcg64) -> Vec<Triangle> {
        (0..rng.random_range(1..=8))
            .map(|_| {
                let mut at = |r: f64| Vector3::from_fn(|_, _| rng.random_range(-r..r));
                let (middle, long, wide) = (at(1.0), at(1.0), at(1.0));
                let (long, wide) = (
                    long * mp_math::powf(10.0, at(1.0).x * 1.5),
                    wide * mp_math::powf(10.0, at(1.0).x * 1.5 - 1.0),
                );
                [Point3::from(middle), Point3::from(middle + long), Point3::from(middle + wide)]
            })
            .collect()
    }

    /// Answers agree with the exact test down to the last digit.
    #[test]
    fn eight_against_eight_near_contact() {
        let mut rng = Pcg64::seed_from_u64(3);
        let (mut hits, mut misses) = (0, 0);
        let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
        for _ in 0..150 {
            let (a, b) = (some(&mut rng), some(&mut rng));
            let meshes = [&a, &b].map(|soup| CollisionMesh::new(&TriMesh::from_soup(soup).unwrap()));
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
