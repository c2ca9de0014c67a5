//! Worlds and robots of experiments.

mod clutter;
mod follow;
mod noisy_robot;
mod scenes;
