//! Random numbers of problems: a stream for each problem, the same on every machine.

/// A stream of random numbers that comes from a seed and the number of a problem only (SplitMix64 of Steele,
/// Lea and Flood, 2014).
#[derive(Clone, Debug)]
pub struct Draw(u64);

impl Draw {
    /// The stream of problem `number` of seed `seed`.
    #[must_use]
    pub fn new(seed: u64, number: u64) -> Self {
        let mut start = Self(seed);
        let mixed = start.bits() ^ number.wrapping_mul(0xD1B5_4A32_D192_ED03);
        let mut draw = Self(mixed);
        draw.bits();
        draw
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in \[0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number from `low` to below `high`, all equally likely.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number in \[low, high), both above zero, whose logarithm is uniform.
    pub fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        low * mp_math::powf(high / low, self.unit())
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A whole number from 0 to `count` - 1; 0 for a count of 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// A whole number from `low` to `high`, both included.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }

    /// One of `all`, which must not be empty.
    pub fn one<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_of_problems_differ_and_stay() {
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..30 {
            for number in 0..30 {
                assert!(seen.insert(Draw::new(seed, number).bits()));
            }
        }
        assert_eq!(Draw::new(1, 2).bits(), Draw::new(1, 2).bits());
        let mut draw = Draw::new(7, 7);
        let mean = (0..10_000).map(|_| draw.unit()).sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
        assert!((0..1000).all(|_| (3..=5).contains(&draw.count(3, 5))));
    }
}
