//! Mutated files for every format: none may panic, hang or be misread. Deterministic, and bounded by a count:
//! `MP_FUZZ_ITERATIONS` for each format.

use mp_io::fuzz::TARGETS;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Good files, to be spoilt.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let texts: &[&str] = match target {
        "off" => &[
            "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2 0.5 0.5 0.5 1.0\n3 1 2 3 7\n",
            "STCNOFF # all\n3 1\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0 0 0 1 0 255 0 255 1 0\n0 1 0 0 0 1 0 0 255 255 0 1\n3 0 1 2\n",
            "COFF 3 1 0 0 0 0 .1 .2 .3 1 1 0 0 .1 .2 .3 1 0 1 0 .1 .2 .3 1\n5 0 1 2 1 0\n",
        ],
        "gempa-mesh" => &["2\n0 0 0 1 0 0 0 1 0\n# two\n0 0 0\n0 1 0\n0 0 1e-3\n"],
        "gempa-environment" => &[
            "Robot\nr.txt\n0.0 0.0 0.0 0.0 0.0 0.0\n1.0 20.0 0.0 0.7 1.2 0.8\n\n\nObstacle #1\nw.off\n3.0 10 8.0 0.0 0.0 0.0\n\
             Obstacle #2\nw.off\n3.0 10 -8.0 0.0 0.0 0.0\nEnd\n",
            "Robot\r\na mesh.off\r\n0 0 0 0 0 0\r\n1 2 0 3 0 0\r\nEnd\r\nSpace SE2\r\nBounds -1 -1 0 2 3 0\r\n# x\r\n",
        ],
        "gempa-path" => &["3\n0 0 0 0 0 0\n5.0492 -0.7257 -3.2830 2.2233 6.1148 4.0886\n1 1 1 1 1 1\n"],
        "json-path" => &[
            "{\"solved\": true, \"path\": [[0, 0, 0, 0, 0, 0],\n[1.5, -2e-3, 3, 0.1, 0.2, 0.3]], \"name\": \"\\u00e9\"}",
        ],
        "stl" => &[
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
        ],
        "obj" => &[
            "v 0 0 0\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng a\nf 1/1/1 2//1 -2 \\\n 4\ns off\n# c\n",
        ],
        "collada" => &[
            "<?xml version=\"1.0\"?>\n<COLLADA><asset><unit meter=\"0.01\"/><up_axis>Z_UP</up_axis></asset>\n\
             <library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"12\">0 0 0 1 0 0 0 1 0 0 0 1\
             </float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\"/><param name=\"Y\"/>\
             <param name=\"Z\"/></accessor></technique_common></source>\n<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/>\
             </vertices>\n<polylist count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><input semantic=\"NORMAL\" \
             source=\"#p\" offset=\"1\"/><vcount>3 4</vcount><p>0 0 1 1 2 2 0 0 1 1 2 2 3 3</p></polylist><tristrips count=\"1\">\
             <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2 3</p></tristrips></mesh></geometry></library_geometries>\n\
             <library_nodes><node id=\"n\"><scale>1 2 3</scale><instance_geometry url=\"#g\"/></node></library_nodes>\n\
             <library_visual_scenes><visual_scene id=\"s\"><node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><rotate>0 0 1 90\
             </rotate><instance_node url=\"#n\"/><node><lookat>0 0 0 1 0 0 0 0 1</lookat><instance_geometry url=\"#g\"/></node></node>\
             </visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n",
        ],
        "ompl-app" => &[
            "[problem]\nname=a\nrobot=r.dae\nworld=w.dae\nstart.x=0\nstart.y=1\nstart.z=2\nstart.theta=0.5\nstart.axis.x=1\n\
             start.axis.y=0\nstart.axis.z=0\ngoal.x=1\ngoal.y=1\ngoal.z=1\ngoal.theta=0\ngoal.axis.x=0\ngoal.axis.y=0\ngoal.axis.z=1\n\
             volume.min.x=-1\nvolume.min.y=-1\nvolume.min.z=-1\nvolume.max.x=9\nvolume.max.y=9\nvolume.max.z=9\n[planner]\nrrt=\n",
            "[problem]\nrobot = r.dae\nstart.x = 0\nstart.y = 1\nstart.theta = 0\ngoal.x = 1\ngoal.y = 1\ngoal.theta = 0 # x\n",
        ],
        "robot-problem" => &[
            "# six\n[robot]\nurdf = \"a.urdf\"\nsrdf = 'a.srdf'\npackages = \"..\"\nbase = [0, 0.0, 1e-1, 0, 0, 0]\n[robot.limits]\n\
             \"joint 1\" = [-1, 1]\nelbow = [0, 2.5]\n[motion]\nstart = [0, 1]\ngoal = [1, 0]\n[[obstacle]]\nname = \"a\"\n\
             box = [1, 2, 3]\npose = [0, 0, 0, 0, 0, 1]\n[[obstacle]]\nsphere = 0.5\n",
            "motion = { start = [0], goals = [[1], [2]] }\nrobot = { urdf = \"a\" }\n[[obstacle]]\ncylinder = [0.1, 1]\n\
             [[obstacle]]\nmesh = \"w.off\"\n",
        ],
        "planar-world" => &[
            "[world]\nwalls = [[0, 0], [4, 3]]\n[robot]\ndisc = 0.07\n[motion]\nstart = [1, 1]\ngoal = [2, 2]\n[[obstacle]]\n\
             rectangle = [[1, 1], [2, 1.5]]\n[[obstacle]]\npolygon = [[2, 2], [3, 2], [3, 2.5]]\nholes = [[[2.8, 2.1], [2.9, 2.1], [2.9, 2]]]\n",
            "world = { image = \"a.png\", scale = 0.01, origin = [0, 1], threshold = 0.4 }\nrobot = { polygon = [[0, 0], [1, 0], [0, 1]] }\n\
             motion = { start = [0, 0, 1], goals = [[1, 1, 0]] }\n[[obstacle]]\ncircle = [1, 1, 0.5]\n",
        ],
        "ros-map" => &[
            "image: a.pgm\nresolution: 0.05\norigin: [-1, 2.5, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
            "# a\nimage: 'b c.png'\nresolution: 1e-2\norigin:\n- 0\n- -1\n- 0.5\nmode: trinary\n",
        ],
        "map-image" => &["P2\n3 2\n255\n0 255 128\n255 0 0\n", "P1 4 2\n0 1 0 1\n1 1 0 0\n"],
        "joint-path" => &["3 2\n0 0\n0.5 -1e-3\n1 1\n", "1 7\n0 0 0 0 0 0 3.25\n"],
        "json-joint-path" => {
            &["{\"solved\": true, \"path\": [[0, 0, 0],\n[1.5, -2e-3, 3]], \"name\": \"\\u00e9\"}"]
        }
        "csv-path" => &["x [m],y [m]\n0.1,-2\n\n0,3.5\n", " 1 , 2e-3\r\n3,4\r\n"],
        "scene-document" => &[
            r##"{"version": 1, "name": "a", "space": "SE2", "robot": {"name": "r", "shape": {"cube": {"size": [1, 2, 3]}}},
                "start": [0, 0, 0, 0, 0, 0], "goal": [4, 0, 0, 1.5, 0, 0], "bounds": [[-9, -9, 0], [9, 9, 0]], "obstacles": [
                {"name": "b", "color": "#00ff7f", "shape": {"torus": {"ring": 1, "tube": 0.2}}, "scale": [1, 1, 2],
                 "pose": [2, 0, 0.5, 0.1, 0.2, 0.3]},
                {"name": "c", "shape": {"mesh": {"file": "c.off", "off": "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}},
                 "pose": [0, 0, 0, 0, 0, 0]}]}"##,
        ],
        other => panic!("no seeds for {other}"),
    };
    let mut all: Vec<Vec<u8>> = texts.iter().map(|t| t.as_bytes().to_vec()).collect();
    if target == "map-image" {
        all.push(b"P5 3 2 255\n\x00\xff\xff\xff\x90\x00".to_vec());
        all.push(b"P6 1 2 # a\n1000\n\x00\xff\x03\xe8\x00\x00\x00\xff\x01\x00\x00\x09".to_vec());
        all.push(b"P4 9 2\n\x80\x00\x7f\xff".to_vec());
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[7; 18]).unwrap();
        writer.finish().unwrap();
        all.push(bytes);
    }
    if target == "stl" {
        let mut binary = vec![b' '; 84];
        binary[80..].copy_from_slice(&2_u32.to_le_bytes());
        for i in 0..2 * 50_u8 {
            binary.push(if i % 4 == 3 { 63 } else { i });
        }
        all.push(binary);
    }
    all
}

