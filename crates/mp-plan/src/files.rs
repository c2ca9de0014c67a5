//! Scenes from files: readers of all formats, scenes by name, and what is in a file.

pub(crate) mod editing;
pub(crate) mod find;
pub mod info;
pub(crate) mod inputs;
pub(crate) mod load;
pub(crate) mod problems;
pub(crate) mod robot_pairs;
pub(crate) mod without_problem;
