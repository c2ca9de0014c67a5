//! The bytes, version 1. `docs/formats/tree.md` describes them.
//!
//! Only what cannot be derived is in the file: the mesh, its boxes, and what is below what. The rest is
//! computed on loading by the code that builds.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};
use xxhash_rust::xxh3::xxh3_64;

use super::TreeError;
use super::check::{self, NONE, Parents};
use super::reader::{Reader, invalid};
use crate::bvh::build::{Size, leaf};
use crate::bvh::{LEAF, Node, NodeBox, Tree, WIDTH};
use crate::mesh::CollisionMesh;

const MAGIC: [u8; 8] = *b"\x89MPT\r\n\x1a\n";
const VERSION: u32 = 1;

/// Magic, version, four counts.
pub(super) const HEADER: usize = 28;
const COUNTS: usize = 12;
/// The bytes of one of each.
const BOUNDING: usize = 15 * 8;
const VERTEX: usize = 3 * 8;
const TRIANGLE: usize = 3 * 4;
const POSITION: usize = 4;
const OBB: usize = 15 * 4;
const LEAF_RECORD: usize = 4 + OBB;
const NODE_RECORD: usize = OBB + WIDTH * 4;
const CHECKSUM: usize = 8;

/// As many nodes may be above one another: more than any mesh makes the builder need, and few enough that
/// checking a made-up file does not take for ever.
const DEEPEST: u32 = 1024;

/// How many of each there are.
struct Counts {
    vertices: usize,
    triangles: usize,
    leaves: usize,
    nodes: usize,
}

impl Counts {
    fn read(bytes: &[u8]) -> Result<Self, TreeError> {
        if !bytes.starts_with(&MAGIC) {
            return Err(TreeError::NotATree);
        }
        let mut reader = Reader::new(bytes, MAGIC.len());
        let version = reader.u32()?;
        if version != VERSION {
            return Err(TreeError::Version { found: version, expected: VERSION });
        }
        let [vertices, triangles, leaves, nodes] = reader.u32s()?.map(|count: u32| count as usize);
        if vertices == 0 {
            return Err(invalid(COUNTS, "at least one vertex", vertices));
        }
        if triangles == 0 {
            return Err(invalid(COUNTS + 4, "at least one triangle", triangles));
        }
        if leaves == 0 || leaves > triangles || leaves >= LEAF as usize {
            return Err(invalid(COUNTS + 8, "at least one leaf, no more than triangles and 2³¹ − 1", leaves));
        }
        if nodes >= leaves {
            return Err(invalid(COUNTS + 12, "fewer nodes than leaves", nodes));
        }
        Ok(Self { vertices, triangles, leaves, nodes })
    }

    fn leaves_at(&self) -> u64 {
        (HEADER + BOUNDING) as u64
            + self.vertices as u64 * VERTEX as u64
            + self.triangles as u64 * (TRIANGLE + POSITION) as u64
    }

    fn nodes_at(&self) -> u64 {
        self.leaves_at() + self.leaves as u64 * LEAF_RECORD as u64
    }

    fn length(&self) -> u64 {
        self.nodes_at() + self.nodes as u64 * NODE_RECORD as u64 + CHECKSUM as u64
    }
}

/// The length of the whole, from the header.
pub(super) fn length(header: &[u8]) -> Result<u64, TreeError> {
    Ok(Counts::read(header)?.length())
}

