//! The source of a bake: its gates, its hull, and who takes no part.

use std::ops::Range;

use antumbra_kernel::{Aabb, Point};
use antumbra_lines::Gate;
use antumbra_scene::{CellKind, PolygonId, Scene, ViewCell};

use crate::gates::{outward_face, polygon_gate};
use crate::random::Random;

/// A gate that lines leave the source through.
#[derive(Clone, Debug)]
pub(super) struct SourceGate {
    /// Its number in certificates.
    pub number: u32,
    pub gate: Gate,
    /// The face as a flat box, for box cells.
    pub face: Option<Aabb>,
}

/// What lines start from.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub bounds: Aabb,
    pub gates: Vec<SourceGate>,
    /// The corners whose hull is the source.
    pub hull: Vec<Point>,
    /// Polygons that take no part.
    pub absent: Range<u32>,
    /// Whether occluders in a gate's plane block.
    pub plane_blocks: bool,
}

impl Source {
    pub(super) fn of_cell(scene: &Scene, cell: &ViewCell) -> Self {
        match cell.kind {
            CellKind::Box => Self::of_box(cell.bounds),
            CellKind::Object(id) => Self::of_polygons(scene, scene.object(id).polygons.clone()),
        }
    }

    pub(super) fn of_box(bounds: Aabb) -> Self {
        let gates = (0..6)
            .filter_map(|number| {
                let gate = outward_face(&bounds, number)?;
                let face = Aabb::around(gate.corners.iter().copied());
                Some(SourceGate { number, gate, face })
            })
            .collect();
        let hull = bounds.corners().to_vec();
        Self {
            bounds,
            gates,
            hull,
            absent: 0..0,
            plane_blocks: true,
        }
    }

    /// Both sides of some polygons, which take no other part.
    pub(super) fn of_polygons(scene: &Scene, polygons: Range<u32>) -> Self {
        let mut hull = Vec::new();
        let mut gates = Vec::new();
        for (k, p) in polygons.clone().enumerate() {
            let polygon = scene.polygon(PolygonId(p));
            hull.extend_from_slice(polygon.corners);
            for against in [false, true] {
                let number = 2 * k as u32 + u32::from(against);
                gates.push(SourceGate {
                    number,
                    gate: polygon_gate(&polygon, against),
                    face: None,
                });
            }
        }
        let bounds = Aabb::around(hull.iter().copied()).unwrap_or_else(|| scene.bounds());
        Self {
            bounds,
            gates,
            hull,
            absent: polygons,
            plane_blocks: false,
        }
    }
}

pub(super) fn area(gate: &Gate) -> f64 {
    let c: Vec<[f64; 3]> = gate.corners.iter().map(|p| p.to_f64()).collect();
    let mut sum = [0.0; 3];
    for i in 1..c.len() - 1 {
        let u: [f64; 3] = std::array::from_fn(|k| c[i][k] - c[0][k]);
        let v: [f64; 3] = std::array::from_fn(|k| c[i + 1][k] - c[0][k]);
        let n = crate::caster::cross(u, v);
        for k in 0..3 {
            sum[k] += n[k];
        }
    }
    crate::caster::dot(sum, sum).sqrt() / 2.0
}

/// A point of a gate, uniform in a random triangle of its fan, and a cosine-weighted direction.
pub(super) fn random_ray(gate: &Gate, rng: &mut Random) -> ([f64; 3], [f64; 3]) {
    let c = &gate.corners;
    let i = 1 + (rng.bits() % (c.len() as u64 - 2)) as usize;
    let (mut a, mut b) = (rng.unit(), rng.unit());
    if a + b > 1.0 {
        (a, b) = (1.0 - a, 1.0 - b);
    }
    let (o, u, v) = (c[0].to_f64(), c[i].to_f64(), c[i + 1].to_f64());
    let p = std::array::from_fn(|k| o[k] + a * (u[k] - o[k]) + b * (v[k] - o[k]));
    let n = gate.plane.normal.map(|x| x as f64);
    let len = crate::caster::dot(n, n).sqrt();
    let n = n.map(|x| x / len);
    // A unit vector uniform on the sphere, added to the normal, is cosine-weighted.
    let z = 2.0 * rng.unit() - 1.0;
    let phi = 2.0 * std::f64::consts::PI * rng.unit();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let s = [r * phi.cos(), r * phi.sin(), z];
    (p, std::array::from_fn(|k| n[k] * 1.0001 + s[k]))
}
