//! Which side of a polygon is outside: scenes do not say, pictures of cut-open walls need it.

use super::vector::{V3, area_vector, dot, lerp, sub, unit};
use super::{Face, Subject};

/// Objects with more faces are taken as they are: the work grows with the square.
const MOST_FACES: usize = 1200;

/// What was found out about the sides of all faces.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    /// For each face, whether its corners must be reversed to turn its front outwards.
    pub reversed: Vec<bool>,
    /// For each object, whether it is a solid: nearly all of its surface has an inside.
    pub solid: Vec<bool>,
}

/// Finds the outside of every face: for solids by counting how often rays meet the object's other
/// faces, for single sheets the side of the cell.
pub(super) fn facing(subject: &Subject) -> Facing {
    let [min, max] = subject.cell;
    let center = lerp(min, max, 0.5);
    let mut found = Facing {
        reversed: Vec::with_capacity(subject.faces.len()),
        solid: vec![false; subject.shown.len()],
    };
    for faces in subject.faces.chunk_by(|a, b| a.object == b.object) {
        let sides: Vec<Option<bool>> = if faces.len() < 4 || faces.len() > MOST_FACES {
            vec![None; faces.len()]
        } else {
            outsides(faces)
        };
        let area = |i: usize| {
            let n = area_vector(&faces[i].corners);
            dot(n, n).sqrt()
        };
        let all: f64 = (0..faces.len()).map(area).sum();
        let sure: f64 = (0..faces.len())
            .filter(|i| sides[*i].is_some())
            .map(area)
            .sum();
        let solid = all > 0.0 && sure > 0.95 * all;
        found.solid[faces[0].object as usize] = solid;
        // A closed room is a solid of air: one looks at it from within.
        let hollow = solid && is_inside(center, faces, None);
        for (face, side) in faces.iter().zip(sides) {
            let towards_cell = dot(area_vector(&face.corners), sub(center, face.corners[0])) >= 0.0;
            let front = match side {
                Some(outside_is_front) if solid => outside_is_front != hollow,
                _ => towards_cell,
            };
            found.reversed.push(!front);
        }
    }
    found
}

/// For each face, whether its front is outside and its back inside, the other way around, or
/// neither.
fn outsides(faces: &[Face]) -> Vec<Option<bool>> {
    let size = faces
        .iter()
        .flat_map(|f| &f.corners)
        .map(|p| sub(*p, faces[0].corners[0]))
        .map(|d| dot(d, d).sqrt())
        .fold(0.0, f64::max);
    let side = |i: usize, towards: f64| {
        let face = &faces[i];
        let n = unit(area_vector(&face.corners)).map(|c| c * towards);
        let count = face.corners.len() as f64;
        let middle: V3 =
            std::array::from_fn(|k| face.corners.iter().map(|p| p[k]).sum::<f64>() / count);
        let start = std::array::from_fn(|k| middle[k] + n[k] * size * 1e-4);
        is_inside(start, faces, Some(n))
    };
    let outside = |i| match (side(i, 1.0), side(i, -1.0)) {
        (false, true) => Some(true),
        (true, false) => Some(false),
        _ => None,
    };
    (0..faces.len()).map(outside).collect()
}

/// Whether most rays from a point, all more or less along a direction, meet faces an odd number of
/// times.
fn is_inside(point: V3, faces: &[Face], along: Option<V3>) -> bool {
    const TILTS: [V3; 3] = [
        [0.0271, 0.1593, -0.0884],
        [-0.1414, 0.0577, 0.1123],
        [0.1131, -0.1717, 0.0435],
    ];
    let along = along.unwrap_or([0.31, 0.42, 0.85]);
    let odd = |tilt: &&V3| {
        let ray: V3 = std::array::from_fn(|k| along[k] + tilt[k]);
        faces
            .iter()
            .filter(|face| meets(point, ray, &face.corners))
            .count()
            % 2
            == 1
    };
    TILTS.iter().filter(odd).count() >= 2
}

/// Whether a ray meets a convex polygon.
fn meets(start: V3, ray: V3, corners: &[V3]) -> bool {
    let n = area_vector(corners);
    let speed = dot(n, ray);
    let t = dot(n, sub(corners[0], start)) / speed;
    if speed == 0.0 || t <= 0.0 {
        return false;
    }
    let at: V3 = std::array::from_fn(|k| start[k] + t * ray[k]);
    let axis = (0..3)
        .max_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs()))
        .unwrap_or(2);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut inside = false;
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        if (a[j] > at[j]) != (b[j] > at[j])
            && at[i] < a[i] + (at[j] - a[j]) / (b[j] - a[j]) * (b[i] - a[i])
        {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::super::vector::{area_vector, dot, sub};
    use super::super::{Face, Shown, Subject, section::tests::block};
    use super::facing;

    fn subject(faces: Vec<Face>, cell: [[f64; 3]; 2]) -> Subject {
        Subject {
            faces,
            shown: vec![Shown::Visible],
            cell,
            caption: String::new(),
        }
    }

    /// How many faces point away from a point after the reversal.
    fn away(subject: &Subject, reversed: &[bool], from: [f64; 3]) -> usize {
        let out = |(face, reversed): (&Face, &bool)| {
            let d = dot(area_vector(&face.corners), sub(face.corners[0], from));
            (d > 0.0) != *reversed
        };
        subject
            .faces
            .iter()
            .zip(reversed)
            .filter(|pair| out(*pair))
            .count()
    }

    #[test]
    fn solids_face_outwards_whatever_their_order_was() {
        let mut faces = block([0.0; 3], [4.0, 0.2, 3.0], 0);
        for face in faces.iter_mut().step_by(2) {
            face.corners.reverse();
        }
        let outside = subject(faces.clone(), [[5.0, 5.0, 1.0], [6.0, 6.0, 2.0]]);
        let found = facing(&outside);
        assert!(found.solid[0]);
        assert_eq!(away(&outside, &found.reversed, [2.0, 0.1, 1.5]), 6);
        // From a cell inside, the same faces are the walls of a room.
        let inside = subject(faces, [[1.0, 0.05, 1.0], [2.0, 0.15, 2.0]]);
        let found = facing(&inside);
        assert_eq!(away(&inside, &found.reversed, [2.0, 0.1, 1.5]), 0);
    }

    #[test]
    fn sheets_face_the_cell() {
        let sheet = Face {
            corners: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0]],
            object: 0,
            clear: false,
        };
        let s = subject(vec![sheet], [[0.0, 3.0, 0.0], [1.0, 4.0, 1.0]]);
        let found = facing(&s);
        assert_eq!((found.solid[0], found.reversed[0]), (false, true));
    }
}
