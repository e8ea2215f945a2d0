//! Hidden-line drawings: the edges of a map, projected, chained into strokes, each with its owner.
//!
//! Nothing is decided here; coordinates are rounded to the resolution of the paper, and what has no
//! length at that resolution is left out.

use std::collections::BTreeMap;

use antumbra_kernel::Point;
use antumbra_scene::{ObjectId, Scene};

use super::overlap::Drawn;
use super::{EdgeClass, MapError, VisibilityMap, camera_axes, hidden};

/// From directions (or points of parallel lines) to paper: x to the right, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    eye: [f64; 3],
    /// Right, up and forward.
    axes: [[f64; 3]; 3],
    parallel: bool,
    scale: f64,
    center: [f64; 2],
}

/// One line of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// The class of its edges.
    pub class: EdgeClass,
    /// The object that its edges belong to: of a shadow the nearer one.
    pub object: ObjectId,
    /// Whether it is behind something.
    pub hidden: bool,
    /// Its points on paper; a closed stroke ends where it starts. At least two, no two in a row
    /// equal.
    pub points: Vec<[f64; 2]>,
}

impl Projection {
    /// Paper for a camera or, if `parallel`, for parallel lines along its line of sight.
    ///
    /// `scale` is in paper units for each unit at distance one (perspective) or for each scene unit
    /// (parallel), and `center` is where the line of sight meets the paper.
    ///
    /// # Errors
    /// If the points do not make a camera.
    pub fn new(
        eye: [f64; 3],
        toward: [f64; 3],
        up: [f64; 3],
        parallel: bool,
    ) -> Result<Self, MapError> {
        Ok(Self {
            eye,
            axes: camera_axes(eye, toward, up)?,
            parallel,
            scale: 1.0,
            center: [0.0; 2],
        })
    }

    /// The same with a scale and a center of the paper.
    #[must_use]
    pub fn on_paper(self, scale: f64, center: [f64; 2]) -> Self {
        Self {
            scale,
            center,
            ..self
        }
    }

    /// How large a scene unit is on paper: everywhere in a parallel view, at distance one in a perspective.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Where the ray of a vertex meets the paper.
    #[must_use]
    pub fn ray(&self, ray: [f64; 3]) -> [f64; 2] {
        let q = if self.parallel { self.offset(ray) } else { ray };
        self.paper(q)
    }

    /// Where a point in scene units is on paper; it must be in front.
    #[must_use]
    pub fn point(&self, p: [f64; 3]) -> [f64; 2] {
        self.paper(self.offset(p))
    }

    /// How far a point lies before the eye along the line of sight.
    #[must_use]
    pub fn depth(&self, p: [f64; 3]) -> f64 {
        dot(self.offset(p), self.axes[2])
    }

    /// Whether lines are parallel.
    #[must_use]
    pub fn is_parallel(&self) -> bool {
        self.parallel
    }

    /// The part of a segment that lies before the eye by more than a millionth of its length.
    fn before(&self, [a, b]: [[f64; 3]; 2]) -> Option<[[f64; 3]; 2]> {
        if self.parallel {
            return Some([a, b]);
        }
        let length = (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
        let near = 1e-6 * length;
        let (s, t) = (self.depth(a) - near, self.depth(b) - near);
        let cut = || std::array::from_fn(|k| a[k] + s / (s - t) * (b[k] - a[k]));
        match (s > 0.0, t > 0.0) {
            (true, true) => Some([a, b]),
            (true, false) => Some([a, cut()]),
            (false, true) => Some([cut(), b]),
            (false, false) => None,
        }
    }

    fn offset(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| p[k] - self.eye[k])
    }

