//! What the nodes of both trees have in common.

/// A reference to a node: the index of an inner node, or that of a leaf with the top bit set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ref(u32);

impl Ref {
    const LEAF: u32 = 1 << 31;

    pub(super) fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
    }

    pub(super) fn inner(index: usize) -> Self {
        Self(index as u32)
    }

    /// `Ok` an inner node, `Err` a leaf.
    #[inline]
    pub(super) fn get(self) -> Result<usize, usize> {
        if self.0 & Self::LEAF == 0 { Ok(self.0 as usize) } else { Err((self.0 & !Self::LEAF) as usize) }
    }
}

/// How many leaves there are below an inner node, and how many there were when it was built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weight {
    pub(super) leaves: u32,
    built: u32,
}

impl Weight {
    pub(super) fn new(leaves: u32) -> Self {
        Self { leaves, built: leaves }
    }

    /// Whether the node should be rebuilt, its heavier child having `most` leaves: when it is out
    /// of balance and has grown enough since it was built to pay for it.
    pub(super) fn is_unbalanced(self, most: u32) -> bool {
        self.leaves > self.built + self.built / 2 + 6 && most > self.leaves - self.leaves / 4
    }

    /// Accounts for `change` more leaves.
    pub(super) fn change(&mut self, change: i64) {
        self.leaves = (i64::from(self.leaves) + change) as u32;
    }
}
