//! Surfaces that are told to be hulls, of which each but the hull is refused for one reason (N34, docs/notes/proof.md, L27a).

use impinge::hull::Hull;
use impinge::volume::ProxyFlaw;

use crate::hull::proxies::{ARRAYS, VOLUMES, mesh, proved, proxies};

/// The bytes of a hull told by hand, with the volumes of other bytes.
fn told(kind: u32, vertices: &[u32], faces: &[[u32; 3]], neighbours: &[Vec<u32>], volumes: &[u8]) -> Vec<u8> {
    let flat: Vec<u32> = neighbours.concat();
    let mut numbers = vec![kind, vertices.len() as u32, faces.len() as u32, flat.len() as u32];
    let mut bytes: Vec<u8> = numbers.drain(..).flat_map(u32::to_le_bytes).collect();
    bytes.extend(&volumes[VOLUMES..ARRAYS]);
    numbers.extend(vertices);
    numbers.extend(faces.as_flattened());
    let ends = neighbours.iter().scan(0, |end, own| {
        *end += own.len() as u32;
        Some(*end)
    });
    numbers.push(0);
    numbers.extend(ends);
    numbers.extend(flat);
    bytes.extend(numbers.into_iter().flat_map(u32::to_le_bytes));
    bytes
}

fn neighbours_of(hull: &Hull) -> Vec<Vec<u32>> {
    (0..hull.vertices().len() as u32).map(|vertex| hull.neighbours(vertex).to_vec()).collect()
}

/// Both ends of each edge of a surface whose edges are all bent.
fn ends(vertices: usize, faces: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); vertices];
    for face in faces {
        (0..3).for_each(|edge| neighbours[face[edge] as usize].push(face[(edge + 1) % 3]));
    }
    neighbours.iter_mut().for_each(|own| own.sort_unstable());
    neighbours
}

#[test]
fn n34_a_surface_that_winds_twice_is_no_hull() {
    // Two tips over a star of five points, each edge of which joins every second one: closed, and no edge is bent inward.
    let ring = [[10.0, 0.0], [3.0, 9.5], [-8.0, 6.0], [-8.0, -6.0], [3.0, -9.5]];
    let mut points: Vec<[f64; 3]> = ring.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    points.extend([[0.0, 0.0, 5.0], [0.0, 0.0, -5.0]]);
    let mesh = mesh(&points);
    let own = proxies(&mesh);
    let steps = |step: u32| -> Vec<[u32; 3]> {
        (0..5).flat_map(|at| [[at, (at + step) % 5, 5], [(at + step) % 5, at, 6]]).collect()
    };
    let bytes = |step| told(4, own.hull().vertices(), &steps(step), &ends(7, &steps(step)), &own.to_bytes());
    assert!(proved(&mesh, &bytes(1)).is_ok());
    assert_eq!(proved(&mesh, &bytes(2)).err(), Some(ProxyFlaw::Hull));
}

/// Once round is the hull, twice round is a surface of as many corners, edges and faces as one that is, bent outward everywhere, beyond
/// which there is no point: the one thing wrong with it is that each direction is covered twice.
#[test]
fn n34_a_surface_that_covers_each_direction_twice_is_no_hull() {
    let ring = [[10.0, 0.0], [3.0, 9.5], [-8.0, 6.0], [-8.0, -6.0], [3.0, -9.5]];
    let tips = [[0.0, 0.0, 5.0], [0.0, 0.0, -5.0]];
    for rounds in [1, 2] {
        let mut points: Vec<[f64; 3]> = ring.repeat(rounds).iter().map(|&[x, y]| [x, y, 0.0]).collect();
        points.extend(tips);
        let mesh = mesh(&points);
        let around = 5 * rounds as u32;
        let faces: Vec<[u32; 3]> = (0..around)
            .map(|at| [at, (at + 1) % around])
            .flat_map(|[from, to]| [[from, to, around], [to, from, around + 1]])
            .collect();
        let vertices: Vec<u32> = (1..=around + 2).collect();
        let bytes = told(4, &vertices, &faces, &ends(points.len(), &faces), &proxies(&mesh).to_bytes());
        assert_eq!(proved(&mesh, &bytes).err(), (rounds == 2).then_some(ProxyFlaw::Hull), "{rounds}");
    }
}

