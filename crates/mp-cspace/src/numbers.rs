//! States as lists of numbers, for files.

use crate::Se2State;
use nalgebra::{Isometry3, Quaternion, SVector, Translation3, UnitQuaternion};

/// A value that is written as a list of numbers, and read back the same to the bit.
pub trait StateVector: Sized {
    /// Gives its numbers to `out`, one by one.
    fn put(&self, out: &mut impl FnMut(f64));
    /// The value of these numbers; `None` when there are too many or too few, or they are not a valid value.
    fn read(numbers: &[f64]) -> Option<Self>;

    /// Appends its numbers.
    fn write(&self, out: &mut Vec<f64>) {
        self.put(&mut |x| out.push(x));
    }
}

impl StateVector for () {
    fn put(&self, _: &mut impl FnMut(f64)) {}
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        numbers.is_empty().then_some(())
    }
}

impl StateVector for f64 {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        out(*self);
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        let [x] = numbers else { return None };
        Some(*x)
    }
}

impl<const N: usize> StateVector for SVector<f64, N> {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        self.iter().for_each(|x| out(*x));
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        (numbers.len() == N).then(|| Self::from_column_slice(numbers))
    }
}

/// x, y, z and w.
impl StateVector for UnitQuaternion<f64> {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        self.coords.iter().for_each(|x| out(*x));
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        let [x, y, z, w] = *numbers else { return None };
        let q = Quaternion::new(w, x, y, z);
        ((q.norm() - 1.0).abs() < 1e-9).then(|| Self::new_unchecked(q))
    }
}

/// Position, then rotation as a quaternion.
impl StateVector for Isometry3<f64> {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        self.translation.vector.put(out);
        self.rotation.put(out);
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        let (position, rotation) = numbers.split_at_checked(3)?;
        let position = Translation3 { vector: StateVector::read(position)? };
        Some(Self::from_parts(position, StateVector::read(rotation)?))
    }
}

/// The numbers of the value, then the one behind it, such as a time.
impl<S: StateVector> StateVector for (S, f64) {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        self.0.put(out);
        out(self.1);
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        let (last, rest) = numbers.split_last()?;
        Some((S::read(rest)?, *last))
    }
}

/// Position, then angle.
impl StateVector for Se2State {
    #[inline]
    fn put(&self, out: &mut impl FnMut(f64)) {
        self.translation.put(out);
        out(self.angle);
    }
    #[inline]
    fn read(numbers: &[f64]) -> Option<Self> {
        let [x, y, angle] = *numbers else { return None };
        Some(Self { translation: [x, y].into(), angle })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Configuration, Rn, Rng, Se2, Se3, So3, Space};

    fn same<S: StateVector + PartialEq + std::fmt::Debug>(state: S) {
        let mut numbers = Vec::new();
        state.write(&mut numbers);
        assert_eq!(S::read(&numbers).as_ref(), Some(&state));
        assert_eq!(Configuration::of(&state).as_slice(), numbers);
        numbers.push(0.5);
        assert_ne!(S::read(&numbers), Some(state));
    }

    #[test]
    fn states_read_back() {
        let mut rng = Rng::seed(1);
        for _ in 0..20 {
            same(Rn::<3>::new([0.0; 3], [1.0; 3]).unwrap().sample_uniform(&mut rng));
            same(Se2::new([0.0; 2], [1.0; 2]).unwrap().sample_uniform(&mut rng));
            same(Se3::new([0.0; 3], [1.0; 3]).unwrap().sample_uniform(&mut rng));
            same(So3.sample_uniform(&mut rng));
        }
        same(nalgebra::Vector3::new(1.0, -0.0, f64::MIN_POSITIVE));
        same(0.1 + 0.2);
        same(());
        assert_eq!(Isometry3::read(&[0.0; 7]), None, "no rotation");
        assert_eq!(Isometry3::read(&[0.0]), None);
    }
}
