//! Covers at eight places at a time.

use super::{Cover, ROUNDING};
use crate::around::Around;
use mp_geom::Sphere;
use mp_simd::wide::{
    Doubles, Frames, LANES, Wide, Wide3, WideFrame, WideKernel, dot, load3, on_widest, store3, sub,
};

/// Where coordinates are larger, products may overflow: nothing is decided then.
pub(crate) const LARGEST: f64 = 1e100;

/// A cover at eight places. Its balls are placed when they are first needed.
#[derive(Clone, Debug)]
pub struct WideCover {
    /// The ball around the whole mesh.
    pub(crate) center: Wide3,
    pub(crate) radius: f64,
    frame: WideFrame,
    /// The centres of the balls around groups, none until they are needed; and of balls.
    groups: Vec<Wide3>,
    balls: Vec<Wide3>,
    /// Bit i is set where the balls of group i are placed.
    are_placed: u32,
    /// The largest sum of the coordinates of a center, and the radius; not a number where one of them is none.
    pub(crate) size: f64,
    /// Bodies that are near: scratch memory.
    pub(crate) near: Vec<u32>,
}

const NOWHERE: Wide3 = [Wide::splat(0.0); 3];

impl Default for WideCover {
    fn default() -> Self {
        let frame = WideFrame { turn: [NOWHERE; 3], origin: NOWHERE };
        let (groups, balls) = (Vec::new(), Vec::new());
        Self {
            center: NOWHERE,
            radius: 0.0,
            frame,
            groups,
            balls,
            are_placed: 0,
            size: f64::INFINITY,
            near: Vec::new(),
        }
    }
}

#[inline(always)]
fn array(ball: &Sphere) -> [f64; 3] {
    [ball.center.x, ball.center.y, ball.center.z]
}

/// The distances of points; then of balls, less the radii.
#[inline(always)]
fn gap<D: Doubles>(a: &Wide3, b: &Wide3, radii: f64) -> D {
    let d = sub::<D>(&load3(a), &load3(b));
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt() - radii
}

/// The places, as bits, where two points are not farther than `far` (m) from each other; also where that cannot be compared.
#[inline(always)]
fn within<D: Doubles>(a: &Wide3, b: &Wide3, far: f64) -> u32 {
    let d = sub::<D>(&load3(a), &load3(b));
    ALL & !D::splat(far * far).less(dot(&d, &d))
}

impl WideCover {
    /// Puts a mesh to eight places, where `around` is the ball around it in its own frame.
    #[inline(always)]
    pub fn place<D: Doubles>(&mut self, around: &Sphere, frame: &WideFrame) {
        let frame = Frames::<D>::load(frame);
        let center = frame.point(&array(around));
        (self.radius, self.frame, self.are_placed) = (around.radius, frame.store(), 0);
        self.groups.clear();
        self.size = (center[0].abs() + center[1].abs() + center[2].abs()).largest() + around.radius;
        self.center = store3(center);
    }

    /// The centres of the balls around the whole mesh.
    #[must_use]
    pub fn center(&self) -> &Wide3 {
        &self.center
    }

    /// The radius of the ball around the whole mesh.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    #[inline(always)]
    fn place_groups<D: Doubles>(&mut self, cover: &Cover) {
        if self.groups.is_empty() {
            let frame = Frames::<D>::load(&self.frame);
            for group in &cover.groups {
                self.groups.push(store3(frame.point(&array(&group.around))));
            }
            self.balls.resize(cover.balls.len(), NOWHERE);
        }
    }

    #[inline(always)]
    fn place_balls<D: Doubles>(&mut self, cover: &Cover, group: usize) {
        if self.are_placed >> group & 1 == 0 {
            let frame = Frames::<D>::load(&self.frame);
            for i in cover.groups[group].balls.clone() {
                self.balls[i] = store3(frame.point(&array(&cover.balls[i])));
            }
            self.are_placed |= 1 << group;
        }
    }

