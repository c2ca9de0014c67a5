//! What is around a body: a box, a cylinder or a capsule.

use crate::bvh::root_box::RootBox;
use crate::cover::ALL;
use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use mp_geom::Sphere;
use mp_simd::wide::Doubles;
use nalgebra::{Isometry3, Point3, Vector3};

/// What is inside of a solid is of use where it reaches this near to what is around it, as a part of its least half extent.
const NEAR: f64 = 0.05;

/// What is said of a mesh, in terms of the box around it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Box and cylinder together are around it.
    Any,
    /// A solid that is as good as its box.
    Box,
    /// As its cylinder.
    Cylinder,
    /// As the capsule about the axis of its cylinder; of a length of zero between its ends it is a ball.
    Capsule,
}

/// What is around a mesh: its box, and the cylinder of least volume about an axis of the box, as high as the box; and what of the same form is
/// inside of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    axis: usize,
    form: Form,
    /// Of the cylinder or the capsule.
    radius: f64,
    /// From the middle of the capsule to the middles of its ends.
    straight: f64,
    /// How much smaller (m) on all sides what is inside is, if that is little.
    inset: Option<f64>,
}

impl Outline {
    /// Around a mesh. O(n) for n triangles.
    pub(crate) fn of(mesh: &CollisionMesh) -> Self {
        let own = &mesh.tree().bounding;
        if mesh.cloud.as_ref().is_some_and(|cloud| cloud.len() == 1) {
            // A ball: its radius is that of the cloud, which is added where it is placed.
            let off = mesh.tree().triangles.iter().flatten().map(|p| (p - own.center).norm());
            let radius = off.fold(0.0, f64::max);
            return Self { axis: 2, form: Form::Capsule, radius, straight: 0.0, inset: Some(2.0 * radius) };
        }
        let radius = |axis: usize| {
            let from_axis = |p: &Point3<f64>| {
                let d = p - own.center;
                d.norm_squared() - own.axes[axis].dot(&d) * own.axes[axis].dot(&d)
            };
            mesh.tree().triangles.iter().flatten().map(from_axis).fold(0.0, f64::max).sqrt()
        };
        let radii = [0, 1, 2].map(radius);
        let volume = |axis: &usize| radii[*axis] * radii[*axis] * own.half[*axis];
        let axis = (0..3).min_by(|a, b| volume(a).total_cmp(&volume(b))).unwrap_or(0);
        let (radius, straight) = (radii[axis], (own.half[axis] - radii[axis]).max(0.0));
        let outline = Self { axis, form: Form::Any, radius, straight, inset: None };
        // All of it is one solid.
        let is_solid = mesh.solids.len() == 1 && mesh.solids[0].len() == mesh.triangle_count();
        if is_solid { outline.fitted(mesh) } else { outline }
    }

    /// Of a solid: as the form whose inside reaches nearest to it. What is below the planes of all triangles meets none of them, and the solid
    /// winds around it.
    fn fitted(self, mesh: &CollisionMesh) -> Self {
        let own = &mesh.tree().bounding;
        let axes = [(self.axis + 1) % 3, (self.axis + 2) % 3, self.axis].map(|k| own.axes[k]);
        let half = [(self.axis + 1) % 3, (self.axis + 2) % 3, self.axis].map(|k| own.half[k]);
        let straight = self.straight;
        let mut rounded = 0.0_f64;
        let mut insets = [f64::NEG_INFINITY; 3];
        for [a, b, c] in &mesh.tree().triangles {
            let across = (b - a).cross(&(c - a));
            // A triangle without area is at the edge of others.
            let Some(normal) = across.try_normalize(f64::MIN_POSITIVE) else { continue };
            let [x, y, z] = axes.map(|axis| axis.dot(&normal).abs());
            let (height, flat) = (normal.dot(&(a - own.center)), (x * x + y * y).sqrt());
            let beyond = [
                (x * half[0] + y * half[1] + z * half[2] - height) / (x + y + z),
                (flat * self.radius + z * half[2] - height) / (flat + z),
                z * straight + self.radius - height,
            ];
            for (inset, beyond) in insets.iter_mut().zip(beyond) {
                // Written so that NaN stays.
                *inset = if beyond <= *inset { *inset } else { beyond };
            }
            for p in [a, b, c] {
                let d = p - own.center;
                let along = axes[2].dot(&d);
                let end = axes[2] * (along - along.clamp(-straight, straight));
                rounded = rounded.max((d - axes[2] * along + end).norm_squared());
            }
        }
        let rounded = rounded.sqrt();
        insets[2] += rounded - self.radius;
        let [a, b, c] = half;
        let least = [a.min(b).min(c), self.radius.min(c), self.radius];
        let forms = [Form::Box, Form::Cylinder, Form::Capsule];
        let fit = (0..3).filter(|i| insets[*i] <= NEAR * least[*i]);
        let Some(i) = fit.min_by(|i, j| insets[*i].total_cmp(&insets[*j])) else { return self };
        let radius = if forms[i] == Form::Capsule { rounded } else { self.radius };
        Self { form: forms[i], radius, inset: Some(insets[i].max(0.0)), ..self }
    }
}

