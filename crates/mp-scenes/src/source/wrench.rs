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

/// Adds the wall and the nut.
pub(super) fn add(files: &mut Files) {
    let wall = cells(WALL[0], WALL[1], WALL[2], |_, j, k| (j, k) != (1, 1));
    files.insert("meshes/wrench/wall.off".into(), off_text(&wall).into_bytes());
    // Corners on the x axis, flats along it.
    let nut = cylinder(NUT[0] / 3.0_f64.sqrt(), NUT[1], 6);
    let nut =
        mapped(&shifted(&nut, [0.0, 0.0, -0.5 * NUT[1]]), |p| [on_grid(p.x), on_grid(p.y), on_grid(p.z)]);
    files.insert("meshes/wrench/nut.off".into(), off_text(&nut).into_bytes());
}
