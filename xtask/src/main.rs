//! The runner of the workspace.
fn main() {}
