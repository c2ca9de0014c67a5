//! One box against eight: the separating-axis test (Gottschalk, Lin, Manocha 1996) in lanes.

use crate::bvh::Node;
use crate::bvh::frames::Placed;
use mp_simd::{Lanes, Mask};

/// Bit `i` is set unless child `i` of `node` is surely farther than `margin` from `q`.
///
/// Six axes, then the nine products of edges where some lane is left. `margin` must hold the rounding error
/// (`Frames::pad`). A product of unit edges is no longer than 1, so its gap is a lower bound as well.
#[inline(always)]
pub(crate) fn touching<L: Lanes>(node: &Node, q: &Placed<'_>, margin: f32) -> u32 {
    touching_on(node, q, L::splat(margin), None)
}

/// Bit `i` is set unless child `i` of `node` surely stays farther than 0 from `q`, while one of the two moves by up to
/// `drift` to either side and up to `pad` in any direction. `pad` holds margin and rounding error too.
#[inline(always)]
pub(crate) fn touching_moving<L: Lanes>(node: &Node, q: &Placed<'_>, pad: L, drift: &[L; 3]) -> u32 {
    touching_on(node, q, pad, Some(drift))
}

/// [`touching_moving`], or [`touching`] without a `drift`; which of the two is known when this is compiled.
#[inline(always)]
fn touching_on<L: Lanes>(node: &Node, q: &Placed<'_>, pad: L, drift: Option<&[L; 3]>) -> u32 {
    let center = q.center::<L>();
    let d: [L; 3] = three!(k => center[k].sub(L::load(&node.center[k])));
    let zero = L::splat(0.0);
    let h: [L; 3] = [L::splat(q.half[0]), L::splat(q.half[1]), L::splat(q.half[2])];
    let mut t = [zero; 3];
    // The drift along the axes of the child.
    let mut w = [zero; 3];
    let mut m = [[zero; 3]; 3];
    let mut am = [[zero; 3]; 3];
    let mut e = [zero; 3];
    let [x, y, z] = three!(k => {
        let u = [L::load(&node.axes[k][0]), L::load(&node.axes[k][1]), L::load(&node.axes[k][2])];
        t[k] = dot(&u, &d);
        e[k] = L::load(&node.half[k]);
        let mut reach = e[k].add(pad);
        if let Some(drift) = drift {
            w[k] = dot(&u, drift);
            reach = reach.add(w[k].abs());
        }
        for j in 0..3 {
            m[k][j] = dot(&u, &q.axis(j));
            am[k][j] = m[k][j].abs();
            reach = am[k][j].mul_add(h[j], reach);
        }
        t[k].abs().le(reach)
    });
    let mut mask = x & y & z;
    if mask.bits() == 0 {
        return 0;
    }
    for j in 0..3 {
        let p = t[0].mul_add(m[0][j], t[1].mul_add(m[1][j], t[2].mul(m[2][j])));
        let mut reach = h[j].add(pad);
        if drift.is_some() {
            let v = w[0].mul_add(m[0][j], w[1].mul_add(m[1][j], w[2].mul(m[2][j])));
            reach = reach.add(v.abs());
        }
        let reach = e[0].mul_add(am[0][j], e[1].mul_add(am[1][j], e[2].mul_add(am[2][j], reach)));
        mask = mask & p.abs().le(reach);
    }
    if mask.bits() == 0 {
        return 0;
    }
    for (i, i1, i2) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for (j, j1, j2) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let p = t[i2].mul_sub(m[i1][j], t[i1].mul(m[i2][j]));
            let mut reach = pad;
            if drift.is_some() {
                let v = w[i2].mul_sub(m[i1][j], w[i1].mul(m[i2][j]));
                reach = v.abs().add(pad);
            }
            let reach = e[i1].mul_add(
                am[i2][j],
                e[i2].mul_add(am[i1][j], am[i][j2].mul_add(h[j1], am[i][j1].mul_add(h[j2], reach))),
            );
            mask = mask & p.abs().le(reach);
        }
    }
    mask.bits()
}

