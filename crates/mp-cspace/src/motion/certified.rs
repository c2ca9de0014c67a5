//! The certified motion check: compares clearance with a bound on how far the robot travels.

use super::discrete::bit_reversed;
use crate::{
    IntervalClearance, KnownFree, MotionCheck, MotionClearance, MotionInterval, MotionValidity,
    ParameterError, Space,
};
use std::collections::VecDeque;

/// Proves motions free: no motion found free passes through an obstacle, however thin.
///
/// Where the robot has clearance `c` and no point of it travels farther than `L` over the whole
/// motion, all states within a fraction `(c - margin) / L` of the motion to either side have
/// clearance at least `margin`. The check covers the motion with such intervals: first one in the
/// middle, then in the middles of the uncovered parts, in order of size, so that the parts about
/// which least is known come first.
///
/// With `margin = tolerance / 2`:
/// - a motion found free has clearance at least `margin` **all along it**, so an independent
///   verifier that requires less always agrees;
/// - a motion whose clearance (as [`Clearance`](crate::Clearance) bounds it) is at least `tolerance` all
///   along is found free;
/// - a motion whose least clearance is between the two may be [`Unproven`](MotionCheck::Unproven), which
///   planners treat as a collision.
///
/// Contact is tested first: at the end, and at some states between where
/// [that is cheap](MotionClearance::contact_first). At most `4·L / tolerance + 2` intervals are queried. The
/// farther a distance query reaches the more it costs, so no interval is longer than twice the
/// [stride](Certified::with_stride).
///
/// The idea is conservative advancement (Mirtich 1996), bisected as in Schwarzer, Saha and
/// Latombe 2005, *Adaptive dynamic collision checking for single and multiple articulated robots*.
#[derive(Clone, Debug)]
pub struct Certified<'c, C: Space, V> {
    /// The space to interpolate in.
    pub space: &'c C,
    /// The robot among its obstacles.
    pub valid: V,
    tolerance: f64,
    stride: f64,
    /// Parts of the motion not yet covered, each from one fraction to another.
    uncovered: VecDeque<(f64, f64)>,
    /// States that are tested for contact together: scratch memory.
    states: [Option<C::State>; MOST_AT_ONCE - 1],
}

/// Motions longer than this many tolerances are refused: rounding would be a thousandth of a tolerance.
const MAX_TOLERANCES: f64 = 1e12;

/// Uncovered parts shorter than this fraction of the motion come from rounding.
const ROUNDING: f64 = 1e-15;

/// Robots are told of at most this many intervals ahead.
const MOST_AT_ONCE: usize = 8;

/// A part of a motion from `a` to `b`, all fractions of it: the interval of `half` to either side of `at` is asked about.
#[derive(Clone, Copy, Default)]
struct Part {
    a: f64,
    b: f64,
    at: f64,
    half: f64,
}

