//! Rays through a scene, in doubles: what samples find. Never a verdict.
//!
//! Each polygon's plane and edge rows are kept as doubles; they are integers of at most 53 bits
//! (the offset excepted), so the exact tests read the same numbers.

use std::ops::ControlFlow;

use antumbra_kernel::plucker::edge_row;
use antumbra_scene::{KdNode, PolygonId, Scene};

/// A scene prepared for casting rays and for exact line tests.
#[derive(Clone, Debug)]
pub struct Caster<'a> {
    scene: &'a Scene,
    /// Rows of all edges, in the order of the polygons' corners.
    rows: Vec<[f64; 6]>,
    first: Vec<u32>,
    planes: Vec<[f64; 4]>,
    occludes: Vec<bool>,
    transparent: bool,
}

/// A segment in fractional grid coordinates, with its Plücker coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub from: [f64; 3],
    pub step: [f64; 3],
    pub moment: [f64; 3],
}

impl Segment {
    pub(crate) fn new(from: [f64; 3], to: [f64; 3]) -> Self {
        let step = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        Self {
            from,
            step,
            moment: cross(from, step),
        }
    }

    pub(crate) fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.from[k] + t * self.step[k])
    }
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<'a> Caster<'a> {
    /// Prepares a scene: linear in its size.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        let n = scene.polygon_count();
        let mut rows = Vec::new();
        let mut first = Vec::with_capacity(n + 1);
        let mut planes = Vec::with_capacity(n);
        let mut occludes = Vec::with_capacity(n);
        first.push(0);
        for polygon in scene.polygons() {
            let c = polygon.corners;
            for i in 0..c.len() {
                rows.push(edge_row(c[i], c[(i + 1) % c.len()]).map(|v| v as f64));
            }
            first.push(rows.len() as u32);
            let p = polygon.plane;
            planes.push([
                p.normal[0] as f64,
                p.normal[1] as f64,
                p.normal[2] as f64,
                p.offset as f64,
            ]);
            occludes.push(polygon.occludes);
        }
        let transparent = occludes.contains(&false);
        Self {
            scene,
            rows,
            first,
            planes,
            occludes,
            transparent,
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Whether any polygon lets lines through.
    pub(crate) fn has_transparent(&self) -> bool {
        self.transparent
    }

    /// Whether a polygon blocks lines.
    #[inline]
    pub(crate) fn occludes(&self, id: PolygonId) -> bool {
        self.occludes[id.index()]
    }

    /// The edge rows of a polygon; every coefficient is an integer.
    #[inline]
    pub(crate) fn rows(&self, id: PolygonId) -> &[[f64; 6]] {
        let i = id.index();
        &self.rows[self.first[i] as usize..self.first[i + 1] as usize]
    }

    /// The normal of a polygon.
    #[inline]
    pub(crate) fn normal(&self, id: PolygonId) -> [f64; 3] {
        let p = &self.planes[id.index()];
        [p[0], p[1], p[2]]
    }

    /// The offset of a polygon's plane.
    #[inline]
    pub(crate) fn offset(&self, id: PolygonId) -> f64 {
        self.planes[id.index()][3]
    }

    /// Where the segment's line crosses a polygon (touching counts), as a parameter.
    #[inline]
    pub(crate) fn crossing(&self, id: PolygonId, s: &Segment) -> Option<f64> {
        let p = &self.planes[id.index()];
        let n = [p[0], p[1], p[2]];
        let along = dot(n, s.step);
        if along == 0.0 {
            return None;
        }
        let t = (p[3] - dot(n, s.from)) / along;
        let forward = along > 0.0;
        for r in self.rows(id) {
            let side = r[0] * s.step[0]
                + r[1] * s.step[1]
                + r[2] * s.step[2]
                + r[3] * s.moment[0]
                + r[4] * s.moment[1]
                + r[5] * s.moment[2];
            if (side < 0.0) == forward && side != 0.0 {
                return None;
            }
        }
        Some(t)
    }

    /// Visits the leaves that the segment passes between two parameters, nearest first.
    ///
    /// `slack` widens every interval (in grid steps), so that with a slack above the rounding
    /// errors no leaf that the exact segment meets is missed. The visitor gets the polygons and
    /// the interval of the leaf.
    pub(crate) fn visit(
        &self,
        s: &Segment,
        (t0, t1): (f64, f64),
        slack: f64,
        mut visitor: impl FnMut(&[PolygonId], f64, f64) -> ControlFlow<()>,
    ) {
        let kd = self.scene.kd();
        let inverse = s.step.map(|c| 1.0 / c);
        let (mut enter, mut leave) = (t0, t1);
        let bounds = kd.bounds();
        let (lo, hi) = (bounds.min.to_f64(), bounds.max.to_f64());
        for k in 0..3 {
            if s.step[k] == 0.0 {
                if s.from[k] < lo[k] - slack || s.from[k] > hi[k] + slack {
                    return;
                }
                continue;
            }
            let a = (lo[k] - slack - s.from[k]) * inverse[k];
            let b = (hi[k] + slack - s.from[k]) * inverse[k];
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        if enter > leave {
            return;
        }
        let mut stack: Vec<(u32, f64, f64)> = Vec::with_capacity(64);
        let mut node = 0_u32;
        loop {
            match kd.nodes()[node as usize] {
                KdNode::Inner {
                    axis,
                    at,
                    lower,
                    upper,
                } => {
                    let k = usize::from(axis);
                    let offset = f64::from(at) - s.from[k];
                    if s.step[k] == 0.0 {
                        if offset.abs() <= slack {
                            stack.push((upper, enter, leave));
                            node = lower;
                        } else {
                            node = if offset > 0.0 { lower } else { upper };
                        }
                        continue;
                    }
                    let t = offset * inverse[k];
                    let dt = slack * inverse[k].abs();
                    let (near, far) = if s.step[k] > 0.0 {
                        (lower, upper)
                    } else {
                        (upper, lower)
                    };
                    if leave < t - dt {
                        node = near;
                    } else if enter > t + dt {
                        node = far;
                    } else {
                        stack.push((far, enter.max(t - dt), leave));
                        leave = leave.min(t + dt);
                        node = near;
                    }
                }
                KdNode::Leaf { first, count } => {
                    if count > 0 && visitor(kd.leaf_items(first, count), enter, leave).is_break() {
                        return;
                    }
                    let Some((n, e, l)) = stack.pop() else { return };
                    (node, enter, leave) = (n, e, l);
                }
            }
        }
    }

    /// The nearest polygon that the segment meets after `t0`, up to `t1`, among those accepted.
    pub(crate) fn first_hit(
        &self,
        s: &Segment,
        (t0, t1): (f64, f64),
        accept: impl Fn(PolygonId) -> bool,
    ) -> Option<(f64, PolygonId)> {
        let mut best: Option<(f64, PolygonId)> = None;
        self.visit(s, (t0, t1), SAMPLING_SLACK, |items, _, leave| {
            for &id in items {
                if accept(id)
                    && let Some(t) = self.crossing(id, s)
                    && t >= t0
                    && t <= t1
                    && best.is_none_or(|b| (t, id) < b)
                {
                    best = Some((t, id));
                }
            }
            match best {
                Some((t, _)) if t < leave => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        });
        best
    }
}

/// A thousandth of a grid step: enough for samples, which prove nothing.
pub(crate) const SAMPLING_SLACK: f64 = 1.0 / 1024.0;
