//! A part of the items of a list.

use mp_plan::Error;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The part `index` of `of` parts of a list, both from 1: every item whose number, modulo `of`, is `index`
/// − 1. As text, `2/5`.
///
/// ```
/// let shard: mp_batch::Shard = "2/3".parse()?;
/// assert_eq!(shard.items(8).collect::<Vec<_>>(), [1, 4, 7]);
/// # Ok::<(), mp_plan::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    index: u32,
    of: u32,
}

impl Shard {
    /// All items.
    pub const WHOLE: Self = Self { index: 1, of: 1 };

    /// The part `index` of `of` parts.
    ///
    /// # Errors
    /// Unless `index` is from 1 to `of`.
    pub fn new(index: u32, of: u32) -> Result<Self, Error> {
        match (1..=of).contains(&index) {
            true => Ok(Self { index, of }),
            false => Err(Error::new(format!("there is no shard {index} of {of}")).help(HELP)),
        }
    }

    /// Which part, from 1.
    #[must_use]
    pub fn index(self) -> u32 {
        self.index
    }

    /// How many parts there are.
    #[must_use]
    pub fn of(self) -> u32 {
        self.of
    }

    /// Whether an item of the list, counted from 0, belongs to this shard.
    #[must_use]
    pub fn has(self, item: u64) -> bool {
        item % u64::from(self.of) == u64::from(self.index - 1)
    }

    /// How many items of a list of `items` belong to this shard.
    #[must_use]
    pub fn count(self, items: u64) -> u64 {
        (items + u64::from(self.of - self.index)) / u64::from(self.of)
    }

    /// Those of `items` items that are in it, in order.
    pub fn items(self, items: u64) -> impl Iterator<Item = u64> + Send {
        (0..self.count(items)).map(move |nth| self.item(nth))
    }

    /// Its item `nth`, from 0.
    pub(crate) fn item(self, nth: u64) -> u64 {
        nth * u64::from(self.of) + u64::from(self.index - 1)
    }
}

/// How shards are written.
const HELP: &str = "write I/N with I from 1 to N, such as 1/4, 2/4, 3/4 and 4/4";

/// All items.
impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = Error;
    fn from_str(text: &str) -> Result<Self, Error> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        let (index, of) = numbers.ok_or_else(|| Error::new(format!("`{text}` is not a shard")).help(HELP))?;
        Self::new(index, of)
    }
}

mp_plan::as_text!(Shard);
