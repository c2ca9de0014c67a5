//! Coordinates and the default index of the spaces of this crate.

use super::{DefaultNn, Embed, KdTree};
use crate::space::twice;
use crate::{
    AsVectors, Configuration, Coordinates, Factored, FloatingJoints, Joints, Product, Rn, Se2, Se2State, Se3,
    So3, Space, StateVector, angle::wrap_angle, nn::Layout,
};
use nalgebra::{Isometry3, SVector, UnitQuaternion};

impl<const N: usize> Embed for Rn<N> {
    fn layout(&self) -> Layout {
        Layout::euclidean(N)
    }
    #[inline]
    fn embed(&self, state: &SVector<f64, N>, out: &mut [f64]) -> usize {
        out[..N].copy_from_slice(state.as_slice());
        N
    }
}
impl<const N: usize> DefaultNn for Rn<N> {
    type Nn = KdTree<N>;
}

impl<Q: Coordinates> Embed for Joints<Q> {
    fn layout(&self) -> Layout {
        self.factor_layouts().into_iter().reduce(Layout::beside).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &Q, out: &mut [f64]) -> usize {
        let n = self.ranges().len();
        let each = out[..n].iter_mut().zip(state.as_slice()).enumerate();
        each.for_each(|(i, (o, x))| *o = self.coordinate(i, *x));
        n
    }
}
impl<const N: usize> DefaultNn for Joints<SVector<f64, N>> {
    type Nn = KdTree<N>;
}
impl DefaultNn for Joints<Configuration> {
    type Nn = KdTree;
}

impl Embed for FloatingJoints {
    fn layout(&self) -> Layout {
        self.base().layout().beside(self.joints().layout())
    }
    #[inline]
    fn embed(&self, state: &Configuration, out: &mut [f64]) -> usize {
        let Some((base, joints)) = Self::split(state.as_slice()) else { return 0 };
        let n = self.base().embed(&base, out);
        let m = self.joints().dim();
        let each = out[n..n + m].iter_mut().zip(joints).enumerate();
        each.for_each(|(i, (o, x))| *o = self.joints().coordinate(i, *x));
        n + m
    }
}
impl DefaultNn for FloatingJoints {
    type Nn = KdTree;
}

impl Embed for So3 {
    fn layout(&self) -> Layout {
        Layout::antipodal(4)
    }
    #[inline]
    fn embed(&self, state: &UnitQuaternion<f64>, out: &mut [f64]) -> usize {
        out[..4].copy_from_slice(&twice(state));
        4
    }
}
impl DefaultNn for So3 {
    type Nn = KdTree<4>;
}

impl Embed for Se2 {
    fn layout(&self) -> Layout {
        Layout::euclidean(2).plus(Layout::angles(1).scaled(self.rotation_weight()))
    }
    #[inline]
    fn embed(&self, state: &Se2State, out: &mut [f64]) -> usize {
        let t = &state.translation;
        out[..3].copy_from_slice(&[t.x, t.y, wrap_angle(state.angle) * self.rotation_weight()]);
        3
    }
}
impl DefaultNn for Se2 {
    type Nn = KdTree<3>;
}

impl Embed for Se3 {
    fn layout(&self) -> Layout {
        Layout::euclidean(3).plus(Layout::antipodal(4).scaled(self.rotation_weight()))
    }
    #[inline]
    fn embed(&self, state: &Isometry3<f64>, out: &mut [f64]) -> usize {
        out[..3].copy_from_slice(state.translation.vector.as_slice());
        out[3..7].copy_from_slice(&twice(&state.rotation).map(|x| x * self.rotation_weight()));
        7
    }
}
impl DefaultNn for Se3 {
    type Nn = KdTree<7>;
}

impl<A: Embed, B: Embed> Embed for Product<A, B> {
    fn layout(&self) -> Layout {
        let ((a, b), (weight_a, weight_b)) = (self.spaces(), self.weights());
        a.layout().scaled(weight_a).beside(b.layout().scaled(weight_b))
    }
    #[inline]
    fn embed(&self, state: &(A::State, B::State), out: &mut [f64]) -> usize {
        let ((a, b), (weight_a, weight_b)) = (self.spaces(), self.weights());
        let n = a.embed(&state.0, out);
        out[..n].iter_mut().for_each(|x| *x *= weight_a);
        let out = &mut out[n..];
        let m = b.embed(&state.1, out);
        out[..m].iter_mut().for_each(|x| *x *= weight_b);
        n + m
    }
}
impl<A: Embed, B: Embed> DefaultNn for Product<A, B> {
    type Nn = KdTree;
}

impl<C: Embed<State: StateVector>> Embed for AsVectors<C> {
    fn layout(&self) -> Layout {
        self.0.layout()
    }
    fn embed(&self, state: &Configuration, out: &mut [f64]) -> usize {
        match state.to() {
            Some(q) => self.0.embed(&q, out),
            None => self.0.layout().dim(),
        }
    }
}

impl<C: Embed<State: StateVector>> DefaultNn for AsVectors<C> {
    type Nn = KdTree;
}