/// What is around a body, in the world, a little enlarged so that rounding never cuts anything off. The axis of the cylinder or capsule is the
/// last one of the box.
#[derive(Clone, Debug)]
pub(crate) struct Around {
    bounds: RootBox,
    radius: f64,
    /// As that of the outline, and twice as much as this is enlarged for rounding.
    inset: Option<f64>,
    /// In the frame of the mesh.
    pub(crate) outline: Outline,
}

impl Around {
    /// Around a mesh at a pose; `None` when they are beyond the limits.
    pub(crate) fn new(mesh: &CollisionMesh, outline: Outline, pose: &Isometry3<f64>) -> Option<Self> {
        let relative = Relative::between(&Isometry3::identity(), 0.0, pose, mesh.radius())?;
        let more = relative.slack + mesh.rounding();
        let Outline { axis, radius, .. } = outline;
        let mut bounds = relative.obb(&mesh.tree().bounding);
        bounds.half.add_scalar_mut(more);
        bounds.axes.swap(axis, 2);
        bounds.half.swap_rows(axis, 2);
        let inset = outline.inset.map(|inset| inset + 2.0 * relative.slack);
        Some(Self { bounds, radius: radius + more, inset, outline })
    }

    /// Whether it is as good as the body: what is within of it by a little touches the body.
    #[inline(always)]
    pub(crate) fn is_tight(&self) -> bool {
        self.inset.is_some()
    }

    /// A lower bound on the distance of a ball; negative where it overlaps.
    #[inline]
    pub(crate) fn gap(&self, ball: &Sphere) -> f64 {
        let [x, y, z] = self.place(ball);
        let half = &self.bounds.half;
        if self.outline.form == Form::Capsule {
            let c = (z - self.outline.straight).max(0.0);
            return (x * x + y * y + c * c).sqrt() - (self.radius + ball.radius);
        }
        let [a, b, c] = [(x - half.x).max(0.0), (y - half.y).max(0.0), (z - half.z).max(0.0)];
        if self.outline.form == Form::Box {
            return (a * a + b * b + c * c).sqrt() - ball.radius;
        }
        let across = ((x * x + y * y).sqrt() - self.radius).max(0.0);
        ((a * a + b * b).max(across * across) + c * c).sqrt() - ball.radius
    }

    /// How far a ball is from the middle along each axis.
    #[inline(always)]
    fn place(&self, ball: &Sphere) -> [f64; 3] {
        let d: Vector3<f64> = ball.center - self.bounds.center;
        [0, 1, 2].map(|k| self.bounds.axes[k].dot(&d).abs())
    }

    /// An upper bound on the distance of a ball from the body; infinite where nothing is known to be inside of it.
    #[inline]
    pub(crate) fn reach(&self, ball: &Sphere) -> f64 {
        let Some(inset) = self.inset else { return f64::INFINITY };
        let ([x, y, z], half) = (self.place(ball), &self.bounds.half);
        let radius = self.radius - inset;
        let distance = match self.outline.form {
            Form::Any => f64::INFINITY,
            Form::Box => {
                let [a, b, c] = [x - half.x, y - half.y, z - half.z].map(|beyond| (beyond + inset).max(0.0));
                (a * a + b * b + c * c).sqrt()
            }
            Form::Cylinder => {
                let across = ((x * x + y * y).sqrt() - radius).max(0.0);
                let c = (z - half.z + inset).max(0.0);
                (across * across + c * c).sqrt()
            }
            Form::Capsule => {
                let c = (z - self.outline.straight).max(0.0);
                (x * x + y * y + c * c).sqrt() - radius
            }
        };
        distance - ball.radius
    }

    /// As [`gap`](Self::gap), for balls at eight places.
    #[inline(always)]
    pub(crate) fn wide_gap<D: Doubles>(&self, center: &[D; 3], radius: f64) -> D {
        let (square, own) = self.wide_square(center);
        square.sqrt() - (own + radius)
    }

    /// The places, as bits, where a ball is not farther than `within` (m), which is not negative; also where that cannot be compared.
    #[inline(always)]
    pub(crate) fn wide_near<D: Doubles>(&self, center: &[D; 3], radius: f64, within: f64) -> u32 {
        let (square, own) = self.wide_square(center);
        let far = within + (own + radius);
        ALL & !D::splat(far * far).less(square)
    }

