//! Meshes and solid primitives: balls, capsules, boxes, cylinders, cones, half-spaces.
//!
//! A ball is all points near a point and a capsule all points near a segment, so queries about them are
//! distance queries against a mesh of one degenerate triangle. A box is a mesh of twelve triangles and its inside;
//! cylinders and cones are compared with triangles as convex solids of revolution; for a half-space the lowest point of
//! the mesh decides.

use mp_geom::primitives::{PrimitiveError, cuboid, positive};
use nalgebra::{Isometry3, Point3, Vector3};

use crate::bvh::frames::Frames;
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::{Relative, to_world};
use crate::query::Query;
use crate::query::inside::{Inside, is_inside};
use crate::query::revolved::{Frustum, NearestPoints, Revolved};
use crate::separation::Separation;
use crate::simd::run;

/// A geometric primitive in its own frame: a closed *solid*, unlike a mesh, which is a surface.
///
/// ```
/// use mp_collide::{CollisionMesh, Query, Solid};
/// use nalgebra::Isometry3;
///
/// let table = CollisionMesh::new(&mp_geom::primitives::cuboid(2.0, 1.0, 0.1)?);
/// let (ball, here) = (Solid::ball(0.25)?, Isometry3::identity());
/// let mut query = Query::default();
/// let above = Isometry3::translation(0.3, 0.0, 1.0);
/// assert_eq!(query.solid_distance(&table, &here, &ball, &above).distance, 0.7);
/// assert!(query.solid_within(&table, &here, &ball, &above, 0.75));
/// # Ok::<(), mp_geom::primitives::PrimitiveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Solid {
    primitive: Primitive,
}

#[derive(Clone, Debug)]
enum Primitive {
    /// All points within `radius` of a core.
    Swept {
        core: CollisionMesh,
        radius: f64,
    },
    Cuboid {
        surface: CollisionMesh,
        half: Vector3<f64>,
    },
    Revolved {
        /// A mesh of the box around it.
        around: CollisionMesh,
        frustum: Frustum,
    },
    HalfSpace,
}

impl Solid {
    /// All points within `radius` (metres) of the origin.
    ///
    /// # Errors
    /// [`PrimitiveError::NotPositive`].
    pub fn ball(radius: f64) -> Result<Self, PrimitiveError> {
        Ok(Self::swept([Point3::origin(); 2], positive("radius", radius)?))
    }

    /// All points within `radius` of a segment of `length` along Z, centred on the origin (metres). Its
    /// height is `length + 2·radius`.
    ///
    /// # Errors
    /// [`PrimitiveError::NotPositive`].
    pub fn capsule(radius: f64, length: f64) -> Result<Self, PrimitiveError> {
        let (radius, end) = (positive("radius", radius)?, positive("length", length)? * 0.5);
        Ok(Self::swept([Point3::new(0.0, 0.0, -end), Point3::new(0.0, 0.0, end)], radius))
    }

    fn swept([p, q]: [Point3<f64>; 2], radius: f64) -> Self {
        let core = CollisionMesh::from_triangles(&[[p, q, q]]);
        Self { primitive: Primitive::Swept { core, radius } }
    }

    /// The box of these edge lengths (metres), centred on the origin.
    ///
    /// # Errors
    /// [`PrimitiveError::NotPositive`].
    pub fn cuboid(x: f64, y: f64, z: f64) -> Result<Self, PrimitiveError> {
        let surface = CollisionMesh::new(&cuboid(x, y, z)?);
        Ok(Self { primitive: Primitive::Cuboid { surface, half: Vector3::new(x, y, z) * 0.5 } })
    }

    /// The cylinder about Z of this radius and height (metres), centred on the origin.
    ///
    /// # Errors
    /// [`PrimitiveError::NotPositive`].
    pub fn cylinder(radius: f64, height: f64) -> Result<Self, PrimitiveError> {
        let (radius, half) = (positive("radius", radius)?, positive("height", height)? * 0.5);
        Self::revolved(Frustum { low: radius, high: radius, half })
    }