/// Squared lower bounds on the distances of `q` from the children of `node`, `pad` (metres) taken off each
/// gap: the largest of the distance to the box around `q` that is aligned with the child, of the gaps along the nine
/// products of edges (which matter near contact; a product is no longer than 1), and of the gap along the line through two
/// points: the point of the child nearest to the centre of `q`, and the point of `q` nearest to that. Infinite in lanes not
/// used.
///
/// The last is seldom much less than the distance: with exact distances instead, a search opens only 3% fewer pairs of
/// boxes that are well apart. Its direction is the sum of three axes, so its rounding error is up to √3 times that along one
/// axis, and a little more for sums: at most 2·`pad`.
#[inline(always)]
pub(crate) fn distances<L: Lanes>(node: &Node, q: &Placed<'_>, pad: f32) -> L {
    let center = q.center::<L>();
    let d: [L; 3] = three!(k => center[k].sub(L::load(&node.center[k])));
    let zero = L::splat(0.0);
    let pad = L::splat(pad);
    let h: [L; 3] = [L::splat(q.half[0]), L::splat(q.half[1]), L::splat(q.half[2])];
    // All in the frames of the children.
    let mut t = [zero; 3];
    let mut m = [[zero; 3]; 3];
    let mut e = [zero; 3];
    let mut aligned = zero;
    for k in 0..3 {
        let u = [L::load(&node.axes[k][0]), L::load(&node.axes[k][1]), L::load(&node.axes[k][2])];
        t[k] = dot(&u, &d);
        e[k] = L::load(&node.half[k]);
        let mut reach = e[k].add(pad);
        for j in 0..3 {
            m[j][k] = dot(&u, &q.axis(j));
            reach = m[j][k].abs().mul_add(h[j], reach);
        }
        let gap = t[k].abs().sub(reach).max(zero);
        aligned = gap.mul_add(gap, aligned);
    }
    let mut across = zero;
    for (i, i1, i2) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for (j, j1, j2) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let p = t[i2].mul_sub(m[j][i1], t[i1].mul(m[j][i2]));
            let reach = e[i1].mul_add(
                m[j][i2].abs(),
                e[i2].mul_add(
                    m[j][i1].abs(),
                    m[j2][i].abs().mul_add(h[j1], m[j1][i].abs().mul_add(h[j2], pad)),
                ),
            );
            across = p.abs().sub(reach).max(across);
        }
    }
    // From the centre of `q` to the nearest point of the child, and on to the nearest point of `q`.
    let back: [L; 3] = three!(k => t[k].min(e[k]).max(zero.sub(e[k])).sub(t[k]));
    let mut join = [zero.sub(back[0]), zero.sub(back[1]), zero.sub(back[2])];
    for j in 0..3 {
        let along = dot(&m[j], &back).min(h[j]).max(zero.sub(h[j]));
        for k in 0..3 {
            join[k] = m[j][k].mul_add(along, join[k]);
        }
    }
    let mut gap = dot(&join, &t).abs();
    for k in 0..3 {
        gap = gap.sub(join[k].abs().mul(e[k])).sub(dot(&join, &m[k]).abs().mul(h[k]));
    }
    let length = dot(&join, &join).sqrt().max(L::splat(1e-18));
    let gap = gap.div(length).sub(pad.add(pad)).max(zero);
    gap.max(across).square().max(aligned).mul(L::splat(1.0 - 1e-5))
}

#[inline(always)]
pub(crate) fn dot<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

#[inline(always)]
pub(crate) fn sub<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

#[inline(always)]
pub(crate) fn cross<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [
        a[1].mul_sub(b[2], a[2].mul(b[1])),
        a[2].mul_sub(b[0], a[0].mul(b[2])),
        a[0].mul_sub(b[1], a[1].mul(b[0])),
    ]
}