/// Words that formats treat specially, or that are hard to treat.
const WORDS: [&str; 40] = [
    "0",
    "-1",
    "1",
    "3",
    "255",
    "256",
    "65536",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "1e308",
    "1e999",
    "-0",
    "NaN",
    "inf",
    "1,5",
    "0x10",
    ".",
    "-",
    "#",
    "\n",
    "\r\n",
    "\r",
    "\t",
    "\0",
    "\u{feff}",
    "\u{e9}",
    "\u{2028}",
    "OFF",
    "BINARY",
    "Robot",
    "Obstacle #1",
    "End",
    "Bounds",
    "solid",
    "endsolid",
    "v",
    "f",
    "\"",
    "</p>",
];

fn mutated(rng: &mut Pcg64, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut out = seeds[rng.random_range(0..seeds.len())].clone();
    for _ in 0..rng.random_range(1..6) {
        let len = out.len();
        let at = rng.random_range(0..=len);
        let end = (at + rng.random_range(0..12_usize)).min(len);
        match rng.random_range(0..8) {
            0 if at < len => out[at] = rng.random(),
            1 if at < len => out[at] ^= 1 << rng.random_range(0..8),
            2 => drop(out.drain(at..end)),
            3 => out.truncate(at),
            4 => {
                let copy = out[at..end].to_vec();
                let to = rng.random_range(0..=len);
                out.splice(to..to, copy);
            }
            5 => {
                // One word for another.
                let start = out[..at].iter().rposition(u8::is_ascii_whitespace).map_or(0, |i| i + 1);
                let stop = out[at..].iter().position(u8::is_ascii_whitespace).map_or(len, |i| at + i);
                out.splice(start..stop, WORDS[rng.random_range(0..WORDS.len())].bytes());
            }
            6 => {
                let word = WORDS[rng.random_range(0..WORDS.len())];
                out.splice(at..at, word.bytes());
            }
            _ => {
                let other = &seeds[rng.random_range(0..seeds.len())];
                let from = rng.random_range(0..=other.len());
                out.truncate(at);
                out.extend(&other[from..]);
            }
        }
        out.truncate(1 << 16);
    }
    out
}

