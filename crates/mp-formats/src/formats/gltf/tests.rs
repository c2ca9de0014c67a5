//! Files of the corpus, and what becomes of them when they are changed.

use super::*;
use crate::files::Disk;
use crate::mesh::{parse_mesh, read_mesh_with};

const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/gltf/good-");

/// A tetrahedron with three edges of length 1, moved 0.5 up along z, doubled, turned so that y becomes z, and moved 1 along z.
#[test]
fn triangles_are_at_the_places_of_their_nodes() {
    let [binary, text] = ["1", "2"].map(|k| std::fs::read(format!("{CORPUS}{k}")).unwrap());
    let mesh = parse_mesh("m.glb", &binary).unwrap();
    assert_eq!(parse_mesh("m.gltf", &text).unwrap(), mesh);
    assert!((mesh.signed_volume() - 8.0 / 6.0).abs() < 1e-14 && mesh.topology().is_solid());
    let (low, high) = (mesh.aabb().min, mesh.aabb().max);
    let off = (low - Point3::new(0.0, -3.0, 1.0)).amax().max((high - Point3::new(2.0, -1.0, 3.0)).amax());
    assert!(off < 1e-14, "{low} {high}");
}

#[test]
fn extensions_that_are_needed_are_read_or_refused() {
    let text = std::fs::read_to_string(format!("{CORPUS}2")).unwrap();
    let with = |key: &str, name: &str| text.replacen('{', &format!("{{\"{key}\":[\"{name}\"],"), 1);
    for name in ["KHR_materials_unlit", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual"] {
        let read = parse_mesh("m.gltf", with("extensionsRequired", name).as_bytes());
        assert_eq!(read.unwrap(), parse_mesh("m.gltf", text.as_bytes()).unwrap(), "{name}");
    }
    for name in ["EXT_mesh_gpu_instancing", "KHR_mesh_quantization", "MY_own", ""] {
        let e = parse_mesh("m.gltf", with("extensionsRequired", name).as_bytes()).unwrap_err();
        assert!(e.kind() == ErrorKind::Unsupported && e.message().contains(name), "{e}");
        crate::error::check_error(&e);
        assert!(parse_mesh("m.gltf", with("extensionsUsed", name).as_bytes()).is_ok());
    }
    // All but one of the places of a mesh would be missing.
    let instances =
        text.replacen("\"mesh\":", "\"extensions\":{\"EXT_mesh_gpu_instancing\":{}},\"mesh\":", 1);
    let e = parse_mesh("m.gltf", instances.as_bytes()).unwrap_err();
    assert!(e.kind() == ErrorKind::Unsupported && e.message().contains(INSTANCES), "{e}");
}

/// A mesh that nothing shows would be missing from a robot without a word.
#[test]
fn meshes_that_no_node_shows_are_an_error() {
    let text = std::fs::read_to_string(format!("{CORPUS}2")).unwrap();
    let error = |text: &str| parse_mesh("m.gltf", text.as_bytes()).unwrap_err().to_string();
    assert!(error(&text.replace("\"mesh\":", "\"mosh\":")).contains("shows no mesh"));
    assert!(error(&text.replace("\"scene\":0", "\"scene\":7")).contains("there is no scene 7"));
}

