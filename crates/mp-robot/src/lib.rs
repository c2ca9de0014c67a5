//! Robots: what a configuration places where, and when it is free.