pub(super) fn write(mesh: &CollisionMesh) -> Vec<u8> {
    let tree = mesh.tree();
    let mut numbers = HashMap::new();
    let mut vertices: Vec<Point3<f64>> = Vec::new();
    let mut number = |p: &Point3<f64>| {
        *numbers.entry([p.x, p.y, p.z].map(f64::to_bits)).or_insert_with(|| {
            vertices.push(*p);
            vertices.len() as u32 - 1
        })
    };
    let triangles: Vec<[u32; 3]> =
        mesh.triangles().iter().map(|t| [0, 1, 2].map(|k| number(&t[k]))).collect();
    let counts = Counts {
        vertices: vertices.len(),
        triangles: triangles.len(),
        leaves: tree.leaves.len(),
        nodes: tree.nodes.len(),
    };
    let mut bytes = Vec::with_capacity(counts.length() as usize);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    for count in [counts.vertices, counts.triangles, counts.leaves, counts.nodes] {
        bytes.extend((count as u32).to_le_bytes());
    }
    let f64s = |bytes: &mut Vec<u8>, v: &[f64]| bytes.extend(v.iter().flat_map(|x| x.to_le_bytes()));
    f64s(&mut bytes, tree.bounding.center.coords.as_slice());
    for axis in &tree.bounding.axes {
        f64s(&mut bytes, axis.as_slice());
    }
    f64s(&mut bytes, tree.bounding.half.as_slice());
    for p in &vertices {
        f64s(&mut bytes, p.coords.as_slice());
    }
    bytes.extend(triangles.iter().flatten().chain(&tree.ids).flat_map(|i| i.to_le_bytes()));
    let obb = |bytes: &mut Vec<u8>, obb: &NodeBox| {
        bytes.extend(obb.frame.iter().flatten().chain(&obb.half).flat_map(|x| x.to_le_bytes()));
    };
    let mut first = 0;
    for (leaf, own) in tree.leaves.iter().zip(&tree.leaf_boxes) {
        debug_assert_eq!(leaf.first, first, "leaves are in the order of the triangles");
        first += leaf.count;
        bytes.extend(leaf.count.to_le_bytes());
        obb(&mut bytes, own);
    }
    for (node, own) in tree.nodes.iter().zip(&tree.node_boxes) {
        obb(&mut bytes, own);
        let children = node.children().chain(std::iter::repeat(NONE)).take(WIDTH);
        bytes.extend(children.flat_map(u32::to_le_bytes));
    }
    bytes.extend(xxh3_64(&bytes).to_le_bytes());
    bytes
}

/// The tree in `bytes`; the checksum is only looked at when `checked`.
pub(crate) fn read(bytes: &[u8], checked: bool) -> Result<CollisionMesh, TreeError> {
    let counts = Counts::read(bytes)?;
    let (expected, found) = (counts.length(), bytes.len() as u64);
    if expected != found {
        return Err(TreeError::Length { expected, found });
    }
    let content = &bytes[..bytes.len() - CHECKSUM];
    if checked {
        let found = Reader::new(bytes, content.len()).u64()?;
        let expected = xxh3_64(content);
        if found != expected {
            return Err(TreeError::Checksum { at: content.len() as u64, expected, found });
        }
    }
    let mut reader = Reader::new(content, HEADER);
    let bounding = crate::mesh_obb::MeshObb {
        center: Point3::from(reader.f64s()?),
        axes: [Vector3::from(reader.f64s()?), Vector3::from(reader.f64s()?), Vector3::from(reader.f64s()?)],
        half: Vector3::from(reader.f64s()?),
    };
    let vertices = vertices(&mut reader, counts.vertices)?;
    let indices = indices(&mut reader, counts.triangles, vertices.len())?;
    let ids = order(&mut reader, counts.triangles)?;
    let Size { center, radius_center, radius } = Size::of(vertices.iter());
    let mut tree = Tree {
        nodes: Vec::with_capacity(counts.nodes),
        leaves: Vec::with_capacity(counts.leaves),
        node_boxes: Vec::with_capacity(counts.nodes),
        leaf_boxes: Vec::with_capacity(counts.leaves),
        root: if counts.nodes == 0 { LEAF } else { 0 },
        bounding,
        triangles: ids.iter().map(|&id| indices[id as usize].map(|v| vertices[v as usize])).collect(),
        ids,
        center,
        radius_center,
        radius,
    };
    leaves(&mut reader, &mut tree, counts.leaves)?;
    let parents = nodes(&mut reader, &mut tree, &counts)?;
    let corners = |position: usize| indices[tree.ids[position] as usize];
    check::boxes(&tree, &vertices, corners, &parents).map_err(|fault| {
        let at = match fault.of {
            None => HEADER as u64,
            Some(r) if r & LEAF != 0 => counts.leaves_at() + u64::from(r & !LEAF) * LEAF_RECORD as u64 + 4,
            Some(r) => counts.nodes_at() + u64::from(r) * NODE_RECORD as u64,
        };
        TreeError::Invalid { at, expected: fault.expected, found: fault.found }
    })?;
    Ok(CollisionMesh::from_tree(tree))
}

fn vertices(reader: &mut Reader<'_>, count: usize) -> Result<Vec<Point3<f64>>, TreeError> {
    let mut vertices = Vec::with_capacity(count);
    for _ in 0..count {
        let at = reader.at();
        let p: [f64; 3] = reader.f64s()?;
        if !p.iter().all(|x| x.is_finite()) {
            return Err(invalid(at, "finite coordinates", format_args!("{p:?}")));
        }
        vertices.push(Point3::from(p));
    }
    Ok(vertices)
}