impl<'c, C, V> Certified<'c, C, V>
where
    C: Space,
    V: MotionClearance<C::State>,
{
    /// Certifies motions in `space` to `tolerance` metres, by strides of 2% of its extent.
    ///
    /// # Errors
    /// When the tolerance is not positive and finite.
    pub fn new(space: &'c C, valid: V, tolerance: f64) -> Result<Self, ParameterError> {
        let tolerance = ParameterError::positive("the tolerance", tolerance)?;
        Ok(Self {
            space,
            valid,
            tolerance,
            stride: 0.02 * space.extent(),
            uncovered: VecDeque::new(),
            states: [const { None }; MOST_AT_ONCE - 1],
        })
    }

    /// The same with strides of `stride` metres: clearance queries reach no farther than that plus the
    /// margin. Changes the cost, and which of the motions near the tolerance are accepted.
    ///
    /// # Errors
    /// When the stride is not positive and finite.
    pub fn with_stride(self, stride: f64) -> Result<Self, ParameterError> {
        Ok(Self { stride: ParameterError::positive("the stride", stride)?, ..self })
    }

    /// Motions with at least this clearance (m) are accepted.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Accepted motions have at least this clearance (m): half the tolerance.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.tolerance * 0.5
    }

    /// The first fraction with contact among states two strides apart, between the ends of a motion in which
    /// no point travels farther than `travel`: the middle first, then the quarters, …
    fn contact(&mut self, from: &C::State, to: &C::State, travel: f64) -> Option<f64> {
        let parts = (0.5 * travel / self.stride.max(self.margin())).ceil() as u64;
        let mut q = from.clone();
        bit_reversed(parts).map(|i| i as f64 / parts as f64).find(|at| {
            self.space.interpolate_into(from, to, *at, &mut q);
            self.valid.in_contact(&q)
        })
    }

    /// The fraction of a state with contact: of `end`, which is at a fraction of the motion, and seven states evenly between the ends.
    fn contact_of_eight(&mut self, [from, to]: [&C::State; 2], (end, at): (&C::State, f64)) -> Option<f64> {
        const BETWEEN: [f64; MOST_AT_ONCE - 1] = [0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875];
        for (between, state) in BETWEEN.iter().zip(&mut self.states) {
            let state = state.get_or_insert_with(|| from.clone());
            self.space.interpolate_into(from, to, *between, state);
        }
        let states: [&C::State; MOST_AT_ONCE] = std::array::from_fn(|k| match k.checked_sub(1) {
            Some(k) => self.states[k].as_ref().unwrap_or(end),
            None => end,
        });
        let found = self.valid.first_within(&states, 0.0)?;
        Some(found.checked_sub(1).map_or(at, |k| BETWEEN[k]))
    }

    /// Takes the next parts to ask about from those not yet covered, and puts the middles of their intervals into `middles`. Returns how many.
    fn next_parts(
        &mut self,
        [from, to]: [&C::State; 2],
        pieces: impl Fn(f64) -> f64,
        parts: &mut [Part],
        middles: &mut [Option<C::State>],
    ) -> usize {
        let mut count = 0;
        while count < parts.len()
            && let Some((a, b)) = self.uncovered.pop_front()
        {
            let at = 0.5 * (a + b);
            // An odd number of pieces has one in the middle.
            let pieces = pieces(b - a);
            if pieces % 2.0 == 0.0 {
                self.uncovered.extend([(a, at), (at, b)]);
                continue;
            }
            let middle = middles[count].get_or_insert_with(|| from.clone());
            self.space.interpolate_into(from, to, at, middle);
            parts[count] = Part { a, b, at, half: 0.5 * (b - a) / pieces };
            count += 1;
        }
        count
    }

    /// How far to either side of its middle the interval of `part` is shown free, as a fraction of the motion, on which no point travels farther
    /// than `travel` (m); and a bound on the clearance there. An answer if the motion is not shown free.
    fn covered(
        &mut self,
        interval: &MotionInterval<'_, C::State>,
        part: &Part,
        travel: f64,
    ) -> Result<(f64, f64), MotionCheck> {
        let MotionInterval { from, to, margin, half, .. } = *interval;
        match self.valid.interval_clearance(interval) {
            IntervalClearance::Collision { at: offset } => {
                let at = part.at + half * offset;
                let mut q = from.clone();
                self.space.interpolate_into(from, to, at, &mut q);
                // This state may differ by rounding from the one the robot found in contact.
                let collides = offset == 0.0 || self.valid.in_contact(&q);
                Err(if collides { MotionCheck::Collision { at } } else { MotionCheck::Unproven { at } })
            }
            IntervalClearance::TooClose { at: offset } => {
                Err(MotionCheck::Unproven { at: part.at + half * offset })
            }
            IntervalClearance::Unproven if interval.travel <= margin => {
                Err(MotionCheck::Unproven { at: part.at })
            }
            IntervalClearance::Unproven => Ok((0.0, f64::INFINITY)),
            IntervalClearance::FreeOver { part } => Ok((part, margin)),
            IntervalClearance::Free { clearance } => {
                let reach = (clearance - margin) / travel;
                let covered = if clearance >= interval.travel + margin { reach.max(half) } else { reach };
                // The clearance at the ends of the covered part, as far as that is in this part.
                let farthest = covered.min(part.b - part.at) * travel;
                Ok((covered, (clearance - farthest).max(margin)))
            }
        }
    }

    /// Covers the motion with intervals proved free. No point of the robot travels farther than `travel`
    /// (m) on it.
    fn cover(&mut self, from: &C::State, to: &C::State, travel: f64) -> MotionCheck {
        let margin = self.margin();
        let stride = self.stride.max(margin);
        // How many equal intervals of at most two strides a part takes.
        let pieces = |part: f64| (0.5 * part * travel / stride).ceil().max(1.0);
        let mut least = f64::INFINITY;
        let at_once = self.valid.intervals_at_once().clamp(1, MOST_AT_ONCE);
        let mut middles = [const { None }; MOST_AT_ONCE];
        let mut parts = [Part::default(); MOST_AT_ONCE];
        self.uncovered.clear();
        match at_once == MOST_AT_ONCE {
            // Eight parts are asked about together as soon as one, and need less clearance.
            true => self
                .uncovered
                .extend(bit_reversed(8).chain([0]).map(|i| (i as f64 / 8.0, (i + 1) as f64 / 8.0))),
            false => self.uncovered.push_back((0.0, 1.0)),
        }
        loop {
            let count = self.next_parts([from, to], pieces, &mut parts[..at_once], &mut middles);
            if count == 0 {
                return MotionCheck::Free { clearance: least };
            }
            let interval = |k: usize| {
                let half = parts[k].half;
                let middle = middles[k].as_ref().unwrap_or(from);
                MotionInterval { from, to, middle, half, travel: half * travel, margin }
            };
            if count > 1 {
                let all: [_; MOST_AT_ONCE] = std::array::from_fn(|k| interval(k.min(count - 1)));
                self.valid.look_ahead(&all[..count]);
            }
            for (k, part) in parts[..count].iter().enumerate() {
                let (covered, clearance) = match self.covered(&interval(k), part, travel) {
                    Ok(found) => found,
                    Err(answer) => return answer,
                };
                least = least.min(clearance);
                let Part { a, b, at, .. } = *part;
                // The uncovered rest on either side, unless it is rounding.
                if at - covered > a + ROUNDING {
                    self.uncovered.push_back((a, at - covered));
                }
                if at + covered < b - ROUNDING {
                    self.uncovered.push_back((at + covered, b));
                }
            }
        }
    }
}

