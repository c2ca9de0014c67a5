//! Bad environments of GEMPA.

use super::*;

#[test]
fn environments() {
    check(&[
        case(scene, "s.env", "", "s.env:1:1: the file is empty; expected `Robot`", "an export may have failed: write the file again"),
        case(scene, "s.env", "\n \n", "s.env:1:1: the file is empty; expected `Robot`", "an export may have failed: write the file again"),
        env("Robot\n", "Robbot\n", "s.env:1:1: the file begins with `Robbot`; expected `Robot`", "an environment file begins with the line `Robot`, then the mesh file, the initial and the goal six-tuple"),
        env("r.off\n", "", "s.env:2:1: `0 0 0 0 0 0` is not the name of a file; expected the name of a mesh file", "the format is described in docs/formats/gempa-environment.md"),
        env("0 0 0 0 0 0", "0 0 0 0 0", "s.env:3:1: the initial configuration has 5 numbers; expected six numbers: x y z α β γ", "the format is described in docs/formats/gempa-environment.md"),
        env("0 0 0 0 0 0", "0 0 0 0 0 0 0", "s.env:3:1: the initial configuration has 7 numbers; expected six numbers: x y z α β γ", "the format is described in docs/formats/gempa-environment.md"),
        env("0 0 0 0 0 0", "0 0 zero 0 0 0", "s.env:3:5: `zero` is not a number; expected six numbers: x y z α β γ", "the format is described in docs/formats/gempa-environment.md"),
        env("0 0 0 0 0 0", "0,0 0 0 0 0 0", "s.env:3:1: `0,0` is not a number; expected six numbers: x y z α β γ", "write numbers with a decimal point, separated by blanks, without commas"),
        env("0 0 0 0 0 0", "0 nan 0 0 0 0", "s.env:3:3: `nan` is not a finite number; expected six numbers: x y z α β γ", "coordinates must be finite: correct the program that wrote the file"),
        env("5 0 0 0 0 0", "5 0 0 0 0 1e999", "s.env:4:11: `1e999` is not a finite number; expected six numbers: x y z α β γ", "coordinates must be finite: correct the program that wrote the file"),
        env("5 0 0 0 0 0", "5 0 0 * 0 0", "s.env:4:7: `*` is not a number; expected six numbers: x y z α β γ", "this format has one goal, of six numbers; a rigid problem (.toml) may have several goals, and leave numbers free: docs/formats/rigid-problem.md"),
        env("5 0 0 0 0 0", "5e9 0 0 0 0 0", "s.env:4:1: the goal configuration has 5e9, more than 1e9 m", "coordinates are metres"),
        env("Obstacle #1", "Obstacle 1", "s.env:6:1: `Obstacle 1` is out of place; expected `Obstacle #k` or `End`", "the format is described in docs/formats/gempa-environment.md"),
        env("Obstacle #1", "Obstacle #one", "s.env:6:1: `Obstacle #one` is out of place; expected `Obstacle #k` or `End`", "the format is described in docs/formats/gempa-environment.md"),
        env("Obstacle #1", "9 9 9 9 9 9", "s.env:6:1: `9 9 9 9 9 9` is out of place; expected `Obstacle #k` or `End`", "a robot has two six-tuples (initial, goal), an obstacle one; this format has one goal, of six numbers; a rigid problem (.toml) may have several goals, and leave numbers free: docs/formats/rigid-problem.md"),
        env("w.off", "2 0 0 0 0 0", "s.env:7:1: `2 0 0 0 0 0` is not the name of a file; expected the name of a mesh file", "the format is described in docs/formats/gempa-environment.md"),
        env("2 0 0 0 0 0\nEnd", "2 0 0 0 0 0\nObstacle #1\nw.off\n0 0 0 0 0 0\nEnd", "s.env:9:1: there are two obstacles #1; expected a number of its own for every obstacle", "messages name obstacles by their number: renumber one of them"),
        env("2 0 0 0 0 0\nEnd\n", "", "s.env:7:6: the file ends too early; expected the pose of obstacle #1, six numbers: x y z α β γ", "the file may be cut short: copy or export it again"),
        env("End\n", "", "s.env:8:12: the file ends too early; expected `Obstacle #k` or `End`", "the file may be cut short: copy or export it again"),
        env("End\n", "End\nBound 0 0 0 1 1 1\n", "s.env:10:1: `Bound` after `End`; expected `Space SE2`, `Space SE3` or `Bounds xmin ymin zmin xmax ymax zmax`", "begin the line with # to make it a comment"),
        env("End\n", "End\nObstacle #2\nmesh.off\n0 0 0 0 0 0\n", "s.env:10:1: `Obstacle` after `End`; expected `Space SE2`, `Space SE3` or `Bounds xmin ymin zmin xmax ymax zmax`", "move `End` behind the last obstacle"),
        env("End\n", "End\nSpace SE4\n", "s.env:10:7: `SE4` is not a space; expected `Space SE2` or `Space SE3`", "the format is described in docs/formats/gempa-environment.md"),
        env("End\n", "End\nSpace\n", "s.env:10:6: `Space` names no space; expected `Space SE2` or `Space SE3`", "the format is described in docs/formats/gempa-environment.md"),
        env("End\n", "End\nSpace SE2\nSpace SE3\n", "s.env:11:1: `Space` is given twice", "remove one of the lines"),
        env("End\n", "End\nBounds -1 -1 -1 9 9\n", "s.env:10:8: bounds has 5 numbers; expected six numbers: xmin ymin zmin xmax ymax zmax", "the format is described in docs/formats/gempa-environment.md"),
        env("End\n", "End\nBounds -1 9 -1 9 -1 1\n", "s.env:10:8: the lowest y, 9, is above the highest, -1; expected six numbers: xmin ymin zmin xmax ymax zmax", "the three lowest come first, then the three highest"),
        env("End\n", "End\nBounds -1 -1 -1 1 1 1\n", "s.env:4:1: the goal configuration is out of bounds: x = 5; expected x from -1 to 1, as `Bounds` says", "move the configuration or widen `Bounds`"),
        env("5 0 0 0 0 0\n\nObstacle #1\nw.off\n2 0 0 0 0 0\nEnd", "5 0 0 0 0.1 0\nEnd\nSpace SE2", "s.env:4:1: the goal configuration leaves the plane; expected z, β and γ equal to 0, as the file says `Space SE2`", "write x y 0 α 0 0, or remove the line `Space SE2`"),
        env("w.off", "nowhere.off", "s.env:7:1: the mesh of Obstacle #1 is not readable: nowhere.off: cannot read the file: no such file", "check the spelling; it is looked for in the folder DIR"),
        env("w.off", "meshes\\w.off", "s.env:7:1: the mesh of Obstacle #1 is not readable: meshes\\w.off: cannot read the file: no such file", "folders in file names are separated by `/`"),
        env("r.off", "r.step", "r.step: this is not a mesh format that is read here; expected a file .off, .txt, .stl, .obj, .dae, .ply, .glb or .gltf (named at s.env:2:1)", "convert the mesh to one of these").with("r.step", "ISO-10303-21;"),
        case(scene, "s.env", ENV, "w.off:6:7: vertex 3 does not exist; expected an index from 0 to 2 (named at s.env:7:1)", "indices of OFF count from 0")
            .with("r.off", TRIANGLE)
            .with("w.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        case(scene, "s.env", ENV, "r.off: the mesh has no triangles (named at s.env:2:1)", "a body needs at least one triangle")
            .with("r.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n")
            .with("w.off", TRIANGLE),
        case(scene, "s.env", ENV, "r.off: vertex (1e12, 0e0, 0e0) is beyond 1e9 m (named at s.env:2:1)", "coordinates are metres: scale the mesh")
            .with("r.off", TRIANGLE.replace("1 0 0", "1e12 0 0"))
            .with("w.off", TRIANGLE),
        case(scene, "s.env", b"Robot\nr\xf6bot.off\n", "s.env:2:2: byte 0xf6 is not UTF-8 text; expected a text file", "save the file as UTF-8; a binary or UTF-16 file cannot be read here"),
        case(scene, "s.env", b"R\0o\0b\0o\0t\0", "s.env:1:2: a zero byte: this is not UTF-8 text; expected a text file", "save the file as UTF-8; a binary or UTF-16 file cannot be read here"),
        case(scene, "scene.xml", "<scene/>", "scene.xml: this is not a problem that is read here; expected the problem of a rigid body: .env, .cfg or .mp.json", "a mesh or a path is not a problem: give the file that names the robot and the obstacles"),
        case(scene, "s.off", TRIANGLE, "s.off: this is not a problem that is read here; expected the problem of a rigid body: .env, .cfg or .mp.json", "a mesh or a path is not a problem: give the file that names the robot and the obstacles"),
    ]);
}
