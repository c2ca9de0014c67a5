//! Messages of ROS 2 in CDR, the common data representation of OMG, version 1, little-endian.

/// A message being written. Numbers are aligned to their width.
pub(super) struct Writer(Vec<u8>);

/// What messages begin with: plain CDR, little-endian.
const BEGIN: [u8; 4] = [0, 1, 0, 0];

impl Writer {
    pub(super) fn new() -> Self {
        Self(BEGIN.to_vec())
    }

    pub(super) fn done(self) -> Vec<u8> {
        self.0
    }

    fn align(&mut self, width: usize) {
        let at = self.0.len() - BEGIN.len();
        self.0.resize(BEGIN.len() + at.next_multiple_of(width), 0);
    }

    pub(super) fn u8(&mut self, x: u8) {
        self.0.push(x);
    }

    pub(super) fn u32(&mut self, x: u32) {
        self.align(4);
        self.0.extend(x.to_le_bytes());
    }

    pub(super) fn f32s(&mut self, all: impl IntoIterator<Item = f32>) {
        all.into_iter().for_each(|x| self.u32(x.to_bits()));
    }

    pub(super) fn f64s(&mut self, all: impl IntoIterator<Item = f64>) {
        for x in all {
            self.align(8);
            self.0.extend(x.to_le_bytes());
        }
    }

    pub(super) fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.bytes());
        self.0.push(0);
    }

    /// A sequence of numbers.
    pub(super) fn numbers(&mut self, all: &[f64]) {
        self.u32(all.len() as u32);
        self.f64s(all.iter().copied());
    }

    /// A time or a duration.
    pub(super) fn time(&mut self, nanoseconds: u64) {
        self.u32((nanoseconds / 1_000_000_000) as u32);
        self.u32((nanoseconds % 1_000_000_000) as u32);
    }

    /// `std_msgs/Header`.
    pub(super) fn header(&mut self, nanoseconds: u64, frame: &str) {
        self.time(nanoseconds);
        self.text(frame);
    }
}

/// A message being read. `None` where it ends too early, or is big-endian.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        Some(Self { bytes: bytes.strip_prefix(&BEGIN[..2])?.get(2..)?, at: 0 })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.at = self.at.next_multiple_of(N);
        let taken = self.bytes.get(self.at..self.at + N)?;
        self.at += N;
        taken.try_into().ok()
    }

    pub(super) fn i32(&mut self) -> Option<i32> {
        self.take().map(i32::from_le_bytes)
    }

    /// How many there are of what has at least `width` bytes each.
    fn count(&mut self, width: usize) -> Option<usize> {
        let count = u32::from_le_bytes(self.take()?) as usize;
        (count.saturating_mul(width) <= self.bytes.len() - self.at).then_some(count)
    }

    pub(super) fn text(&mut self) -> Option<String> {
        let length = self.count(1)?;
        let text = self.bytes.get(self.at..self.at + length)?;
        self.at += length;
        Some(String::from_utf8_lossy(text.strip_suffix(&[0]).unwrap_or(text)).into_owned())
    }

    pub(super) fn numbers(&mut self) -> Option<Vec<f64>> {
        let count = self.count(8)?;
        (0..count).map(|_| self.take().map(f64::from_le_bytes)).collect()
    }

    /// A sequence of what `each` reads.
    pub(super) fn list<T>(&mut self, mut each: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = self.count(4)?;
        (0..count).map(|_| each(self)).collect()
    }

    /// A time or a duration: seconds, and nanoseconds.
    pub(super) fn time(&mut self) -> Option<[i64; 2]> {
        Some([i64::from(self.i32()?), i64::from(u32::from_le_bytes(self.take()?))])
    }
}
