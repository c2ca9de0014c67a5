//! Readers end when they are told to, wherever they are in a file.

use mp_io::{ErrorKind, InMemory, PlanarProblem, Until, read_mesh_of};
use mp_stop::{Cancel, Clock, Interrupt};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Readings of the clock: one for each question, as the steps between them are long.
static READ: AtomicU64 = AtomicU64::new(0);
const STEP: Duration = Duration::from_millis(2);

/// A token that says to end at question `n`.
fn at(n: u64) -> Interrupt {
    READ.store(0, Ordering::SeqCst);
    let clock = Clock::new(|| STEP * u32::try_from(READ.fetch_add(1, Ordering::SeqCst)).unwrap());
    Interrupt::by(Cancel::new(), clock, STEP * u32::try_from(n).unwrap())
}

/// Reads to the end, which takes at least a question for 1024 `rows`; then is interrupted at some of the questions.
fn ends<T>(what: &str, rows: u64, read: impl Fn(Interrupt) -> Result<T, mp_io::Error>) {
    assert!(read(at(u64::from(u32::MAX))).is_ok(), "{what}");
    let questions = READ.load(Ordering::SeqCst);
    assert!(questions * 1024 >= rows, "{what}: {questions} questions for {rows} rows");
    for part in [0.0, 0.1, 0.35, 0.6, 0.9, 0.99] {
        let n = 1 + (part * (questions - 1) as f64) as u64;
        let error =
            read(at(n)).err().unwrap_or_else(|| panic!("{what}: goes on after question {n} of {questions}"));
        assert_eq!(error.kind(), ErrorKind::Interrupted, "{what}: {error}");
        assert_eq!(READ.load(Ordering::SeqCst), n + 1, "{what}: the clock is read after the end");
    }
}