    fn paper(&self, q: [f64; 3]) -> [f64; 2] {
        let [x, y, depth] = self.axes.map(|axis| dot(q, axis));
        let s = if self.parallel {
            self.scale
        } else {
            self.scale / depth
        };
        [self.center[0] + s * x, self.center[1] - s * y]
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The visible edges of some classes as strokes: edges of one class and object are chained where
/// just two of them meet. `resolution` is the smallest distance on paper.
#[must_use]
pub fn strokes(
    map: &VisibilityMap,
    scene: &Scene,
    projection: &Projection,
    classes: &[EdgeClass],
    resolution: f64,
) -> Vec<Stroke> {
    let mut groups: BTreeMap<(EdgeClass, ObjectId), Vec<[u32; 2]>> = BTreeMap::new();
    for edge in map.edges().iter().filter(|e| classes.contains(&e.class)) {
        if let Some(near) = edge.near {
            let object = scene.polygon(near.polygon).object;
            groups
                .entry((edge.class, object))
                .or_default()
                .push(edge.ends);
        }
    }
    let at: Vec<[f64; 2]> = map
        .vertices()
        .iter()
        .map(|v| rounded(projection.ray(v.ray), resolution))
        .collect();
    let mut out = Vec::new();
    for ((class, object), edges) in groups {
        for chain in chains(&edges) {
            let mut points: Vec<[f64; 2]> = chain.iter().map(|&v| at[v as usize]).collect();
            points.dedup();
            if points.len() > 1 {
                out.push(Stroke {
                    class,
                    object,
                    hidden: false,
                    points,
                });
            }
        }
    }
    out
}

/// The parts of feature edges of the scene that are in the view and behind something, as strokes of
/// class *corner*. Where they end is rounded. What is not on a paper of some width and height, from the
/// origin, is left out, and what lies under visible strokes or under another hidden one.
#[must_use]
pub fn hidden_strokes(
    map: &VisibilityMap,
    scene: &Scene,
    projection: &Projection,
    crease: f64,
    (paper, resolution): ([f64; 2], f64),
    visible: &[Stroke],
) -> Vec<Stroke> {
    let mut drawn = Drawn::new(2.0 * resolution);
    for pair in visible.iter().flat_map(|s| s.points.windows(2)) {
        drawn.add([pair[0], pair[1]]);
    }
    let mut out = Vec::new();
    for (object, ends) in hidden::segments(map, scene, crease) {
        let Some(points) = projection
            .before(ends)
            .map(|ends| ends.map(|p| projection.point(p)))
            .and_then(|ends| on_paper(ends, paper))
        else {
            continue;
        };
        let points = points.map(|p| rounded(p, resolution));
        if points[0] == points[1] {
            continue;
        }
        for part in drawn.uncovered(points) {
            drawn.add(part);
            out.push(Stroke {
                class: EdgeClass::Corner,
                object,
                hidden: true,
                points: part.map(|p| rounded(p, resolution)).to_vec(),
            });
        }
    }
    out
}

/// The part of a segment on paper, by clipping at the four borders.
fn on_paper([a, b]: [[f64; 2]; 2], paper: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        if d[k] == 0.0 {
            if a[k] < 0.0 || a[k] > paper[k] {
                return None;
            }
            continue;
        }
        let (s, t) = (-a[k] / d[k], (paper[k] - a[k]) / d[k]);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    let at = |t: f64| [a[0] + t * d[0], a[1] + t * d[1]];
    (enter < leave).then(|| [at(enter), at(leave)])
}

fn rounded(p: [f64; 2], resolution: f64) -> [f64; 2] {
    // Adding zero turns a negative zero positive.
    p.map(|c| (c / resolution).round() * resolution + 0.0)
}

/// Paths over edges: through vertices where exactly two edges of the group meet, closed ones last.
fn chains(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut at: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, ends) in edges.iter().enumerate() {
        ends.iter().for_each(|v| at.entry(*v).or_default().push(i));
    }
    let mut used = vec![false; edges.len()];
    let mut out = Vec::new();
    let starts: Vec<(u32, usize)> = at
        .iter()
        .filter(|(_, around)| around.len() != 2)
        .flat_map(|(&v, around)| around.iter().map(move |&i| (v, i)))
        .collect();
    let closed = edges.iter().enumerate().map(|(i, ends)| (ends[0], i));
    for (start, first) in starts.into_iter().chain(closed) {
        if used[first] {
            continue;
        }
        let (mut here, mut edge) = (start, first);
        let mut path = vec![start];
        loop {
            used[edge] = true;
            here = edges[edge][usize::from(edges[edge][0] == here)];
            path.push(here);
            let around = &at[&here];
            let next = around.iter().find(|&&i| !used[i]);
            match next {
                Some(&next) if around.len() == 2 => edge = next,
                _ => break,
            }
        }
        out.push(path);
    }
    out
}

/// A corner of the scene's grid in scene units.
pub(super) fn place(scene: &Scene, p: Point) -> [f64; 3] {
    scene.grid().to_scene(p)
}

#[cfg(test)]
mod tests {
    use super::{chains, on_paper};

    #[test]
    fn segments_are_clipped_at_the_border_of_the_paper() {
        let paper = [10.0, 4.0];
        let inside = [[1.0, 1.0], [2.0, 3.0]];
        assert_eq!(on_paper(inside, paper), Some(inside));
        let across = on_paper([[-5.0, 2.0], [15.0, 2.0]], paper);
        assert_eq!(across, Some([[0.0, 2.0], [10.0, 2.0]]));
        assert_eq!(on_paper([[-5.0, 0.0], [1.0, 8.0]], paper), None);
        assert_eq!(on_paper([[3.0, 5.0], [8.0, 5.0]], paper), None);
    }

    #[test]
    fn edges_are_chained_where_two_meet() {
        // A square 0 1 2 3, and a fork at 5.
        let square = [[0, 1], [2, 1], [2, 3], [3, 0]];
        assert_eq!(chains(&square), [vec![0, 1, 2, 3, 0]]);
        let fork = [[4, 5], [5, 6], [7, 5], [7, 8]];
        assert_eq!(chains(&fork), [vec![4, 5], vec![5, 6], vec![5, 7, 8]]);
    }
}
