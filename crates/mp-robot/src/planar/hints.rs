//! Directions along obstacles in the plane, from their boundaries.

use super::{DiscRobot, PolygonRobot};
use mp_cspace::{Rng, Se2State, Validity, obstacles::ObstacleHints};
use mp_geom::planar::PlanarWorld;
use nalgebra::{Point2, Vector2};
use rand::RngExt;

/// A random unit vector along a boundary, either way: along the boundary nearest to `hit`, or without `hit` along a random
/// edge of a random obstacle.
fn along(world: &PlanarWorld, hit: Option<Vector2<f64>>, rng: &mut Rng) -> Option<Vector2<f64>> {
    let along = match hit {
        Some(q) => {
            let p = Point2::from(q);
            let away = p - world.nearest(&p)?.point;
            Vector2::new(-away.y, away.x)
        }
        None if world.polygons().is_empty() => return None,
        None => {
            let polygon = &world.polygons()[rng.random_range(0..world.polygons().len())];
            let [a, b] = polygon.edges().nth(rng.random_range(0..polygon.edges().count()))?;
            b - a
        }
    };
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    along.try_normalize(0.0).map(|v| v * sign)
}

/// From the boundary nearest to the centre.
impl ObstacleHints<Vector2<f64>> for DiscRobot {
    fn touches(&mut self, q: &Vector2<f64>) -> bool {
        !self.is_valid(q)
    }
    fn slide_along(
        &mut self,
        from: &Vector2<f64>,
        toward: &Vector2<f64>,
        hit: Option<&Vector2<f64>>,
        rng: &mut Rng,
    ) -> Option<Vector2<f64>> {
        Some(from + along(self.world(), hit.copied(), rng)? * (toward - from).norm())
    }
    fn moved_by(&self, q: &Vector2<f64>, from: &Vector2<f64>, to: &Vector2<f64>) -> Vector2<f64> {
        q + (to - from)
    }
}

/// From the boundary nearest to the origin of the body.
impl ObstacleHints<Se2State> for PolygonRobot {
    fn touches(&mut self, q: &Se2State) -> bool {
        !self.is_valid(q)
    }
    fn slide_along(
        &mut self,
        from: &Se2State,
        toward: &Se2State,
        hit: Option<&Se2State>,
        rng: &mut Rng,
    ) -> Option<Se2State> {
        let far = (toward.translation - from.translation).norm();
        let step = along(self.world(), hit.map(|q| q.translation), rng)? * far;
        Some(Se2State { translation: from.translation + step, ..*from })
    }
    fn moved_by(&self, q: &Se2State, from: &Se2State, to: &Se2State) -> Se2State {
        let at = q.translation + (to.translation - from.translation);
        Se2State::new(at.x, at.y, q.angle + (to.angle - from.angle))
    }
}