#[test]
fn meshes_points_and_maps() {
    let side = 120;
    let corner = |i: usize, j: usize| format!("{i} {j} {}", (i * j) % 7);
    let vertices: Vec<String> = (0..side).flat_map(|i| (0..side).map(move |j| corner(i, j))).collect();
    let squares: Vec<[usize; 3]> = (0..side - 1)
        .flat_map(|i| {
            (0..side - 1).flat_map(move |j| {
                let k = i * side + j;
                [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]
            })
        })
        .collect();
    let faces = |first: usize, head: &str| -> String {
        squares.iter().map(|[a, b, c]| format!("{head}{} {} {}\n", a + first, b + first, c + first)).collect()
    };
    let obj = format!("v {}\n{}", vertices.join("\nv "), faces(1, "f "));
    let off =
        format!("OFF\n{} {} 0\n{}\n{}", vertices.len(), squares.len(), vertices.join("\n"), faces(0, "3 "));
    let facet = |t: &[usize; 3]| {
        let corners: String = t.iter().map(|&k| format!("vertex {}\n", vertices[k])).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let stl = format!("solid a\n{}endsolid a\n", squares.iter().map(facet).collect::<String>());
    let mut binary = vec![0_u8; 80];
    binary.extend((squares.len() as u32).to_le_bytes());
    for t in &squares {
        binary.extend([0; 12]);
        for &k in t {
            let numbers = vertices[k].split(' ').map(|v| v.parse::<f32>().unwrap());
            numbers.for_each(|v| binary.extend(v.to_le_bytes()));
        }
        binary.extend([0; 2]);
    }
    let rows = squares.len() as u64;
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {rows}\nproperty list uchar int vertex_indices\nend_header\n{}\n{}",
        vertices.len(),
        vertices.join("\n"),
        faces(0, "3 ")
    );
    let collada = format!(
        "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><library_geometries><geometry id=\"g\"><mesh>\
         <source id=\"p\"><float_array id=\"a\">{}</float_array></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\
         <triangles count=\"{rows}\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles></mesh></geometry></library_geometries>\
         <library_visual_scenes><visual_scene id=\"s\"><node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>\
         <scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>",
        vertices.join(" "),
        faces(0, "")
    );
    let places: Vec<f32> =
        vertices.iter().flat_map(|v| v.split(' ')).map(|number| number.parse().unwrap()).collect();
    let corners: Vec<u32> = squares.iter().flatten().map(|&k| k as u32).collect();
    let soup: String = squares.iter().map(|t| t.map(|k| vertices[k].as_str()).join(" ") + "\n").collect();
    let gempa = format!("{rows}\n{soup}");
    let (at, of) = (4 * places.len(), 4 * corners.len());
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{
        "attributes":{{"POSITION":0}},"indices":1}}]}}],"buffers":[{{"byteLength":{}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{at}}},{{"buffer":0,"byteOffset":{at},"byteLength":{of}}}],"accessors":[
        {{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}]}}"#,
        at + of,
        vertices.len(),
        corners.len()
    );
    let json = format!("{json:w$}", w = json.len().next_multiple_of(4));
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut glb = [b"glTF".as_slice(), &word(2), &word(28 + json.len() + at + of)].concat();
    glb.extend([&word(json.len()), b"JSON".as_slice(), json.as_bytes(), &word(at + of), b"BIN\0"].concat());
    places.iter().for_each(|x| glb.extend(x.to_le_bytes()));
    corners.iter().for_each(|k| glb.extend(k.to_le_bytes()));
    for (name, bytes) in [
        ("a.glb", glb),
        ("a.txt", gempa.into_bytes()),
        ("a.dae", collada.into_bytes()),
        ("a.obj", obj.into_bytes()),
        ("a.off", off.into_bytes()),
        ("a.ply", ply.into_bytes()),
        ("a.stl", stl.into_bytes()),
        ("b.stl", binary),
    ] {
        let files = InMemory(|path: &str| (path == name).then_some(&bytes));
        ends(name, rows, |interrupt| read_mesh_of(&Until { files: &files, interrupt }, Path::new(name)));
    }

    let points: Vec<u8> = places.iter().flat_map(|x| x.to_le_bytes()).collect();
    let count = vertices.len();
    let pcd = format!(
        "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT 1\nPOINTS {count}\nDATA binary\n"
    );
    let head = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({count}, 3), }}\n");
    let length = (head.len() as u16).to_le_bytes();
    let mut las = vec![0; 375];
    let mut put = |at: usize, with: &[u8]| las[at..at + with.len()].copy_from_slice(with);
    put(0, b"LASF");
    put(96, &word(375));
    put(105, &12_u16.to_le_bytes());
    put(107, &word(count));
    for (name, bytes) in [
        ("a.pcd", [pcd.as_bytes(), &points].concat()),
        ("a.npy", [b"\x93NUMPY\x01\0", &length[..], head.as_bytes(), &points].concat()),
        ("a.las", [&las, &points[..]].concat()),
        ("a.xyz", vertices.join("\n").into_bytes()),
    ] {
        let read = |interrupt| mp_formats::points::parse_points(Path::new(name), &bytes, interrupt);
        ends(name, count as u64, read);
    }

    let pixels: Vec<u8> = (0..200 * 300_usize).map(|i| if i * i % 11 < 5 { 0 } else { 255 }).collect();
    let image = [b"P5 200 300 255\n".as_slice(), &pixels].concat();
    let yaml = b"image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n";
    let toml = b"[world]\nmap = \"m.yaml\"\n[robot]\ndisc = 0.01\n[motion]\nstart = [1, 1]\ngoal = [2, 2]\n";
    let files = InMemory(|path: &str| match path {
        "m.pgm" => Some(image.clone()),
        "m.yaml" => Some(yaml.to_vec()),
        "m.toml" => Some(toml.to_vec()),
        _ => None,
    });
    ends("a map", 600, |interrupt| {
        PlanarProblem::load_from(&Until { files: &files, interrupt }, Path::new("m.toml"))
    });
}