    /// Lower bounds on the distance from what `around` is around: by the ball around the mesh; where that is less than `enough`, by those
    /// around groups of balls; and where one of these is less, by its balls.
    #[inline(always)]
    pub(crate) fn apart_from<D: Doubles>(&mut self, cover: &Cover, around: &Around, enough: D, some: D) -> D {
        let whole = around.wide_gap::<D>(&load3(&self.center), self.radius);
        let open = whole.less(enough);
        if open == 0 || cover.groups.is_empty() {
            return whole;
        }
        self.place_groups::<D>(cover);
        let mut least = D::splat(f64::INFINITY);
        for k in 0..cover.groups.len() {
            let group = around.wide_gap::<D>(&load3(&self.groups[k]), cover.groups[k].around.radius);
            let mut near = group;
            if group.less(enough) & open != 0 {
                self.place_balls::<D>(cover, k);
                let mut balls = D::splat(f64::INFINITY);
                for i in cover.groups[k].balls.clone() {
                    balls = around.wide_gap::<D>(&load3(&self.balls[i]), cover.balls[i].radius).min(balls);
                }
                near = balls.max(group);
            }
            least = near.min(least);
            // Too little in all lanes that are open: the groups left would say no more.
            if least.less(some) & open == open {
                return whole;
            }
        }
        least.max(whole)
    }
}

/// Contact at eight places: a bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contacts {
    /// Bit i is set where there is contact at place i.
    pub touching: u32,
    /// Bit i is set where balls leave it open whether there is contact at place i.
    pub open: u32,
}

/// All eight places.
pub(crate) const ALL: u32 = (1 << LANES) - 1;

impl Contacts {
    /// Contact with either.
    #[inline(always)]
    pub fn add(&mut self, other: Self) {
        self.touching |= other.touching;
        self.open = (self.open | other.open) & !self.touching;
    }
}

impl WideCover {
    /// Whether the mesh is within `kept` (m) of the body that `around` is around.
    #[inline(always)]
    pub(crate) fn contact<D: Doubles>(
        &mut self,
        cover: &Cover,
        around: &Around,
        kept: f64,
        rounding: f64,
    ) -> Contacts {
        let mut found = Contacts::default();
        let near = kept + rounding;
        let mut open = around.wide_near::<D>(&load3(&self.center), self.radius, near);
        if open == 0 || cover.groups.is_empty() {
            return Contacts { touching: 0, open };
        }
        self.place_groups::<D>(cover);
        for k in 0..cover.groups.len() {
            let mut group =
                open & around.wide_near::<D>(&load3(&self.groups[k]), cover.groups[k].around.radius, near);
            if group == 0 {
                continue;
            }
            self.place_balls::<D>(cover, k);
            for i in cover.groups[k].balls.clone() {
                let ball = &cover.balls[i];
                let close = group & around.wide_near::<D>(&load3(&self.balls[i]), ball.radius, near);
                found.open |= close;
                if close == 0 || !cover.is_exact || !around.is_tight() {
                    continue;
                }
                for lane in (0..LANES).filter(|lane| close >> lane & 1 == 1) {
                    let center = self.balls[i].map(|x| x.0[lane]).into();
                    let reach = around.reach(&Sphere { center, radius: ball.radius });
                    found.touching |= u32::from(reach + rounding < kept) << lane;
                }
                open &= !found.touching;
                group &= open;
            }
        }
        found.open &= !found.touching;
        found
    }
}

/// Whether two covers are within a distance.
struct Within<'a> {
    own: (&'a Cover, &'a mut WideCover),
    other: (&'a Cover, &'a mut WideCover),
    distance: f64,
}

impl WideKernel for Within<'_> {
    type Output = Contacts;
    #[inline(always)]
    fn run<D: Doubles>(self) -> Contacts {
        let ((own, a), (others, b)) = (self.own, self.other);
        let size = a.size + b.size;
        let is_usual = size < LARGEST;
        if !is_usual {
            return Contacts { touching: 0, open: ALL };
        }
        let rounding = ROUNDING * size;
        let (near, touching) = (self.distance + rounding, self.distance - rounding);
        let mut open = within::<D>(&a.center, &b.center, near + a.radius + b.radius);
        if open == 0 || own.groups.is_empty() || others.groups.is_empty() {
            return Contacts { touching: 0, open };
        }
        let is_exact = own.is_exact && others.is_exact;
        let mut found = Contacts::default();
        a.place_groups::<D>(own);
        b.place_groups::<D>(others);
        for i in 0..own.groups.len() {
            let radius = own.groups[i].around.radius;
            let one = open & within::<D>(&a.groups[i], &b.center, near + radius + b.radius);
            for j in 0..others.groups.len() {
                let radii = radius + others.groups[j].around.radius;
                if one == 0 || one & within::<D>(&a.groups[i], &b.groups[j], near + radii) == 0 {
                    continue;
                }
                a.place_balls::<D>(own, i);
                b.place_balls::<D>(others, j);
                for k in own.groups[i].balls.clone() {
                    let radius = own.balls[k].radius;
                    let wide = radius + others.groups[j].around.radius;
                    let some = one & within::<D>(&a.balls[k], &b.groups[j], near + wide);
                    if some == 0 {
                        continue;
                    }
                    for l in others.groups[j].balls.clone() {
                        let radii = radius + others.balls[l].radius;
                        let close = some & within::<D>(&a.balls[k], &b.balls[l], near + radii);
                        found.open |= close;
                        if is_exact && close != 0 && touching + radii > 0.0 {
                            // Written so that NaN is open.
                            let d = sub::<D>(&load3(&a.balls[k]), &load3(&b.balls[l]));
                            let reach = touching + radii;
                            found.touching |= close & dot(&d, &d).less(D::splat(reach * reach));
                        }
                    }
                }
            }
            open &= !found.touching;
        }
        found.open &= !found.touching;
        found
    }
}

