//! Test: what the leaves of a tree are accepted for is true of sampled lines.

use antumbra_kernel::{Plane, Point, Sign};
use antumbra_scene::{Faces, ObjectInput, PartInput, PolygonId, Scene, SceneBuilder, SceneInput};

use super::ends::Gate;
use super::piece::Piece;
use super::rows::Hyperplane;
use super::tree::Question;
use crate::proof::RowName;

/// Three coordinates and their common denominator.
type Homogeneous = ([i128; 3], i128);

struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) % n) as i64
    }

    /// Three triangles, or two and a parallelogram. Small coordinates: many planes cross, many
    /// things touch.
    fn polygons(&mut self, reach: u64) -> Option<Scene> {
        let mut corner = || [0; 3].map(|_| (self.below(2 * reach + 1) - reach as i64) as f64);
        let objects = (0..3).map(|object| {
            let mut vertices = vec![corner(), corner(), corner()];
            let mut faces = Faces::default();
            if object == 2 && vertices[0][0] > 0.0 {
                let [a, b, c] = [0, 1, 2].map(|i: usize| vertices[i]);
                vertices.push(std::array::from_fn(|k| a[k] + c[k] - b[k]));
                faces.push(&[0, 1, 2, 3]);
            } else {
                faces.push(&[0, 1, 2]);
            }
            let part = PartInput {
                vertices,
                faces,
                ..Default::default()
            };
            ObjectInput {
                name: None,
                parts: vec![part],
            }
        });
        let input = SceneInput {
            objects: objects.collect(),
            source_name: "test".into(),
        };
        let (scene, _) = SceneBuilder::new(input).grid(Some(1.0)).build().ok()?;
        (scene.polygon_count() == 3).then_some(scene)
    }

    /// A homogeneous point inside a triangle.
    fn inside(&mut self, corners: &[Point]) -> Homogeneous {
        let weights = [0; 3].map(|_| i128::from(1 + self.below(1000)));
        let at = |k: usize| {
            let terms = corners.iter().zip(weights);
            terms.map(|(p, w)| i128::from(p.to_i64()[k]) * w).sum()
        };
        ([at(0), at(1), at(2)], weights.iter().sum())
    }
}

fn gate(scene: &Scene, id: u32, against: bool) -> Gate {
    let polygon = scene.polygon(PolygonId(id));
    let mut corners = polygon.corners.to_vec();
    if against {
        corners.reverse();
        let plane = polygon.plane.flipped();
        return Gate { corners, plane };
    }
    let plane = *polygon.plane;
    Gate { corners, plane }
}

/// The half-spaces of a piece.
fn bounds(piece: &Piece) -> Vec<Hyperplane> {
    match piece {
        Piece::Fast(cone) => cone.rows.iter().cloned().map(Hyperplane::Narrow).collect(),
        Piece::Middle(cone) => cone.rows.iter().cloned().map(Hyperplane::Middle).collect(),
        Piece::Big(cone) => cone.rows.iter().cloned().map(Hyperplane::Wide).collect(),
    }
}

fn value(plane: &Plane, (p, w): &Homogeneous) -> i128 {
    let n = plane.normal.map(i128::from);
    (0..3).map(|k| n[k] * p[k]).sum::<i128>() - plane.offset * w
}

/// The signs of rows on the line through two points.
fn signs(rows: &[Hyperplane], a: &Homogeneous, b: &Homogeneous) -> Vec<Sign> {
    let d: [i128; 3] = std::array::from_fn(|k| b.0[k] * a.1 - a.0[k] * b.1);
    let term = |i: usize, j: usize| a.0[i] * b.0[j] - a.0[j] * b.0[i];
    let line = [d[0], d[1], d[2], term(1, 2), term(2, 0), term(0, 1)];
    let row = |row: &Hyperplane| {
        let row = row.middle().expect("small").exact;
        Sign::of((0..6).map(|k| row[k] * line[k]).sum::<i128>())
    };
    rows.iter().map(row).collect()
}

/// Polygons A, B and O at random, cut by all rows of O: wherever O is accepted as blocking,
/// sampled lines from A to B really meet it on the way, and where sampled lines are, the piece
/// is not accepted as imaginary.
#[test]
fn what_is_blocked_is_blocked() {
    let mut random = Random(11);
    let (mut blocked, mut sampled, mut imaginary, mut lines) = (0, 0, 0, 0);
    for round in 0..400 {
        let Some(scene) = random.polygons([3, 6, 30][round % 3]) else {
            continue;
        };
        let from = gate(&scene, 0, random.below(2) == 1);
        let to = gate(&scene, 1, random.below(2) == 1);
        let exist =
            to.reaches(&from.plane, Sign::Positive) && from.reaches(&to.plane, Sign::Negative);
        if !exist {
            continue;
        }
        let question = Question {
            scene: &scene,
            from: &from,
            to: &to,
            source_plane_blocks: false,
            absent: &(0..0),
            may_ignore: false,
        };
        let polygon = PolygonId(2);
        let edges = scene.polygon(polygon).corners.len();
        let names = (0..edges as u32)
            .map(|edge| RowName::Edge { polygon, edge })
            .chain([
                RowName::SourceLine { polygon },
                RowName::TargetLine { polygon },
            ]);
        let rows: Vec<Hyperplane> = names
            .map(|name| question.hyperplane(name).expect("a row"))
            .collect();
        let starts = Piece::all_between(&from, &to).expect("a start");
        let mut pieces = starts;
        for row in &rows {
            let cut = |piece: Piece| piece.cut(row).expect("small").into_iter().flatten();
            pieces = pieces.into_iter().flat_map(cut).collect();
        }
        let samples: Vec<_> = (0..200)
            .map(|_| (random.inside(&from.corners), random.inside(&to.corners)))
            .filter(|(a, b)| value(&to.plane, a) < 0 && value(&from.plane, b) > 0)
            .collect();
        let plane = scene.polygon(polygon).plane;
        for piece in &pieces {
            let bounds = bounds(piece);
            let within = |(a, b): &&(Homogeneous, Homogeneous)| {
                signs(&bounds, a, b).iter().all(|s| s.is_positive())
            };
            let inside = || samples.iter().filter(within);
            if !piece.holds_real_lines() {
                assert_eq!(inside().count(), 0, "round {round}");
                imaginary += 1;
            }
            for negative in [false, true] {
                let holds =
                    |rows: Vec<(Hyperplane, String)>| rows.iter().all(|(row, _)| piece.within(row));
                if !question.blocked_rows(polygon, negative).is_ok_and(holds) {
                    continue;
                }
                blocked += 1;
                for (a, b) in inside() {
                    let (x, y) = (value(plane, a), value(plane, b));
                    let way = if negative {
                        Sign::Negative
                    } else {
                        Sign::Positive
                    };
                    let between = Sign::of(x) == way.flip() && Sign::of(y) == way;
                    assert!(between, "round {round}: {x} {y}");
                    let sides = signs(&rows[..edges], a, b);
                    assert!(sides.iter().all(|s| *s == way), "round {round}");
                    sampled += 1;
                }
            }
            lines += inside().count();
        }
    }
    assert!(blocked > 100 && sampled > 1000, "{blocked} {sampled}");
    assert!(imaginary > 100 && lines > 10_000, "{imaginary} {lines}");
}
