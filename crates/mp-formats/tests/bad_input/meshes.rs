//! Bad meshes.

use super::*;

#[test]
fn off_files() {
    check(&[
        off(
            "",
            "m.off:1:1: the file is empty; expected the keyword OFF, COFF, NOFF or STOFF",
            "an export may have failed: write the file again",
        ),
        off(
            "# only a comment\n",
            "m.off:1:17: the file ends too early; expected the keyword OFF, COFF, NOFF or STOFF",
            "the file may be cut short: copy or export it again",
        ),
        off(
            "PLY\n",
            "m.off:1:1: the file begins with `PLY`; expected the keyword OFF, COFF, NOFF or STOFF",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "4OFF\n3 1 0\n",
            "m.off:1:1: `4OFF` is not read; expected the keyword OFF, COFF, NOFF or STOFF",
            "vertices must have three coordinates: convert the file to OFF",
        ),
        off(
            "nOFF\n4\n3 1 0\n",
            "m.off:1:1: `nOFF` is not read; expected the keyword OFF, COFF, NOFF or STOFF",
            "vertices must have three coordinates: convert the file to OFF",
        ),
        off(
            "OFF BINARY\n\0\0\0\u{3}",
            "m.off:1:1: binary OFF is not read; expected text OFF",
            "convert the file to text OFF with a mesh tool",
        ),
        off(
            "OFF\n",
            "m.off:1:4: the file ends too early; expected the numbers of vertices, faces and edges",
            "the file may be cut short: copy or export it again",
        ),
        off(
            "OFF\n3\n",
            "m.off:2:2: the file ends too early; expected the numbers of vertices, faces and edges",
            "the file may be cut short: copy or export it again",
        ),
        off(
            "OFF\n-3 1 0\n",
            "m.off:2:1: `-3` is not a count; expected the numbers of vertices, faces and edges",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "OFF\n3.5 1 0\n",
            "m.off:2:1: `3.5` is not a count; expected the numbers of vertices, faces and edges",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1\n",
            "m.off:5:4: the file ends too early; expected x y z of vertex 2 of 3",
            "the file may be cut short: copy or export it again",
        ),
        off(
            "OFF\n4000000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "m.off:6:8: the file ends too early; expected x y z of vertex 4 of 4000000000",
            "the file may be cut short: copy or export it again",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n",
            "m.off:4:5: `inf` is not a finite number; expected x y z of vertex 1 of 3",
            "coordinates must be finite: correct the program that wrote the file",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "m.off:6:7: vertex 3 does not exist; expected an index from 0 to 2",
            "indices of OFF count from 0",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
            "m.off:6:7: `-1` is not the index of a vertex; expected face 0 of 1: a number of corners, then as many vertices",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n0\n",
            "m.off:6:1: a face without corners; expected face 0 of 1: a number of corners, then as many vertices",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
            "m.off: the mesh has no triangles",
            "a body needs at least one triangle",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n",
            "m.off:6:17: the file ends too early; expected face 0 of 1: a number of corners, then as many vertices",
            "the file may be cut short: copy or export it again",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 300 0 0\n",
            "m.off:6:9: `300` is not a colour; expected whole numbers from 0 to 255, or decimals from 0 to 1",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1 0\n",
            "m.off:6:9: `1` is not a colour of a face; expected a colour of 1, 3 or 4 numbers, or the end of the line",
            "the format is described in docs/formats/off.md",
        ),
        off(
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
            "m.off:7:1: `3` follows the last face; expected the end of the file after 3 vertices and 1 faces",
            "correct the counts in the header, or remove what follows",
        ),
        off(
            "OFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2\n",
            "m.off:3:1: the vertices have 6 numbers each; expected three numbers: x y z",
            "begin the file with COFF if the others are colours, NOFF if they are normals",
        ),
        off(
            "COFF\n3 1 0\n0 0 0 red\n",
            "m.off:3:10: the file ends too early; expected the colour of vertex 0, three or four numbers",
            "the file may be cut short: copy or export it again",
        ),
        off(
            &("OFF\n5000 1 0\n".to_owned() + &"0 0 0\n".repeat(5000) + "5000" + &" 0".repeat(5000) + "\n"),
            "m.off: a polygon has 5000 corners, more than the 4096 allowed",
            "export the mesh as triangles",
        ),
    ]);
}

