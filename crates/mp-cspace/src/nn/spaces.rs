//! Coordinates and the default index of the spaces of this crate.

use super::{DefaultNn, Embed, EmbedFactors, KdTree, Layout};
use crate::{
    Coordinates, JointRange, Joints, Product, Rn, RnDyn, Se2, Se2State, Se3, So2, So3, Torus, wrap_angle,
};
use nalgebra::{DVector, Isometry3, SVector, UnitQuaternion};

/// Twice the quaternion, its scalar part not negative: twice the chord is at most the angle.
#[inline]
fn twice(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    let q = &rotation.as_ref().coords;
    let factor = 2.0_f64.copysign(q.w);
    [q.x * factor, q.y * factor, q.z * factor, q.w * factor]
}

impl<const N: usize> Embed for Rn<N> {
    fn layout(&self) -> Layout {
        Layout::flat(N)
    }
    #[inline]
    fn embed(&self, state: &SVector<f64, N>, out: &mut [f64]) -> usize {
        out[..N].copy_from_slice(state.as_slice());
        N
    }
}
impl<const N: usize> EmbedFactors for Rn<N> {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::flat(1); N]
    }
    #[inline]
    fn embed_factors(&self, state: &SVector<f64, N>, put: &mut impl FnMut(usize, f64)) {
        (0..).zip(state.iter()).for_each(|(i, &x)| put(i, x));
    }
}
impl<const N: usize> DefaultNn for Rn<N> {
    type Nn = KdTree<N>;
}

impl Embed for RnDyn {
    fn layout(&self) -> Layout {
        Layout::flat(crate::Space::dim(self))
    }
    #[inline]
    fn embed(&self, state: &DVector<f64>, out: &mut [f64]) -> usize {
        let n = crate::Space::dim(self);
        out[..n].iter_mut().zip(state.iter()).for_each(|(o, x)| *o = *x);
        n
    }
}
impl EmbedFactors for RnDyn {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::flat(1); crate::Space::dim(self)]
    }
    #[inline]
    fn embed_factors(&self, state: &DVector<f64>, put: &mut impl FnMut(usize, f64)) {
        (0..).zip(state.iter()).for_each(|(i, &x)| put(i, x));
    }
}
impl DefaultNn for RnDyn {
    type Nn = KdTree;
}

impl Embed for So2 {
    fn layout(&self) -> Layout {
        Layout::angles(1)
    }
    #[inline]
    fn embed(&self, state: &f64, out: &mut [f64]) -> usize {
        out[0] = wrap_angle(*state);
        1
    }
}
impl EmbedFactors for So2 {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![self.layout()]
    }
    #[inline]
    fn embed_factors(&self, state: &f64, put: &mut impl FnMut(usize, f64)) {
        put(0, wrap_angle(*state));
    }
}
impl DefaultNn for So2 {
    type Nn = KdTree<1>;
}

impl<const N: usize> Embed for Torus<N> {
    fn layout(&self) -> Layout {
        Layout::angles(N)
    }
    #[inline]
    fn embed(&self, state: &SVector<f64, N>, out: &mut [f64]) -> usize {
        out[..N].iter_mut().zip(state.iter()).for_each(|(o, &x)| *o = wrap_angle(x));
        N
    }
}
impl<const N: usize> EmbedFactors for Torus<N> {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::angles(1); N]
    }
    #[inline]
    fn embed_factors(&self, state: &SVector<f64, N>, put: &mut impl FnMut(usize, f64)) {
        (0..).zip(state.iter()).for_each(|(i, &x)| put(i, wrap_angle(x)));
    }
}
impl<const N: usize> DefaultNn for Torus<N> {
    type Nn = KdTree<N>;
}

