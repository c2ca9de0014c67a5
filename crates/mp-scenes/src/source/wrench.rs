//! `wrench`: the spanning wrench of seven degrees of freedom (Fig. 1c of "Key elements for motion planning algorithms",
//! 2010): it moves freely, and its jaw slides. It is too wide for a slot in a wall unless its jaw is nearly shut, and behind
//! the wall its jaw must be open to take a nut.

use super::scene::Files;
use super::shape::{cells, cylinder, mapped, on_grid, shifted};
use mp_io::off_text;

/// Across flats (m), and the height of the nut.
const NUT: [f64; 2] = [0.3, 0.12];

/// The planes (m) of a wall with a slot in its middle: its sides, and along y and z its ends and those of the slot.
const WALL: [&[f64]; 3] = [&[-0.05, 0.05], &[-1.0, -0.22, 0.22, 1.0], &[-0.8, -0.13, 0.13, 0.8]];

/// Adds the robot, the wall, the nut and the problem.
pub(super) fn add(files: &mut Files) {
    files.insert("robots/wrench.urdf".into(), URDF.into());
    files.insert("scenes/wrench.toml".into(), PROBLEM.into());
    let wall = cells(WALL[0], WALL[1], WALL[2], |_, j, k| (j, k) != (1, 1));
    files.insert("meshes/wrench/wall.off".into(), off_text(&wall).into_bytes());
    // Corners on the x axis, flats along it.
    let nut = cylinder(NUT[0] / 3.0_f64.sqrt(), NUT[1], 6);
    let nut =
        mapped(&shifted(&nut, [0.0, 0.0, -0.5 * NUT[1]]), |p| [on_grid(p.x), on_grid(p.y), on_grid(p.z)]);
    files.insert("meshes/wrench/nut.off".into(), off_text(&nut).into_bytes());
}

/// The inner face of the fixed jaw is at y = 0.1, that of the sliding one at 0.1 minus the width.
const URDF: &str = r#"<?xml version="1.0"?>
<!-- An adjustable wrench: a handle with a fixed jaw, and a jaw that slides on it. -->
<robot name="wrench">
  <link name="handle">
    <collision><origin xyz="-0.315 0 0"/><geometry><box size="0.45 0.08 0.05"/></geometry></collision>
    <collision><origin xyz="-0.55 0 0"/><geometry><cylinder radius="0.06" length="0.05"/></geometry></collision>
    <collision><origin xyz="-0.05 0.03 0"/><geometry><box size="0.1 0.3 0.06"/></geometry></collision>
    <collision><origin xyz="0.14 0.14 0"/><geometry><box size="0.28 0.08 0.06"/></geometry></collision>
  </link>
  <link name="jaw">
    <collision><origin xyz="0.14 0.075 0"/><geometry><box size="0.28 0.05 0.06"/></geometry></collision>
    <collision><origin xyz="-0.04 0.155 0"/><geometry><box size="0.08 0.21 0.04"/></geometry></collision>
  </link>
  <joint name="width" type="prismatic">
    <parent link="handle"/><child link="jaw"/>
    <origin xyz="0 0 0"/><axis xyz="0 -1 0"/>
    <limit lower="0.04" upper="0.38" effort="10" velocity="0.1"/>
  </joint>
</robot>
"#;

const PROBLEM: &str = r#"# A spanning wrench shuts its jaw to pass a slot in a wall, and opens it to take a nut.

[robot]
urdf = "../robots/wrench.urdf"
base = "floating"
bounds = [[-1.6, -0.8, -0.6], [1.6, 0.8, 0.6]]

[motion]
# x, y, z, alpha, beta, gamma, width
start = [-1, 0.3, 0.2, -0.4, 0.3, 0, 0.35]
goal = [0.9063, 0.1644, 0, 0.6, 0, 0, 0.36]

[[obstacle]]
name = "wall"
mesh = "../meshes/wrench/wall.off"

[[obstacle]]
name = "nut"
mesh = "../meshes/wrench/nut.off"
pose = [1.1, 0.2, 0, 0.6, 0, 0]

[[obstacle]]
name = "bolt"
cylinder = [0.07, 0.8]
pose = [1.1, 0.2, -0.4, 0, 0, 0]
"#;
