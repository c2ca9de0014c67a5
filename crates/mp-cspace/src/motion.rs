//! The two motion checks of the straight local planner: discrete and certified.
