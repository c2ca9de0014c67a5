//! The program, as people call it.

mod arms;
mod bad_input;
mod cli;
mod common;
mod films;
mod guides;
mod kinds;
mod many;
mod museum;
mod outputs;
mod relax;
mod routes;
mod streams;
mod trajectories;
mod view;
