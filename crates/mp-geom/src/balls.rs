//! Meshes that are balls: point clouds, each point with a radius.

use crate::mesh::check_finite;
use crate::primitives::positive;
use crate::shape;
use crate::{PrimitiveError, Sphere, TriMesh, thin};
use nalgebra::Point3;
use std::ops::Range;
use std::sync::Arc;

/// The most balls that are drawn: more are thinned further.
const DRAWN: usize = 20_000;

/// Up to this many balls are drawn with finer facets.
const ROUND: usize = 1000;

impl TriMesh {
    /// A ball of `radius` (m) around each of `centers`: its triangles are single points.
    ///
    /// # Errors
    /// [`PrimitiveError`] when there are no centres, one is not finite, or the radius is not above zero.
    pub fn of_balls(centers: Vec<Point3<f64>>, radius: f64) -> Result<Self, PrimitiveError> {
        let radius = positive("radius", radius)?;
        if centers.is_empty() {
            return Err(PrimitiveError::NoInside { what: "a set of no points" });
        }
        check_finite(&centers)?;
        let triangles = (0..centers.len() as u32).map(|i| [i; 3]).collect();
        let mesh = Self::new(centers, triangles)?;
        let all = 0..mesh.triangles.len() as u32;
        Ok(Self { balls: Arc::new(vec![(all, radius)]), ..mesh })
    }

    /// The triangles that are single points, each the centre of a ball of this radius (m): ranges, ascending.
    /// The ball belongs to the mesh, with its inside.
    #[must_use]
    pub fn balls(&self) -> &[(Range<u32>, f64)] {
        &self.balls
    }