    /// The cone about Z with a base of this radius at z = −`height`/2 and its tip at z = `height`/2 (metres).
    ///
    /// # Errors
    /// [`PrimitiveError::NotPositive`].
    pub fn cone(radius: f64, height: f64) -> Result<Self, PrimitiveError> {
        let (radius, half) = (positive("radius", radius)?, positive("height", height)? * 0.5);
        Self::revolved(Frustum { low: radius, high: 0.0, half })
    }

    fn revolved(frustum: Frustum) -> Result<Self, PrimitiveError> {
        let width = 2.0 * frustum.low.max(frustum.high);
        let around = CollisionMesh::new(&cuboid(width, width, 2.0 * frustum.half)?);
        Ok(Self { primitive: Primitive::Revolved { around, frustum } })
    }

    /// All points with z ≤ 0; its pose places the plane.
    #[must_use]
    pub fn half_space() -> Self {
        Self { primitive: Primitive::HalfSpace }
    }

    /// The kind of solid and its lengths.
    #[cfg(feature = "parry")]
    pub(crate) fn dimensions(&self) -> Dimensions {
        match &self.primitive {
            Primitive::Swept { core, radius } => {
                let radius = *radius;
                let half = core.triangles().first().map_or(0.0, |core| core[1].z);
                if half > 0.0 { Dimensions::Capsule { radius, half } } else { Dimensions::Ball { radius } }
            }
            Primitive::Cuboid { half, .. } => Dimensions::Cuboid { half: *half },
            Primitive::Revolved { frustum, .. } => {
                let Frustum { low: radius, high, half } = *frustum;
                if high > 0.0 {
                    Dimensions::Cylinder { radius, half }
                } else {
                    Dimensions::Cone { radius, half }
                }
            }
            Primitive::HalfSpace => Dimensions::HalfSpace,
        }
    }
}

/// The lengths of a solid (metres), halved where they are symmetric about the origin.
#[cfg(feature = "parry")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Dimensions {
    Ball { radius: f64 },
    Capsule { radius: f64, half: f64 },
    Cuboid { half: Vector3<f64> },
    Cylinder { radius: f64, half: f64 },
    Cone { radius: f64, half: f64 },
    HalfSpace,
}

/// Queries between a mesh at `pose_wm` and a solid at `pose_ws` (poses in the world).
///
/// The mesh is a surface and the solid is filled: a mesh wholly inside a solid collides with it, a solid
/// wholly inside a closed mesh does not. **Touching counts**, to rounding: balls, capsules and half-spaces
/// collide when the distance, computed as accurately as the crate docs say, is not above zero. The same holds for cylinders
/// and cones, which take about a microsecond for each triangle that may be the nearest. The surface
/// of a box is compared exactly, as meshes are. Bad input counts as in collision with everything.
impl Query {
    /// Whether mesh and solid have a point in common.
    pub fn solid_intersects(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        solid: &Solid,
        pose_ws: &Isometry3<f64>,
    ) -> bool {
        match &solid.primitive {
            Primitive::Swept { core, radius } => self.within(mesh, pose_wm, core, pose_ws, *radius),
            Primitive::Cuboid { surface, half } => {
                self.intersects(mesh, pose_wm, surface, pose_ws)
                    || self.corner_inside((mesh, pose_wm), (surface, pose_ws), half).is_some()
            }
            Primitive::Revolved { around, frustum } => {
                self.frustum((mesh, pose_wm), (around, pose_ws), frustum, 0.0, true).is_some()
            }
            Primitive::HalfSpace => {
                self.lowest(mesh, pose_wm, pose_ws).is_none_or(|(height, _)| height <= 0.0)
            }
        }
    }

