use super::*;

fn body(vertices: &[[f64; 3]], pieces: Vec<Vec<usize>>, parts: Vec<Part>) -> Body {
    let vertices = vertices.to_vec();
    Body {
        name: "it".to_owned(),
        frame: 0,
        of_robot: true,
        radius: 0.0,
        radii: vec![],
        vertices,
        pieces,
        parts,
    }
}

/// Whether the only solid of the pieces holds a point; why there is none.
fn holds(vertices: &[[f64; 3]], pieces: &[Vec<usize>], point: [f64; 3]) -> Result<bool, String> {
    let solid = solids(&body(vertices, pieces.to_vec(), vec![Part::Solid(pieces.len())]))?;
    Ok(solid[0].holds(Vec3::from_array(point)))
}

const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
const TETRAHEDRON: [[f64; 3]; 4] = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];

fn ring(n: usize) -> Vec<Vec<usize>> {
    (0..n).map(|i| vec![i, (i + 1) % n]).collect()
}

fn faces() -> Vec<Vec<usize>> {
    vec![vec![0, 2, 1], vec![0, 1, 3], vec![0, 3, 2], vec![1, 2, 3]]
}

#[test]
fn what_is_inside_is_found() {
    let area = |x, y| holds(&SQUARE, &ring(4), [x, y, 0.0]).unwrap();
    assert!(area(1.0, 1.5) && !area(3.0, 1.0) && !area(-1.0, 1.0));
    let solid = |x, y, z| holds(&TETRAHEDRON, &faces(), [x, y, z]).unwrap();
    assert!(solid(0.5, 0.5, 0.5) && !solid(3.0, 3.0, 3.0) && !solid(-1.0, 1.0, 1.0) && !solid(2.0, 2.0, 2.0));
    // A cavity is outside, and is inside again of what fills it.
    let small: Vec<[f64; 3]> = TETRAHEDRON.iter().map(|v| v.map(|x| 0.5 + 0.25 * x)).collect();
    let all: Vec<[f64; 3]> = TETRAHEDRON.into_iter().chain(small).collect();
    let cavity = faces().into_iter().map(|f| vec![f[1] + 4, f[0] + 4, f[2] + 4]);
    let pieces: Vec<Vec<usize>> = faces().into_iter().chain(cavity).collect();
    assert_eq!(holds(&all, &pieces, [0.6; 3]), Ok(false));
    assert_eq!(holds(&all, &pieces, [0.3; 3]), Ok(true));
    let filled = faces().into_iter().map(|f| f.iter().map(|v| v + 4).collect());
    let pieces: Vec<Vec<usize>> = pieces.into_iter().chain(filled).collect();
    let solid = solids(&body(&all, pieces, vec![Part::Solid(8), Part::Solid(4)])).unwrap();
    assert!(solid.iter().any(|s| s.holds(Vec3::splat(0.6))));
}

#[test]
fn what_is_not_closed_has_no_inside() {
    // Every index of an outline and of a solid, changed to every other one.
    for (vertices, pieces) in [(SQUARE, ring(4)), (TETRAHEDRON, faces())] {
        assert!(holds(&vertices, &pieces, [0.5; 3]).is_ok());
        for (i, k, v) in
            (0..4).flat_map(|i| (0..pieces[0].len()).flat_map(move |k| (0..4).map(move |v| (i, k, v))))
        {
            let mut changed = pieces.clone();
            changed[i][k] = v;
            let why = holds(&vertices, &changed, [0.5; 3]);
            assert_eq!(why.is_ok(), changed == pieces, "{changed:?}: {why:?}");
        }
        let without = holds(&vertices, &pieces[1..], [0.5; 3]).unwrap_err();
        assert!(without.contains("not closed"), "{without}");
    }
    let inward: Vec<Vec<usize>> = faces().into_iter().map(|f| vec![f[1], f[0], f[2]]).collect();
    assert!(holds(&TETRAHEDRON, &inward, [0.5; 3]).unwrap_err().contains("outward"));
    // The same places under other indices are the same.
    let soup: Vec<[f64; 3]> = faces().iter().flatten().map(|v| TETRAHEDRON[*v]).collect();
    let pieces: Vec<Vec<usize>> = (0..4).map(|i| vec![3 * i, 3 * i + 1, 3 * i + 2]).collect();
    assert_eq!(holds(&soup, &pieces, [0.5; 3]), Ok(true));
    // A line counts as a surface only where it is an outline; a single point has no inside.
    let line =
        |pieces: Vec<Vec<usize>>| solids(&body(&SQUARE, pieces, vec![Part::Surface(3)])).map(|s| s.len());
    assert_eq!(line(ring(3)), Ok(0));
    assert!(line(ring(4)[..3].to_vec()).is_err());
    assert!(holds(&SQUARE, &[vec![0]], [0.5; 3]).is_err());
    assert!(holds(&TETRAHEDRON, &[faces(), ring(4)].concat(), [0.5; 3]).is_err());
}

#[test]
fn parts_have_all_pieces() {
    let parts = |parts| solids(&body(&TETRAHEDRON, faces(), parts)).map(|solids| solids.len());
    assert_eq!(parts(vec![Part::Solid(4)]), Ok(1));
    assert_eq!(parts(vec![Part::Surface(4)]), Ok(0));
    for (wrong, why) in [
        (vec![Part::Solid(3)], "closed"),
        (vec![Part::Surface(3)], "fewer"),
        (vec![Part::Solid(5)], "more"),
        (vec![Part::Solid(4), Part::Surface(1)], "more"),
        (vec![Part::Solid(0), Part::Surface(4)], "closed"),
        (vec![Part::Surface(0), Part::Solid(4)], "closed"),
        (vec![], "fewer"),
    ] {
        let found = parts(wrong).unwrap_err();
        assert!(found.contains(why), "{found}");
    }
}

#[test]
fn each_connected_part_has_a_witness() {
    let two: Vec<[f64; 3]> = TETRAHEDRON.into_iter().chain(TETRAHEDRON.map(|v| v.map(|x| x + 9.0))).collect();
    let second = faces().into_iter().map(|f| f.iter().map(|v| v + 4).collect());
    let it = body(&two, faces().into_iter().chain(second).collect(), vec![]);
    let found = witnesses(&it);
    assert_eq!((found.len(), found.iter().filter(|w| w.x < 5.0).count()), (2, 1));
    // Vertices that no piece has are no witnesses; places are one place under several indices.
    let soup: Vec<[f64; 3]> =
        [[7.0; 3]].into_iter().chain(faces().iter().flatten().map(|v| TETRAHEDRON[*v])).collect();
    let it = body(&soup, (0..4).map(|i| vec![3 * i + 1, 3 * i + 2, 3 * i + 3]).collect(), vec![]);
    assert_eq!(witnesses(&it).len(), 1);
}