impl<C, V> MotionValidity<C::State> for Certified<'_, C, V>
where
    C: Space,
    V: MotionClearance<C::State>,
{
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }

    fn check_extension(&mut self, from: &C::State, to: &C::State, known: KnownFree) -> MotionCheck {
        // Contact is likeliest at the end that is not known to be free.
        let (end, at) = if known == KnownFree::To { (from, 0.0) } else { (to, 1.0) };
        let eight = self.valid.contacts_at_once() >= MOST_AT_ONCE;
        // Before the bound on travel, which takes nearly as long for arms of many links.
        if eight && let Some(at) = self.contact_of_eight([from, to], (end, at)) {
            return MotionCheck::Collision { at };
        }
        let travel = self.valid.motion_bound(from, to);
        // Written so that NaN fails it too.
        let provable = travel / self.tolerance < MAX_TOLERANCES;
        if !provable {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if !eight && self.valid.in_contact(end) {
            return MotionCheck::Collision { at };
        }
        if self.valid.contact_first()
            && let Some(at) = self.contact(from, to, travel)
        {
            return MotionCheck::Collision { at };
        }
        self.cover(from, to, travel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Clearance;
    use crate::{Rn, Rng};
    use nalgebra::Vector2;
    use rand::RngExt;
    use std::cell::Cell;

    /// A point among discs; counts its queries.
    #[derive(Default)]
    struct Discs {
        discs: Vec<(Vector2<f64>, f64)>,
        queries: Cell<u32>,
    }

    impl Discs {
        fn exact(&self, q: &Vector2<f64>) -> f64 {
            self.discs.iter().map(|(c, r)| (q - c).norm() - r).fold(f64::INFINITY, f64::min)
        }
        /// Clearance along a segment.
        fn along(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
            let u = b - a;
            let to_disc = |c: &Vector2<f64>| {
                let t = ((c - a).dot(&u) / u.norm_squared().max(1e-300)).clamp(0.0, 1.0);
                (a + u * t - c).norm()
            };
            self.discs.iter().map(|(c, r)| to_disc(c) - r).fold(f64::INFINITY, f64::min)
        }
    }
    impl Clearance<Vector2<f64>> for Discs {
        fn clearance(&mut self, q: &Vector2<f64>, enough: f64) -> f64 {
            self.queries.set(self.queries.get() + 1);
            let exact = self.exact(q).max(0.0);
            // Any answer of at least `enough` is allowed: the least helpful is `enough`.
            exact.min(enough)
        }
        fn in_contact(&mut self, q: &Vector2<f64>) -> bool {
            self.exact(q) <= 0.0
        }
    }
    impl MotionClearance<Vector2<f64>> for Discs {
        fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
            (to - from).norm()
        }
    }

    /// The same, proving nothing beyond the interval, as a swept test does.
    struct Swept(Discs);
    impl Clearance<Vector2<f64>> for Swept {
        fn clearance(&mut self, q: &Vector2<f64>, enough: f64) -> f64 {
            self.0.clearance(q, enough)
        }
    }
    impl MotionClearance<Vector2<f64>> for Swept {
        fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
            self.0.motion_bound(from, to)
        }
        fn interval_clearance(&mut self, interval: &MotionInterval<'_, Vector2<f64>>) -> IntervalClearance {
            self.0.queries.set(self.0.queries.get() + 1);
            let part = (interval.to - interval.from) * interval.half;
            let middle = *interval.middle;
            assert!((part.norm() - interval.travel).abs() < 1e-12);
            let places = [-0.9, -0.3, 0.0, 0.3, 0.9];
            let contact = places.into_iter().find(|at| self.0.exact(&(middle + part * *at)) <= 0.0);
            if let Some(at) = contact {
                IntervalClearance::Collision { at }
            } else if self.0.along(&(middle - part), &(middle + part)) >= interval.margin {
                IntervalClearance::Free { clearance: interval.travel + interval.margin }
            } else {
                IntervalClearance::Unproven
            }
        }
        fn contact_first(&self) -> bool {
            self.0.discs.len() == 2
        }
    }

    #[test]
    fn keeps_its_promises_with_a_swept_test() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(8);
        let tolerance = 0.01;
        let mut hits = 0;
        for round in 0..5000 {
            let discs = (0..2 + round % 2).map(|_| (space.sample_uniform(&mut rng), 0.1)).collect();
            let discs = Discs { discs, ..Discs::default() };
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let exact = discs.along(&a, &b);
            let stride = rng.random_range(0.001..0.5);
            let mut check =
                Certified::new(&space, Swept(discs), tolerance).unwrap().with_stride(stride).unwrap();
            match check.check_motion(&a, &b) {
                MotionCheck::Free { clearance } => {
                    assert!(clearance >= tolerance / 2.0 && clearance <= exact + 1e-12);
                }
                MotionCheck::Collision { at } => {
                    assert!(check.valid.0.exact(&a.lerp(&b, at)) <= 0.0);
                    hits += 1;
                }
                MotionCheck::Unproven { .. } => assert!(exact < tolerance),
            }
            let bound = 4.0 * (b - a).norm() / tolerance + 2.0;
            assert!(f64::from(check.valid.0.queries.get()) <= bound);
        }
        assert!(hits > 1000, "{hits}");
    }

    #[test]
    fn keeps_its_promises_on_random_segments() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(5);
        let tolerance = 0.01;
        let (mut free, mut refused) = (0, 0);
        for _ in 0..20_000 {
            let discs = (0..3).map(|_| (space.sample_uniform(&mut rng), 0.1)).collect();
            let discs = Discs { discs, ..Discs::default() };
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let exact = discs.along(&a, &b);
            let mut check = Certified::new(&space, discs, tolerance).unwrap();
            match check.check_motion(&a, &b) {
                MotionCheck::Free { clearance } => {
                    assert!(clearance >= tolerance / 2.0 && clearance <= exact + 1e-12);
                    free += 1;
                }
                MotionCheck::Collision { at } => {
                    assert!(check.valid.exact(&a.lerp(&b, at)) <= 0.0);
                    refused += 1;
                }
                MotionCheck::Unproven { at } => {
                    assert!(check.valid.exact(&a.lerp(&b, at)) < tolerance && exact < tolerance);
                }
            }
            let bound = 4.0 * (b - a).norm() / tolerance + 2.0;
            assert!(f64::from(check.valid.queries.get()) <= bound);
        }
        assert!(free > 2000 && refused > 2000);
    }

    /// Answers beyond `enough`, as bounds on boxes give, cover far beyond the interval: the clearance
    /// reported is that at the ends of the covered part.
    #[test]
    fn reports_no_more_clearance_than_there_is() {
        struct Generous(Discs);
        impl Clearance<Vector2<f64>> for Generous {
            fn clearance(&mut self, q: &Vector2<f64>, _: f64) -> f64 {
                self.0.exact(q).max(0.0)
            }
        }
        impl MotionClearance<Vector2<f64>> for Generous {
            fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
                self.0.motion_bound(from, to)
            }
        }
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(2);
        let mut free = 0;
        for _ in 0..2000 {
            let discs = Discs { discs: vec![(space.sample_uniform(&mut rng), 0.1)], ..Discs::default() };
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let exact = discs.along(&a, &b);
            let check = Certified::new(&space, Generous(discs), 0.01).unwrap();
            if let MotionCheck::Free { clearance } = check.with_stride(0.02).unwrap().check_motion(&a, &b) {
                assert!(clearance <= exact + 1e-12, "{clearance} {exact}");
                free += 1;
            }
        }
        assert!(free > 500);
    }

    /// Where an answer names a part, only that part counts as covered.
    #[test]
    fn keeps_its_promises_by_parts() {
        struct Parts(Discs);
        impl Clearance<Vector2<f64>> for Parts {
            fn clearance(&mut self, q: &Vector2<f64>, enough: f64) -> f64 {
                self.0.clearance(q, enough)
            }
        }
        impl MotionClearance<Vector2<f64>> for Parts {
            fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
                self.0.motion_bound(from, to)
            }
            fn interval_clearance(
                &mut self,
                interval: &MotionInterval<'_, Vector2<f64>>,
            ) -> IntervalClearance {
                self.0.queries.set(self.0.queries.get() + 1);
                let clearance = self.0.exact(interval.middle);
                match IntervalClearance::of(clearance, interval.margin) {
                    IntervalClearance::Free { clearance } => {
                        let travel = (interval.to - interval.from).norm();
                        IntervalClearance::FreeOver { part: (clearance - interval.margin) / travel }
                    }
                    other => other,
                }
            }
        }
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(12);
        let tolerance = 0.01;
        for _ in 0..5000 {
            let discs = (0..3).map(|_| (space.sample_uniform(&mut rng), 0.1)).collect();
            let discs = Discs { discs, ..Discs::default() };
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let exact = discs.along(&a, &b);
            let mut check = Certified::new(&space, Parts(discs), tolerance).unwrap();
            match check.check_motion(&a, &b) {
                MotionCheck::Free { clearance } => {
                    assert!(clearance >= tolerance / 2.0 && clearance <= exact + 1e-12);
                }
                _ => assert!(exact < tolerance),
            }
            let bound = 4.0 * (b - a).norm() / tolerance + 2.0;
            assert!(f64::from(check.valid.0.queries.get()) <= bound);
        }
    }

    /// The same whatever number of intervals a robot asks to know ahead, of which it is told all that follow.
    #[test]
    fn keeps_its_promises_when_it_looks_ahead() {
        struct Ahead(Discs, usize, VecDeque<(Vector2<f64>, f64)>);
        impl Clearance<Vector2<f64>> for Ahead {
            fn clearance(&mut self, q: &Vector2<f64>, enough: f64) -> f64 {
                self.0.clearance(q, enough)
            }
        }
        impl MotionClearance<Vector2<f64>> for Ahead {
            fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
                self.0.motion_bound(from, to)
            }
            fn intervals_at_once(&self) -> usize {
                self.1
            }
            fn look_ahead(&mut self, intervals: &[MotionInterval<'_, Vector2<f64>>]) {
                assert!((2..=self.1).contains(&intervals.len()) && self.2.is_empty());
                self.2.extend(intervals.iter().map(|i| (*i.middle, i.half)));
            }
            fn interval_clearance(
                &mut self,
                interval: &MotionInterval<'_, Vector2<f64>>,
            ) -> IntervalClearance {
                if let Some(told) = self.2.pop_front() {
                    assert_eq!(told, (*interval.middle, interval.half));
                }
                self.0.interval_clearance(interval)
            }
        }
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(13);
        let tolerance = 0.01;
        let (mut free, mut refused) = (0, 0);
        for round in 0..4000 {
            let discs = (0..3).map(|_| (space.sample_uniform(&mut rng), 0.1)).collect();
            let discs = Discs { discs, ..Discs::default() };
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let exact = discs.along(&a, &b);
            let ahead = Ahead(discs, [0, 1, 2, 7, 100][round % 5], VecDeque::new());
            let mut check = Certified::new(&space, ahead, tolerance).unwrap();
            if check.check_motion(&a, &b).is_free() {
                assert!(exact >= tolerance / 2.0);
                free += 1;
            } else {
                assert!(exact < tolerance);
                refused += 1;
            }
        }
        assert!(free > 500 && refused > 500, "{free} {refused}");
    }

    /// Motions never pass walls of thickness 0.1 to 1e-12, from either side.
    #[test]
    fn no_wall_is_too_thin() {
        struct Wall(f64);
        impl Clearance<Vector2<f64>> for Wall {
            fn clearance(&mut self, q: &Vector2<f64>, _: f64) -> f64 {
                ((q.x - 0.3).abs() - self.0 / 2.0).max(0.0)
            }
        }
        impl MotionClearance<Vector2<f64>> for Wall {
            fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
                (to - from).norm()
            }
        }
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(6);
        for exponent in 1..=12 {
            let mut check = Certified::new(&space, Wall(mp_math::powi(0.1, exponent)), 1e-4).unwrap();
            for _ in 0..500 {
                let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
                if (a.x < 0.3) != (b.x < 0.3) {
                    assert!(!check.check_motion(&a, &b).is_free());
                }
            }
        }
    }

    /// As of a small body over a long way.
    #[test]
    fn long_motions_are_checked() {
        let space = Rn::<2>::new([0.0, 0.0], [1e6, 1.0]).unwrap();
        let discs = Discs { discs: vec![(Vector2::new(123_456.7, 0.5), 0.1)], ..Discs::default() };
        let mut check = Certified::new(&space, discs, 1e-5).unwrap();
        for (y, free) in [(0.1, true), (0.6002, true), (0.39998, true), (0.59999, false), (0.5, false)] {
            let found = check.check_motion(&Vector2::new(0.0, y), &Vector2::new(1e6, y));
            let off = found.failed_at().map(|at| (1e6 * at - 123_456.7).abs());
            assert!(found.is_free() == free && off.is_none_or(|off| off < 0.1), "{y}: {found:?}");
        }
    }

    #[test]
    fn standing_still_and_bad_states() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let discs = || Discs { discs: vec![(Vector2::new(0.5, 0.5), 0.1)], ..Discs::default() };
        let mut check = Certified::new(&space, discs(), 0.01).unwrap();
        let (inside, near, out) = (Vector2::new(0.5, 0.5), Vector2::new(0.603, 0.5), Vector2::new(0.8, 0.5));
        assert_eq!(check.check_motion(&inside, &inside), MotionCheck::Collision { at: 1.0 });
        assert_eq!(check.check_motion(&near, &near), MotionCheck::Unproven { at: 0.5 });
        assert!(check.check_motion(&out, &out).is_free());
        for x in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(!check.check_motion(&out, &Vector2::new(x, 0.0)).is_free());
        }
        for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Certified::new(&space, discs(), tolerance).is_err());
        }
    }
}