#[test]
fn morph_targets_count_by_their_weights() {
    let text = std::fs::read_to_string(format!("{CORPUS}2")).unwrap();
    let plain = parse_mesh("m.gltf", text.as_bytes()).unwrap();
    // The positions are a target too: with a weight of 1 all is twice as far from the origin of the mesh.
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mesh = &mut json["meshes"][0];
    let positions = mesh["primitives"][0]["attributes"]["POSITION"].clone();
    mesh["primitives"][0]["targets"] = serde_json::json!([{"POSITION": positions}, {"NORMAL": 99}]);
    let node = json["nodes"].as_array().unwrap().iter().position(|n| n.get("mesh").is_some()).unwrap();
    let mut volume = |of_mesh: &str, of_node: &str| {
        let number = |text: &str| serde_json::from_str(text).unwrap();
        json["meshes"][0]["weights"] = number(of_mesh);
        json["nodes"][node].as_object_mut().unwrap().remove("weights");
        if !of_node.is_empty() {
            json["nodes"][node]["weights"] = number(of_node);
        }
        parse_mesh("m.gltf", json.to_string().as_bytes())
            .map(|mesh| mesh.signed_volume() / plain.signed_volume())
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    near(volume("[1, 1]", "").unwrap(), 8.0);
    near(volume("[0, 1]", "").unwrap(), 1.0);
    near(volume("[]", "[2.0]").unwrap(), 27.0);
    near(volume("[1, 1]", "[0, 0]").unwrap(), 1.0);
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let indices = json["meshes"][0]["primitives"][0]["indices"].clone();
    json["meshes"][0]["primitives"][0]["targets"] = serde_json::json!([{"POSITION": indices}]);
    json["meshes"][0]["weights"] = serde_json::json!([1]);
    assert!(parse_mesh("m.gltf", json.to_string().as_bytes()).is_err());
}

/// They alone say where a skinned mesh is, not its node and those above.
#[test]
fn skins_are_where_their_joints_are() {
    let text = std::fs::read_to_string(format!("{CORPUS}2")).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    // All four vertices half by a joint that stands at 6 and whose place in the mesh is 2, half by one that stands still.
    let mut bytes = [[0, 1, 0, 0].repeat(4), [128, 128, 0, 0].repeat(4)].concat();
    for moved in [-2.0_f32, 0.0] {
        let bind = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, moved, 0.0, 0.0, 1.0_f32];
        bytes.extend(bind.iter().flat_map(|v| v.to_le_bytes()));
    }
    let mut push = |pointer: &str, value| {
        json.pointer_mut(pointer).unwrap().as_array_mut().unwrap().push(value);
    };
    push("/buffers", serde_json::json!({"uri": "skin.bin", "byteLength": bytes.len()}));
    push("/bufferViews", serde_json::json!({"buffer": 1, "byteLength": bytes.len()}));
    for (offset, component, count, kind) in
        [(0, 5121, 4, "VEC4"), (16, 5121, 4, "VEC4"), (32, 5126, 2, "MAT4")]
    {
        let numbers = serde_json::json!({"bufferView": 2, "byteOffset": offset, "componentType": component,
            "count": count, "type": kind, "normalized": offset == 16});
        push("/accessors", numbers);
    }
    push("/nodes", serde_json::json!({"translation": [6, 0, 0]}));
    push("/nodes", serde_json::json!({}));
    push("/scenes/0/nodes", 2.into());
    push("/scenes/0/nodes", 3.into());
    let attributes = &mut json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = 2.into();
    attributes["WEIGHTS_0"] = 3.into();
    json["nodes"][1]["skin"] = 0.into();
    json["skins"] = serde_json::json!([{"joints": [2, 3], "inverseBindMatrices": 4}]);
    let read = |json: &serde_json::Value| {
        let (text, interrupt) = (json.to_string(), Interrupt::never());
        let beside = &|_: &str| Ok(bytes.clone());
        super::read(
            "m.gltf",
            text.as_bytes(),
            &mut Reading { axes: Axes::OfFile, interrupt, remark: &mut |_| (), beside },
        )
    };
    let mesh = read(&json).unwrap();
    assert_eq!((mesh.aabb().min, mesh.aabb().max), ([2.0, 0.0, 0.0].into(), [3.0, 1.0, 1.0].into()));
    for (pointer, bad) in [
        ("/nodes/1/skin", 1),
        ("/skins/0/joints/1", 99),
        ("/accessors/2/count", 3),
        ("/accessors/4/count", 1),
    ] {
        let mut json = json.clone();
        *json.pointer_mut(pointer).unwrap() = bad.into();
        crate::error::check_error(&read(&json).unwrap_err());
    }
    json["skins"][0]["joints"].as_array_mut().unwrap().pop();
    assert!(read(&json).is_err());
}

#[test]
fn strips_fans_mirrors_and_files_beside() {
    let text = std::fs::read_to_string(format!("{CORPUS}2")).unwrap();
    let area = |text: &str| parse_mesh("m.gltf", text.as_bytes()).map(|mesh| mesh.triangles().len());
    // 0 2 1 0 1 3 1 2 3 0 3 2: triangles with two equal corners are dropped.
    assert!(area(&text.replace("\"mode\":4", "\"mode\":5")).unwrap() >= 4);
    assert!(area(&text.replace("\"mode\":4", "\"mode\":6")).unwrap() >= 4);
    let points = area(&text.replace("\"mode\":4", "\"mode\":0")).unwrap_err();
    assert!(points.remedy().is_some_and(|help| help.contains("at least one triangle")), "{points}");
    let mirrored = text.replace("\"scale\":[2,2,2]", "\"scale\":[2,-2,2]");
    let mirrored = parse_mesh("m.gltf", mirrored.as_bytes()).unwrap();
    assert!(mirrored.signed_volume() > 1.3);
    let folder = tempfile::tempdir().unwrap();
    let (_, rest) = text.split_once("base64,").unwrap();
    let (data, _) = rest.split_once('"').unwrap();
    std::fs::write(folder.path().join("a ö.bin"), base64(data).unwrap()).unwrap();
    // Some writers make lines of it.
    let lines = text.replace(data, &format!("{}\\n{}\\r\\n", &data[..8], &data[8..]));
    assert_eq!(area(&lines).unwrap(), area(&text).unwrap());
    let apart = text.replace(&format!("data:application/octet-stream;base64,{data}"), "a%20%C3%B6.bin");
    std::fs::write(folder.path().join("m.gltf"), &apart).unwrap();
    let read = read_mesh_with(&Disk, &folder.path().join("m.gltf"), Axes::OfFile).unwrap();
    assert_eq!(read, parse_mesh("m.gltf", text.as_bytes()).unwrap());
    let gone = parse_mesh("m.gltf", apart.as_bytes()).unwrap_err();
    assert!(gone.remedy().is_some_and(|help| help.contains("as one file")), "{gone}");
}
