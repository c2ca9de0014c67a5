//! Small files of our own, each a feature of the format.

use super::Scene;
use crate::error::ErrorKind;
use crate::mesh::Axes;
use crate::mesh::parse_mesh;
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::{Point3, Vector3};

const ASSET: &str = "<asset><unit meter=\"1\"/><up_axis>Y_UP</up_axis></asset>";

/// A right triangle and a square above it, sharing their positions.
const POLYGONS: &str = r##"<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="24">0 0 0  1 0 0  1 1 0  0 1 0  0 0 2  1 0 2  1 1 2  0 1 2</float_array>
<technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
PRIMITIVES
</mesh></geometry></library_geometries>"##;

const TRIANGLE: &str =
    r##"<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>"##;

fn dae(asset: &str, primitives: &str, nodes: &str) -> String {
    let library = POLYGONS.replace("PRIMITIVES", primitives);
    format!(
        "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n\
         {asset}\n{library}\n<library_visual_scenes><visual_scene id=\"s\">{nodes}</visual_scene></library_visual_scenes>\n\
         <scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n"
    )
}

const PLAIN: &str = "<node><instance_geometry url=\"#g\"/></node>";

fn parse(text: &str) -> TriMesh {
    parse_mesh("t.dae", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"))
}

fn area(mesh: &TriMesh) -> f64 {
    let of = |i| {
        let [a, b, c] = mesh.triangle(i);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    (0..mesh.triangles().len()).map(of).sum()
}

#[test]
fn all_kinds_of_primitives() {
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    let cases = [
        ("triangles", 2, "<p>0 1 2 0 2 3</p>", "", 2, 1.0),
        ("polylist", 2, "<p>0 1 2 4 5 6 7</p>", "<vcount>3 4</vcount>", 3, 1.5),
        ("polygons", 2, "<p>0 1 2</p><p>4 5 6 7</p>", "", 3, 1.5),
        ("tristrips", 1, "<p>0 1 3 2</p>", "", 2, 1.0),
        ("trifans", 1, "<p>0 1 2 3</p>", "", 2, 1.0),
    ];
    for (tag, count, p, vcount, triangles, expected) in cases {
        let text = dae(ASSET, &format!("<{tag} count=\"{count}\">{input}{vcount}{p}</{tag}>"), PLAIN);
        let mesh = parse(&text);
        assert_eq!(mesh.triangles().len(), triangles, "{tag}");
        assert!((area(&mesh) - expected).abs() < 1e-12, "{tag}");
    }
    // The triangles of a strip all face the same way.
    let strip = parse(&dae(ASSET, &format!("<tristrips>{input}<p>0 1 3 2</p></tristrips>"), PLAIN));
    for i in 0..2 {
        let [a, b, c] = strip.triangle(i);
        assert_eq!((b - a).cross(&(c - a)).normalize(), Vector3::z());
    }
}

#[test]
fn a_mirror_turns_triangles_over() {
    let normal = |scale: &str| {
        let node = format!("<node><scale>{scale}</scale><instance_geometry url=\"#g\"/></node>");
        let [a, b, c] = parse(&dae(ASSET, TRIANGLE, &node)).triangle(0);
        (b - a).cross(&(c - a)).z
    };
    assert_eq!(["1 1 1", "-1 1 1", "-1 -1 1", "1 1 -1", "-1 -1 -1"].map(normal), [1.0, 1.0, 1.0, -1.0, -1.0]);
}

#[test]
fn offsets_of_other_inputs_are_passed_over() {
    let primitives = r##"<source id="n"><float_array count="6">0 0 1 0 1 0</float_array></source>
<triangles count="1" material="m"><input semantic="NORMAL" source="#n" offset="0"/><input semantic="VERTEX" source="#v" offset="2"/><p>1 9 0 0 9 1 1 9 2</p></triangles>"##;
    let mesh = parse(&dae(ASSET, primitives, PLAIN));
    assert_eq!(mesh.triangle(0), [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(1.0, 1.0, 0.0)]);
}

/// FreeCAD numbers the sources of each geometry anew.
#[test]
fn an_id_means_the_element_of_its_own_geometry() {
    let text = dae(ASSET, TRIANGLE, &PLAIN.repeat(2).replacen("#g", "#h", 1));
    let geometry = &text[text.find("<geometry").unwrap()..text.find("</library_geometries>").unwrap()];
    let second = geometry.replace("id=\"g\"", "id=\"h\"").replace("1 0 0  1 1 0", "5 0 0  5 1 0");
    let mesh = parse(&text.replace(geometry, &format!("{geometry}{second}")));
    assert_eq!((mesh.triangle(0)[1].x, mesh.triangle(1)[1].x), (5.0, 1.0));
    // Which of two is meant nobody can tell.
    let twice = dae(ASSET, TRIANGLE, PLAIN).replace(geometry, &geometry.repeat(2));
    let error = parse_mesh("t.dae", twice.as_bytes());
    assert!(error.unwrap_err().to_string().contains("several elements have this id"));
}

/// PhysX writes hulls that physics alone uses: as a mesh without triangles a robot would lose the link.
#[test]
fn geometries_that_no_node_shows_are_an_error() {
    let error = parse_mesh("t.dae", dae(ASSET, TRIANGLE, "<node/>").as_bytes()).unwrap_err().to_string();
    assert!(error.contains("shows no geometry"), "{error}");
    let error = parse_mesh("t.dae", dae(ASSET, "", "<node/>").as_bytes()).unwrap_err().to_string();
    assert!(error.contains("no triangles"), "{error}");
}

#[test]
fn normals_may_be_no_numbers_but_positions_may_not() {
    let primitives = |word: &str| {
        format!(
            "<source id=\"n\"><float_array count=\"6\">0 0 1 {word} {word} {word}</float_array></source>\
             <triangles count=\"1\"><input semantic=\"NORMAL\" source=\"#n\" offset=\"0\"/>\
             <input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/><p>1 0 0 1 1 2</p></triangles>"
        )
    };
    for word in ["-nan(ind)", "NaN", "-1.#IND", "1.#QNAN0"] {
        let text = dae(ASSET, &primitives(word), PLAIN);
        assert_eq!(parse(&text).triangles().len(), 1, "{word}");
        assert!(
            Scene::parse("t.dae", text.as_bytes(), Axes::YUp, Interrupt::never())
                .unwrap()
                .center()
                .iter()
                .all(|v| v.is_finite())
        );
        let text = dae(ASSET, TRIANGLE, PLAIN).replace("0 0 0  1 0 0", &format!("0 0 0  1 {word} 0"));
        let e = parse_mesh("t.dae", text.as_bytes()).unwrap_err();
        assert!(e.to_string().contains(word) && e.line() == Some(5), "{e}");
    }
    assert!(parse_mesh("t.dae", dae(ASSET, &primitives("north"), PLAIN).as_bytes()).is_err());
}

#[test]
fn polygons_of_fewer_than_three_corners_are_left_out() {
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    for primitives in [
        format!("<polylist>{input}<vcount>2 3 1</vcount><p>4 5 0 1 2 7</p></polylist>"),
        format!("<polygons>{input}<p>4 5</p><p>0 1 2</p></polygons>"),
        format!("<polygons>{input}<p>7</p><p>0 1 2</p></polygons>"),
    ] {
        let mesh = parse(&dae(ASSET, &primitives, PLAIN));
        assert_eq!((mesh.triangles().len(), mesh.vertices().len()), (1, 3), "{primitives}");
    }
    let none = format!("<polygons>{input}<p>4 5</p></polygons>");
    assert!(parse_mesh("t.dae", dae(ASSET, &none, PLAIN).as_bytes()).is_err());
}

#[test]
fn a_file_is_read_in_the_encoding_that_it_declares() {
    let text = dae(ASSET, TRIANGLE, PLAIN);
    let declared = |encoding: &str| {
        let head = format!("<?xml version=\"1.0\" encoding=\"{encoding}\"?><!-- # -->");
        text.replace("<?xml version=\"1.0\"?>", &head)
    };
    for encoding in ["ISO-8859-1", "windows-1252"] {
        let mut bytes = declared(encoding).into_bytes();
        let comment = bytes.iter().position(|b| *b == b'#').unwrap();
        bytes[comment] = 0xe4;
        assert_eq!(parse_mesh("t.dae", &bytes).unwrap().triangles().len(), 1, "{encoding}");
    }
    let wide: Vec<u8> = declared("UTF-16").encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(parse_mesh("t.dae", &[b"\xff\xfe".as_slice(), &wide].concat()).unwrap().triangles().len(), 1);
    let undeclared =
        [b"<!-- \xe4 -->", text.trim_start_matches("<?xml version=\"1.0\"?>").as_bytes()].concat();
    let e = parse_mesh("t.dae", &undeclared).unwrap_err();
    assert!(e.report().contains("declare its encoding"), "{}", e.report());
}

#[test]
fn units_and_up_axes() {
    for (up, expected) in [("X_UP", [-2.0, 1.0, 0.0]), ("Y_UP", [1.0, 2.0, 0.0]), ("Z_UP", [1.0, 0.0, -2.0])]
    {
        let asset = format!("<asset><unit name=\"cm\" meter=\"0.01\"/><up_axis>{up}</up_axis></asset>");
        let nodes = "<node><translate>99 199 0</translate><instance_geometry url=\"#g\"/></node>";
        let last = parse(&dae(&asset, TRIANGLE, nodes)).triangle(0)[2];
        assert!((last - Point3::from(expected)).norm() < 1e-12, "{up}: {last}");
    }
}

/// Not read: the part would be of another size.
#[test]
fn one_unit_in_a_file() {
    for (meter, refused) in [("1", false), ("0.01", true)] {
        let part = format!("<geometry id=\"g\"><asset><unit meter=\"{meter}\"/></asset>");
        let text = dae(ASSET, TRIANGLE, PLAIN).replacen("<geometry id=\"g\">", &part, 1);
        assert!(text.contains(&part));
        let said = parse_mesh("t.dae", text.as_bytes()).map_err(|e| e.report());
        assert_eq!(said.as_ref().is_err_and(|e| e.contains("another unit")), refused, "{said:?}");
    }
}

#[test]
fn transforms_apply_in_their_order_and_through_instances() {
    let library = "<library_nodes><node id=\"n\"><scale>2 3 1</scale><instance_geometry url=\"#g\"/></node></library_nodes>";
    let nodes = "<node><matrix>1 0 0 10  0 1 0 20  0 0 1 30  0 0 0 1</matrix>\
                 <node><translate>1 0 0</translate><rotate>0 0 1 90</rotate><instance_node url=\"#n\"/></node></node>";
    let text = dae(ASSET, TRIANGLE, nodes)
        .replace("<library_visual_scenes>", &(library.to_owned() + "<library_visual_scenes>"));
    let mesh = parse(&text);
    // (1, 1, 0) scaled to (2, 3, 0), turned to (−3, 2, 0), moved.
    assert!((mesh.triangle(0)[2] - Point3::new(8.0, 22.0, 30.0)).norm() < 1e-12);
    let twice = parse(&dae(ASSET, TRIANGLE, &PLAIN.repeat(2)));
    assert_eq!((twice.triangles().len(), twice.vertices().len()), (2, 6));
}

#[test]
fn look_at_and_controllers() {
    let nodes = "<node><lookat>5 0 0  5 0 -1  0 1 0</lookat><instance_controller url=\"#c\"/></node>";
    let text = dae(ASSET, TRIANGLE, nodes).replace(
        "<library_visual_scenes>",
        "<library_controllers><controller id=\"c\"><skin source=\"#g\"/></controller></library_controllers><library_visual_scenes>",
    );
    assert_eq!(parse(&text).triangle(0)[1], Point3::new(6.0, 0.0, 0.0));
    // What is up may be slanted: the frame stays square.
    assert_eq!(parse(&text.replace("0 1 0<", "0 1 -1<")), parse(&text));
    // A skin is where its matrix places it, in the frame of the node; also that of a morph.
    let bind = "<bind_shape_matrix>0.5 0 0 7  0 0.5 0 0  0 0 0.5 0  0 0 0 1</bind_shape_matrix>";
    let bound = text.replace("<skin source=\"#g\"/>", &format!("<skin source=\"#g\">{bind}</skin>"));
    assert_eq!(parse(&bound).triangle(0)[1], Point3::new(12.5, 0.0, 0.0));
    let morph = "</controller><controller id=\"m\"><morph source=\"#g\"/></controller>";
    let nested = bound.replace("source=\"#g\"", "source=\"#m\"").replacen("</controller>", morph, 1);
    assert_eq!(parse(&nested), parse(&bound));
    let said = |text: &str| {
        Scene::parse("t.dae", text.as_bytes(), Axes::YUp, Interrupt::never()).unwrap().remarks(Axes::YUp)
    };
    assert!(said(&bound).is_empty() && said(&nested)[0].starts_with("morphs are not applied"));
    for wrong in [bound.replace("7  0", "7"), nested.replace("source=\"#g\"", "source=\"#m\"")] {
        crate::error::check_error(&parse_mesh("t.dae", wrong.as_bytes()).unwrap_err());
    }
}

#[test]
fn the_center_counts_a_corner_once_for_each_normal() {
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    // Two coplanar triangles share two corners: four vertices, though the mesh has other positions as well.
    let flat = format!("<triangles>{input}<p>0 1 2 0 2 3</p></triangles>");
    let center = Scene::parse("t.dae", dae(ASSET, &flat, PLAIN).as_bytes(), Axes::YUp, Interrupt::never())
        .unwrap()
        .center();
    assert!((center - Vector3::new(0.5, 0.5, 0.0)).norm() < 1e-7);
    // An upright triangle on the edge 0 1 has another normal: those two count again.
    let bent = format!("<triangles>{input}<p>0 1 2 0 2 3 0 1 4</p></triangles>");
    let center = Scene::parse("t.dae", dae(ASSET, &bent, PLAIN).as_bytes(), Axes::YUp, Interrupt::never())
        .unwrap()
        .center();
    let expected = (Vector3::new(2.0, 2.0, 0.0) + Vector3::new(1.0, 0.0, 2.0)) / 7.0;
    assert!((center - expected).norm() < 1e-6, "{center}");
    // Normals of the file that agree join them.
    let normals = r##"<source id="n"><float_array count="3">0 0 1</float_array></source>"##;
    let smooth = format!(
        "{normals}<triangles>{input}<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/><p>0 0 1 0 2 0 0 0 2 0 3 0 0 0 1 0 4 0</p></triangles>"
    );
    let center = Scene::parse("t.dae", dae(ASSET, &smooth, PLAIN).as_bytes(), Axes::YUp, Interrupt::never())
        .unwrap()
        .center();
    let expected = (Vector3::new(2.0, 2.0, 0.0) + Vector3::new(0.0, 0.0, 2.0)) / 5.0;
    assert!((center - expected).norm() < 1e-6, "{center}");
}

#[test]
fn normals_of_vertices_count_too() {
    // Eight normals, one for each position: 0 and 4 lie on each other once moved down, and differ in them.
    let normals = r##"<source id="n"><float_array count="24">0 0 1 0 0 1 0 0 1 0 0 1 0 0 -1 0 0 -1 0 0 -1 0 0 -1</float_array></source>"##;
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    let text = dae(ASSET, &format!("{normals}<triangles>{input}<p>0 1 2 0 2 1 4 5 6</p></triangles>"), PLAIN)
        .replace(
            "<input semantic=\"POSITION\" source=\"#p\"/>",
            "<input semantic=\"POSITION\" source=\"#p\"/><input semantic=\"NORMAL\" source=\"#n\"/>",
        )
        .replace("0 0 2  1 0 2  1 1 2", "0 0 0  1 0 0  1 1 0");
    let center = Scene::parse("t.dae", text.as_bytes(), Axes::YUp, Interrupt::never()).unwrap().center();
    // Both sides of the first triangle share three vertices; the second has three of its own in the same places.
    assert!((center - Vector3::new(2.0 / 3.0, 1.0 / 3.0, 0.0)).norm() < 1e-6, "{center}");
    let uneven = text.replace("<p>0 1 2 0 2 1 4 5 6</p>", "<p>0 1 2 0 2 1 4 1 2</p>");
    let center = Scene::parse("t.dae", uneven.as_bytes(), Axes::YUp, Interrupt::never()).unwrap().center();
    assert!((center - Vector3::new(0.5, 0.25, 0.0)).norm() < 1e-6, "{center}");
}

#[test]
fn floods_are_refused() {
    let fails = |text: &str| parse_mesh("t.dae", text.as_bytes()).unwrap_err();
    let bomb = "<!DOCTYPE a [<!ENTITY b \"x\">]>\n<COLLADA>&b;</COLLADA>";
    let e = fails(bomb);
    assert!(e.remedy().unwrap().contains("DOCTYPE"), "{e}");
    let itself = "<node id=\"a\"><instance_node url=\"#a\"/></node>";
    assert_eq!(fails(&dae(ASSET, TRIANGLE, itself)).kind(), ErrorKind::TooLarge);
    // Each node holds the next one ten times over: 10^20 triangles.
    let mut nodes = String::new();
    for i in 0..20 {
        let next = format!("<instance_node url=\"#n{}\"/>", i + 1).repeat(10);
        nodes += &format!("<node id=\"n{i}\">{next}</node>");
    }
    nodes += "<node id=\"n20\"><instance_geometry url=\"#g\"/></node>";
    assert_eq!(fails(&dae(ASSET, TRIANGLE, &nodes)).kind(), ErrorKind::TooLarge);
    let wide = format!("<COLLADA {}/>", (0..100_000).map(|i| format!("a{i}=\"\" ")).collect::<String>());
    assert_eq!(fails(&wide).kind(), ErrorKind::TooLarge);
    let spaces: String = (0..10_000).map(|i| format!("<a xmlns:n{i}=\"u\">")).collect();
    assert_eq!(fails(&spaces).kind(), ErrorKind::TooLarge);
    let deep = "<a>".repeat(300_000);
    assert_eq!(fails(&deep).kind(), ErrorKind::Format);
    let deep = format!("<COLLADA>{}{}</COLLADA>", "<node>".repeat(300_000), "</node>".repeat(300_000));
    assert_eq!(fails(&deep).kind(), ErrorKind::Format);
    let counts = TRIANGLE.replace("count=\"1\"", "count=\"99999999999\"");
    assert!(fails(&dae(ASSET, &counts, PLAIN)).to_string().contains("count=\"99999999999\""));
}

#[test]
fn places_are_right_whatever_the_line_ends() {
    for ends in ["\n", "\r\n"] {
        let text = dae(ASSET, &TRIANGLE.replace("<p>0 1 2</p>", "<p>0\n 1 8</p>"), PLAIN).replace('\n', ends);
        let e = parse_mesh("t.dae", text.as_bytes()).unwrap_err();
        assert_eq!((e.line(), e.column()), (Some(9), Some(4)), "{e}");
        assert_eq!(e.message(), "index 8 is out of range");
    }
}

/// As SketchUp writes surfaces with their edges: positions and normals in `<vertices>`, triangles and lines that
/// share them, edges alone in a geometry of their own, and a count of lines that is wrong.
fn sketchup(lines: &str) -> String {
    let normals = "<source id=\"n\"><float_array count=\"24\">0 0 1 0 0 1 0 0 1 0 0 1 0 0 -1 0 0 -1 0 0 -1 0 0 -1</float_array></source>";
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    let both = format!(
        "{normals}<triangles count=\"2\" material=\"face\">{input}<p>0 1 2 2 1 0</p></triangles>\
         <lines count=\"9\" material=\"edge\">{input}<p>{lines}</p></lines>"
    );
    dae(ASSET, &both, PLAIN).replace(
        "<input semantic=\"POSITION\" source=\"#p\"/>",
        "<input semantic=\"POSITION\" source=\"#p\"/><input semantic=\"NORMAL\" source=\"#n\"/>",
    )
}

fn center(text: &str) -> Vector3<f64> {
    Scene::parse("t.dae", text.as_bytes(), Axes::YUp, Interrupt::never())
        .unwrap_or_else(|e| panic!("{e}"))
        .center()
}

#[test]
fn the_center_counts_the_ends_of_lines() {
    let text = sketchup("0 1 1 2 4 6");
    // The triangles have the vertices 0, 1 and 2, the lines 0, 1, 2, 4 and 6: eight in all.
    let expected = Vector3::new(2.0 * (0.0 + 1.0 + 1.0) + 0.0 + 1.0, 2.0 * 1.0 + 0.0 + 1.0, 2.0 + 2.0) / 8.0;
    assert!((center(&text) - expected).norm() < 1e-6, "{}", center(&text));
    // Every instance counts.
    let shifted = "<node><translate>10 0 0</translate><instance_geometry url=\"#g\"/></node>";
    let twice = text.replace(PLAIN, &(PLAIN.to_owned() + shifted));
    assert!((center(&twice) - expected - Vector3::new(5.0, 0.0, 0.0)).norm() < 1e-6);
    // So do geometries of lines alone.
    let edge = "<geometry id=\"e\"><mesh><source id=\"ep\"><float_array count=\"6\">0 0 9 0 0 18</float_array></source>\
                <vertices id=\"ev\"><input semantic=\"POSITION\" source=\"#ep\"/></vertices>\
                <lines count=\"1\"><input semantic=\"VERTEX\" source=\"#ev\" offset=\"0\"/><p>1 0</p></lines></mesh></geometry>";
    let alone = text
        .replace("</library_geometries>", &(edge.to_owned() + "</library_geometries>"))
        .replace(PLAIN, &(PLAIN.to_owned() + "<node><instance_geometry url=\"#e\"/></node>"));
    let expected = (8.0 * expected + Vector3::new(0.0, 0.0, 27.0)) / 10.0;
    assert!((center(&alone) - expected).norm() < 1e-6, "{}", center(&alone));
}

#[test]
fn lines_are_no_part_of_the_mesh() {
    let text = sketchup("0 1 1 2 4 6");
    let mesh = parse(&text);
    assert_eq!((mesh.triangles().len(), mesh.vertices().len()), (2, 3));
    assert_eq!(mesh.aabb().max, Point3::new(1.0, 1.0, 0.0));
    // Lines before the polygons they share positions with leave the mesh as it is.
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    let first = dae(ASSET, &format!("<lines count=\"2\">{input}<p>6 2 2 7</p></lines>{TRIANGLE}"), PLAIN);
    assert_eq!(parse(&first), parse(&dae(ASSET, TRIANGLE, PLAIN)));
    assert!((center(&first) - Vector3::new(4.0, 4.0, 4.0) / 6.0).norm() < 1e-6);
}

#[test]
fn strips_of_lines_and_empty_lines() {
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    let with = |lines: &str| center(&dae(ASSET, &format!("{TRIANGLE}{lines}"), PLAIN));
    // Four ends of one strip and two of another: 0 1 5 4, 4 7.
    let strips = with(&format!("<linestrips count=\"2\">{input}<p>0 1 5 4</p><p>4 7</p></linestrips>"));
    assert!((strips - Vector3::new(4.0, 2.0, 6.0) / 8.0).norm() < 1e-6, "{strips}");
    // The importer goes by the count where it is zero, and knows no points.
    for nothing in [
        "<lines count=\"0\"/>",
        "<lines count=\"0\"><p>4 5</p></lines>",
        "<polylist count=\"0\"/>",
        "<triangles/>",
        "<points count=\"1\"><p>4</p></points>",
    ] {
        assert!((with(nothing) - Vector3::new(2.0, 1.0, 0.0) / 3.0).norm() < 1e-6, "{nothing}");
    }
}

#[test]
fn lines_of_an_odd_number_of_ends_are_refused() {
    for (lines, message) in [("0 1 2", "<p> has 3 ends of lines"), ("0 8", "index 8 is out of range")] {
        let e = parse_mesh("t.dae", sketchup(lines).as_bytes()).unwrap_err();
        assert_eq!(e.message(), message);
    }
}

#[test]
fn groups_before_one_with_normals_join_whatever_their_faces() {
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    let normals = "<source id=\"n\"><float_array count=\"3\">0 0 1</float_array></source>";
    let bent = format!("{normals}<triangles>{input}<p>0 1 2 0 1 4</p></triangles>");
    let lit = format!(
        "<triangles>{input}<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/><p>4 0 5 0 6 0</p></triangles>"
    );
    // The corners of the bent group are 0, 1, 2 and 4 once; alone, 0 and 1 count for either face.
    let before = center(&dae(ASSET, &format!("{bent}{lit}"), PLAIN));
    assert!((before - Vector3::new(4.0, 2.0, 8.0) / 7.0).norm() < 1e-6, "{before}");
    let after = center(&dae(ASSET, &format!("{lit}{bent}"), PLAIN));
    assert!((after - Vector3::new(5.0, 2.0, 8.0) / 9.0).norm() < 1e-6, "{after}");
}
