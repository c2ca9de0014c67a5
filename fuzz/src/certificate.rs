//! Certificates: the program that replays them shares no code with the other crates, and has no module for fuzzing.

use mp_verify_certificate::{is_of_meshes, is_of_path, verify};
use xxhash_rust::xxh3::xxh3_128;

/// Reads any bytes. The error is why they prove nothing.
pub(crate) type Target = fn(&[u8]) -> Result<(), String>;

/// What is read: a name, and the function to call.
pub(crate) const TARGETS: [(&str, Target); 3] = [
    ("certificate", certificate),
    ("certificate-mesh", certificate_mesh),
    ("certificate-path", certificate_path),
];

/// A certificate without its checksum: the right one is put behind it.
pub(crate) fn sealed(text: &str) -> String {
    format!("{text},\n\"checksum\":\"{:032x}\"}}\n", xxh3_128(text.as_bytes()))
}

/// Certificates, which are replayed.
fn certificate(bytes: &[u8]) -> Result<(), String> {
    let proved = verify(&sealed(text(bytes)?))?;
    assert!(proved.clearance.is_none_or(|c| c > 0.0) && proved.configurations > 0, "{proved:?}");
    Ok(())
}

/// Meshes, with which a body is compared.
fn certificate_mesh(bytes: &[u8]) -> Result<(), String> {
    is_of_meshes(&sealed(STILL), &[("wall".to_owned(), bytes.to_vec())]).map(drop)
}

/// Paths, with which that of a certificate is compared.
fn certificate_path(bytes: &[u8]) -> Result<(), String> {
    is_of_path(&sealed(STILL), text(bytes)?)
}

fn text(bytes: &[u8]) -> Result<&str, String> {
    std::str::from_utf8(bytes).map_err(|e| e.to_string())
}

/// A rounded triangle beside a wall of two triangles.
const STILL: &str = r#"{"certificate":2,"scene":"still","columns":["x [m]","y [m]"],"model":{"steps":[{"line":0},{"line":1}],"time":null,
"drive":null,"frames":[{"plane":{"first":0,"yaw":null}},{"fixed":{"parent":null,"pose":[0,0,0,0,0,0,1]}}],"bodies":[{"name":"robot",
"frame":0,"of_robot":true,"radius":0.4,"vertices":[[0,0,0],[0.1,0,0],[0,0.1,0]],"pieces":[[0,1,2]],"parts":[{"surface":1}]},{"name":"wall","frame":1,"of_robot":false,
"radius":0,"vertices":[[2,0,0],[2,1,0],[2,1,1],[2,0,1]],"pieces":[[0,1,2],[0,2,3]],"parts":[{"surface":2}]}],"pairs":[{"body":0,"others":[1]}]},
"path":[[0,0],[0.5,0.25]],"clearance":0.5,"edges":[[[[1,0.8]]]]"#;
