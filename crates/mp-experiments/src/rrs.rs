//! The experiment of Baizid, Chellali, Luza, Vitezslav and Arrichiello, *RRS: rapidly-exploring random
//! snakes, a new method for mobile robot path planning*: a trial (§4 and §5), and a simulated robot that
//! follows what was found (§6).

mod follow;
pub mod noisy_robot;
mod trial;

pub use follow::{Followed, Following, KINDS, MARGIN, follow, planned_and_followed, risk_of};
pub use trial::{
    Case, Counted, ITERATIONS, Planned, Point, PreparedWorld, RANGE, Rrs, Run, Steps, planned, rrs,
};