/// The vertices of each triangle; every vertex belongs to one.
fn indices(reader: &mut Reader<'_>, count: usize, vertices: usize) -> Result<Vec<[u32; 3]>, TreeError> {
    let mut used = vec![false; vertices];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let at = reader.at();
        let triangle: [u32; 3] = reader.u32s()?;
        for v in triangle {
            match used.get_mut(v as usize) {
                Some(used) => *used = true,
                None => return Err(invalid(at, "three numbers of vertices", format_args!("{triangle:?}"))),
            }
        }
        indices.push(triangle);
    }
    match used.iter().position(|used| !used) {
        Some(v) => Err(invalid(HEADER + BOUNDING + v * VERTEX, "a vertex of a triangle", "one of none")),
        None => Ok(indices),
    }
}

/// Each number below `count` once.
fn order(reader: &mut Reader<'_>, count: usize) -> Result<Vec<u32>, TreeError> {
    let mut free = vec![true; count];
    let mut ids = Vec::with_capacity(count);
    for _ in 0..count {
        let at = reader.at();
        let id = reader.u32()?;
        match free.get_mut(id as usize) {
            Some(free) if *free => *free = false,
            Some(_) => return Err(invalid(at, "each triangle once", format_args!("{id} a second time"))),
            None => return Err(invalid(at, "the number of a triangle", id)),
        }
        ids.push(id);
    }
    Ok(ids)
}

fn leaves(reader: &mut Reader<'_>, tree: &mut Tree, leaves: usize) -> Result<(), TreeError> {
    let mut first = 0;
    for i in 0..leaves {
        let at = reader.at();
        let count = reader.u32()? as usize;
        // At least one is left for each leaf to come.
        let most = (tree.triangles.len() - first).saturating_sub(leaves - i - 1).min(WIDTH);
        if count == 0 || count > most || (i + 1 == leaves && count != tree.triangles.len() - first) {
            return Err(invalid(at, "leaves of 1 to 8 triangles, all of them together", count));
        }
        let obb = reader.obb()?;
        tree.leaves.push(leaf(&tree.triangles, &tree.center, &(first..first + count), &obb));
        tree.leaf_boxes.push(obb);
        first += count;
    }
    Ok(())
}

/// Every node but the first, and every leaf, is the child of exactly one node, which comes before it: a
/// tree.
fn nodes(reader: &mut Reader<'_>, tree: &mut Tree, counts: &Counts) -> Result<Parents, TreeError> {
    let mut parents = Parents { of_node: vec![NONE; counts.nodes], of_leaf: vec![NONE; counts.leaves] };
    let mut depth = vec![0; counts.nodes];
    let mut all_children = Vec::with_capacity(counts.nodes);
    for i in 0..counts.nodes {
        let at = reader.at();
        if i > 0 {
            let parent = parents.of_node[i];
            if parent == NONE {
                return Err(invalid(at, "a node below an earlier one", "one below none"));
            }
            depth[i] = depth[parent as usize] + 1;
            if depth[i] > DEEPEST {
                return Err(invalid(at, "no more than 1024 nodes above one another", "more"));
            }
        }
        tree.node_boxes.push(reader.obb()?);
        let at = reader.at();
        let children: [u32; WIDTH] = reader.u32s()?;
        let used = children.iter().position(|&c| c == NONE).unwrap_or(WIDTH);
        if used < 2 || children[used..].iter().any(|&c| c != NONE) {
            return Err(invalid(at, "two to eight children, then ffffffff", format_args!("{children:x?}")));
        }
        for &child in &children[..used] {
            let place = match child & LEAF {
                0 if child as usize > i => parents.of_node.get_mut(child as usize),
                0 => None,
                _ => parents.of_leaf.get_mut((child & !LEAF) as usize),
            };
            match place {
                Some(parent) if *parent == NONE => *parent = i as u32,
                _ => {
                    let expected = "children that are later nodes or leaves, and in no other node";
                    return Err(invalid(at, expected, format_args!("{children:x?}")));
                }
            }
        }
        all_children.push(children);
    }
    if let Some(i) = parents.of_leaf.iter().position(|&parent| parent == NONE && counts.leaves > 1) {
        let at = counts.leaves_at() as usize + i * LEAF_RECORD;
        return Err(invalid(at, "a leaf below a node", "one below none"));
    }
    for children in all_children {
        let mut node = Node::EMPTY;
        for (lane, child) in children.into_iter().take_while(|&child| child != NONE).enumerate() {
            node.set(lane, child, tree.own(child));
        }
        tree.nodes.push(node);
    }
    Ok(parents)
}
