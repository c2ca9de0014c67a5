//! Scenes planned in, in one program: each would link all of the library again.

mod attached;
mod auto;
mod clearance;
mod constrained;
mod editing;
mod field;
mod fuzz;
mod hybrid;
mod kinds;
mod many_queries;
mod mjcf;
mod objective;
mod own_robot;
mod parts;
mod pose_goals;
mod relax;
mod robots;
mod several_robots;
mod snake_field;
mod trajectory;
mod which_joints;
mod wrench;