/// Whether two meshes at eight places are within `distance` (m), zero for contact, by their covers: that they are is known only where both are
/// [exact](Cover::is_exact).
pub fn wide_within(
    own: (&Cover, &mut WideCover),
    other: (&Cover, &mut WideCover),
    distance: f64,
) -> Contacts {
    on_widest(Within { own, other, distance })
}

/// As [`wide_within`], for what is compiled for the widest instructions already.
#[inline(always)]
pub fn wide_within_here<D: Doubles>(
    own: (&Cover, &mut WideCover),
    other: (&Cover, &mut WideCover),
    distance: f64,
) -> Contacts {
    Within { own, other, distance }.run::<D>()
}

/// Of two covers.
struct FromEachOther<'a> {
    own: (&'a Cover, &'a mut WideCover),
    other: (&'a Cover, &'a mut WideCover),
    enough: Wide,
    some: Wide,
}

impl WideKernel for FromEachOther<'_> {
    type Output = Wide;
    #[inline(always)]
    fn run<D: Doubles>(self) -> Wide {
        wide_apart_here(self.own, self.other, D::load(&self.enough), D::load(&self.some)).store()
    }
}

/// Lower bounds (m) on the distance of two meshes by their covers: by the balls around them, and where that is less than `enough`, by
/// smaller balls, until all of these are less than `some`. Where both are [exact](Cover::is_exact), a bound of less than `enough` is the
/// distance, less its rounding; where balls overlap it is negative.
pub fn wide_apart(
    own: (&Cover, &mut WideCover),
    other: (&Cover, &mut WideCover),
    enough: Wide,
    some: Wide,
) -> Wide {
    on_widest(FromEachOther { own, other, enough, some })
}

/// As [`wide_apart`], for what is compiled for the widest instructions already.
#[inline(always)]
pub fn wide_apart_here<D: Doubles>(
    (own, a): (&Cover, &mut WideCover),
    (others, b): (&Cover, &mut WideCover),
    enough: D,
    some: D,
) -> D {
    let size = a.size + b.size;
    let is_usual = size < LARGEST;
    if !is_usual {
        return D::splat(f64::NEG_INFINITY);
    }
    let rounding = ROUNDING * size;
    let enough = enough + rounding;
    let whole = gap::<D>(&a.center, &b.center, a.radius + b.radius);
    let open = whole.less(enough);
    if open == 0 || own.groups.is_empty() || others.groups.is_empty() {
        return whole - rounding;
    }
    // What balls say is all there is to know then.
    let is_exact = own.is_exact && others.is_exact;
    a.place_groups::<D>(own);
    b.place_groups::<D>(others);
    let mut least = D::splat(f64::INFINITY);
    for i in 0..own.groups.len() {
        let radius = own.groups[i].around.radius;
        let group = gap::<D>(&a.groups[i], &b.center, radius + b.radius);
        if group.less(enough) & open == 0 {
            least = group.min(least);
            continue;
        }
        for j in 0..others.groups.len() {
            let groups = gap::<D>(&a.groups[i], &b.groups[j], radius + others.groups[j].around.radius);
            let mut near = groups;
            if groups.less(enough) & open != 0 {
                a.place_balls::<D>(own, i);
                b.place_balls::<D>(others, j);
                let mut balls = D::splat(f64::INFINITY);
                for k in own.groups[i].balls.clone() {
                    for l in others.groups[j].balls.clone() {
                        let radii = own.balls[k].radius + others.balls[l].radius;
                        balls = gap::<D>(&a.balls[k], &b.balls[l], radii).min(balls);
                    }
                }
                near = balls.max(groups);
            }
            least = near.min(least);
        }
        if !is_exact && least.less(some) & open == open {
            return whole - rounding;
        }
    }
    least.max(whole) - rounding
}