#[test]
fn other_meshes() {
    let mut cut = vec![0; 84];
    cut[80] = 2;
    cut.extend([0; 50]);
    let mut infinite = vec![0; 84];
    infinite[80] = 1;
    infinite.extend([0; 12]);
    infinite.extend(f32::INFINITY.to_le_bytes());
    infinite.extend([0; 34]);
    check(&[
        case(
            mesh,
            "m.txt",
            "",
            "m.txt:1:1: the file is empty; expected the number of triangles",
            "an export may have failed: write the file again",
        ),
        case(
            mesh,
            "m.txt",
            "one\n",
            "m.txt:1:1: `one` is not a count; expected the number of triangles",
            "the format is described in docs/formats/gempa-mesh.md",
        ),
        case(
            mesh,
            "m.txt",
            "1 2\n0 0 0 1 0 0 0 1 0\n",
            "m.txt:1:3: `2` follows the number of triangles; expected the number of triangles alone on its line",
            "the format is described in docs/formats/gempa-mesh.md",
        ),
        case(mesh, "m.txt", "0\n", "m.txt: the mesh has no triangles", "a body needs at least one triangle"),
        case(
            mesh,
            "m.txt",
            "2\n0 0 0 1 0 0 0 1 0\n0 0 0 1 0\n",
            "m.txt:3:10: the file ends too early; expected z of corner 2 of triangle 2 of 2",
            "the file may be cut short: copy or export it again",
        ),
        case(
            mesh,
            "m.txt",
            "1\n0 0 0 1 0 0 0 1 0\n7\n",
            "m.txt:3:1: `7` follows the last triangle; expected the end of the file after 1 triangles of nine numbers",
            "correct the count on the first line, or remove what follows",
        ),
        case(
            mesh,
            "m.txt",
            "1\n0 0 0 1 0 0 0 y 0\n",
            "m.txt:2:15: `y` is not a number; expected y of corner 3 of triangle 1 of 1",
            "the format is described in docs/formats/gempa-mesh.md",
        ),
        case(
            mesh,
            "m.stl",
            "",
            "m.stl: the file has 0 bytes and does not begin with `solid`; expected text STL, or binary STL with a header of 84 bytes",
            "the file may be cut short, or be of another format: export it again",
        ),
        case(
            mesh,
            "m.stl",
            "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\n",
            "m.stl:5:11: the file ends too early; expected x y z of the vertex",
            "the file may be cut short: copy or export it again",
        ),
        case(
            mesh,
            "m.stl",
            "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
            "m.stl:6:1: `endloop` is out of place; expected `vertex`",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.stl",
            "solid x\nendsolid\n",
            "m.stl: the mesh has no triangles",
            "a body needs at least one triangle",
        ),
        case(
            mesh,
            "m.stl",
            "solid x\n",
            "m.stl:1:8: the file ends too early; expected `facet` or `endsolid`",
            "the file may be cut short: copy or export it again",
        ),
        case(
            mesh,
            "m.stl",
            "solid x\ntriangle\n",
            "m.stl:2:1: `triangle` is out of place; expected `facet` or `endsolid`",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.stl",
            cut,
            "m.stl: the file has 134 bytes; expected 184 bytes of binary STL for the 2 triangles its header announces",
            "the file may be cut short, or be of another format: export it again",
        ),
        case(
            mesh,
            "m.stl",
            infinite,
            "m.stl: corner 0 of triangle 0 is not finite: inf; expected finite coordinates",
            "correct the program that wrote the file",
        ),
        case(mesh, "m.obj", "", "m.obj: the mesh has no triangles", "a body needs at least one triangle"),
        case(
            mesh,
            "m.obj",
            "v 0 0\n",
            "m.obj:1:1: a vertex with 2 numbers; expected x y z, then perhaps a weight or a colour",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.obj",
            "v 0 0 0\nv 1 0 0\nf\n",
            "m.obj:3:1: a face without corners; expected three or more vertices: v, v/vt, v//vn or v/vt/vn",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.obj",
            "v 0 0 0\nv 1 0 0\nf 1 2 3\n",
            "m.obj:3:7: vertex 3 does not exist; expected an index from 1 to 2",
            "indices of OBJ count from 1, negative ones back from the last vertex above",
        ),
        case(
            mesh,
            "m.obj",
            "v 0 0 0\nv 1 0 0\nf 1 2 1/\u{e9}\n",
            "m.obj:3:7: `1/é` is not a corner; expected v, v/vt, v//vn or v/vt/vn",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.obj",
            "v 0 0 0\ncstype bezier\n",
            "m.obj:2:1: `cstype` is not a statement that is read here; expected v, f, or a statement of OBJ without surface",
            "export curved surfaces as polygons",
        ),
        case(
            mesh,
            "m.obj",
            "hello\n",
            "m.obj:1:1: `hello` is not a statement that is read here; expected v, f, or a statement of OBJ without surface",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.wrl",
            "#VRML V2.0 utf8\n",
            "m.wrl: this is not a mesh format that is read here; expected a file .off, .txt, .stl, .obj, .dae, .ply, .glb or .gltf",
            "convert the mesh to one of these",
        ),
    ]);
}