    /// The centre and the radius (m) of each of its [balls](Self::balls), in order.
    pub fn each_ball(&self) -> impl Iterator<Item = Sphere> + '_ {
        let ball = |i: u32, radius| Sphere { center: self.triangle(i as usize)[0], radius };
        self.balls.iter().flat_map(move |(range, radius)| range.clone().map(move |i| ball(i, *radius)))
    }

    /// Whether it is balls alone.
    #[must_use]
    pub fn is_balls(&self) -> bool {
        let count: usize = self.balls.iter().map(|(range, _)| range.len()).sum();
        count > 0 && count == self.triangles.len()
    }

    /// The same without its balls: points in their place.
    #[must_use]
    pub fn without_balls(self) -> Self {
        Self { balls: Arc::default(), ..self }
    }

    /// The largest radius (m) of its [balls](Self::balls); `None` if it has none.
    #[must_use]
    pub fn rounding(&self) -> Option<f64> {
        self.balls.iter().map(|(_, radius)| *radius).reduce(f64::max)
    }

    /// The same with triangles alone, for what knows no balls, as files of meshes do: an icosahedron around
    /// each ball, larger by at most 26%. A mesh without balls is cloned.
    #[must_use]
    pub fn faceted(&self) -> Self {
        self.with_facets(usize::MAX, 0)
    }

    /// A mesh to be drawn in its place, as [`faceted`](Self::faceted) makes it, with rounder balls where there are few. Where there are very many
    /// balls, fewer and larger ones stand for them: the picture looks the same.
    #[must_use]
    pub fn drawn(&self) -> Self {
        let count: usize = self.balls.iter().map(|(range, _)| range.len()).sum();
        self.with_facets(DRAWN, if count <= ROUND { 2 } else { 0 })
    }

    fn with_facets(&self, most: usize, divided: u32) -> Self {
        if self.balls.is_empty() {
            return self.clone();
        }
        let (mut parts, mut done) = (Vec::new(), 0);
        for (range, radius) in &*self.balls {
            parts.extend(self.part(done..range.start));
            done = range.end;
            parts.extend(self.facets(range, *radius, most, divided));
        }
        parts.extend(self.part(done..self.triangles.len() as u32));
        Self::merged(&parts).unwrap_or_else(|| self.clone())
    }

    /// Meshes around balls: as many as there are, or fewer and larger ones where there are more than `most`.
    fn facets(&self, range: &Range<u32>, radius: f64, most: usize, divided: u32) -> Option<Self> {
        let mut centers: Vec<_> = range.clone().map(|i| self.triangle(i as usize)[0]).collect();
        let mut cell = radius;
        while centers.len() > most {
            cell *= 2.0;
            centers = thin(&centers, cell).ok()?.centers;
        }
        let ball = shape::ball(if cell > radius { 0.5 * cell } else { radius }, divided).ok()?;
        let count = u32::try_from(centers.len()).ok()?;
        let each = ball.vertices().len() as u32;
        let vertices = centers.iter().flat_map(|p| ball.vertices().iter().map(move |v| v + p.coords));
        let triangles =
            (0..count).flat_map(|i| ball.triangles().iter().map(move |t| t.map(|v| v + i * each)));
        Some(Self::new(vertices.collect(), triangles.collect()).ok()?.trusted_solids(count))
    }

    /// The triangles of a range; `None` when it is empty.
    fn part(&self, range: Range<u32>) -> Option<Self> {
        (!range.is_empty()).then(|| {
            let triangles = &self.triangles[range.start as usize..range.end as usize];
            let solids = self.solids.iter().filter(|s| range.start <= s.start && s.end <= range.end);
            let solids = solids.map(|s| s.start - range.start..s.end - range.start).collect();
            Self { solids: Arc::new(solids), ..self.with_triangles(triangles.to_vec()) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::cuboid;
    use nalgebra::Isometry3;

    fn row(count: usize) -> TriMesh {
        TriMesh::of_balls((0..count).map(|i| Point3::new(i as f64, 0.0, 0.0)).collect(), 0.1).unwrap()
    }

    #[test]
    fn balls_stay_balls() {
        let cube = cuboid(1.0, 1.0, 1.0).unwrap();
        let moved = row(3).transformed(&Isometry3::translation(0.0, 5.0, 0.0));
        let merged = TriMesh::merged([&cube, &moved, &cube]).unwrap();
        assert_eq!(merged.balls(), [(12..15, 0.1)]);
        assert_eq!((merged.solids(), merged.rounding()), (&[0..12, 15..27][..], Some(0.1)));
        assert!((moved.aabb().max.y - 5.1).abs() < 1e-15 && (moved.aabb().min.x + 0.1).abs() < 1e-15);
        assert!((row(2).radius_about(&Point3::origin()) - 1.1).abs() < 1e-15);
        assert_eq!(row(2).scaled([2.0, 1.0, 1.0]).unwrap().rounding(), Some(0.2));
        assert_ne!(row(3), TriMesh::of_balls(row(3).vertices().to_vec(), 0.2).unwrap());
        assert_eq!(row(3).component_vertices(), row(3).vertices());
    }

    #[test]
    fn facets_are_around_balls() {
        let cube = cuboid(1.0, 1.0, 1.0).unwrap();
        let mesh = TriMesh::merged([&cube, &row(2), &cube]).unwrap().faceted();
        assert_eq!(mesh.solids(), [0..12, 12..32, 32..52, 52..64]);
        assert!(
            mesh.balls().is_empty() && mesh.winding_number_of(12..32, &Point3::new(0.0999, 0.0, 0.0)) > 0.9
        );
        assert_eq!(cube.faceted(), cube);
        let (many, drawn) = (row(50_000), row(50_000).drawn());
        assert!(drawn.triangles().len() <= 20 * DRAWN && many.faceted().triangles().len() == 1_000_000);
        let [a, b] = [many.aabb(), drawn.aabb()];
        assert!((a.max.x - b.max.x).abs() < 4.0 && (a.min.x - b.min.x).abs() < 4.0);
    }

    #[test]
    fn what_is_no_ball() {
        let p = Point3::origin();
        for (centers, radius) in
            [(vec![], 0.1), (vec![p], 0.0), (vec![p], f64::NAN), (vec![p * f64::NAN], 0.1)]
        {
            assert!(TriMesh::of_balls(centers, radius).is_err());
        }
    }
}
