//! What queries rely on: every box is around all triangles below it, is no larger than the mesh needs, and
//! has orthonormal axes.

use nalgebra::{Point3, Vector3};

use crate::bvh::frames::fits;
use crate::bvh::{LEAF, NodeBox, Tree};
use crate::pose::LIMIT;

/// No node, no leaf.
pub(super) const NONE: u32 = u32::MAX;

/// The node above each node and each leaf, or [`NONE`].
pub(super) struct Parents {
    pub(super) of_node: Vec<u32>,
    pub(super) of_leaf: Vec<u32>,
}

/// What is wrong with a box: with that of a node or leaf, or with the one around everything.
pub(super) struct Fault {
    pub(super) of: Option<u32>,
    pub(super) expected: &'static str,
    pub(super) found: String,
}

/// How far axes of unit length rounded to `f32` may be from orthonormal, and a bit.
const ORTHONORMAL: f64 = 3e-7;
/// Boxes may miss corners by so little, in parts of the mesh's radius: a thousandth of what queries add to them
/// (`Frames::pad`).
const MISSED: f64 = 1e-9;
/// Boxes may reach farther than the mesh by so much, in parts of its radius; rounding in queries is
/// in proportion to the radius.
const EXCESS: f64 = 1e-5;

/// Coordinates below this (metres) are as good as zero: outside the contract of queries, and squares are lost.
const NOTHING: f64 = 1e-75;

const AROUND: &str = "a box around all triangles below it";

/// Checks all boxes. `corners` gives the vertices of the triangle at a position in the tree.
pub(super) fn boxes(
    tree: &Tree,
    vertices: &[Point3<f64>],
    corners: impl Fn(usize) -> [u32; 3],
    parents: &Parents,
) -> Result<(), Fault> {
    if tree.radius <= LIMIT {
        bounding(tree, vertices)?;
    }
    if !fits(tree.radius_center) {
        return Ok(()); // Never used.
    }
    let wide = |of: u32| Wide::new(tree.own(of), tree.radius_center).map_err(|fault| fault.of(of));
    let nodes = (0..tree.nodes.len() as u32).map(wide).collect::<Result<Vec<Wide>, Fault>>()?;
    let (mut seen, mut points) = (Vec::new(), Vec::new());
    for (i, leaf) in tree.leaves.iter().enumerate() {
        seen.clear();
        points.clear();
        for position in leaf.first..leaf.first + leaf.count {
            for v in corners(position as usize) {
                if !seen.contains(&v) {
                    seen.push(v);
                    points.push(vertices[v as usize] - tree.center);
                }
            }
        }
        let own = i as u32 | LEAF;
        wide(own)?.holds(&points).map_err(|fault| fault.of(own))?;
        let mut up = parents.of_leaf[i];
        while up != NONE {
            nodes[up as usize].holds(&points).map_err(|fault| fault.of(up))?;
            up = parents.of_node[up as usize];
        }
    }
    Ok(())
}

/// The box in `f64` around everything: to the rounding of `f64`.
fn bounding(tree: &Tree, vertices: &[Point3<f64>]) -> Result<(), Fault> {
    let obb = &tree.bounding;
    let fault = |expected, found| Fault { of: None, expected, found };
    let along = |p: &Vector3<f64>| obb.axes.map(|u| u.dot(p));
    let (at, rounding) = (along(&obb.center.coords), 1e-14 * tree.radius + NOTHING);
    let sound =
        |k: usize| obb.half[k] >= 0.0 && at[k].abs() + obb.half[k] <= tree.radius * (1.0 + EXCESS) + rounding;
    if !(orthonormal(&obb.axes, 1e-12) && (0..3).all(sound)) {
        return Err(fault("a box with orthonormal axes that is no larger than the mesh", format!("{obb:?}")));
    }
    let outside = |p: &&Point3<f64>| {
        let x = along(&p.coords);
        (0..3).any(|k| (x[k] - at[k]).abs() > obb.half[k] + rounding)
    };
    match vertices.iter().find(outside) {
        Some(p) => Err(fault(AROUND, format!("corner {p} outside"))),
        None => Ok(()),
    }
}

/// Whether axes are orthonormal; not a number is not.
fn orthonormal(axes: &[Vector3<f64>; 3], tolerance: f64) -> bool {
    let error = |i: usize, j: usize| axes[i].dot(&axes[j]) - if i == j { 1.0 } else { 0.0 };
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| error(i, j).abs() <= tolerance)
}

/// A box of the tree, in `f64`.
struct Wide {
    axes: [Vector3<f64>; 3],
    /// The centre along each axis.
    at: [f64; 3],
    /// How far a corner may be from that.
    reach: [f64; 3],
}

impl Wide {
    fn new(obb: &NodeBox, radius: f64) -> Result<Self, BoxFault> {
        let column = |k: usize| Vector3::from([0, 1, 2].map(|d| f64::from(obb.frame[d][k])));
        let (center, axes) = (column(0), [column(1), column(2), column(3)]);
        let at = axes.map(|u| u.dot(&center));
        let half = obb.half.map(f64::from);
        let sound = |k: usize| half[k] >= 0.0 && at[k].abs() + half[k] <= radius * (1.0 + EXCESS) + NOTHING;
        if !(orthonormal(&axes, ORTHONORMAL) && (0..3).all(sound)) {
            let expected = "a box with orthonormal axes that is no larger than the mesh";
            return Err(BoxFault { expected, found: format!("{:?} {:?}", obb.frame, obb.half) });
        }
        Ok(Self { axes, at, reach: half.map(|h| h + MISSED * radius + NOTHING) })
    }

    fn holds(&self, points: &[Vector3<f64>]) -> Result<(), BoxFault> {
        let outside =
            |p: &&Vector3<f64>| (0..3).any(|k| (self.axes[k].dot(p) - self.at[k]).abs() > self.reach[k]);
        match points.iter().find(outside) {
            Some(p) => {
                Err(BoxFault { expected: AROUND, found: format!("corner {:?} outside", p.as_slice()) })
            }
            None => Ok(()),
        }
    }
}

/// A fault of a box yet to be named.
struct BoxFault {
    expected: &'static str,
    found: String,
}

impl BoxFault {
    fn of(self, of: u32) -> Fault {
        Fault { of: Some(of), expected: self.expected, found: self.found }
    }
}
