//! Layouts: how coordinates bound a metric from below.

use std::f64::consts::TAU;

/// How the coordinates of a state ([`Embed`](crate::nn::Embed)) bound the metric.
///
/// The coordinates fall into consecutive *groups*. For the difference Δ of the coordinates of two
/// states, minimised over the symmetries below,
///
/// > Σ over groups of ‖Δ in the group‖₂ ≤ distance.
///
/// Built from [`euclidean`](Self::euclidean), [`periodic`](Self::periodic) and
/// [`antipodal`](Self::antipodal), scaled, and joined by [`plus`](Self::plus) where distances add
/// or [`beside`](Self::beside) where their squares do.
///
/// ```
/// use mp_cspace::nn::Layout;
/// // ‖Δp‖ + |Δθ|/2 in the plane: positions as they are, angles halved.
/// let se2 = Layout::euclidean(2).plus(Layout::angles(1).scaled(0.5));
/// assert_eq!(se2.dim(), 3);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Past-the-end coordinate of each group.
    pub(crate) groups: Vec<usize>,
    pub(crate) symmetries: Vec<Symmetry>,
    /// Whether the distance is hardly more than its bound, for states that are near each other.
    pub(crate) tight: bool,
}

/// A map of the coordinates that leaves the state unchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Symmetry {
    /// Adding ±`period` to one coordinate.
    Period { coordinate: usize, period: f64 },
    /// Negating the coordinates `start..end`.
    Antipode { start: usize, end: usize },
}

impl Layout {
    /// `n` plain coordinates: ‖Δ‖₂.
    #[must_use]
    pub fn euclidean(n: usize) -> Self {
        Self { groups: vec![n], symmetries: Vec::new(), tight: true }
    }

    /// `n` coordinates of the given period, embedded in \[−period/2, period/2\]: the Euclidean norm
    /// of the differences, each taken the shorter way round.
    #[must_use]
    pub fn periodic(n: usize, period: f64) -> Self {
        let symmetries = (0..n).map(|coordinate| Symmetry::Period { coordinate, period }).collect();
        Self { symmetries, ..Self::euclidean(n) }
    }

    /// `n` angles in radians, embedded in \[−π, π\].
    #[must_use]
    pub fn angles(n: usize) -> Self {
        Self::periodic(n, TAU)
    }

    /// `n` coordinates that mean the same when all are negated: min ‖a ± b‖₂.
    ///
    /// An example are unit quaternions: at rotation angle θ this is 2 sin(θ/4), so twice it is at most θ.
    /// Of both signs embed the one whose scalar part is not negative: the index is exact with either, but
    /// faster so.
    #[must_use]
    pub fn antipodal(n: usize) -> Self {
        Self { symmetries: vec![Symmetry::Antipode { start: 0, end: n }], ..Self::euclidean(n) }
    }

    /// All coordinates and periods multiplied by `factor` ≥ 0; the embedding must multiply them too.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for s in &mut self.symmetries {
            if let Symmetry::Period { period, .. } = s {
                *period *= factor;
            }
        }
        self
    }

    /// The coordinates of `self`, then those of `other`; the bounds add.
    #[must_use]
    pub fn plus(mut self, other: Self) -> Self {
        let shift = self.dim();
        self.groups.extend(other.groups.iter().map(|end| end + shift));
        self.symmetries.extend(other.symmetries.iter().map(|s| s.shifted(shift)));
        self.tight &= other.tight;
        self
    }

    /// The coordinates of `self`, then those of `other`, in one group: the squares of the bounds
    /// add. Where either side has several groups the result is below √(bound² + bound²), hence
    /// still a lower bound.
    #[must_use]
    pub fn beside(self, other: Self) -> Self {
        let n = self.dim() + other.dim();
        let single = self.groups.len() <= 1 && other.groups.len() <= 1;
        let both = self.plus(other);
        Self { groups: vec![n], tight: both.tight && single, ..both }
    }

    /// Says that the distance may be much greater than its bound even for states that are near each other.
    /// Answers do not depend on it, only how soon they are found.
    #[must_use]
    pub fn loose(mut self) -> Self {
        self.tight = false;
        self
    }

    /// The number of coordinates.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.groups.last().copied().unwrap_or(0)
    }
}

impl Symmetry {
    fn shifted(self, by: usize) -> Self {
        match self {
            Self::Period { coordinate, period } => Self::Period { coordinate: coordinate + by, period },
            Self::Antipode { start, end } => Self::Antipode { start: start + by, end: end + by },
        }
    }
}
