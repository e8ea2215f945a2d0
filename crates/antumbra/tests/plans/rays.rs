//! What must hold of every answer, judged by the oracle of the plane.

use std::collections::HashMap;

use antumbra::plan::{CellShape, Plan, PlanView, Ratio};
use antumbra_kernel::Point2;
use antumbra_testkit::flat::{FlatScene, GridPoint, first_on_line, orient2d};
use antumbra_testkit::random::Random;
use dashu_int::IBig;

pub(crate) fn grid(p: Point2) -> GridPoint {
    p.to_i64()
}

pub(crate) fn oracle(plan: &Plan) -> FlatScene {
    FlatScene::new(plan.pieces().iter().map(|e| e.map(grid)).collect())
}

/// For each piece: whether it touches the cell, and its visible intervals.
type Seen = HashMap<usize, (bool, Vec<[f64; 2]>)>;

pub(crate) fn seen(view: &PlanView) -> Seen {
    let mut out = Seen::new();
    for id in &view.touching {
        out.entry(id.0 as usize).or_default().0 = true;
    }
    // Maximal intervals: in order, with gaps between them.
    for pair in view.fragments.windows(2) {
        assert!(pair[0].piece < pair[1].piece || pair[0].at[1] < pair[1].at[0]);
    }
    for f in &view.fragments {
        assert!(f.at[0] < f.at[1] && f.at[0] >= Ratio::ZERO && f.at[1] <= Ratio::ONE);
        let interval = [f.at[0].value(), f.at[1].value()];
        out.entry(f.piece.0 as usize).or_default().1.push(interval);
    }
    out
}

/// A random grid point of the closed cell, and how often the draw failed.
pub(crate) fn inside(cell: &CellShape, random: &mut Random) -> Option<GridPoint> {
    let corners = cell.corners();
    let bounds = cell.bounds();
    match cell {
        CellShape::Point(p) => Some(grid(*p)),
        CellShape::Segment([a, b]) => {
            // Grid points on the segment: whole steps between its ends.
            let (dx, dy) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
            let steps = gcd(dx.abs(), dy.abs());
            let k = random.integer(0, steps);
            Some([
                i64::from(a.x) + dx / steps * k,
                i64::from(a.y) + dy / steps * k,
            ])
        }
        CellShape::Region(_) => {
            let p = [
                random.integer(bounds.min.x.into(), bounds.max.x.into()),
                random.integer(bounds.min.y.into(), bounds.max.y.into()),
            ];
            let n = corners.len();
            let holds = (0..n).all(|i| {
                let (a, b) = (grid(corners[i]), grid(corners[(i + 1) % n]));
                orient2d(a, b, p) > 0
            });
            holds.then_some(p)
        }
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a.max(1) } else { gcd(b, a % b) }
}

/// Shoots rays from the cell: none may hit what the answer does not list. Returns how many hit something.
pub(crate) fn shoot(
    plan: &Plan,
    scene: &FlatScene,
    view: &PlanView,
    rays: usize,
    random: &mut Random,
) -> usize {
    let seen = seen(view);
    let bounds = plan.bounds().expect("pieces");
    let mut hits = 0;
    let mut shot = 0;
    for _ in 0..rays * 20 {
        if shot == rays {
            break;
        }
        let Some(from) = inside(&view.cell, random) else {
            continue;
        };
        shot += 1;
        // Half of them far, half of them near silhouettes.
        let through = if random.index(2) == 0 || seen.is_empty() {
            [
                random.integer(bounds.min.x.into(), bounds.max.x.into()),
                random.integer(bounds.min.y.into(), bounds.max.y.into()),
            ]
        } else {
            let piece = plan.pieces()[random.index(plan.pieces().len())];
            let end = grid(piece[random.index(2)]);
            [
                end[0] + random.integer(-3, 3),
                end[1] + random.integer(-3, 3),
            ]
        };
        if from == through {
            continue;
        }
        let Some(hit) = scene.first_hit(from, through) else {
            continue;
        };
        if hit.grazes {
            continue;
        }
        hits += 1;
        let (touching, intervals) = seen.get(&hit.segment).unwrap_or_else(|| {
            panic!(
                "a ray from {from:?} through {through:?} hits piece {} {:?}, which is called hidden from {:?}: {:?}",
                hit.segment, plan.pieces()[hit.segment], view.cell, plan.pieces().iter().take(20).map(|e| e.map(grid)).collect::<Vec<_>>()
            )
        });
        let t = hit.at[0] as f64 / hit.at[1] as f64;
        assert!(
            *touching || intervals.iter().any(|i| i[0] <= t && t <= i[1]),
            "a ray from {from:?} through {through:?} hits piece {} at {t}, outside of {intervals:?}",
            hit.segment
        );
    }
    hits
}

