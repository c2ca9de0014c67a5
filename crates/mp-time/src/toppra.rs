//! The fastest way along a path within limits of velocity and acceleration: TOPP-RA.
//!
//! Pham and Pham, *A new approach to time-optimal path parameterization based on reachability analysis*, IEEE Transactions on Robotics 34
//! (2018). With the parameter s of the path q(s), the square of its speed x = ṡ² and its acceleration u = s̈ give
//!
//! - velocities q'·√x, and accelerations q'·u + q''·x, which are linear in u and x;
//! - x + 2Δu at the end of an interval of length Δ over which u is constant.
//!
//! 1. From the end to the start: the set of x at each point of the grid from which the next set can be reached. It is an interval from zero, as
//!    limits are symmetric: standing still is always allowed.
//! 2. From the start to the end: the largest u that stays in these sets.
//!
//! Both are linear programs of two variables, solved here in closed form: for a given x each limit is an interval of u, and the largest x at
//! which these have a number in common is where the greatest of their lower ends, a convex function, meets the least of their upper ends, a
//! concave one. Newton's method finds it exactly, from the right, in a few steps.
//!
//! Limits of acceleration are asked at both ends of each interval, with the derivatives inside of it (the paper's interpolation scheme): so they
//! hold where q' = 0 in some joint (zero-inertia points) and where q'' jumps, and all along an interval where q'' is constant.

/// A path cut into intervals, with what limits the robot along it.
#[derive(Clone, Debug)]
pub struct Grid {
    acceleration: Vec<f64>,
    /// The length of each interval.
    steps: Vec<f64>,
    /// The largest x at each point.
    caps: Vec<f64>,
    /// For each interval two rows for each joint: u is within ± the second number of x times the first.
    rows: Vec<[f64; 2]>,
}

/// A coefficient of u that is smaller than this counts as zero.
const NO_INERTIA: f64 = 1e-14;

/// No x is larger than this, also where nothing limits it.
const FASTEST: f64 = 1e12;

impl Grid {
    /// An empty grid for joints with these limits of acceleration (rad/s² or m/s²), which are above zero.
    #[must_use]
    pub fn new(acceleration: &[f64]) -> Self {
        Self { acceleration: acceleration.to_vec(), steps: Vec::new(), caps: vec![FASTEST], rows: Vec::new() }
    }

    /// Adds an interval of this length, with the first and second derivative of the path at its beginning and its end.
    pub fn push(&mut self, step: f64, ends: [[&[f64]; 2]; 2]) {
        let last = self.caps.len() - 1;
        self.caps.push(FASTEST);
        for (end, [first, second]) in ends.into_iter().enumerate() {
            for ((limit, first), second) in self.acceleration.iter().zip(first).zip(second) {
                // At the end x is greater by 2Δu.
                let inertia = if end == 0 { *first } else { first + 2.0 * step * second };
                if inertia.abs() > NO_INERTIA {
                    self.rows.push([-second / inertia, limit / inertia.abs()]);
                } else {
                    self.rows.push([0.0, f64::INFINITY]);
                    if *second != 0.0 {
                        self.caps[last] = self.caps[last].min(limit / second.abs());
                    }
                }
            }
        }
        self.steps.push(step);
    }

    /// Bounds x at a point of the grid, such as by limits of velocity; zero means that the robot stops there.
    pub fn cap(&mut self, point: usize, x: f64) {
        self.caps[point] = self.caps[point].min(x);
    }

    /// The length of each interval.
    #[must_use]
    pub fn steps(&self) -> &[f64] {
        &self.steps
    }

    fn rows_of(&self, interval: usize) -> &[[f64; 2]] {
        let rows = 2 * self.acceleration.len();
        &self.rows[interval * rows..(interval + 1) * rows]
    }
}

/// The largest and the smallest u that the rows of an interval allow at x, each with how it changes with x. At the end of the interval x is
/// between zero and `next`.
fn bounds(rows: &[[f64; 2]], step: f64, next: f64, x: f64) -> [[f64; 2]; 2] {
    let over = 0.5 / step;
    let (mut low, mut high) = ([-over * x, -over], [over * (next - x), -over]);
    for [slope, width] in rows {
        let middle = slope * x;
        if middle - width > low[0] {
            low = [middle - width, *slope];
        }
        if middle + width < high[0] {
            high = [middle + width, *slope];
        }
    }
    [low, high]
}

/// The largest x up to `cap` at which some u is allowed.
fn largest(rows: &[[f64; 2]], step: f64, next: f64, cap: f64) -> f64 {
    // It ends before: each step leaves a pair of rows behind.
    const STEPS: usize = 200;
    let mut x = cap;
    for _ in 0..STEPS {
        let [low, high] = bounds(rows, step, next, x);
        let gap = low[0] - high[0];
        if gap <= 0.0 {
            return x;
        }
        let closer = x - gap / (low[1] - high[1]);
        // Where two lines meet, rounding ends it.
        if closer >= x || closer.is_nan() {
            return x;
        }
        x = closer.max(0.0);
    }
    x
}

/// The square of the speed, x = ṡ², at each point of the grid, from standing still to standing still; `None` where rounding leaves
/// no speed inside of the path.
#[must_use]
pub fn fastest(grid: &Grid) -> Option<Vec<f64>> {
    let count = grid.steps.len();
    let mut reachable = vec![0.0; count + 1];
    for i in (0..count).rev() {
        reachable[i] = largest(grid.rows_of(i), grid.steps[i], reachable[i + 1], grid.caps[i]);
    }
    let mut x = vec![0.0; count + 1];
    for i in 0..count {
        let step = grid.steps[i];
        let [low, high] = bounds(grid.rows_of(i), step, reachable[i + 1], x[i]);
        let u = high[0].max(low[0]);
        x[i + 1] = (x[i] + 2.0 * step * u).clamp(0.0, reachable[i + 1]);
    }
    let stands = x.windows(2).any(|w| w[0] + w[1] <= 0.0);
    (count > 0 && !stands).then_some(x)
}

/// How long it takes (s) along an interval of this length between two squares of speeds.
#[must_use]
pub fn seconds(step: f64, from: f64, to: f64) -> f64 {
    2.0 * step / (from.sqrt() + to.sqrt())
}
