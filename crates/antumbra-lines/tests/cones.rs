//! Laws of Plücker cones: split and rejoin, rays inside, real lines found where they are.

use antumbra_kernel::plucker::{edge_row, line_through};
use antumbra_kernel::{Plane, Point, Sign};
use antumbra_lines::{
    Cone, ConeError, Gate, PluckerSpace, RealLines, Split, nearly_real, real_lines,
    start_halfspaces,
};
use dashu_int::IBig;
use dashu_int::ops::BitTest;

struct Random(u64);

impl Random {
    fn below(&mut self, n: i32) -> i32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 20) % n as u64) as i32
    }
    fn point(&mut self, reach: i32, z: i32) -> Point {
        Point::new(
            self.below(2 * reach + 1) - reach,
            self.below(2 * reach + 1) - reach,
            z,
        )
    }
}

fn gate(corners: &[Point]) -> Gate {
    Gate {
        corners: corners.to_vec(),
        plane: Plane::through(corners[0], corners[1], corners[2]),
    }
}

fn square(half: i32, z: i32) -> Gate {
    gate(&[
        Point::new(-half, -half, z),
        Point::new(half, -half, z),
        Point::new(half, half, z),
        Point::new(-half, half, z),
    ])
}

fn triangle(rng: &mut Random, reach: i32, z: i32, slant: i32) -> Option<Gate> {
    let mut p: Vec<Point> = (0..3)
        .map(|_| {
            let lift = rng.below(2 * slant + 1) - slant;
            rng.point(reach, z + lift)
        })
        .collect();
    let plane = Plane::through(p[0], p[1], p[2]);
    if plane.normal[2] == 0 {
        return None;
    }
    if plane.normal[2] < 0 {
        p.reverse();
    }
    Some(gate(&p))
}

#[test]
fn the_start_polytope_holds_every_line_between_its_polygons() {
    let mut rng = Random(5);
    for round in 0..200 {
        let reach = if round % 2 == 0 { 4 } else { 1 << 20 };
        let (Some(a), Some(b)) = (
            triangle(&mut rng, reach, 0, 0),
            triangle(&mut rng, reach, 2 * reach, reach / 2),
        ) else {
            continue;
        };
        let mut space = PluckerSpace::new();
        let start = match start_halfspaces(&mut space, &a, &b) {
            Ok(start) => start,
            Err(ConeError::Flat) => continue,
            Err(e) => panic!("{e}"),
        };
        let cone =
            Cone::new(&mut space, &start.halfspaces).expect("a pair of polygons spans a cone");
        cone.sanity_check(&mut space)
            .expect("the start polytope is sound");
        assert_eq!(real_lines(&mut space, &cone), RealLines::Some);
        for &p in &a.corners {
            for &q in &b.corners {
                if b.plane.side(p) == Sign::Positive || a.plane.side(q) == Sign::Negative {
                    continue;
                }
                let line = line_through(p, q);
                for h in cone.halfspaces() {
                    let row = space.big_row(h.row);
                    let value: dashu_int::IBig = (0..6).map(|k| &row[k] * line[k]).sum();
                    assert!(if h.negative {
                        value <= 0.into()
                    } else {
                        value >= 0.into()
                    });
                }
            }
        }
    }
}

#[test]
fn splitting_keeps_the_cone_sound_and_loses_nothing() {
    let mut rng = Random(11);
    let mut splits = 0;
    for round in 0..120 {
        let reach = if round % 3 == 0 { 3 } else { 1 << 22 };
        let (Some(a), Some(b)) = (
            triangle(&mut rng, reach, 0, 0),
            triangle(&mut rng, reach, reach, 0),
        ) else {
            continue;
        };
        let mut space = PluckerSpace::new();
        let Ok(start) = start_halfspaces(&mut space, &a, &b) else {
            continue;
        };
        let mut cone = Cone::new(&mut space, &start.halfspaces).expect("pointed");
        for _ in 0..12 {
            let (u, v) = (rng.point(reach, reach / 2), rng.point(reach, reach / 3));
            if u == v {
                continue;
            }
            let h = space.halfspace(&edge_row(u, v), false);
            match cone.split(&mut space, h).expect("few facets") {
                Split::Both(inside, outside) => {
                    splits += 1;
                    inside.sanity_check(&mut space).expect("inside part");
                    outside.sanity_check(&mut space).expect("outside part");
                    cone = if rng.below(2) == 0 { inside } else { outside };
                }
                Split::Inside | Split::Outside => {}
            }
        }
    }
    assert!(splits > 200, "only {splits} splits were exercised");
}

