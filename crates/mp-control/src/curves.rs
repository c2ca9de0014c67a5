//! Shortest curves of cars: those of Dubins, which drive forward only, and those of Reeds and Shepp, which
//! also reverse.
//!
//! L. E. Dubins, *On curves of minimal length with a constraint on average curvature*, American Journal of
//! Mathematics 79, 1957; J. A. Reeds and L. A. Shepp, *Optimal paths for a car that goes both forwards and
//! backwards*, Pacific Journal of Mathematics 145, 1990, whose formulas have their numbers here.

use mp_cspace::{Se2State, angle::wrap_angle};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A part of a curve: an arc of the smallest circle, or a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePart {
    /// 1 to the left, −1 to the right, 0 straight.
    pub turn: f64,
    /// Its length (m), negative in reverse.
    pub length: f64,
}

/// A part of a curve for a turning radius of 1.
type Part = (f64, f64);
const L: f64 = 1.0;
const S: f64 = 0.0;
const R: f64 = -1.0;

/// The shortest curve from one pose to another of a car that drives forward only and turns in circles of
/// `radius` (m), positive and finite: at most three parts, none for equal poses.
#[must_use]
pub fn dubins(from: &Se2State, to: &Se2State, radius: f64) -> Vec<CurvePart> {
    let [x, y, phi] = seen_from(from, to, radius);
    let (d, theta) = (mp_math::hypot(x, y), mp_math::atan2(y, x));
    let (a, b) = (forward(-theta), forward(phi - theta));
    let ((sa, ca), (sb, cb), cab) = (mp_math::sin_cos(a), mp_math::sin_cos(b), mp_math::cos(a - b));
    let mut best = Best::default();
    let mut try_it = |turns: [f64; 3], lengths: [f64; 3]| {
        let lengths = [forward(lengths[0]), lengths[1], forward(lengths[2])];
        best.take(turns.into_iter().zip(lengths));
    };
    let straight = |square: f64| (square >= 0.0).then(|| square.sqrt());
    if let Some(p) = straight(2.0 + d * d - 2.0 * cab + 2.0 * d * (sa - sb)) {
        let t = mp_math::atan2(cb - ca, d + sa - sb);
        try_it([L, S, L], [t - a, p, b - t]);
    }
    if let Some(p) = straight(2.0 + d * d - 2.0 * cab + 2.0 * d * (sb - sa)) {
        let t = mp_math::atan2(ca - cb, d - sa + sb);
        try_it([R, S, R], [a - t, p, t - b]);
    }
    if let Some(p) = straight(d * d - 2.0 + 2.0 * cab + 2.0 * d * (sa + sb)) {
        let t = mp_math::atan2(-ca - cb, d + sa + sb) - mp_math::atan2(-2.0, p);
        try_it([L, S, R], [t - a, p, t - b]);
    }
    if let Some(p) = straight(d * d - 2.0 + 2.0 * cab - 2.0 * d * (sa + sb)) {
        let t = mp_math::atan2(ca + cb, d - sa - sb) - mp_math::atan2(2.0, p);
        try_it([R, S, L], [a - t, p, b - t]);
    }
    let middle = |cosine: f64| (cosine.abs() <= 1.0).then(|| TAU - mp_math::acos(cosine));
    if let Some(p) = middle((6.0 - d * d + 2.0 * cab + 2.0 * d * (sa - sb)) / 8.0) {
        let t = a - mp_math::atan2(ca - cb, d - sa + sb) + 0.5 * p;
        try_it([R, L, R], [t, p, a - b - t + p]);
    }
    if let Some(p) = middle((6.0 - d * d + 2.0 * cab + 2.0 * d * (sb - sa)) / 8.0) {
        let t = -a + mp_math::atan2(cb - ca, d + sa - sb) + 0.5 * p;
        try_it([L, R, L], [t, p, b - a - t + p]);
    }
    best.scaled(radius)
}

