//! Parts of a motion: which have been made, and how two trees lie in each.

use crate::kernels::swept_interval::{SweptInterval, UP};

/// A motion as a range of whole numbers, which is halved into parts.
pub(crate) trait Schedule {
    /// Whether the earliest part in which the bodies meet is wanted, or any.
    const ORDERED: bool;
    /// A bound on how far (m) any point moves from the middle of a range to either end; 0 for a single pose.
    fn most(&self, range: [u32; 2]) -> f64;
    /// How the trees lie and move in a range; `None` when the balls around them stay apart.
    fn make(&self, range: [u32; 2]) -> Option<SweptInterval>;
    /// The distance (m) that triangles are shown to keep all along a range, if they are to be compared over it as a
    /// whole; smallest ranges in which something moves need that.
    fn keep(&self, _range: [u32; 2]) -> Option<f64> {
        None
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionPart {
    /// From its first number to before its last.
    pub(crate) range: [u32; 2],
    /// A bound on how far any point moves (m) from the middle to either end; 0 for a single pose.
    pub(crate) most: f32,
    /// The index of the first of its two halves, or [`MotionPart::NOT_MADE`].
    halves: u32,
    /// The index of its interval, or [`MotionPart::NOT_MADE`], or [`MotionPart::FAR`].
    interval: u32,
}

impl MotionPart {
    const NOT_MADE: u32 = u32::MAX;
    /// In place of an interval: the bodies stay apart.
    const FAR: u32 = u32::MAX - 1;
}

/// The parts of a motion made so far, and their intervals.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionParts {
    parts: Vec<MotionPart>,
    intervals: Vec<SweptInterval>,
}

impl MotionParts {
    /// Starts over with one part, number 0.
    pub(crate) fn start(&mut self, range: [u32; 2], schedule: &impl Schedule) {
        self.parts.clear();
        self.intervals.clear();
        self.add(range, schedule);
    }

    fn add(&mut self, range: [u32; 2], schedule: &impl Schedule) {
        let most = (schedule.most(range) * UP) as f32;
        self.parts.push(MotionPart {
            range,
            most,
            halves: MotionPart::NOT_MADE,
            interval: MotionPart::NOT_MADE,
        });
    }

    #[inline]
    pub(crate) fn part(&self, index: u32) -> &MotionPart {
        &self.parts[index as usize]
    }

    /// How the trees lie and move in a part, made when first asked for; `None` when the bodies stay apart.
    #[inline]
    pub(crate) fn interval(&mut self, index: u32, schedule: &impl Schedule) -> Option<&SweptInterval> {
        if self.part(index).interval == MotionPart::NOT_MADE {
            let made = schedule.make(self.part(index).range);
            let at = if made.is_some() { self.intervals.len() as u32 } else { MotionPart::FAR };
            self.parts[index as usize].interval = at;
            self.intervals.extend(made);
        }
        self.intervals.get(self.part(index).interval as usize)
    }

    /// The index of the first, earlier half of a part; the other half comes next. `None` for the smallest parts, which
    /// are not divided.
    pub(crate) fn halve(&mut self, index: u32, schedule: &impl Schedule) -> Option<u32> {
        let MotionPart { range: [lo, hi], halves, .. } = *self.part(index);
        if halves != MotionPart::NOT_MADE {
            return Some(halves);
        }
        if hi - lo == 1 {
            return None;
        }
        let first = self.parts.len() as u32;
        self.parts[index as usize].halves = first;
        let middle = u32::midpoint(lo, hi);
        self.add([lo, middle], schedule);
        self.add([middle, hi], schedule);
        Some(first)
    }
}
