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

/// How often the facets around balls are divided: three times for up to this many balls, which makes them larger than the ball by less than
/// 2%, twice (7%) for up to the second number, and not at all for more.
const ROUND: [usize; 3] = [100, 1000, 1000];

/// The same for what is drawn; up to the last number they are divided once.
const DRAWN_ROUND: [usize; 3] = [30, 300, 3000];

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
        let count = self.count_of_balls();
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

    /// The same with triangles alone, for what knows no balls, as files of meshes do: flat faces around each
    /// ball, larger than it by less than 2% (up to 100 balls), 7% (up to 1000) or 26%. A mesh without balls is
    /// cloned.
    #[must_use]
    pub fn faceted(&self) -> Self {
        self.with_facets(usize::MAX, divisions(self.count_of_balls(), ROUND))
    }

    /// A mesh to be drawn in its place, as [`faceted`](Self::faceted) makes it, in a picture of `together`
    /// balls: the more there are, the fewer faces each has. Where there are very many balls, fewer and larger
    /// ones stand for them: the picture looks the same.
    #[must_use]
    pub fn drawn(&self, together: usize) -> Self {
        self.with_facets(DRAWN, divisions(together.max(self.count_of_balls()), DRAWN_ROUND))
    }

    /// How many of its triangles are [balls](Self::balls).
    #[must_use]
    pub fn count_of_balls(&self) -> usize {
        self.balls.iter().map(|(range, _)| range.len()).sum()
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

/// How often the facets around `count` balls are divided.
fn divisions(count: usize, few: [usize; 3]) -> u32 {
    few.map(|few| u32::from(count <= few)).iter().sum()
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
        let larger = TriMesh::of_balls(vec![Point3::origin()], 0.2).unwrap();
        let together = TriMesh::merged([&row(1), &moved, &larger, &cube, &row(1)]).unwrap();
        assert_eq!(together.balls(), [(0..4, 0.1), (4..5, 0.2), (17..18, 0.1)], "runs of equal radius");
        assert_eq!((merged.solids(), merged.rounding()), (&[0..12, 15..27][..], Some(0.1)));
        assert!((moved.aabb().max.y - 5.1).abs() < 1e-15 && (moved.aabb().min.x + 0.1).abs() < 1e-15);
        assert!((row(2).radius_about(&Point3::origin()) - 1.1).abs() < 1e-15);
        assert_eq!(row(2).scaled([2.0, -2.0, 2.0]).unwrap().rounding(), Some(0.2));
        let ellipsoids = row(2).scaled([2.0, 1.0, 1.0]).unwrap().aabb();
        assert!((2.2..2.204).contains(&ellipsoids.max.x) && (0.1..0.102).contains(&ellipsoids.max.z));
        assert_ne!(row(3), TriMesh::of_balls(row(3).vertices().to_vec(), 0.2).unwrap());
        assert_eq!(row(3).component_vertices(), row(3).vertices());
    }

    #[test]
    fn facets_are_around_balls() {
        let cube = cuboid(1.0, 1.0, 1.0).unwrap();
        let mesh = TriMesh::merged([&cube, &row(2), &cube]).unwrap().faceted();
        assert_eq!(mesh.solids(), [0..12, 12..1292, 1292..2572, 2572..2584]);
        assert!(
            mesh.balls().is_empty() && mesh.winding_number_of(12..1292, &Point3::new(0.0999, 0.0, 0.0)) > 0.9
        );
        assert_eq!(row(101).faceted().triangles().len(), 101 * 320);
        assert_eq!(cube.faceted(), cube);
        assert_eq!([0, 31, 301, 3001].map(|n| row(1).drawn(n).triangles().len()), [1280, 320, 80, 20]);
        let (many, drawn) = (row(50_000), row(50_000).drawn(0));
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