    /// The squares of lower bounds on the distances (m) of eight points from the axis of the capsule, or else from box and cylinder; and how far (m) the
    /// capsule reaches from its axis, 0 for the others.
    #[inline(always)]
    fn wide_square<D: Doubles>(&self, center: &[D; 3]) -> (D, f64) {
        let (half, zero) = (&self.bounds.half, D::splat(0.0));
        let [x, y, z] = self.wide_place(center);
        if self.outline.form == Form::Capsule {
            let c = (z - self.outline.straight).max(zero);
            return (x * x + y * y + c * c, self.radius);
        }
        let [a, b, c] = [(x - half.x).max(zero), (y - half.y).max(zero), (z - half.z).max(zero)];
        if self.outline.form == Form::Box {
            return (a * a + b * b + c * c, 0.0);
        }
        let across = ((x * x + y * y).sqrt() - self.radius).max(zero);
        ((a * a + b * b).max(across * across) + c * c, 0.0)
    }

    #[inline(always)]
    fn wide_place<D: Doubles>(&self, center: &[D; 3]) -> [D; 3] {
        let o = &self.bounds.center;
        let d = [center[0] - o.x, center[1] - o.y, center[2] - o.z];
        let axes = &self.bounds.axes;
        three!(k => (d[0] * axes[k].x + d[1] * axes[k].y + d[2] * axes[k].z).abs())
    }

    /// Its largest coordinate and its size, about.
    #[inline(always)]
    pub(crate) fn size(&self) -> f64 {
        self.bounds.center.coords.amax() + self.bounds.half.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Query;
    use mp_geom::{Shape, TriMesh, primitives};
    use mp_simd::wide::{LANES, Wide};

    fn shape(name: &str, lengths: &[f64]) -> TriMesh {
        Shape::primitive(name, lengths).unwrap().mesh().unwrap()
    }

    /// The distance of a ball from a body, which may be a solid: what is around it says no more, and what is inside of it no less. What is as good
    /// as its box, cylinder or capsule says nearly as much.
    #[test]
    fn distances_are_between_the_bounds() {
        let solids = [
            (shape("box", &[0.1, 0.5, 0.9]), Form::Box, 1e-9),
            (shape("cylinder", &[0.1, 0.6]), Form::Cylinder, 2e-3),
            (shape("cylinder", &[0.4, 0.1]), Form::Cylinder, 3e-3),
            (shape("capsule", &[0.1, 0.6]), Form::Capsule, 3e-3),
            (shape("sphere", &[0.3]), Form::Capsule, 1e-9),
            (shape("sphere", &[0.3]).faceted(), Form::Capsule, 8e-3),
            (shape("cone", &[0.2, 0.6]), Form::Any, f64::INFINITY),
            (shape("box", &[0.1, 0.5, 0.9]).into_surface(), Form::Any, f64::INFINITY),
            (primitives::torus(0.5, 0.1, 24, 12).unwrap(), Form::Any, f64::INFINITY),
        ];
        let mut query = Query::default();
        for (i, (solid, form, loose)) in solids.iter().enumerate() {
            let (mesh, (mut near, mut inside)) = (CollisionMesh::new(solid), (0, 0));
            let outline = Outline::of(&mesh);
            assert_eq!((outline.form, outline.inset.is_some()), (*form, *form != Form::Any), "{i}");
            for k in 0..600 {
                let t = f64::from(k) + 0.1;
                let way = |x: f64, y: f64, z: f64| {
                    Vector3::new(mp_math::sin(x * t), mp_math::cos(y * t), mp_math::sin(z * t))
                };
                let pose = Isometry3::new(way(1.1, 0.7, 0.3) * 3.0, way(0.9, 1.7, 2.3) * 2.0);
                let around = Around::new(&mesh, outline, &pose).unwrap();
                let scale = if k % 3 == 0 { 0.1 } else { 0.8 };
                let center = pose * Point3::from(way(0.31, 1.3, 2.1) * scale);
                let ball = Sphere { center, radius: 0.05 * f64::from(k % 4) + 1e-3 };
                let body = CollisionMesh::new(&TriMesh::of_balls(vec![center], ball.radius).unwrap());
                let here = Isometry3::identity();
                let is_inside = query.meets(&mesh, &pose, &body, &here);
                let distance =
                    if is_inside { 0.0 } else { query.clearance(&mesh, &pose, &body, &here, f64::INFINITY) };
                let (gap, reach) = (around.gap(&ball), around.reach(&ball));
                assert!(gap <= distance + 1e-12, "{i} {gap} {distance}");
                // Deep inside of a surface no bound on what is inside says anything.
                assert!(reach >= distance - 1e-12 || is_inside, "{i} {reach} {distance}");
                assert!(reach >= gap && reach - gap <= 2.0 * loose, "{i} {gap} {reach}");
                let wide = around.wide_gap(&[center.x, center.y, center.z].map(Wide::splat), ball.radius);
                assert!(wide.0.iter().all(|x| x.to_bits() == gap.to_bits()), "{wide:?} {gap}");
                assert_eq!(wide.0.len(), LANES);
                near += usize::from(distance > 0.0 && distance - gap <= *loose);
                inside += usize::from(reach < 0.0 && is_inside);
                assert!(reach >= 0.0 || is_inside, "{i} {reach}");
            }
            assert!(near > 200 && (inside > 30) == (*form != Form::Any), "{i} {near} {inside}");
        }
    }
}
