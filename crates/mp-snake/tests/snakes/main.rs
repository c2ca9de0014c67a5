//! Snakes against closed forms, dense solves and an independent judge.

mod judged;
mod shapes;
mod worlds;