#[test]
fn gltf_files() {
    const GLTF: &str = include_str!("../../../../fuzz/corpus/gltf/good-2");
    const AGAIN: &str = "export the mesh again, as glTF 2.0";
    let of = |from: &str, to: &str, error, help| {
        assert!(GLTF.contains(from), "{from}");
        case(mesh, "m.gltf", GLTF.replacen(from, to, 1), error, help)
    };
    check(&[
        case(
            mesh,
            "m.gltf",
            "{",
            "m.gltf:1:1: this is not JSON: EOF while parsing an object; expected glTF 2.0",
            AGAIN,
        ),
        case(mesh, "m.glb", "glTF\u{2}\0\0\0", "m.glb: the file is cut short", AGAIN),
        case(mesh, "m.glb", "glTF\u{1}\0\0\0", "m.glb: this is binary glTF of version 1, not 2", AGAIN),
        case(
            mesh,
            "m.glb",
            "glTF\u{2}\0\0\0\0\0\0\0\u{9}\0\0\0JSON",
            "m.glb: a part of the file is longer than the file",
            AGAIN,
        ),
        case(
            mesh,
            "m.glb",
            "glTF\u{2}\0\0\0\0\0\0\0\0\0\0\0JUNK",
            "m.glb: the part at byte 12 is not JSO",
            AGAIN,
        ),
        of(
            "\"asset\"",
            "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"",
            "m.gltf: the mesh is compressed by KHR_draco_mesh_compression, which is not read",
            "export it without compression",
        ),
        of("base64,", "base64,?", "m.gltf: the bytes of buffer 0 are not base64", AGAIN),
        of(
            "\"children\":[1]",
            "\"children\":[0]",
            "m.gltf: node 0 is in two places, or nested more than 128 deep",
            AGAIN,
        ),
        of("\"children\":[1]", "\"children\":[7]", "m.gltf: there is no node 7", AGAIN),
        of("\"mesh\":0", "\"mesh\":4", "m.gltf: node 1 has the mesh 4, which is not there", AGAIN),
        of("\"POSITION\"", "\"NORMAL\"", "m.gltf: primitive 0 of mesh 0 has no POSITION", AGAIN),
        of("\"count\":4", "\"count\":5", "m.gltf: accessor 0 is longer than its bytes", AGAIN),
        of(
            "\"count\":4",
            "\"count\":3",
            "m.gltf: primitive 0 of mesh 0 has the vertex 3, and 3 vertices",
            AGAIN,
        ),
        of("\"VEC3\"", "\"VEC2\"", "m.gltf: accessor 0 is VEC2, not VEC3", AGAIN),
        of(
            "5126",
            "5122",
            "m.gltf: accessor 0 has numbers of another type: positions are floats, and indices whole numbers above 0",
            AGAIN,
        ),
    ]);
}
