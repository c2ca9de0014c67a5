//! Bad problems of OMPL.app.

use super::*;

#[test]
fn ompl_app_problems() {
    check(&[
        case(
            scene,
            "s.cfg",
            "",
            "s.cfg:1:1: the file is empty; expected the section [problem]",
            "an OMPL.app problem begins with the line [problem]",
        ),
        case(
            scene,
            "s.cfg",
            "[planner]\nrrt=\n",
            "s.cfg:2:5: the file ends too early; expected the section [problem]",
            "an OMPL.app problem begins with the line [problem]",
        ),
        cfg(
            "robot=r.off\n",
            "",
            "s.cfg:1:1: [problem] has no `robot`; expected robot = …",
            "the format is described in docs/formats/ompl-app.md",
        ),
        cfg(
            "robot=r.off\n",
            "robot=\n",
            "s.cfg:2:7: [problem] has no `robot`; expected robot = …",
            "the format is described in docs/formats/ompl-app.md",
        ),
        cfg(
            "start.y=0\n",
            "",
            "s.cfg:1:1: [problem] has no `start.y`; expected start.y = …",
            "the format is described in docs/formats/ompl-app.md",
        ),
        cfg(
            "start.y=0",
            "start.y",
            "s.cfg:5:1: `start.y` has no value; expected key = value",
            "the format is described in docs/formats/ompl-app.md",
        ),
        cfg(
            "start.y=0",
            "start.y=north",
            "s.cfg:5:9: `north` is not a number; expected start.y = a number",
            "the format is described in docs/formats/ompl-app.md",
        ),
        cfg(
            "start.y=0",
            "start.y=0\nstart.y=1",
            "s.cfg:6:1: `start.y` is given twice; expected every key once",
            "remove one of them",
        ),
        cfg(
            "goal.theta=0\n",
            "",
            "s.cfg:1:1: [problem] has no `goal.theta`; expected goal.theta = …",
            "the goal needs x, y, theta. Goals that leave numbers free are in rigid problems (.toml)",
        ),
        cfg(
            "start.y=0",
            "start.y=0\nstart.z=0",
            "s.cfg:1:1: [problem] has no `start.axis.x`; expected start.axis.x = …",
            "in space, start and goal each need x, y, z, theta, axis.x, axis.y, axis.z; in the plane x, y, theta",
        ),
        cfg(
            "start.x=0",
            "start.x=2e9",
            "s.cfg:4:9: the start has 2e9, more than 1e9 m",
            "coordinates are metres",
        ),
        cfg(
            "[problem]",
            "[problem",
            "s.cfg:1:1: the title of a section does not end; expected `]`",
            "the format is described in docs/formats/ompl-app.md",
        ),
        cfg(
            "robot=",
            "control=blimp\nrobot=",
            "s.cfg:2:9: this is a problem with dynamics, `blimp`; expected a problem without `control`",
            "only rigid bodies that move freely are planned for; remove the line to ignore the dynamics",
        ),
        cfg(
            "world=w.off",
            "world=gone.dae",
            "s.cfg:3:7: the mesh of the world is not readable: gone.dae: cannot read the file: no such file",
            "check the spelling; it is looked for in the folder DIR",
        ),
        cfg(
            "world=w.off",
            "volume.min.x=2\nvolume.max.x=1\nvolume.min.y=0\nvolume.max.y=1",
            "s.cfg:3:14: volume.min.x is above volume.max.x, 1; expected the lower of the two",
            "the format is described in docs/formats/ompl-app.md",
        ),
    ]);
}
