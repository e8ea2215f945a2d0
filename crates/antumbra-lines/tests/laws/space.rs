//! The laws of cutting: written once, run for every space.

use antumbra_kernel::{Point2, crossing2d, orient2d};
use antumbra_lines::{Cut, Half, LineSpace, Pencil, PlaneLines, Position, Space3, Wall, facet};

use crate::{Random, cones};

/// How many rays a piece has at least.
trait Lawful: LineSpace {
    const RAYS: usize;
}

impl Lawful for Space3 {
    const RAYS: usize = 3;
}

impl Lawful for PlaneLines {
    const RAYS: usize = 3;
}

impl Lawful for Pencil {
    const RAYS: usize = 2;
}

/// Whether a ray lies in a closed piece.
fn holds<S: Lawful>(space: &S, piece: &S::Piece, ray: &S::Ray) -> bool {
    space
        .facets(piece)
        .all(|f| space.sign(f.plane, ray) != f.side.opposite().sign())
}

/// A piece holds its rays, and has an inside: no facet holds all of them.
fn is_piece<S: Lawful>(space: &S, piece: &S::Piece) {
    let rays: Vec<&S::Ray> = space.rays(piece).collect();
    assert!(rays.len() >= S::RAYS, "{piece:?}");
    assert!(rays.iter().all(|ray| holds(space, piece, ray)), "{piece:?}");
    for facet in space.facets(piece) {
        let inside = facet.side.sign();
        assert!(rays.iter().any(|r| space.sign(facet.plane, r) == inside));
    }
}

/// Cuts a piece and checks the laws of one cut; returns the parts, negative first.
fn lawful_cut<S: Lawful>(
    space: &mut S,
    piece: &S::Piece,
    plane: S::Plane,
    wall: Wall,
) -> [Option<S::Piece>; 2] {
    let position = space.position(piece, plane);
    let whole: Vec<S::Ray> = space.rays(piece).cloned().collect();
    match space.cut(piece.clone(), plane, wall) {
        Cut::Whole(half, same) => {
            assert_eq!(position, Position::In(half));
            is_piece(space, &same);
            let mut parts = [None, None];
            parts[half.index()] = Some(same);
            parts
        }
        Cut::Parts(parts) => {
            assert_eq!(position, Position::Both);
            for (half, part) in [Half::Negative, Half::Positive].into_iter().zip(&parts) {
                is_piece(space, part);
                assert_eq!(space.position(part, plane), Position::In(half));
                // Nothing is added, and one facet is new.
                assert!(space.rays(part).all(|ray| holds(space, piece, ray)));
                let new: Vec<_> = space.facets(part).filter(|f| f.wall == wall).collect();
                assert_eq!(new.len(), 1);
                assert_eq!((new[0].plane, new[0].side), (plane, half));
            }
            // Nothing is lost.
            for ray in &whole {
                assert!(parts.iter().any(|part| holds(space, part, ray)));
            }
            parts.map(Some)
        }
    }
}

/// The parts that two cuts leave, by the sides they lie on.
fn both_cuts<S: Lawful>(
    space: &mut S,
    piece: &S::Piece,
    [first, second]: [S::Plane; 2],
) -> [[Option<S::Piece>; 2]; 2] {
    lawful_cut(space, piece, first, Wall(1)).map(|part| match part {
        Some(part) => lawful_cut(space, &part, second, Wall(2)),
        None => [None, None],
    })
}

fn laws<S: Lawful>(space: &mut S, piece: &S::Piece, planes: &[S::Plane]) -> usize {
    is_piece(space, piece);
    let mut parts = 0;
    for (i, &p) in planes.iter().enumerate() {
        for &q in &planes[i + 1..] {
            let one = both_cuts(space, piece, [p, q]);
            let other = both_cuts(space, piece, [q, p]);
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                // The order of cuts does not matter: the parts hold each other's rays.
                let (a, b) = (&one[i][j], &other[j][i]);
                assert_eq!(a.is_some(), b.is_some());
                if let (Some(a), Some(b)) = (a, b) {
                    parts += 1;
                    assert!(space.rays(a).all(|ray| holds(space, b, ray)));
                    assert!(space.rays(b).all(|ray| holds(space, a, ray)));
                }
            }
        }
    }
    parts
}

#[test]
fn cones_of_small_numbers_keep_the_laws() {
    let mut parts = 0;
    for seed in 0..600 {
        if let Some((mut space, cone, planes)) = cones(seed, 3 + seed as i64 % 5) {
            parts += laws(&mut space, &cone, &planes);
        }
    }
    assert!(parts > 5_000, "{parts}");
}

#[test]
fn cones_of_large_numbers_keep_the_laws() {
    let mut parts = 0;
    for seed in 0..200 {
        // 2^24 for viewpoints; 2^34 makes rows wide.
        let reach = if seed % 2 == 0 { 1 << 24 } else { 1 << 34 };
        if let Some((mut space, cone, planes)) = cones(seed, reach / 2) {
            parts += laws(&mut space, &cone, &planes);
        }
    }
    assert!(parts > 1_000, "{parts}");
}

fn point(random: &mut Random, reach: i64) -> Point2 {
    let mut coordinate = || random.between(-reach, reach) as i32;
    Point2::new(coordinate(), coordinate())
}

/// Lines of the plane: those through a segment that pass another one.
#[test]
fn lines_of_the_plane_keep_the_laws() {
    let mut parts = 0;
    for seed in 0..3000 {
        let mut random = Random(seed * 2 + 88_172_645_463_325_252);
        let reach = if seed % 2 == 0 { 4 } else { (1 << 23) - 1 };
        let mut space = PlaneLines::new();
        let (a, b, c) = (
            point(&mut random, reach),
            point(&mut random, reach),
            point(&mut random, reach),
        );
        if orient2d(a, b, c) >= 0 {
            continue;
        }
        let facets = [
            facet(space.point(a), Half::Negative),
            facet(space.point(b), Half::Positive),
            facet(space.point(c), Half::Positive),
        ];
        let cone = space.cone_of(&facets);
        let mut planes: Vec<_> = (0..3)
            .map(|_| space.point(point(&mut random, reach)))
            .collect();
        let crossing = crossing2d(
            [a, point(&mut random, reach)],
            [c, point(&mut random, reach)],
        );
        if crossing[2] > 0 {
            planes.push(space.crossing(crossing));
        }
        parts += laws(&mut space, &cone, &planes);
    }
    assert!(parts > 1000, "only {parts} parts");
}

/// Lines through a point of the plane.
#[test]
fn pencils_keep_the_laws() {
    let mut parts = 0;
    for seed in 0..3000 {
        let mut random = Random(seed * 2 + 88_172_645_463_325_252);
        let reach = if seed % 2 == 0 { 3 } else { (1 << 24) - 1 };
        let mut space = Pencil::new(Point2::default());
        let mut d = || [random.between(-reach, reach), random.between(-reach, reach)];
        let (right, left) = (d(), d());
        if right[0] * left[1] - right[1] * left[0] <= 0 {
            continue;
        }
        let directions: Vec<[i64; 2]> = (0..4).map(|_| d()).filter(|v| *v != [0, 0]).collect();
        let wedge = space.wedge(right, left);
        let planes: Vec<_> = directions.into_iter().map(|v| space.direction(v)).collect();
        parts += laws(&mut space, &wedge, &planes);
    }
    assert!(parts > 1000, "only {parts} parts");
}
