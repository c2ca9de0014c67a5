//! Configurations as rows of numbers: the one state that planners made by name are compiled for.

use crate::{Coordinates, StateVector};
use std::fmt;
use std::ops::{Deref, DerefMut};

/// The most numbers that lie in the value itself, without memory on the heap.
const INLINE: usize = 16;

/// A configuration as a row of numbers, whose meaning its space knows: joint values; the shift of a rigid
/// body and its rotation as a unit quaternion x y z w; a time or velocities behind them. Up to 16 numbers lie
/// in the value itself, more on the heap.
///
/// [`Joints`](crate::Joints) and [`FloatingJoints`](crate::FloatingJoints) have it as their state;
/// [`AsVectors`](crate::AsVectors) gives it to any other space.
///
/// ```
/// use mp_cspace::Configuration;
/// let mut q = Configuration::from([0.5, -1.0]);
/// q[1] = 2.0;
/// assert_eq!(q.as_slice(), [0.5, 2.0]);
/// ```
#[derive(Clone)]
pub struct Configuration(Numbers);

#[derive(Clone)]
enum Numbers {
    /// The count, and that many numbers.
    Inline(u8, [f64; INLINE]),
    Heap(Box<[f64]>),
}

impl Configuration {
    /// A row of `count` zeros.
    #[must_use]
    pub fn zeros(count: usize) -> Self {
        match u8::try_from(count) {
            Ok(few) if count <= INLINE => Self(Numbers::Inline(few, [0.0; INLINE])),
            _ => Self(Numbers::Heap(vec![0.0; count].into())),
        }
    }

    /// The numbers.
    #[inline]
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        match &self.0 {
            Numbers::Inline(count, numbers) => &numbers[..usize::from(*count).min(INLINE)],
            Numbers::Heap(numbers) => numbers,
        }
    }

    /// The numbers, mutable.
    #[inline]
    #[must_use]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        match &mut self.0 {
            Numbers::Inline(count, numbers) => &mut numbers[..usize::from(*count).min(INLINE)],
            Numbers::Heap(numbers) => numbers,
        }
    }

    /// The row of the numbers of a state.
    #[inline]
    #[must_use]
    pub fn of<S: StateVector>(state: &S) -> Self {
        let mut row = Self::zeros(0);
        row.set(state);
        row
    }

    /// Takes the numbers of a state, in place where they fit.
    #[inline]
    pub fn set<S: StateVector>(&mut self, state: &S) {
        if let Numbers::Inline(count, few) = &mut self.0 {
            let mut put = 0;
            state.put(&mut |x| {
                if let Some(slot) = few.get_mut(put) {
                    *slot = x;
                }
                put += 1;
            });
            if put <= INLINE {
                *count = put as u8;
                return;
            }
        }
        let mut numbers = Vec::new();
        state.write(&mut numbers);
        *self = numbers.into();
    }

    /// The state with these numbers; `None` when there is none.
    #[inline]
    #[must_use]
    pub fn to<S: StateVector>(&self) -> Option<S> {
        S::read(self.as_slice())
    }
}

impl From<&[f64]> for Configuration {
    #[inline]
    fn from(numbers: &[f64]) -> Self {
        let mut row = Self::zeros(numbers.len());
        row.as_mut_slice().copy_from_slice(numbers);
        row
    }
}

impl<const N: usize> From<[f64; N]> for Configuration {
    fn from(numbers: [f64; N]) -> Self {
        Self::from(&numbers[..])
    }
}

impl From<Vec<f64>> for Configuration {
    fn from(numbers: Vec<f64>) -> Self {
        Self::from(&numbers[..])
    }
}

impl FromIterator<f64> for Configuration {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut numbers = numbers.into_iter();
        let (mut count, mut few) = (0, [0.0; INLINE]);
        for (slot, x) in few.iter_mut().zip(numbers.by_ref()) {
            *slot = x;
            count += 1;
        }
        match numbers.next() {
            None => Self(Numbers::Inline(count, few)),
            Some(next) => Self(Numbers::Heap(few.into_iter().chain([next]).chain(numbers).collect())),
        }
    }
}

impl Deref for Configuration {
    type Target = [f64];
    #[inline]
    fn deref(&self) -> &[f64] {
        self.as_slice()
    }
}

impl DerefMut for Configuration {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}

impl PartialEq for Configuration {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl fmt::Debug for Configuration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_slice().fmt(f)
    }
}

impl Coordinates for Configuration {
    const COUNT: Option<usize> = None;
    #[inline]
    fn from_fn(count: usize, mut f: impl FnMut(usize) -> f64) -> Self {
        let mut row = Self::zeros(count);
        row.iter_mut().enumerate().for_each(|(i, x)| *x = f(i));
        row
    }
    #[inline]
    fn as_slice(&self) -> &[f64] {
        self.as_slice()
    }
    #[inline]
    fn as_mut_slice(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}

impl StateVector for Configuration {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        self.iter().for_each(|x| out(*x));
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        Some(numbers.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_any_length_keep_their_numbers() {
        for count in [0, 1, 7, INLINE, INLINE + 1, 40, 300] {
            let numbers: Vec<f64> = (0..count).map(|i| 0.5 + i as f64).collect();
            let mut q = Configuration::from(numbers.clone());
            assert_eq!(q.as_slice(), numbers);
            assert_eq!(q, numbers.iter().copied().collect::<Configuration>());
            assert_eq!(q, Configuration::of(&q));
            assert_eq!(q.to::<Configuration>().as_ref(), Some(&q));
            assert_eq!(q, Configuration::from_fn(count, |i| 0.5 + i as f64));
            assert_ne!(q, Configuration::zeros(count + 1));
            if let Some(x) = q.last_mut() {
                *x = -1.0;
                assert_ne!(q.as_slice(), numbers);
            }
        }
    }
}