#[test]
fn export_seeds() {
    for (name, _) in TARGETS {
        if name == "errors" { continue; }
        let folder = format!("{}/../../fuzz/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::create_dir_all(&folder).unwrap();
        for (i, seed) in seeds(name).into_iter().enumerate() {
            std::fs::write(format!("{folder}/good-{}", i + 1), seed).unwrap();
        }
    }
}

#[test]
fn mutated_files_are_read_or_refused() {
    let iterations: u64 = match std::env::var("MP_FUZZ_ITERATIONS") {
        Ok(n) => n.parse().expect("MP_FUZZ_ITERATIONS is a count"),
        Err(_) => 4000,
    };
    for (i, (name, target)) in TARGETS.into_iter().enumerate() {
        let seeds = seeds(name);
        let mut rng = Pcg64::seed_from_u64(i as u64);
        assert!(seeds.iter().all(|seed| target(seed).is_ok()), "{name}: the files to be spoilt are good");
        let mut good = 0;
        for _ in 0..iterations {
            let input = mutated(&mut rng, &seeds);
            match std::panic::catch_unwind(|| target(&input)) {
                Ok(read) => good += u64::from(read.is_ok()),
                Err(_) => panic!("{name} panics on {}", input.escape_ascii()),
            }
        }
        // Both outcomes must be met, or the test tests little.
        assert!(
            iterations < 1000 || (good > iterations / 100 && good < iterations),
            "{name}: {good} were good"
        );
    }
}