/// The counterexample to looking at edges only: every vertex has Q > 0, no edge of the cell
/// crosses the quadric, and yet real lines fill it.
#[test]
fn real_lines_that_touch_no_edge_are_found() {
    let mut space = PluckerSpace::new();
    let (a, b) = (square(4000, -1000), square(4000, 1000));
    let mut start = start_halfspaces(&mut space, &a, &b)
        .expect("two squares")
        .halfspaces;
    let turned = |(x, y): (i32, i32), z: i32| Point::new(-y, x, z);
    for (k, (x, y)) in [(30, 20), (500, 0), (-300, 400), (-200, -450)]
        .into_iter()
        .enumerate()
    {
        let row = edge_row(Point::new(x, y, -1000), turned((x, y), 1000));
        start.push(space.halfspace(&row, k != 0));
    }
    // The rows of the note with the first turned over: the inside of a, outside of the others.
    for h in start.iter_mut().rev().take(4) {
        *h = h.opposite();
    }
    let cone = Cone::new(&mut space, &start).expect("a cell with an interior");
    let vertices: Vec<_> = cone.vertices().collect();
    let signs: Vec<Sign> = vertices
        .iter()
        .map(|&v| space.bilinear_sign(v, v))
        .collect();
    let one_sign = !signs.contains(&Sign::Positive) || !signs.contains(&Sign::Negative);
    assert!(one_sign, "the vertices alone must not decide");
    assert_eq!(real_lines(&mut space, &cone), RealLines::Some);
    // One of them can be had, although vertices and edges show no point where Q has the other sign.
    let mut weight = 0;
    let line = nearly_real(&mut space, &cone, 160, || {
        weight += 1;
        weight
    })
    .expect("real lines");
    for h in cone.halfspaces() {
        let row = space.big_row(h.row);
        let value: IBig = (0..6).map(|k| &row[k] * &line[k]).sum();
        assert!((value > IBig::ZERO) != h.negative && value != IBig::ZERO);
    }
    let q: IBig = (0..3).map(|k| &line[k] * &line[k + 3]).sum();
    let size = line.iter().map(BitTest::bit_len).max().unwrap_or(0);
    assert!(q.bit_len() + 100 < 2 * size, "next to the quadric");
}

/// Signs decided by doubles agree with big integers, along chains of cuts whose vertices were never
/// computed exactly.
#[test]
fn rounded_vertices_never_change_a_sign() {
    let mut rng = Random(23);
    let mut compared = 0;
    for round in 0..60 {
        let reach = [3, 1 << 12, 1 << 22][round % 3];
        let (Some(a), Some(b)) = (
            triangle(&mut rng, reach, 0, 0),
            triangle(&mut rng, reach, reach, reach / 4),
        ) else {
            continue;
        };
        let mut space = PluckerSpace::new();
        let Ok(start) = start_halfspaces(&mut space, &a, &b) else {
            continue;
        };
        let mut cone = Cone::new(&mut space, &start.halfspaces).expect("pointed");
        let mut rows = Vec::new();
        for _ in 0..14 {
            let (u, v) = (rng.point(reach, reach / 2), rng.point(reach, reach / 3));
            if u == v {
                continue;
            }
            let h = space.halfspace(&edge_row(u, v), false);
            rows.push(h.row);
            if let Split::Both(inside, outside) = cone.split(&mut space, h).expect("few facets") {
                cone = if rng.below(2) == 0 { inside } else { outside };
            }
        }
        for vertex in cone.vertices().collect::<Vec<_>>() {
            for &row in &rows {
                let sign = space.sign(row, vertex);
                let exact = space.exact_dot(row, vertex);
                assert_eq!(sign, Sign::of_ordering(exact.cmp(&0.into())));
                compared += 1;
            }
            let sign = space.bilinear_sign(vertex, vertex);
            let exact = space.big_bilinear(vertex, vertex);
            assert_eq!(sign, Sign::of_ordering(exact.cmp(&0.into())));
        }
    }
    assert!(compared > 3000, "only {compared} signs were compared");
}