/// The shortest curve from one pose to another of a car that drives forward and backward and turns in circles
/// of `radius` (m), positive and finite: at most five parts, none for equal poses.
#[must_use]
pub fn reeds_shepp(from: &Se2State, to: &Se2State, radius: f64) -> Vec<CurvePart> {
    let [x, y, phi] = seen_from(from, to, radius);
    let mut best = Best::default();
    // The same curves run backward, and mirrored.
    for [back, side] in [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
        let (x, y, phi) = (back * x, side * y, back * side * phi);
        // From the goal to the start: the parts in reverse order.
        let (s, c) = mp_math::sin_cos(phi);
        let (xb, yb) = (x * c + y * s, x * s - y * c);
        let mut take = |parts: &[Part], reversed: bool| {
            let made = |part: &Part| (side * part.0, back * part.1);
            match reversed {
                true => best.take(parts.iter().rev().map(made)),
                false => best.take(parts.iter().map(made)),
            }
        };
        if let Some([t, u, v]) = lp_sp_lp(x, y, phi) {
            take(&[(L, t), (S, u), (L, v)], false);
        }
        if let Some([t, u, v]) = lp_sp_rp(x, y, phi) {
            take(&[(L, t), (S, u), (R, v)], false);
        }
        for (x, y, reversed) in [(x, y, false), (xb, yb, true)] {
            if let Some([t, u, v]) = lp_rm_l(x, y, phi) {
                take(&[(L, t), (R, u), (L, v)], reversed);
            }
            if let Some([t, u, v]) = lp_rm_sm_lm(x, y, phi) {
                take(&[(L, t), (R, -FRAC_PI_2), (S, u), (L, v)], reversed);
            }
            if let Some([t, u, v]) = lp_rm_sm_rm(x, y, phi) {
                take(&[(L, t), (R, -FRAC_PI_2), (S, u), (R, v)], reversed);
            }
        }
        if let Some([t, u, v]) = lp_rup_lum_rm(x, y, phi) {
            take(&[(L, t), (R, u), (L, -u), (R, v)], false);
        }
        if let Some([t, u, v]) = lp_rum_lum_rp(x, y, phi) {
            take(&[(L, t), (R, u), (L, u), (R, v)], false);
        }
        if let Some([t, u, v]) = lp_rm_s_lm_rp(x, y, phi) {
            take(&[(L, t), (R, -FRAC_PI_2), (S, u), (L, -FRAC_PI_2), (R, v)], false);
        }
    }
    best.scaled(radius)
}

/// The shortest curve so far.
#[derive(Default)]
struct Best {
    parts: Vec<Part>,
    length: Option<f64>,
}

impl Best {
    fn take(&mut self, parts: impl Iterator<Item = Part> + Clone) {
        let length: f64 = parts.clone().map(|(_, length)| length.abs()).sum();
        if length.is_finite() && self.length.is_none_or(|best| length < best) {
            (self.parts, self.length) = (parts.collect(), Some(length));
        }
    }

    /// The curve for a radius, without parts whose length is only rounding.
    fn scaled(self, radius: f64) -> Vec<CurvePart> {
        let parts = self.parts.into_iter().filter(|(_, length)| length.abs() > ROUNDING);
        parts.map(|(turn, length)| CurvePart { turn, length: length * radius }).collect()
    }
}

/// Lengths below this, for a radius of 1, are rounding.
const ROUNDING: f64 = 1e-12;

/// The pose `to` in the frame of `from`, for a turning radius of 1.
fn seen_from(from: &Se2State, to: &Se2State, radius: f64) -> [f64; 3] {
    let offset = (to.translation - from.translation) / radius;
    let (s, c) = mp_math::sin_cos(from.angle);
    [offset.x * c + offset.y * s, offset.y * c - offset.x * s, wrap_angle(to.angle - from.angle)]
}

/// The angle from 0 to 2π, where what is below 2π by rounding only is 0.
fn forward(angle: f64) -> f64 {
    let angle = angle.rem_euclid(TAU);
    if angle > TAU - 1e-9 { 0.0 } else { angle }
}

fn polar(x: f64, y: f64) -> (f64, f64) {
    (mp_math::hypot(x, y), mp_math::atan2(y, x))
}