    /// The distance of mesh and solid with nearest points, in the world; `point_a` is on the mesh. It is 0
    /// exactly when [`Query::solid_intersects`] says so, and then both are a common point (the origin for
    /// bad input).
    pub fn solid_distance(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        solid: &Solid,
        pose_ws: &Isometry3<f64>,
    ) -> Separation {
        let touching = |point| Separation { distance: 0.0, point_a: point, point_b: point };
        match &solid.primitive {
            Primitive::Swept { core, radius } => {
                let hit = self.within(mesh, pose_wm, core, pose_ws, *radius);
                let to_core = self.distance(mesh, pose_wm, core, pose_ws);
                if hit {
                    return touching(to_core.point_a);
                }
                let out = (to_core.point_a - to_core.point_b) / to_core.distance;
                let distance = (to_core.distance - radius).max(f64::MIN_POSITIVE);
                Separation { distance, point_b: to_core.point_b + out * *radius, ..to_core }
            }
            Primitive::Cuboid { surface, half } => {
                let apart = self.distance(mesh, pose_wm, surface, pose_ws);
                if apart.distance <= 0.0 {
                    return apart;
                }
                self.corner_inside((mesh, pose_wm), (surface, pose_ws), half).map_or(apart, touching)
            }
            Primitive::Revolved { around, frustum } => {
                let posed = (around, pose_ws);
                let nearest = self.frustum((mesh, pose_wm), posed, frustum, f64::INFINITY, false);
                let Some(NearestPoints { distance, other, solid }) = nearest else {
                    return touching(Point3::origin());
                };
                let [point_a, point_b] = [other, solid].map(|p| to_world(pose_wm, &p));
                if distance > 0.0 { Separation { distance, point_a, point_b } } else { touching(point_a) }
            }
            Primitive::HalfSpace => match self.lowest(mesh, pose_wm, pose_ws) {
                None => touching(Point3::origin()),
                Some((height, point)) if height <= 0.0 => touching(point),
                Some((height, point)) => {
                    let up = pose_ws.rotation * Vector3::z();
                    Separation { distance: height, point_a: point, point_b: point - up * height }
                }
            },
        }
    }

    /// A lower bound on the distance of mesh and solid that is exact when below `enough` (metres) and some
    /// value of at least `enough` otherwise; 0 exactly when they intersect. NaN counts as infinity.
    pub fn solid_clearance(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        solid: &Solid,
        pose_ws: &Isometry3<f64>,
        enough: f64,
    ) -> f64 {
        match &solid.primitive {
            Primitive::Swept { core, radius } => {
                // Contact is decided first, by the same test as in `solid_intersects`.
                if self.within(mesh, pose_wm, core, pose_ws, *radius) {
                    return 0.0;
                }
                let enough = enough.max(0.0);
                let to_core = self.clearance(mesh, pose_wm, core, pose_ws, enough + radius);
                let clearance = to_core - radius;
                // A mesh far enough from the core is far enough from the solid.
                let far = to_core >= enough + radius;
                if far { clearance.max(enough) } else { clearance }.max(f64::MIN_POSITIVE)
            }
            Primitive::Cuboid { surface, half } => {
                let clearance = self.clearance(mesh, pose_wm, surface, pose_ws, enough);
                let inside = clearance > 0.0
                    && self.corner_inside((mesh, pose_wm), (surface, pose_ws), half).is_some();
                if inside { 0.0 } else { clearance }
            }
            Primitive::Revolved { around, frustum } => {
                let enough = if enough.is_nan() { f64::INFINITY } else { enough.max(0.0) };
                let nearest = self.frustum((mesh, pose_wm), (around, pose_ws), frustum, enough, false);
                nearest.map_or(enough.max(f64::MIN_POSITIVE), |apart| apart.distance)
            }
            Primitive::HalfSpace => {
                self.lowest(mesh, pose_wm, pose_ws).map_or(0.0, |(height, _)| height.max(0.0))
            }
        }
    }