impl<Q: Coordinates> Joints<Q> {
    fn joint_layout(range: JointRange) -> Layout {
        match range {
            JointRange::Interval { .. } => Layout::flat(1),
            JointRange::Circle => Layout::angles(1),
        }
    }
    #[inline]
    fn coordinate(&self, i: usize, x: f64) -> f64 {
        match self.ranges()[i] {
            JointRange::Interval { .. } => x,
            JointRange::Circle => wrap_angle(x),
        }
    }
}
impl<Q: Coordinates> Embed for Joints<Q> {
    fn layout(&self) -> Layout {
        let joints = self.ranges().iter().map(|range| Self::joint_layout(*range));
        joints.reduce(Layout::beside).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &Q, out: &mut [f64]) -> usize {
        let n = self.ranges().len();
        let each = out[..n].iter_mut().zip(state.as_slice()).enumerate();
        each.for_each(|(i, (o, x))| *o = self.coordinate(i, *x));
        n
    }
}
impl<Q: Coordinates> EmbedFactors for Joints<Q> {
    fn factor_layouts(&self) -> Vec<Layout> {
        self.ranges().iter().map(|range| Self::joint_layout(*range)).collect()
    }
    #[inline]
    fn embed_factors(&self, state: &Q, put: &mut impl FnMut(usize, f64)) {
        let n = self.ranges().len();
        state.as_slice().iter().take(n).enumerate().for_each(|(i, x)| put(i, self.coordinate(i, *x)));
    }
}
impl<const N: usize> DefaultNn for Joints<SVector<f64, N>> {
    type Nn = KdTree<N>;
}
impl DefaultNn for Joints<DVector<f64>> {
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
impl EmbedFactors for So3 {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![self.layout()]
    }
    #[inline]
    fn embed_factors(&self, state: &UnitQuaternion<f64>, put: &mut impl FnMut(usize, f64)) {
        twice(state).into_iter().for_each(|x| put(0, x));
    }
}
impl DefaultNn for So3 {
    type Nn = KdTree<4>;
}

impl Embed for Se2 {
    fn layout(&self) -> Layout {
        Layout::flat(2).plus(Layout::angles(1).scaled(self.rotation_weight()))
    }
    #[inline]
    fn embed(&self, state: &Se2State, out: &mut [f64]) -> usize {
        let t = &state.translation;
        out[..3].copy_from_slice(&[t.x, t.y, wrap_angle(state.angle) * self.rotation_weight()]);
        3
    }
}
impl EmbedFactors for Se2 {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::flat(1), Layout::flat(1), Layout::angles(1)]
    }
    #[inline]
    fn embed_factors(&self, state: &Se2State, put: &mut impl FnMut(usize, f64)) {
        put(0, state.translation.x);
        put(1, state.translation.y);
        put(2, wrap_angle(state.angle));
    }
}
impl DefaultNn for Se2 {
    type Nn = KdTree<3>;
}

impl Embed for Se3 {
    fn layout(&self) -> Layout {
        Layout::flat(3).plus(Layout::antipodal(4).scaled(self.rotation_weight()))
    }
    #[inline]
    fn embed(&self, state: &Isometry3<f64>, out: &mut [f64]) -> usize {
        out[..3].copy_from_slice(state.translation.vector.as_slice());
        out[3..7].copy_from_slice(&twice(&state.rotation).map(|x| x * self.rotation_weight()));
        7
    }
}
impl EmbedFactors for Se3 {
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::flat(1), Layout::flat(1), Layout::flat(1), Layout::antipodal(4)]
    }
    #[inline]
    fn embed_factors(&self, state: &Isometry3<f64>, put: &mut impl FnMut(usize, f64)) {
        (0..).zip(state.translation.vector.iter()).for_each(|(i, &x)| put(i, x));
        twice(&state.rotation).into_iter().for_each(|x| put(3, x));
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
impl<A: EmbedFactors, B: EmbedFactors> EmbedFactors for Product<A, B> {
    fn factor_layouts(&self) -> Vec<Layout> {
        let (a, b) = self.spaces();
        [a.factor_layouts(), b.factor_layouts()].concat()
    }
    #[inline]
    fn embed_factors(&self, state: &(A::State, B::State), put: &mut impl FnMut(usize, f64)) {
        let (a, b) = self.spaces();
        let first = a.factors();
        a.embed_factors(&state.0, put);
        // A plain reference to `put` would make the type grow with every nesting.
        let put: &mut dyn FnMut(usize, f64) = put;
        b.embed_factors(&state.1, &mut |i, x| put(first + i, x));
    }
}
impl<A: Embed, B: Embed> DefaultNn for Product<A, B> {
    type Nn = KdTree;
}
