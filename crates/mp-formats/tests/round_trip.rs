//! What is written reads back the same.

mod numbers;

use mp_formats::formats::gempa::gempa_mesh_text;
use mp_formats::formats::off::{OffColor, OffDocument, OffFace, off_text};
use mp_formats::formats::stl::stl_text;
use mp_formats::mesh::parse_mesh;
use mp_formats::path::PathFile;
use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};
use numbers::{number, six};
use proptest::collection::vec;
use proptest::prelude::*;

fn unit() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..=1.0, Just(0.0), Just(1.0)]
}

fn color() -> impl Strategy<Value = OffColor> {
    prop_oneof![
        any::<[u8; 3]>().prop_map(OffColor::Rgb),
        any::<[u8; 4]>().prop_map(OffColor::Rgba),
        proptest::array::uniform3(unit()).prop_map(OffColor::RgbF),
        proptest::array::uniform4(unit()).prop_map(OffColor::RgbaF),
    ]
}

fn face_color() -> impl Strategy<Value = Option<OffColor>> {
    prop_oneof![Just(None), color().prop_map(Some), any::<u32>().prop_map(|i| Some(OffColor::Map(i.into())))]
}

fn document() -> impl Strategy<Value = OffDocument> {
    let vertex =
        (proptest::array::uniform3(number()), proptest::array::uniform3(number()), color(), [unit(), unit()]);
    let sizes = (vec(vertex, 1..12), any::<[bool; 3]>(), vec("[ -~]{0,12}", 0..3), any::<Option<u32>>());
    sizes.prop_flat_map(|(vertices, [normals, colors, texture], comments, edges)| {
        let n = vertices.len() as u32;
        let faces = vec((vec(0..n, 1..6), face_color()), 0..8);
        faces.prop_map(move |faces| OffDocument {
            comments: comments.clone(),
            vertices: vertices.iter().map(|v| Point3::from(v.0)).collect(),
            normals: vertices.iter().filter(|_| normals).map(|v| Vector3::from(v.1)).collect(),
            colors: vertices.iter().filter(|_| colors).map(|v| v.2).collect(),
            texture: vertices.iter().filter(|_| texture).map(|v| v.3).collect(),
            faces: faces.into_iter().map(|(corners, color)| OffFace { corners, color }).collect(),
            edges: edges.map(u64::from),
        })
    })
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let triangle = proptest::array::uniform3(proptest::array::uniform3(number()));
    vec(triangle, 1..10).prop_map(|soup| {
        let soup: Vec<_> = soup.into_iter().map(|t| t.map(Point3::from)).collect();
        TriMesh::from_soup(&soup).unwrap()
    })
}

fn triangles(mesh: &TriMesh) -> Vec<[Point3<f64>; 3]> {
    (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect()
}

proptest! {
    #[test]
    fn off_documents(document in document()) {
        let text = document.to_text();
        prop_assert_eq!(OffDocument::parse("t.off", text.as_bytes()).unwrap(), document);
    }

    #[test]
    fn paths(configurations in vec(six(), 1..20)) {
        let path = PathFile { configurations };
        prop_assert_eq!(&PathFile::parse("t.txt", path.to_text().as_bytes()).unwrap(), &path);
        prop_assert_eq!(&PathFile::parse_json("t.json", path.to_json().as_bytes(), &[]).unwrap(), &path);
    }

    #[test]
    fn meshes(mesh in soup()) {
        prop_assert_eq!(&OffDocument::parse("t.off", off_text(&mesh).as_bytes()).unwrap().to_mesh("t.off").unwrap(), &mesh);
        prop_assert_eq!(triangles(&parse_mesh("t.txt", gempa_mesh_text(&mesh).as_bytes()).unwrap()), triangles(&mesh));
        prop_assert_eq!(triangles(&parse_mesh("t.stl", stl_text(&mesh).as_bytes()).unwrap()), triangles(&mesh));
    }

    #[test]
    fn the_same_mesh_in_off_and_obj(document in document()) {
        let mut text = String::new();
        for v in &document.vertices {
            text += &format!("v {:e} {:e} {:e}\n", v.x, v.y, v.z);
        }
        for f in document.faces.iter().filter(|f| f.corners.len() > 2) {
            let corners: Vec<String> = f.corners.iter().map(|c| (c + 1).to_string()).collect();
            text += &format!("f {}\n", corners.join(" "));
        }
        let (off, obj) = (document.to_mesh("t.obj"), parse_mesh("t.obj", text.as_bytes()));
        prop_assert_eq!(off.map_err(|e| e.to_string()), obj.map_err(|e| e.to_string()));
    }
}
