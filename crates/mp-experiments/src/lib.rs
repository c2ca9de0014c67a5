//! What the papers' experiments plan for, and single runs: `mp-bench` measures them.
//!
//! - [`clutter`]: a free-flyer and an arm among 2 to 512 boxes (Jouandeau et al. 2008).
//! - [`rrs`]: a disc in mazes and clutter, by trees and snakes; a robot with noise that follows its paths
//!   (Baizid et al.).
//!
//! Little here is generic for those who call it: these planners are compiled once, and optimised also where
//! the program that measures them is not.

pub mod clutter;
pub mod rrs;

/// Why something cannot be run.
pub type Error = Box<dyn std::error::Error + Send + Sync>;

/// The result of a function of this crate.
pub type Result<T> = std::result::Result<T, Error>;
