//! Random problems for every planner, and an oracle that judges their paths.
//!
//! Problem `i` of seed `s` comes from these two numbers only ([`draw`]): its world ([`worlds`]) with the
//! files of a scene, and a request for any planner by name with settings at their ends ([`request`]). The
//! files are read, planned in and answered as by the program `mp` ([`trial`]), and the [`oracle`] judges the
//! text of the path. It knows the problem from the generator, not from our structures. [`soak`] does so for
//! many problems, and keeps a [`tally`].

pub mod draw;
pub mod oracle;
pub mod request;
mod slice;
pub mod soak;
pub mod tally;
mod thin_walls;
pub mod trial;
pub mod worlds;