/// Confirms the witness of every fragment.
pub(crate) fn confirm(scene: &FlatScene, view: &PlanView) {
    let cell = &view.cell;
    for f in &view.fragments {
        let line = f.witness.big();
        let id = f.piece.0 as usize;
        let hit = first(scene, &line, cell);
        let (segment, [n, d]) = hit
            .unwrap_or_else(|e| panic!("{e}: the witness of piece {id} from {cell:?}: {line:?}"))
            .expect("it hits something");
        assert_eq!(segment, id, "the witness hits another piece, from {cell:?}");
        let ((ln, ld), (hn, hd)) = (f.at[0].parts(), f.at[1].parts());
        assert!(
            ln * &d <= &n * ld && &n * hd <= hn * &d,
            "a witness outside of its fragment"
        );
    }
}

/// What a line that leaves a cell meets first, and where. What lies along a segment, or holds a point, that one looks
/// from hides nothing from it.
pub(crate) fn first(
    scene: &FlatScene,
    line: &[IBig; 3],
    cell: &CellShape,
) -> Result<Option<(usize, [IBig; 2])>, String> {
    let corners: Vec<GridPoint> = cell.corners().iter().map(|&c| grid(c)).collect();
    if let CellShape::Region(_) = cell {
        return first_on_line(scene.segments(), line, &corners);
    }
    let apart = |[p, q]: [GridPoint; 2]| match cell {
        CellShape::Region(_) => true,
        CellShape::Segment(_) => [p, q]
            .iter()
            .any(|&e| orient2d(corners[0], corners[1], e) != 0),
        CellShape::Point(_) => {
            let eye = corners[0];
            orient2d(p, q, eye) != 0 || (0..2).any(|k| (p[k] - eye[k]) * (q[k] - eye[k]) > 0)
        }
    };
    let (ids, segments): (Vec<usize>, Vec<_>) = scene
        .segments()
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, s)| apart(*s))
        .unzip();
    let hit = if let CellShape::Point(_) = cell {
        from_point(&segments, line, corners[0])
    } else {
        first_on_line(&segments, line, &corners)
    }?;
    Ok(hit.map(|(i, at)| (ids[i], at)))
}

/// A triangle with an edge across the line at the eye does for a cell; four times the coordinates make room for it.
#[allow(clippy::type_complexity, reason = "as the oracle's own")]
fn from_point(
    segments: &[[GridPoint; 2]],
    line: &[IBig; 3],
    eye: GridPoint,
) -> Result<Option<(usize, [IBig; 2])>, String> {
    let larger = |p: GridPoint| p.map(|v| 4 * v);
    let e = larger(eye);
    let (a, b) = (&line[0], &line[1]);
    let sign = |v: &IBig| i64::from(*v > IBig::ZERO) - i64::from(*v < IBig::ZERO);
    // The direction is (b, -a).
    let (dx, dy) = (sign(b), -sign(a));
    let cell = [
        [e[0] - dy, e[1] + dx],
        [e[0] - 2 * dx, e[1] - 2 * dy],
        [e[0] + dy, e[1] - dx],
    ];
    let segments: Vec<_> = segments.iter().map(|s| s.map(larger)).collect();
    let scaled = [line[0].clone(), line[1].clone(), &line[2] * 4];
    first_on_line(&segments, &scaled, &cell)
}
