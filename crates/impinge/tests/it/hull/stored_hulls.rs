//! Stored surfaces that claim to be hulls. Each one except the hull is rejected, for one reason
//! (docs/notes/proof.md, L27a).

use impinge::hull::Hull;
use impinge::volume::ProxyFlaw;

use crate::hull::proxies::{ARRAYS, VOLUMES, mesh, proxies, read_and_validated};

/// Returns the bytes of a hull made by hand, with the volumes of other bytes.
fn stored_hull(kind: u32, vertices: &[u32], faces: &[[u32; 3]], neighbors: &[Vec<u32>], volumes: &[u8]) -> Vec<u8> {
    let flat: Vec<u32> = neighbors.concat();
    let mut numbers = vec![kind, vertices.len() as u32, faces.len() as u32, flat.len() as u32];
    let mut bytes: Vec<u8> = numbers.drain(..).flat_map(u32::to_le_bytes).collect();
    bytes.extend(&volumes[VOLUMES..ARRAYS]);
    numbers.extend(vertices);
    numbers.extend(faces.as_flattened());
    let ends = neighbors.iter().scan(0, |end, own| {
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
    (0..hull.vertices().len() as u32).map(|vertex| hull.neighbors(vertex).to_vec()).collect()
}

/// Returns the neighbors of each vertex, if every edge of the surface is an edge of the hull.
fn neighbors_by_edges(vertices: usize, faces: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut neighbors = vec![Vec::new(); vertices];
    for face in faces {
        (0..3).for_each(|edge| neighbors[face[edge] as usize].push(face[(edge + 1) % 3]));
    }
    neighbors.iter_mut().for_each(|own| own.sort_unstable());
    neighbors
}

#[test]
fn a_surface_that_winds_twice_is_rejected() {
    // Two tips over a star of five points, whose edges join every second point. The surface is
    // closed, and no edge is bent inward.
    let ring = [[10.0, 0.0], [3.0, 9.5], [-8.0, 6.0], [-8.0, -6.0], [3.0, -9.5]];
    let mut points: Vec<[f64; 3]> = ring.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    points.extend([[0.0, 0.0, 5.0], [0.0, 0.0, -5.0]]);
    let mesh = mesh(&points);
    let own = proxies(&mesh);
    let steps = |step: u32| -> Vec<[u32; 3]> {
        (0..5).flat_map(|at| [[at, (at + step) % 5, 5], [(at + step) % 5, at, 6]]).collect()
    };
    let bytes = |step| {
        stored_hull(4, own.hull().vertices(), &steps(step), &neighbors_by_edges(7, &steps(step)), &own.to_bytes())
    };
    assert!(read_and_validated(&mesh, &bytes(1)).is_ok());
    assert_eq!(read_and_validated(&mesh, &bytes(2)).err(), Some(ProxyFlaw::Hull));
}

/// Checks a surface around the axis twice. It has the Euler characteristic of a hull, is bent
/// outward everywhere, and no point is beyond it. Its only fault is that it covers each direction
/// twice.
#[test]
fn a_surface_that_covers_each_direction_twice_is_rejected() {
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
        let bytes =
            stored_hull(4, &vertices, &faces, &neighbors_by_edges(points.len(), &faces), &proxies(&mesh).to_bytes());
        assert_eq!(read_and_validated(&mesh, &bytes).err(), (rounds == 2).then_some(ProxyFlaw::Hull), "{rounds}");
    }
}

/// Checks surfaces with one fault each. All points are corners, so none is outside.
#[test]
fn surfaces_with_one_dent_or_one_gap_are_rejected() {
    // Nearly the regular icosahedron: each corner has five neighbors, and no four corners lie in a
    // plane.
    let mut points = Vec::new();
    for [x, y] in [[5.0, 8.0], [5.0, -8.0], [-5.0, 8.0], [-5.0, -8.0]] {
        points.extend([[0.0, x, y], [x, y, 0.0], [y, 0.0, x]]);
    }
    let mesh = mesh(&points);
    let own = proxies(&mesh);
    let (vertices, faces, volumes) = (own.hull().vertices(), own.hull().faces(), own.to_bytes());
    assert_eq!((vertices.len(), faces.len()), (12, 20));
    let flaw = |faces: &[[u32; 3]], neighbors: &[Vec<u32>]| {
        read_and_validated(&mesh, &stored_hull(4, vertices, faces, neighbors, &volumes)).err()
    };
    assert_eq!(flaw(faces, &neighbors_by_edges(12, faces)), None);

    for at in 0..20 {
        // The other diagonal of two faces that share an edge is bent inward, whether or not its
        // ends are listed as neighbors.
        let [a, b, c] = faces[at];
        let has_edge = |face: &[u32; 3]| (0..3).any(|edge| [face[edge], face[(edge + 1) % 3]] == [b, a]);
        let beyond = faces.iter().position(has_edge).expect("a face across the edge");
        let d = faces[beyond].into_iter().find(|corner| ![a, b].contains(corner)).expect("a third corner");
        let mut dented = faces.to_vec();
        (dented[at], dented[beyond]) = ([d, b, c], [c, a, d]);
        let mut around = neighbors_by_edges(12, &dented);
        assert_eq!(flaw(&dented, &around), Some(ProxyFlaw::Hull), "{at}");
        around[c as usize].retain(|&end| end != d);
        around[d as usize].retain(|&end| end != c);
        assert_eq!(flaw(&dented, &around), Some(ProxyFlaw::Hull), "{at}");

        // A face is missing and another one occurs twice, so that the count is right.
        for twice in (0..20).filter(|&twice| twice != at) {
            let mut gaping = faces.to_vec();
            gaping[at] = faces[twice];
            assert_eq!(flaw(&gaping, &neighbors_by_edges(12, &gaping)), Some(ProxyFlaw::Hull), "{at} {twice}");
        }
    }

    // A number of faces that does not fit the number of corners is rejected before the arrays are
    // read.
    for count in [19, 21] {
        let other: Vec<[u32; 3]> = faces.iter().cycle().take(count).copied().collect();
        assert_eq!(flaw(&other, &neighbors_by_edges(12, &other)), Some(ProxyFlaw::Shape), "{count}");
    }
}

#[test]
fn surfaces_that_are_no_hull_are_rejected() {
    // A cube, the middles of a facet and of an edge, and a point inside near a facet.
    let mut points: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|x| 4.0 * f64::from(x))).collect();
    points.extend([[2.0, 2.0, 4.0], [2.0, 0.0, 0.0], [2.0, 2.0, 3.5]]);
    let mesh = mesh(&points);
    let own = proxies(&mesh);
    let hull = own.hull();
    let (vertices, faces, neighbors, volumes) =
        (hull.vertices().to_vec(), hull.faces().to_vec(), neighbours_of(hull), own.to_bytes());
    let flaw = |vertices: &[u32], faces: &[[u32; 3]], neighbors: &[Vec<u32>]| {
        read_and_validated(&mesh, &stored_hull(4, vertices, faces, neighbors, &volumes)).err()
    };
    assert_eq!(flaw(&vertices, &faces, &neighbors), None);

    let inside_out: Vec<[u32; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(flaw(&vertices, &inside_out, &neighbors), Some(ProxyFlaw::Hull));
    let mut open = faces.clone();
    open[3] = open[4];
    assert_eq!(flaw(&vertices, &open, &neighbors), Some(ProxyFlaw::Hull));
    for vertex in 0..8 {
        let mut fewer = neighbors.clone();
        fewer[vertex].pop();
        assert_eq!(flaw(&vertices, &faces, &fewer), Some(ProxyFlaw::Hull));
        let mut more = neighbors.clone();
        more[vertex].push(vertex as u32 ^ 7);
        more[vertex].sort_unstable();
        assert_eq!(flaw(&vertices, &faces, &more), Some(ProxyFlaw::Hull));
    }

    // The other diagonal of the upper side gives the same surface.
    let upper: Vec<usize> = (0..12).filter(|&at| faces[at].iter().all(|&corner| corner >= 4)).collect();
    let mut turned = faces.clone();
    assert_eq!(upper.len(), 2);
    let is_joined = |corner: u32| upper.iter().all(|&at| faces[at].contains(&corner));
    let diagonal = (4..8).find(|&corner| is_joined(corner)).expect("a diagonal");
    let others = if diagonal == 4 || diagonal == 7 { [5, 7, 6, 4] } else { [4, 5, 7, 6] };
    let [a, b, c, d] = others;
    (turned[upper[0]], turned[upper[1]]) = ([a, b, c], [a, c, d]);
    assert_eq!(flaw(&vertices, &turned, &neighbors), None);

    // The upper side as four triangles around a point on it or below it: the point is not extreme,
    // or edges are bent inward.
    for middle in [9_u32, 11] {
        let mut with = vertices.clone();
        with.push(middle);
        let mut fan: Vec<[u32; 3]> = faces.iter().copied().filter(|face| face.iter().any(|&c| c < 4)).collect();
        fan.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]);
        for own in [vec![], vec![4, 5, 6, 7]] {
            let mut around = neighbors.clone();
            if !own.is_empty() {
                (4..8).for_each(|corner: usize| around[corner].push(8));
            }
            around.push(own);
            assert_eq!(flaw(&with, &fan, &around), Some(ProxyFlaw::Hull), "{middle}");
        }
    }
    // Fewer corners than the hull has.
    let pyramid =
        [[0, 1, 2], [1, 3, 2], [1, 0, 4], [3, 1, 4], [2, 3, 4], [0, 2, 4]].map(|[a, b, c]: [u32; 3]| [a, c, b]);
    assert_eq!(flaw(&vertices[..5], &pyramid, &neighbors_by_edges(5, &pyramid)), Some(ProxyFlaw::Hull));
    for kind in [0, 1, 2, 3, 5, u32::MAX] {
        assert!(
            read_and_validated(&mesh, &stored_hull(kind, &vertices, &faces, &neighbors, &volumes)).is_err(),
            "{kind}"
        );
    }
}