    /// Whether the distance of mesh and solid is at most `tolerance` (metres), to rounding. A negative one
    /// counts as 0, NaN as infinity.
    pub fn solid_within(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        solid: &Solid,
        pose_ws: &Isometry3<f64>,
        tolerance: f64,
    ) -> bool {
        match &solid.primitive {
            Primitive::Swept { core, radius } => {
                let tolerance = if tolerance.is_nan() { f64::INFINITY } else { tolerance.max(0.0) };
                self.within(mesh, pose_wm, core, pose_ws, tolerance + radius)
            }
            Primitive::Cuboid { surface, half } => {
                self.within(mesh, pose_wm, surface, pose_ws, tolerance)
                    || self.corner_inside((mesh, pose_wm), (surface, pose_ws), half).is_some()
            }
            Primitive::Revolved { around, frustum } => {
                let tolerance = if tolerance.is_nan() { f64::INFINITY } else { tolerance.max(0.0) };
                self.frustum((mesh, pose_wm), (around, pose_ws), frustum, tolerance, true).is_some()
            }
            Primitive::HalfSpace => {
                let lowest = self.lowest(mesh, pose_wm, pose_ws);
                tolerance.is_nan() || lowest.is_none_or(|(height, _)| height <= tolerance.max(0.0))
            }
        }
    }

    /// The first corner (in the world) of some triangle inside a box; as the mesh does not meet the surface of the box,
    /// all of that triangle is inside. For bad input the origin.
    fn corner_inside(
        &mut self,
        mesh: PosedMesh<'_>,
        surface: PosedMesh<'_>,
        half: &Vector3<f64>,
    ) -> Option<Point3<f64>> {
        let Some(relative) = Relative::of(mesh, surface) else { return Some(Point3::origin()) };
        let (a, b) = (mesh.0.tree(), surface.0.tree());
        let frames = Frames::new(a, b, &relative);
        if frames.apart > (a.radius_center + b.radius_center) * (1.0 + 1e-12) + relative.slack {
            return None;
        }
        let corner = if frames.fits_f32(a, b) {
            let (stack, counters) = (&mut self.stack, &mut self.counters);
            run(self.isa, Inside { a, b, half, frames: &frames, stack, counters })
        } else {
            let mut corners = a.triangles.iter().map(|triangle| triangle[0]);
            corners.find(|corner| is_inside(corner, half, &relative))
        };
        corner.map(|corner| to_world(mesh.1, &corner))
    }

    /// Nearest points of mesh and solid in the frame of the mesh, if no farther apart than `enough` (metres); if `any`,
    /// some points no farther apart than that. For bad input the origin.
    fn frustum(
        &mut self,
        mesh: PosedMesh<'_>,
        around: PosedMesh<'_>,
        solid: &Frustum,
        enough: f64,
        any: bool,
    ) -> Option<NearestPoints> {
        self.counters.queries += 1;
        let Some(relative) = Relative::of(mesh, around) else {
            let origin = Point3::origin();
            return Some(NearestPoints { distance: 0.0, other: origin, solid: origin });
        };
        let (a, b) = (mesh.0.tree(), around.0.tree());
        let frames = Frames::new(a, b, &relative);
        if frames.apart > (a.radius_center + b.radius_center + enough) * (1.0 + 1e-12) + relative.slack {
            return None;
        }
        if frames.fits_f32(a, b) {
            let (frames, stack, counters) = (&frames, &mut self.stack, &mut self.counters);
            return run(self.isa, Revolved { a, b, solid, frames, enough, any, stack, counters });
        }
        let all = a.triangles.iter().map(|triangle| solid.near_triangle_of_a(triangle, &relative));
        all.filter(|apart| apart.distance <= enough).min_by(|x, y| x.distance.total_cmp(&y.distance))
    }

    /// How high the lowest point of the mesh is above the plane z = 0 of `pose_ws`, and that point, in the
    /// world. `None` for bad input.
    fn lowest(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        pose_ws: &Isometry3<f64>,
    ) -> Option<(f64, Point3<f64>)> {
        self.counters.queries += 1;
        let relative = Relative::between(pose_wm, mesh.radius(), pose_ws, 0.0)?;
        let up: Vector3<f64> = relative.rotation.column(2).into();
        let origin = Point3::from(relative.translation);
        let (height, point) = mesh.tree().lowest(&up, &origin, &mut self.stack, &mut self.counters);
        Some((height, to_world(pose_wm, &point)))
    }
}