fn tau_omega(u: f64, v: f64, xi: f64, eta: f64, phi: f64) -> (f64, f64) {
    let delta = wrap_angle(u - v);
    let (a, b) = (mp_math::sin(u) - mp_math::sin(delta), mp_math::cos(u) - mp_math::cos(delta) - 1.0);
    let t = mp_math::atan2(eta * a - xi * b, xi * a + eta * b);
    let side = 2.0 * (mp_math::cos(delta) - mp_math::cos(v) - mp_math::cos(u)) + 3.0;
    let tau = wrap_angle(if side < 0.0 { t + PI } else { t });
    (tau, wrap_angle(tau - u + v - phi))
}

/// Whether it is not negative, up to rounding.
fn ahead(length: f64) -> bool {
    length >= -ROUNDING
}

/// Formula 8.1.
fn lp_sp_lp(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (u, t) = polar(x - mp_math::sin(phi), y - 1.0 + mp_math::cos(phi));
    let v = wrap_angle(phi - t);
    (ahead(t) && ahead(v)).then_some([t, u, v])
}

/// Formula 8.2.
fn lp_sp_rp(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (far, t) = polar(x + mp_math::sin(phi), y - 1.0 - mp_math::cos(phi));
    let square = far * far - 4.0;
    let u = (square >= 0.0).then(|| square.sqrt())?;
    let t = wrap_angle(t + mp_math::atan2(2.0, u));
    let v = wrap_angle(t - phi);
    (ahead(t) && ahead(v)).then_some([t, u, v])
}

/// Formulas 8.3 and 8.4.
fn lp_rm_l(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (far, theta) = polar(x - mp_math::sin(phi), y - 1.0 + mp_math::cos(phi));
    let u = (far <= 4.0).then(|| -2.0 * mp_math::asin(0.25 * far))?;
    let t = wrap_angle(theta + 0.5 * u + PI);
    (ahead(t) && ahead(-u)).then(|| [t, u, wrap_angle(phi - t + u)])
}

/// Formula 8.7.
fn lp_rup_lum_rm(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (xi, eta) = (x + mp_math::sin(phi), y - 1.0 - mp_math::cos(phi));
    let rho = 0.25 * (2.0 + mp_math::hypot(xi, eta));
    let u = (rho <= 1.0).then(|| mp_math::acos(rho))?;
    let (t, v) = tau_omega(u, -u, xi, eta, phi);
    (ahead(t) && ahead(-v)).then_some([t, u, v])
}

/// Formula 8.8.
fn lp_rum_lum_rp(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (xi, eta) = (x + mp_math::sin(phi), y - 1.0 - mp_math::cos(phi));
    let rho = (20.0 - xi * xi - eta * eta) / 16.0;
    let u = (0.0..=1.0).contains(&rho).then(|| -mp_math::acos(rho))?;
    let (t, v) = tau_omega(u, u, xi, eta, phi);
    (ahead(t) && ahead(v)).then_some([t, u, v])
}

/// Formula 8.9.
fn lp_rm_sm_lm(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (rho, theta) = polar(x - mp_math::sin(phi), y - 1.0 + mp_math::cos(phi));
    let r = (rho >= 2.0).then(|| (rho * rho - 4.0).sqrt())?;
    let u = 2.0 - r;
    let t = wrap_angle(theta + mp_math::atan2(r, -2.0));
    let v = wrap_angle(phi - FRAC_PI_2 - t);
    (ahead(t) && ahead(-u) && ahead(-v)).then_some([t, u, v])
}

/// Formula 8.10.
fn lp_rm_sm_rm(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (rho, t) = polar(1.0 + mp_math::cos(phi) - y, x + mp_math::sin(phi));
    let u = (rho >= 2.0).then_some(2.0 - rho)?;
    let v = wrap_angle(t + FRAC_PI_2 - phi);
    (ahead(t) && ahead(-u) && ahead(-v)).then_some([t, u, v])
}

