//! Which bodies are compared with which.

/// The groups a body belongs to and the groups it is compared with, a bit each.
///
/// Two bodies are compared when each is a member of a group the other is compared with:
/// `a.member & b.with != 0 && b.member & a.with != 0`. By default a body is a member of every group and
/// compared with every group.
///
/// ```
/// use mp_collide::Groups;
/// let (robot, wall, ghost) = (Groups::new(0b01, 0b10), Groups::new(0b10, !0), Groups::new(0b10, 0b00));
/// assert!(robot.meets(wall) && wall.meets(robot));
/// assert!(!robot.meets(robot) && !robot.meets(ghost) && !ghost.meets(Groups::ALL));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Groups {
    /// The groups it is a member of.
    pub member: u32,
    /// The groups it is compared with.
    pub with: u32,
}

impl Groups {
    /// A member of every group, compared with every group: the default.
    pub const ALL: Self = Self { member: !0, with: !0 };
    /// In no group: compared with nothing.
    pub const NONE: Self = Self { member: 0, with: 0 };

    /// A member of the groups `member`, compared with the groups `with`.
    #[must_use]
    pub const fn new(member: u32, with: u32) -> Self {
        Self { member, with }
    }

    /// Whether a body of these groups and one of `other` are compared; the same both ways.
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.member & other.with != 0 && other.member & self.with != 0
    }
}

impl Default for Groups {
    fn default() -> Self {
        Self::ALL
    }
}
