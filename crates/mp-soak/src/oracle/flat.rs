//! Distances in the plane between outlines and discs.

/// A point of the plane.
pub(super) type P = [f64; 2];

/// A shape in the plane, in the frame of the world.
#[derive(Clone, Debug)]
pub(super) enum Flat {
    /// Closed rings. If they are filled, a point is inside when an odd number of rings goes around it.
    Rings { rings: Vec<Vec<P>>, filled: bool },
    /// A filled disc.
    Disc { middle: P, radius: f64 },
}

fn sub(a: P, b: P) -> P {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: P, b: P) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: P, b: P) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn edges(ring: &[P]) -> impl Iterator<Item = (P, P)> {
    ring.iter().enumerate().map(|(i, p)| (*p, ring[(i + 1) % ring.len()]))
}

fn point_segment(p: P, a: P, b: P) -> f64 {
    let (along, to) = (sub(b, a), sub(p, a));
    let square = dot(along, along);
    let t = if square > 0.0 { (dot(to, along) / square).clamp(0.0, 1.0) } else { 0.0 };
    let off = [to[0] - t * along[0], to[1] - t * along[1]];
    dot(off, off).sqrt()
}

fn segments(a: P, b: P, c: P, d: P) -> f64 {
    let side = |p: P, q: P, r: P| cross(sub(q, p), sub(r, p));
    let crosses = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
    if crosses {
        return 0.0;
    }
    let ends = point_segment(a, c, d).min(point_segment(b, c, d));
    ends.min(point_segment(c, a, b)).min(point_segment(d, a, b))
}

/// Whether a ray from `p` crosses the rings an odd number of times.
fn inside(p: P, rings: &[Vec<P>]) -> bool {
    let crosses = |(a, b): &(P, P)| {
        (a[1] > p[1]) != (b[1] > p[1]) && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
    };
    rings.iter().flat_map(|ring| edges(ring)).filter(crosses).count() % 2 == 1
}

/// The distance (m) between two shapes; 0 where they touch or one is inside of the other.
pub(super) fn between(a: &Flat, b: &Flat) -> f64 {
    match (a, b) {
        (Flat::Disc { middle: p, radius: r }, Flat::Disc { middle: q, radius: s }) => {
            let off = sub(*p, *q);
            (dot(off, off).sqrt() - r - s).max(0.0)
        }
        (Flat::Disc { middle, radius }, Flat::Rings { rings, filled })
        | (Flat::Rings { rings, filled }, Flat::Disc { middle, radius }) => {
            if *filled && inside(*middle, rings) {
                return 0.0;
            }
            let all = rings.iter().flat_map(|ring| edges(ring));
            let least = all.map(|(a, b)| point_segment(*middle, a, b)).fold(f64::INFINITY, f64::min);
            (least - radius).max(0.0)
        }
        (Flat::Rings { rings: a, filled: a_filled }, Flat::Rings { rings: b, filled: b_filled }) => {
            // A ring that is wholly inside has each of its corners inside.
            let holds = |outer: &[Vec<P>], filled: bool, inner: &[Vec<P>]| {
                filled && inner.iter().any(|ring| ring.first().is_some_and(|p| inside(*p, outer)))
            };
            if holds(a, *a_filled, b) || holds(b, *b_filled, a) {
                return 0.0;
            }
            let mut least = f64::INFINITY;
            for (p, q) in a.iter().flat_map(|ring| edges(ring)) {
                for (r, s) in b.iter().flat_map(|ring| edges(ring)) {
                    least = least.min(segments(p, q, r, s));
                }
            }
            least
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, half: f64) -> Vec<P> {
        vec![[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]]
    }

    #[test]
    fn shapes_inside_of_others_touch_them() {
        let filled = |rings: Vec<Vec<P>>| Flat::Rings { rings, filled: true };
        let outer = filled(vec![square(0.0, 0.0, 3.0)]);
        let small = filled(vec![square(0.5, 0.5, 0.25)]);
        let frame = filled(vec![square(0.0, 0.0, 3.0), square(0.0, 0.0, 2.0)]);
        assert_eq!(between(&outer, &small), 0.0);
        assert_eq!(between(&small, &outer), 0.0);
        assert_eq!(between(&frame, &small), 1.25);
        let wall = Flat::Rings { rings: vec![square(0.0, 0.0, 3.0)], filled: false };
        assert_eq!(between(&wall, &small), 2.25);
        let disc = |x, radius| Flat::Disc { middle: [x, 0.0], radius };
        assert_eq!(between(&disc(0.0, 1.0), &disc(3.0, 0.5)), 1.5);
        assert_eq!(between(&disc(0.0, 1.0), &outer), 0.0);
        assert_eq!(between(&disc(0.0, 1.0), &frame), 1.0);
        assert_eq!(between(&disc(5.0, 1.0), &frame), 1.0);
        assert_eq!(between(&filled(vec![square(7.0, 0.0, 1.0)]), &outer), 3.0);
        assert_eq!(between(&filled(vec![square(3.5, 0.0, 1.0)]), &outer), 0.0);
    }
}
