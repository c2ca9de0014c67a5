//! What is shipped. Written by `mp-bench assets`.

use crate::File;

/// All files, in the order of their paths.
pub const FILES: &[File] = &[
    File {
        path: "meshes/alpha/obstacle-1.0.off",
        bytes: include_bytes!("../assets/meshes/alpha/obstacle-1.0.off"),
    },
    File {
        path: "meshes/alpha/obstacle-1.1.off",
        bytes: include_bytes!("../assets/meshes/alpha/obstacle-1.1.off"),
    },
    File {
        path: "meshes/alpha/obstacle-1.2.off",
        bytes: include_bytes!("../assets/meshes/alpha/obstacle-1.2.off"),
    },
    File {
        path: "meshes/alpha/obstacle-1.3.off",
        bytes: include_bytes!("../assets/meshes/alpha/obstacle-1.3.off"),
    },
    File {
        path: "meshes/alpha/obstacle-1.4.off",
        bytes: include_bytes!("../assets/meshes/alpha/obstacle-1.4.off"),
    },
    File {
        path: "meshes/alpha/obstacle-1.5.off",
        bytes: include_bytes!("../assets/meshes/alpha/obstacle-1.5.off"),
    },
    File { path: "meshes/alpha/robot.off", bytes: include_bytes!("../assets/meshes/alpha/robot.off") },
    File {
        path: "meshes/apartment/armchair.off",
        bytes: include_bytes!("../assets/meshes/apartment/armchair.off"),
    },
    File {
        path: "meshes/apartment/basin.off",
        bytes: include_bytes!("../assets/meshes/apartment/basin.off"),
    },
    File { path: "meshes/apartment/bath.off", bytes: include_bytes!("../assets/meshes/apartment/bath.off") },
    File { path: "meshes/apartment/bed.off", bytes: include_bytes!("../assets/meshes/apartment/bed.off") },
    File {
        path: "meshes/apartment/chair.off",
        bytes: include_bytes!("../assets/meshes/apartment/chair.off"),
    },
    File {
        path: "meshes/apartment/closet.off",
        bytes: include_bytes!("../assets/meshes/apartment/closet.off"),
    },
    File {
        path: "meshes/apartment/counter.off",
        bytes: include_bytes!("../assets/meshes/apartment/counter.off"),
    },
    File {
        path: "meshes/apartment/floor.txt",
        bytes: include_bytes!("../assets/meshes/apartment/floor.txt"),
    },
    File { path: "meshes/apartment/lamp.off", bytes: include_bytes!("../assets/meshes/apartment/lamp.off") },
    File {
        path: "meshes/apartment/piano.off",
        bytes: include_bytes!("../assets/meshes/apartment/piano.off"),
    },
    File {
        path: "meshes/apartment/plant.off",
        bytes: include_bytes!("../assets/meshes/apartment/plant.off"),
    },
    File {
        path: "meshes/apartment/refrigerator.off",
        bytes: include_bytes!("../assets/meshes/apartment/refrigerator.off"),
    },
    File {
        path: "meshes/apartment/round_table.off",
        bytes: include_bytes!("../assets/meshes/apartment/round_table.off"),
    },
    File {
        path: "meshes/apartment/shelves.off",
        bytes: include_bytes!("../assets/meshes/apartment/shelves.off"),
    },
    File { path: "meshes/apartment/sofa.off", bytes: include_bytes!("../assets/meshes/apartment/sofa.off") },
    File {
        path: "meshes/apartment/stool.off",
        bytes: include_bytes!("../assets/meshes/apartment/stool.off"),
    },
    File {
        path: "meshes/apartment/table.off",
        bytes: include_bytes!("../assets/meshes/apartment/table.off"),
    },
    File {
        path: "meshes/apartment/walls.off",
        bytes: include_bytes!("../assets/meshes/apartment/walls.off"),
    },
    File {
        path: "meshes/apartment/wardrobe.off",
        bytes: include_bytes!("../assets/meshes/apartment/wardrobe.off"),
    },
    File { path: "meshes/bugtrap/rod.txt", bytes: include_bytes!("../assets/meshes/bugtrap/rod.txt") },
    File { path: "meshes/bugtrap/trap.off", bytes: include_bytes!("../assets/meshes/bugtrap/trap.off") },
    File {
        path: "meshes/cubicles/column.txt",
        bytes: include_bytes!("../assets/meshes/cubicles/column.txt"),
    },
    File {
        path: "meshes/cubicles/divider.txt",
        bytes: include_bytes!("../assets/meshes/cubicles/divider.txt"),
    },
    File { path: "meshes/cubicles/outer.off", bytes: include_bytes!("../assets/meshes/cubicles/outer.off") },
    File {
        path: "meshes/cubicles/partition.off",
        bytes: include_bytes!("../assets/meshes/cubicles/partition.off"),
    },
    File { path: "meshes/cubicles/robot.txt", bytes: include_bytes!("../assets/meshes/cubicles/robot.txt") },
    File { path: "meshes/cubicles/slab.off", bytes: include_bytes!("../assets/meshes/cubicles/slab.off") },
    File { path: "meshes/gempa/ball.txt", bytes: include_bytes!("../assets/meshes/gempa/ball.txt") },
    File { path: "meshes/gempa/base.txt", bytes: include_bytes!("../assets/meshes/gempa/base.txt") },
    File { path: "meshes/gempa/beam.txt", bytes: include_bytes!("../assets/meshes/gempa/beam.txt") },
    File { path: "meshes/gempa/bench.off", bytes: include_bytes!("../assets/meshes/gempa/bench.off") },
    File {
        path: "meshes/gempa/bench_lamina.txt",
        bytes: include_bytes!("../assets/meshes/gempa/bench_lamina.txt"),
    },
    File { path: "meshes/gempa/column.off", bytes: include_bytes!("../assets/meshes/gempa/column.off") },
    File { path: "meshes/gempa/cone.off", bytes: include_bytes!("../assets/meshes/gempa/cone.off") },
    File {
        path: "meshes/gempa/corridor_lower.off",
        bytes: include_bytes!("../assets/meshes/gempa/corridor_lower.off"),
    },
    File {
        path: "meshes/gempa/corridor_upper.txt",
        bytes: include_bytes!("../assets/meshes/gempa/corridor_upper.txt"),
    },
    File { path: "meshes/gempa/cube.txt", bytes: include_bytes!("../assets/meshes/gempa/cube.txt") },
    File { path: "meshes/gempa/floor.txt", bytes: include_bytes!("../assets/meshes/gempa/floor.txt") },
    File {
        path: "meshes/gempa/robot_angular.txt",
        bytes: include_bytes!("../assets/meshes/gempa/robot_angular.txt"),
    },
    File {
        path: "meshes/gempa/robot_slab.txt",
        bytes: include_bytes!("../assets/meshes/gempa/robot_slab.txt"),
    },
    File {
        path: "meshes/gempa/tetrahedron.txt",
        bytes: include_bytes!("../assets/meshes/gempa/tetrahedron.txt"),
    },
    File { path: "meshes/gempa/tray.txt", bytes: include_bytes!("../assets/meshes/gempa/tray.txt") },
    File {
        path: "meshes/gempa/window_high.off",
        bytes: include_bytes!("../assets/meshes/gempa/window_high.off"),
    },
    File {
        path: "meshes/gempa/window_low.off",
        bytes: include_bytes!("../assets/meshes/gempa/window_low.off"),
    },
    File {
        path: "meshes/gempa/window_middle.off",
        bytes: include_bytes!("../assets/meshes/gempa/window_middle.off"),
    },
    File { path: "meshes/maze/robot.txt", bytes: include_bytes!("../assets/meshes/maze/robot.txt") },
    File { path: "meshes/maze/walls.off", bytes: include_bytes!("../assets/meshes/maze/walls.off") },
    File {
        path: "meshes/planar-bugtrap/robot.txt",
        bytes: include_bytes!("../assets/meshes/planar-bugtrap/robot.txt"),
    },
    File {
        path: "meshes/planar-bugtrap/trap.off",
        bytes: include_bytes!("../assets/meshes/planar-bugtrap/trap.off"),
    },
    File { path: "meshes/windows/box.off", bytes: include_bytes!("../assets/meshes/windows/box.off") },
    File {
        path: "meshes/windows/easy_wall.off",
        bytes: include_bytes!("../assets/meshes/windows/easy_wall.off"),
    },
    File { path: "meshes/windows/robot.off", bytes: include_bytes!("../assets/meshes/windows/robot.off") },
    File {
        path: "meshes/windows/twisty_wall.off",
        bytes: include_bytes!("../assets/meshes/windows/twisty_wall.off"),
    },
    File { path: "paths/alpha.txt", bytes: include_bytes!("../assets/paths/alpha.txt") },
    File { path: "robots/six.urdf", bytes: include_bytes!("../assets/robots/six.urdf") },
    File { path: "scenes/alpha-1.0.env", bytes: include_bytes!("../assets/scenes/alpha-1.0.env") },
    File { path: "scenes/alpha-1.1.env", bytes: include_bytes!("../assets/scenes/alpha-1.1.env") },
    File { path: "scenes/alpha-1.2.env", bytes: include_bytes!("../assets/scenes/alpha-1.2.env") },
    File { path: "scenes/alpha-1.3.env", bytes: include_bytes!("../assets/scenes/alpha-1.3.env") },
    File { path: "scenes/alpha-1.4.env", bytes: include_bytes!("../assets/scenes/alpha-1.4.env") },
    File { path: "scenes/alpha-1.5.env", bytes: include_bytes!("../assets/scenes/alpha-1.5.env") },
    File { path: "scenes/apartment.env", bytes: include_bytes!("../assets/scenes/apartment.env") },
    File { path: "scenes/arm.toml", bytes: include_bytes!("../assets/scenes/arm.toml") },
    File { path: "scenes/bugtrap.env", bytes: include_bytes!("../assets/scenes/bugtrap.env") },
    File { path: "scenes/cubicles.env", bytes: include_bytes!("../assets/scenes/cubicles.env") },
    File { path: "scenes/easy.env", bytes: include_bytes!("../assets/scenes/easy.env") },
    File { path: "scenes/gempa-1.env", bytes: include_bytes!("../assets/scenes/gempa-1.env") },
    File { path: "scenes/gempa-2.env", bytes: include_bytes!("../assets/scenes/gempa-2.env") },
    File { path: "scenes/gempa-3.env", bytes: include_bytes!("../assets/scenes/gempa-3.env") },
    File { path: "scenes/gempa-4.env", bytes: include_bytes!("../assets/scenes/gempa-4.env") },
    File { path: "scenes/maze.env", bytes: include_bytes!("../assets/scenes/maze.env") },
    File { path: "scenes/planar-bugtrap.env", bytes: include_bytes!("../assets/scenes/planar-bugtrap.env") },
    File { path: "scenes/rrs-follow.toml", bytes: include_bytes!("../assets/scenes/rrs-follow.toml") },
    File { path: "scenes/rrs-high.toml", bytes: include_bytes!("../assets/scenes/rrs-high.toml") },
    File { path: "scenes/rrs-low.toml", bytes: include_bytes!("../assets/scenes/rrs-low.toml") },
    File { path: "scenes/rrs-maze.toml", bytes: include_bytes!("../assets/scenes/rrs-maze.toml") },
    File { path: "scenes/rrs-random.toml", bytes: include_bytes!("../assets/scenes/rrs-random.toml") },
    File { path: "scenes/twisty.env", bytes: include_bytes!("../assets/scenes/twisty.env") },
];
