//! Whether a body is the mesh of a file. Strict: what is not understood is refused, and nothing is rounded.

use crate::file::Body;

/// The corners of a polygon, in their order.
type Face = Vec<[f64; 3]>;

/// Whether the pieces of a body are the faces of a mesh, one after the other, however they are cut into
/// triangles.
pub(crate) fn is_of(body: &Body, mesh: &[u8]) -> Result<(), String> {
    let faces = read(mesh).ok_or(
        "this program cannot read it: OFF, OBJ, STL and GEMPA text, each vertex and each face of OFF and OBJ on a line of its own",
    )?;
    let differs = |i: usize| Err(format!("face {} of the file is not one of the body", i + 1));
    let mut pieces = body.pieces.iter();
    for (i, face) in faces.iter().enumerate().filter(|(_, face)| face.len() > 2) {
        // The boundary of the triangles is that of the face: an edge inside is one of two triangles, and once
        // in each direction.
        let mut open: Vec<_> = (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]).collect();
        for piece in pieces.by_ref().take(face.len() - 2) {
            let corners: Face = piece.iter().map(|v| body.vertices[*v]).collect();
            if corners.len() != 3 || !corners.iter().all(|corner| face.contains(corner)) {
                return differs(i);
            }
            for [from, to] in (0..3).map(|k| [corners[k], corners[(k + 1) % 3]]) {
                match open.iter().position(|edge| *edge == [from, to]) {
                    Some(k) => drop(open.swap_remove(k)),
                    None => open.push([to, from]),
                }
            }
        }
        if !open.is_empty() {
            return differs(i);
        }
    }
    match pieces.count() {
        0 => Ok(()),
        n => Err(format!("the body has {n} triangles that are not of the file")),
    }
}

/// The faces of a mesh.
fn read(bytes: &[u8]) -> Option<Vec<Face>> {
    let count = bytes.get(80..84).map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]));
    if count.is_some_and(|n| 84 + 50 * u64::from(n) == bytes.len() as u64) {
        // Binary STL. For each triangle a normal, nine numbers, and two bytes that mean nothing.
        let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let corner = |b: &[u8]| [number(b), number(&b[4..]), number(&b[8..])];
        let triangle = |b: &[u8]| b[12..48].chunks(12).map(corner).collect();
        return Some(bytes[84..].chunks(50).map(triangle).collect());
    }
    let text = std::str::from_utf8(bytes).ok()?.trim_start_matches('\u{feff}');
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    let lines: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
    let mut words = lines.iter().flat_map(|line| line.split_whitespace());
    let first = words.next()?;
    let mut corners = Vec::new();
    if first == "OFF" {
        return off(&lines);
    } else if first.eq_ignore_ascii_case("solid") {
        while words.any(|word| word.eq_ignore_ascii_case("vertex")) {
            corners.push(three(&mut words)?);
        }
    } else if let Ok(triangles) = lines[0].parse::<usize>() {
        corners = (0..triangles.checked_mul(3)?).map(|_| three(&mut words)).collect::<Option<_>>()?;
    } else {
        return obj(&lines);
    }
    let whole = corners.len() % 3 == 0 && words.next().is_none();
    whole.then(|| corners.chunks(3).map(<[_]>::to_vec).collect())
}

fn three<'w>(words: &mut impl Iterator<Item = &'w str>) -> Option<[f64; 3]> {
    let mut next = || words.next()?.parse().ok();
    Some([next()?, next()?, next()?])
}

fn off(lines: &[&str]) -> Option<Vec<Face>> {
    let head = lines[0].strip_prefix("OFF")?;
    let (head, lines) = if head.is_empty() { (*lines.get(1)?, &lines[2..]) } else { (head, &lines[1..]) };
    let mut counts = head.split_whitespace().map(str::parse);
    let (vertices, faces) = lines.split_at_checked(counts.next()?.ok()?)?;
    let vertex = |line: &&str| three(&mut line.split_whitespace());
    let vertices: Vec<[f64; 3]> = vertices.iter().map(vertex).collect::<Option<_>>()?;
    let face = |line: &&str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let corners = words.get(1..=words[0].parse().ok()?)?.iter();
        corners.map(|i| vertices.get(i.parse::<usize>().ok()?).copied()).collect()
    };
    (counts.next()?.ok()? == faces.len()).then(|| faces.iter().map(face).collect())?
}

fn obj(lines: &[&str]) -> Option<Vec<Face>> {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for line in lines {
        let mut words = line.split_whitespace();
        match words.next()? {
            "v" => vertices.push(three(&mut words)?),
            "f" => {
                let so_far = vertices.len();
                let index = |word: &str| {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    usize::try_from(if number < 0 { so_far as i64 + number } else { number - 1 }).ok()
                };
                faces.push(words.map(index).collect::<Option<Vec<_>>>()?);
            }
            "vt" | "vn" | "g" | "o" | "s" | "usemtl" | "mtllib" => {}
            _ => return None,
        }
    }
    let corners = |face: &Vec<usize>| face.iter().map(|i| vertices.get(*i).copied()).collect();
    faces.iter().map(corners).collect()
}
