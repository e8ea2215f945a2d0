//! Curves as chords: a full turn of an arc becomes 64 of them, a Bézier curve strays from its chords by
//! at most a thousandth of its size.

use std::f64::consts::TAU;

use kurbo::{Affine, BezPath, PathEl, Point, Shape as _};

/// Chords of a full turn.
const TURN: f64 = 64.0;

/// The points of an elliptical arc: `center + cos t * major + sin t * minor` from one parameter to another.
pub(super) fn arc(
    center: Point,
    major: [f64; 2],
    minor: [f64; 2],
    (from, to): (f64, f64),
) -> Vec<Point> {
    let chords = ((to - from).abs() / TAU * TURN).ceil().clamp(1.0, TURN) as u32;
    let at = |i: u32| {
        let (sin, cos) = (from + (to - from) * f64::from(i) / f64::from(chords)).sin_cos();
        center
            + (
                cos * major[0] + sin * minor[0],
                cos * major[1] + sin * minor[1],
            )
    };
    (0..=chords).map(at).collect()
}

/// The points between two vertices of a polyline with a bulge: the tangent of a quarter of the arc's
/// angle, positive to the left. Without the first.
pub(super) fn bulge(a: Point, b: Point, bulge: f64) -> Vec<Point> {
    let angle = 4.0 * bulge.atan();
    if bulge == 0.0 || a == b {
        return vec![b];
    }
    let half = b.to_vec2() / 2.0 - a.to_vec2() / 2.0;
    let tangent = (angle / 2.0).tan();
    let center = a.midpoint(b) + kurbo::Vec2::new(-half.y, half.x) / tangent;
    let start = a - center;
    let mut points = arc(
        center,
        [start.x, start.y],
        [-start.y, start.x],
        (0.0, angle),
    );
    points.remove(0);
    points.pop();
    // The end itself, so that neighbors share it.
    points.push(b);
    points
}

/// The lines of a path after a transformation; closed ones end where they begin.
pub(super) fn path_lines(path: &BezPath, transform: Affine) -> Vec<Vec<[f64; 2]>> {
    let path = transform * path.clone();
    let size = path.bounding_box();
    let tolerance = (size.width().max(size.height()) / 1000.0).max(f64::MIN_POSITIVE);
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    kurbo::flatten(&path, tolerance, |element| match element {
        PathEl::MoveTo(p) => lines.push(vec![[p.x, p.y]]),
        PathEl::LineTo(p) => {
            if let Some(line) = lines.last_mut() {
                line.push([p.x, p.y]);
            }
        }
        PathEl::ClosePath => {
            if let Some(line) = lines.last_mut()
                && line.first() != line.last()
            {
                line.push(line[0]);
            }
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    lines.retain(|line| line.len() > 1);
    lines
}

#[cfg(test)]
mod tests {
    use super::{arc, bulge, path_lines};
    use kurbo::{Affine, BezPath, Point};

    #[test]
    fn a_turn_has_64_chords_on_the_circle() {
        let points = arc(
            Point::new(1.0, 2.0),
            [3.0, 0.0],
            [0.0, 3.0],
            (0.0, std::f64::consts::TAU),
        );
        assert_eq!(points.len(), 65);
        for p in points {
            assert!((p.distance(Point::new(1.0, 2.0)) - 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_bulge_of_one_is_a_half_circle_to_the_right_of_its_chord() {
        let points = bulge(Point::new(0.0, 0.0), Point::new(2.0, 0.0), 1.0);
        assert_eq!(points.last(), Some(&Point::new(2.0, 0.0)));
        let lowest = points.iter().map(|p| p.y).fold(0.0, f64::min);
        assert!((lowest + 1.0).abs() < 1e-9, "{lowest}");
    }

    #[test]
    fn closed_paths_end_where_they_begin() {
        let path = BezPath::from_svg("M0 0 H4 V3 Z M10 10 L11 10").unwrap();
        let lines = path_lines(&path, Affine::FLIP_Y);
        assert_eq!(
            lines[0],
            [[0.0, 0.0], [4.0, 0.0], [4.0, -3.0], [0.0, 0.0]].map(|p| p.map(|c: f64| c + 0.0))
        );
        assert_eq!(lines.len(), 2);
    }
}