/// Each surface is wrong in one way alone, and all points that there are are its corners, so that none is outside.
#[test]
fn n34_surfaces_with_one_dent_or_one_gap_are_no_hull() {
    // Nearly the regular icosahedron: each corner has five neighbours, and no four are in a plane.
    let mut points = Vec::new();
    for [x, y] in [[5.0, 8.0], [5.0, -8.0], [-5.0, 8.0], [-5.0, -8.0]] {
        points.extend([[0.0, x, y], [x, y, 0.0], [y, 0.0, x]]);
    }
    let mesh = mesh(&points);
    let own = proxies(&mesh);
    let (vertices, faces, volumes) = (own.hull().vertices(), own.hull().faces(), own.to_bytes());
    assert_eq!((vertices.len(), faces.len()), (12, 20));
    let judge = |faces: &[[u32; 3]], neighbours: &[Vec<u32>]| {
        proved(&mesh, &told(4, vertices, faces, neighbours, &volumes)).err()
    };
    assert_eq!(judge(faces, &ends(12, faces)), None);

    for at in 0..20 {
        // The other diagonal of two faces that share an edge: it is bent inward, whether or not its ends are told as neighbours.
        let [a, b, c] = faces[at];
        let has_edge = |face: &[u32; 3]| (0..3).any(|edge| [face[edge], face[(edge + 1) % 3]] == [b, a]);
        let beyond = faces.iter().position(has_edge).expect("a face across the edge");
        let d = faces[beyond].into_iter().find(|corner| ![a, b].contains(corner)).expect("a third corner");
        let mut dented = faces.to_vec();
        (dented[at], dented[beyond]) = ([d, b, c], [c, a, d]);
        let mut around = ends(12, &dented);
        assert_eq!(judge(&dented, &around), Some(ProxyFlaw::Hull), "{at}");
        around[c as usize].retain(|&end| end != d);
        around[d as usize].retain(|&end| end != c);
        assert_eq!(judge(&dented, &around), Some(ProxyFlaw::Hull), "{at}");

        // A face is missing, and another one there twice, so that there are as many.
        for twice in (0..20).filter(|&twice| twice != at) {
            let mut gaping = faces.to_vec();
            gaping[at] = faces[twice];
            assert_eq!(judge(&gaping, &ends(12, &gaping)), Some(ProxyFlaw::Hull), "{at} {twice}");
        }
    }

    // Faces more or fewer than there are of corners are none of a hull's arrays, and are not read.
    for count in [19, 21] {
        let other: Vec<[u32; 3]> = faces.iter().cycle().take(count).copied().collect();
        assert_eq!(judge(&other, &ends(12, &other)), Some(ProxyFlaw::Shape), "{count}");
    }
}

#[test]
fn n34_surfaces_that_are_no_hull_are_refused() {
    // A cube, the middles of a facet and of an edge, and a point inside near a facet.
    let mut points: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|x| 4.0 * f64::from(x))).collect();
    points.extend([[2.0, 2.0, 4.0], [2.0, 0.0, 0.0], [2.0, 2.0, 3.5]]);
    let mesh = mesh(&points);
    let own = proxies(&mesh);
    let hull = own.hull();
    let (vertices, faces, neighbours, volumes) =
        (hull.vertices().to_vec(), hull.faces().to_vec(), neighbours_of(hull), own.to_bytes());
    let judge = |vertices: &[u32], faces: &[[u32; 3]], neighbours: &[Vec<u32>]| {
        proved(&mesh, &told(4, vertices, faces, neighbours, &volumes)).err()
    };
    assert_eq!(judge(&vertices, &faces, &neighbours), None);

    let inside_out: Vec<[u32; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(judge(&vertices, &inside_out, &neighbours), Some(ProxyFlaw::Hull));
    let mut open = faces.clone();
    open[3] = open[4];
    assert_eq!(judge(&vertices, &open, &neighbours), Some(ProxyFlaw::Hull));
    for vertex in 0..8 {
        let mut fewer = neighbours.clone();
        fewer[vertex].pop();
        assert_eq!(judge(&vertices, &faces, &fewer), Some(ProxyFlaw::Hull));
        let mut more = neighbours.clone();
        more[vertex].push(vertex as u32 ^ 7);
        more[vertex].sort_unstable();
        assert_eq!(judge(&vertices, &faces, &more), Some(ProxyFlaw::Hull));
    }

    // The other diagonal of the upper side, which is the same surface.
    let upper: Vec<usize> = (0..12).filter(|&at| faces[at].iter().all(|&corner| corner >= 4)).collect();
    let mut turned = faces.clone();
    assert_eq!(upper.len(), 2);
    let is_joined = |corner: u32| upper.iter().all(|&at| faces[at].contains(&corner));
    let diagonal = (4..8).find(|&corner| is_joined(corner)).expect("a diagonal");
    let others = if diagonal == 4 || diagonal == 7 { [5, 7, 6, 4] } else { [4, 5, 7, 6] };
    let [a, b, c, d] = others;
    (turned[upper[0]], turned[upper[1]]) = ([a, b, c], [a, c, d]);
    assert_eq!(judge(&vertices, &turned, &neighbours), None);

    // The upper side as four triangles about a point on it, above it or below it: it is not extreme, or bends edges inward.
    for middle in [9_u32, 11] {
        let mut with = vertices.clone();
        with.push(middle);
        let mut fan: Vec<[u32; 3]> = faces.iter().copied().filter(|face| face.iter().any(|&c| c < 4)).collect();
        fan.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]);
        for own in [vec![], vec![4, 5, 6, 7]] {
            let mut around = neighbours.clone();
            if !own.is_empty() {
                (4..8).for_each(|corner: usize| around[corner].push(8));
            }
            around.push(own);
            assert_eq!(judge(&with, &fan, &around), Some(ProxyFlaw::Hull), "{middle}");
        }
    }
    // Fewer corners than there are.
    let pyramid =
        [[0, 1, 2], [1, 3, 2], [1, 0, 4], [3, 1, 4], [2, 3, 4], [0, 2, 4]].map(|[a, b, c]: [u32; 3]| [a, c, b]);
    assert_eq!(judge(&vertices[..5], &pyramid, &ends(5, &pyramid)), Some(ProxyFlaw::Hull));
    for kind in [0, 1, 2, 3, 5, u32::MAX] {
        assert!(proved(&mesh, &told(kind, &vertices, &faces, &neighbours, &volumes)).is_err(), "{kind}");
    }
}