/// Formula 8.11, with a misprint mended.
fn lp_rm_s_lm_rp(x: f64, y: f64, phi: f64) -> Option<[f64; 3]> {
    let (xi, eta) = (x + mp_math::sin(phi), y - 1.0 - mp_math::cos(phi));
    let rho = mp_math::hypot(xi, eta);
    let u = (rho >= 2.0).then(|| 4.0 - (rho * rho - 4.0).sqrt()).filter(|u| *u <= 0.0)?;
    let t = wrap_angle(mp_math::atan2((4.0 - u) * xi - 2.0 * eta, -2.0 * xi + (u - 4.0) * eta));
    let v = wrap_angle(t - phi);
    (ahead(t) && ahead(v)).then_some([t, u, v])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Flow, Unicycle};
    use mp_cspace::Rng;
    use rand::RngExt;

    fn length(curve: &[CurvePart]) -> f64 {
        curve.iter().map(|part| part.length.abs()).sum()
    }

    /// Where a curve leads, driven at 1 m/s.
    fn end(from: &Se2State, curve: &[CurvePart], radius: f64) -> Se2State {
        curve.iter().fold(*from, |q, part| {
            let way = part.length.signum();
            Unicycle.integrate(&q, &[way, way * part.turn / radius], part.length.abs())
        })
    }

    /// Curves end at the goal; none is shorter than the straight line; those that may reverse are never
    /// longer than those that may not, and as long from the goal to the start; and with corners cut off, no
    /// curve is found that is shorter.
    #[test]
    fn curves_lead_to_the_goal_and_are_shortest() {
        let mut rng = Rng::seed(1);
        for i in 0..20_000 {
            let reach = if i % 2 == 0 { 2.0 } else { 12.0 };
            let mut pose = || {
                let [x, y] = [0, 1].map(|_| rng.random_range(-reach..reach));
                Se2State::new(x, y, rng.random_range(-PI..PI))
            };
            let (from, to, between) = (pose(), pose(), pose());
            let radius = 1.5;
            let [forward, both] = [dubins(&from, &to, radius), reeds_shepp(&from, &to, radius)];
            for curve in [&forward, &both] {
                let reached = end(&from, curve, radius);
                let off = (reached.translation - to.translation).norm();
                let turned = wrap_angle(reached.angle - to.angle).abs();
                assert!(off < 1e-9 && turned < 1e-9, "{from:?} {to:?} {curve:?}: {off} {turned}");
                assert!(length(curve) >= (to.translation - from.translation).norm() - 1e-9);
            }
            assert!(forward.iter().all(|part| part.length > 0.0));
            assert!(length(&both) <= length(&forward) + 1e-9);
            let back = length(&reeds_shepp(&to, &from, radius));
            assert!((back - length(&both)).abs() < 1e-9, "{from:?} {to:?}: {back} {both:?}");
            // The triangle inequality: a detour is no shorter.
            let detour = |steer: fn(&Se2State, &Se2State, f64) -> Vec<CurvePart>| {
                length(&steer(&from, &between, radius)) + length(&steer(&between, &to, radius))
            };
            assert!(detour(dubins) >= length(&forward) - 1e-9);
            assert!(detour(reeds_shepp) >= length(&both) - 1e-9);
        }
    }

    /// Lengths that are known.
    #[test]
    fn known_curves() {
        let at = Se2State::new;
        let start = at(0.0, 0.0, 0.0);
        let turned = at(0.0, 0.0, PI);
        for (forward, both, to) in [
            (0.0, 0.0, start),
            (5.0, 5.0, at(5.0, 0.0, 0.0)),
            (7.0 * PI / 3.0, PI, turned),
            (PI, PI, at(0.0, 2.0, PI)),
            (TAU * 2.0 - 1.0, 1.0, at(-1.0, 0.0, 0.0)),
        ] {
            let found = [length(&dubins(&start, &to, 1.0)), length(&reeds_shepp(&start, &to, 1.0))];
            assert!((found[1] - both).abs() < 1e-9, "{to:?} {found:?}");
            assert!((found[0] - forward).abs() < 1e-9 || forward > 11.0, "{to:?} {found:?}");
        }
    }
}
