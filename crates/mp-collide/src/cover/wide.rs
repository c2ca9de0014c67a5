//! Covers at eight places at a time.

use super::{Cover, ROUNDING};
use crate::around::Around;
use mp_geom::Sphere;
use mp_simd::Lanes;
use mp_simd::wide::{LANES, Wide, Wide3, WideFrame, WideKernel, dot, on_widest, sub};

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
    /// The largest coordinates and the radius.
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
fn gap(a: &Wide3, b: &Wide3, radii: f64) -> Wide {
    let d = sub(a, b);
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt() - radii
}

/// The places, as bits, where two points are not farther than `far` (m) from each other; also where that cannot be compared.
#[inline(always)]
fn within<L: Lanes>(a: &Wide3, b: &Wide3, far: f64) -> u32 {
    let d = sub(a, b);
    ALL & !Wide::splat(far * far).less::<L>(dot(&d, &d))
}

impl WideCover {
    /// Puts a mesh to eight places, where `around` is the ball around it in its own frame.
    #[inline(always)]
    pub fn place(&mut self, around: &Sphere, frame: &WideFrame) {
        self.center = frame.point(&array(around));
        (self.radius, self.frame, self.are_placed) = (around.radius, *frame, 0);
        self.groups.clear();
        let [x, y, z] = &self.center;
        // A sum keeps what is not a number.
        self.size = x.largest() + y.largest() + z.largest() + around.radius;
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
    fn place_groups(&mut self, cover: &Cover) {
        if self.groups.is_empty() {
            for group in &cover.groups {
                self.groups.push(self.frame.point(&array(&group.around)));
            }
            self.balls.resize(cover.balls.len(), NOWHERE);
        }
    }

    #[inline(always)]
    fn place_balls(&mut self, cover: &Cover, group: usize) {
        if self.are_placed >> group & 1 == 0 {
            for i in cover.groups[group].balls.clone() {
                self.balls[i] = self.frame.point(&array(&cover.balls[i]));
            }
            self.are_placed |= 1 << group;
        }
    }

    /// Lower bounds on the distance from what `around` is around: by the ball around the mesh; where that is less than `enough`, by those
    /// around groups of balls; and where one of these is less, by its balls.
    #[inline(always)]
    pub(crate) fn apart_from<L: Lanes>(
        &mut self,
        cover: &Cover,
        around: &Around,
        enough: Wide,
        some: Wide,
    ) -> Wide {
        let whole = around.wide_gap(&self.center, self.radius);
        let open = whole.less::<L>(enough);
        if open == 0 || cover.groups.is_empty() {
            return whole;
        }
        self.place_groups(cover);
        let mut least = Wide::splat(f64::INFINITY);
        for k in 0..cover.groups.len() {
            let group = around.wide_gap(&self.groups[k], cover.groups[k].around.radius);
            let mut near = group;
            if group.less::<L>(enough) & open != 0 {
                self.place_balls(cover, k);
                let mut balls = Wide::splat(f64::INFINITY);
                for i in cover.groups[k].balls.clone() {
                    balls = around.wide_gap(&self.balls[i], cover.balls[i].radius).min(balls);
                }
                near = balls.max(group);
            }
            least = near.min(least);
            // Too little in all lanes that are open: the groups left would say no more.
            if least.less::<L>(some) & open == open {
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
    pub(crate) fn contact<L: Lanes>(
        &mut self,
        cover: &Cover,
        around: &Around,
        kept: f64,
        rounding: f64,
    ) -> Contacts {
        let mut found = Contacts::default();
        let near = kept + rounding;
        let mut open = around.wide_near::<L>(&self.center, self.radius, near);
        if open == 0 || cover.groups.is_empty() {
            return Contacts { touching: 0, open };
        }
        self.place_groups(cover);
        for k in 0..cover.groups.len() {
            let mut group =
                open & around.wide_near::<L>(&self.groups[k], cover.groups[k].around.radius, near);
            if group == 0 {
                continue;
            }
            self.place_balls(cover, k);
            for i in cover.groups[k].balls.clone() {
                let ball = &cover.balls[i];
                let close = group & around.wide_near::<L>(&self.balls[i], ball.radius, near);
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
    fn run<L: Lanes>(self) -> Contacts {
        let ((own, a), (others, b)) = (self.own, self.other);
        let size = a.size + b.size;
        let is_usual = size < LARGEST;
        if !is_usual {
            return Contacts { touching: 0, open: ALL };
        }
        let rounding = ROUNDING * size;
        let (near, touching) = (self.distance + rounding, self.distance - rounding);
        let mut open = within::<L>(&a.center, &b.center, near + a.radius + b.radius);
        if open == 0 || own.groups.is_empty() || others.groups.is_empty() {
            return Contacts { touching: 0, open };
        }
        let is_exact = own.is_exact && others.is_exact;
        let mut found = Contacts::default();
        a.place_groups(own);
        b.place_groups(others);
        for i in 0..own.groups.len() {
            let radius = own.groups[i].around.radius;
            let one = open & within::<L>(&a.groups[i], &b.center, near + radius + b.radius);
            for j in 0..others.groups.len() {
                let radii = radius + others.groups[j].around.radius;
                if one == 0 || one & within::<L>(&a.groups[i], &b.groups[j], near + radii) == 0 {
                    continue;
                }
                a.place_balls(own, i);
                b.place_balls(others, j);
                for k in own.groups[i].balls.clone() {
                    let radius = own.balls[k].radius;
                    let wide = radius + others.groups[j].around.radius;
                    let some = one & within::<L>(&a.balls[k], &b.groups[j], near + wide);
                    if some == 0 {
                        continue;
                    }
                    for l in others.groups[j].balls.clone() {
                        let radii = radius + others.balls[l].radius;
                        let close = some & within::<L>(&a.balls[k], &b.balls[l], near + radii);
                        found.open |= close;
                        if is_exact && close != 0 && touching + radii > 0.0 {
                            // Written so that NaN is open.
                            let (d, reach) = (sub(&a.balls[k], &b.balls[l]), touching + radii);
                            found.touching |= close & dot(&d, &d).less::<L>(Wide::splat(reach * reach));
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
pub fn wide_within_here<L: Lanes>(
    own: (&Cover, &mut WideCover),
    other: (&Cover, &mut WideCover),
    distance: f64,
) -> Contacts {
    Within { own, other, distance }.run::<L>()
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
    fn run<L: Lanes>(self) -> Wide {
        let ((own, a), (others, b)) = (self.own, self.other);
        let size = a.size + b.size;
        let is_usual = size < LARGEST;
        if !is_usual {
            return Wide::splat(f64::NEG_INFINITY);
        }
        let rounding = ROUNDING * size;
        let enough = self.enough + rounding;
        let whole = gap(&a.center, &b.center, a.radius + b.radius);
        let open = whole.less::<L>(enough);
        if open == 0 || own.groups.is_empty() || others.groups.is_empty() {
            return whole - rounding;
        }
        // What balls say is all there is to know then.
        let is_exact = own.is_exact && others.is_exact;
        a.place_groups(own);
        b.place_groups(others);
        let mut least = Wide::splat(f64::INFINITY);
        for i in 0..own.groups.len() {
            let radius = own.groups[i].around.radius;
            let group = gap(&a.groups[i], &b.center, radius + b.radius);
            if group.less::<L>(enough) & open == 0 {
                least = group.min(least);
                continue;
            }
            for j in 0..others.groups.len() {
                let groups = gap(&a.groups[i], &b.groups[j], radius + others.groups[j].around.radius);
                let mut near = groups;
                if groups.less::<L>(enough) & open != 0 {
                    a.place_balls(own, i);
                    b.place_balls(others, j);
                    let mut balls = Wide::splat(f64::INFINITY);
                    for k in own.groups[i].balls.clone() {
                        for l in others.groups[j].balls.clone() {
                            let radii = own.balls[k].radius + others.balls[l].radius;
                            balls = gap(&a.balls[k], &b.balls[l], radii).min(balls);
                        }
                    }
                    near = balls.max(groups);
                }
                least = near.min(least);
            }
            if !is_exact && least.less::<L>(self.some) & open == open {
                return whole - rounding;
            }
        }
        least.max(whole) - rounding
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
pub fn wide_apart_here<L: Lanes>(
    own: (&Cover, &mut WideCover),
    other: (&Cover, &mut WideCover),
    enough: Wide,
    some: Wide,
) -> Wide {
    FromEachOther { own, other, enough, some }.run::<L>()
}
