//! First hits and all hits along rays, by a third-party bounding volume hierarchy and float triangles.
//!
//! The hierarchy works in single precision on boxes grown by more than its rounding; triangles are
//! tested in double precision (after Möller and Trumbore). Good to about 1e-12 of the scene's size,
//! so a contradiction with an exact verdict is a suspicion, to be decided by
//! [`segment::contact`](crate::segment::contact).

use std::time::Duration;

use glam::{Vec3A, vec3a};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::Ray;
use obvhs::{Boundable, BvhBuildParams};

/// A triangle and who owns it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its corners.
    pub corners: [[f64; 3]; 3],
    /// Any number that tells owners apart, such as an object id.
    pub owner: u32,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The position as a multiple of the ray's direction.
    pub t: f64,
    /// The index of the triangle.
    pub triangle: usize,
    /// The owner of the triangle.
    pub owner: u32,
}

/// A set of triangles to shoot rays at. It may be shared between threads.
pub struct RayCaster {
    triangles: Vec<Triangle>,
    bvh: Bvh2,
    /// Scene to hierarchy: (p - center) * scale lies in the cube from -1 to 1.
    center: [f64; 3],
    scale: f64,
}

/// Grows boxes by more than single precision loses on coordinates below one.
const GROWTH: f32 = 4e-6;

impl Boundable for Triangle {
    fn aabb(&self) -> Aabb {
        let corner = |i: usize| {
            let [x, y, z] = self.corners[i];
            vec3a(x as f32, y as f32, z as f32)
        };
        let low = corner(0).min(corner(1)).min(corner(2)) - Vec3A::splat(GROWTH);
        let high = corner(0).max(corner(1)).max(corner(2)) + Vec3A::splat(GROWTH);
        Aabb::new(low, high)
    }
}

impl RayCaster {
    /// Builds the hierarchy over some triangles.
    ///
    /// # Panics
    /// If a coordinate is not finite.
    #[must_use]
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let corners = || triangles.iter().flat_map(|t| t.corners.iter());
        assert!(
            corners().flatten().all(|c| c.is_finite()),
            "a corner is not finite"
        );
        let low = |k: usize| corners().map(|c| c[k]).fold(f64::INFINITY, f64::min);
        let high = |k: usize| corners().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
        let (mut center, mut half) = ([0.0; 3], 0.0_f64);
        if !triangles.is_empty() {
            center = std::array::from_fn(|k| low(k) / 2.0 + high(k) / 2.0);
            half = (0..3)
                .map(|k| high(k) / 2.0 - low(k) / 2.0)
                .fold(0.0, f64::max);
        }
        let scale = if half > 0.0 { 1.0 / half } else { 1.0 };
        let shrunk: Vec<Triangle> = triangles
            .iter()
            .map(|t| Triangle {
                corners: t
                    .corners
                    .map(|c| std::array::from_fn(|k| (c[k] - center[k]) * scale)),
                owner: t.owner,
            })
            .collect();
        let bvh = build_bvh2(
            &shrunk,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        Self {
            triangles,
            bvh,
            center,
            scale,
        }
    }

    /// The triangles, in the order of the indices in [`Hit`].
    #[must_use]
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// The nearest hit of `origin + t * direction` with `range.0 <= t <= range.1`.
    #[must_use]
    pub fn first_hit(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        range: (f64, f64),
    ) -> Option<Hit> {
        self.hits(origin, direction, range).into_iter().next()
    }

    /// All hits of `origin + t * direction` with `range.0 <= t <= range.1`, nearest first; equally
    /// near ones by index.
    #[must_use]
    pub fn hits(&self, origin: [f64; 3], direction: [f64; 3], range: (f64, f64)) -> Vec<Hit> {
        let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
        if self.triangles.is_empty() || !(length > 0.0 && length.is_finite()) {
            return Vec::new();
        }
        // Start where the ray comes near the scene, so that far origins lose no precision.
        let unit: [f64; 3] = direction.map(|c| c / length);
        let local: [f64; 3] = std::array::from_fn(|k| (origin[k] - self.center[k]) * self.scale);
        let nearest = -(0..3).map(|k| local[k] * unit[k]).sum::<f64>();
        let begin = (nearest - 4.0).max(range.0 * length * self.scale);
        let start = vec(std::array::from_fn(|k| local[k] + begin * unit[k]));
        let end = (nearest + 4.0).min(range.1 * length * self.scale) - begin;
        if end.is_nan() || end < 0.0 {
            return Vec::new();
        }
        let ray = Ray::new(start, vec(unit), -GROWTH, end as f32 + GROWTH);
        let mut hits = Vec::new();
        self.visit(ray, |triangle| {
            let corners = &self.triangles[triangle].corners;
            if let Some(t) =
                intersect(origin, direction, corners).filter(|t| range.0 <= *t && *t <= range.1)
            {
                hits.push(Hit {
                    t,
                    triangle,
                    owner: self.triangles[triangle].owner,
                });
            }
        });
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits.dedup();
        hits
    }

    /// Calls a function with every triangle whose grown box the ray meets.
    fn visit(&self, ray: Ray, mut found: impl FnMut(usize)) {
        self.bvh.ray_traverse_anyhit(ray, |_, slot| {
            found(self.bvh.primitive_indices[slot] as usize)
        });
    }
}

fn vec([x, y, z]: [f64; 3]) -> Vec3A {
    vec3a(x as f32, y as f32, z as f32)
}

/// The parameter at which a line meets a closed triangle, if it is not parallel to it.
fn intersect(origin: [f64; 3], direction: [f64; 3], [a, b, c]: &[[f64; 3]; 3]) -> Option<f64> {
    let (ab, ac, ao) = (subtract(*b, *a), subtract(*c, *a), subtract(origin, *a));
    let p = cross(direction, ac);
    let bottom = dot(ab, p);
    if bottom == 0.0 {
        return None;
    }
    let u = dot(ao, p) / bottom;
    let q = cross(ao, ab);
    let v = dot(direction, q) / bottom;
    let t = dot(ac, q) / bottom;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t.is_finite()).then_some(t)
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

fn dot(u: [f64; 3], v: [f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

#[cfg(test)]
mod tests {
    use super::{Hit, RayCaster, Triangle, intersect};
    use crate::points::Points;
    use crate::random::Random;

    fn stack(count: u32) -> RayCaster {
        let corners = |z: f64| [[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 9.0, z]];
        let triangle = |owner: u32| Triangle {
            corners: corners(f64::from(owner)),
            owner,
        };
        RayCaster::new((0..count).map(triangle).collect())
    }

    #[test]
    fn hits_come_nearest_first_and_in_range() {
        let caster = stack(50);
        let first = caster.first_hit([0.1, 0.2, -5.0], [0.0, 0.0, 2.0], (0.0, 1e9));
        assert_eq!(
            first,
            Some(Hit {
                t: 2.5,
                triangle: 0,
                owner: 0
            })
        );
        let hits = caster.hits([0.1, 0.2, -5.0], [0.0, 0.0, 1.0], (10.0, 14.5));
        assert_eq!(
            hits.iter().map(|h| h.owner).collect::<Vec<_>>(),
            [5, 6, 7, 8, 9]
        );
        assert!(
            caster
                .hits([50.0, 0.0, -5.0], [0.0, 0.0, 1.0], (0.0, 1e9))
                .is_empty()
        );
        assert!(
            RayCaster::new(Vec::new())
                .hits([0.0; 3], [1.0; 3], (0.0, 1.0))
                .is_empty()
        );
    }

    #[test]
    fn the_hierarchy_loses_no_hit() {
        let mut points = Points::new(9);
        let mut triangle = |owner: u32| {
            let center = points.uniform();
            let mut corner = || {
                let offset: [i64; 3] =
                    std::array::from_fn(|_| points.random().integer(-3_000_000, 3_000_000));
                std::array::from_fn(|k| (center[k] + offset[k]) as f64)
            };
            Triangle {
                corners: [corner(), corner(), corner()],
                owner,
            }
        };
        let triangles: Vec<Triangle> = (0..400).map(&mut triangle).collect();
        let caster = RayCaster::new(triangles.clone());
        let mut random = Random::new(10);
        let mut found = 0;
        for i in 0..2000 {
            let mut coordinate = || (random.unit() - 0.5) * 2e7;
            let origin: [f64; 3] = std::array::from_fn(|_| coordinate());
            let mut direction: [f64; 3] = std::array::from_fn(|_| coordinate());
            if i % 3 == 0 {
                // Along an axis, and nearly so.
                direction = [0.0, 1.0, if i % 2 == 0 { 0.0 } else { 1e-9 }];
            }
            let mut slow: Vec<usize> = (0..triangles.len())
                .filter(|k| {
                    intersect(origin, direction, &triangles[*k].corners).is_some_and(|t| t >= 0.0)
                })
                .collect();
            let mut fast: Vec<usize> = caster
                .hits(origin, direction, (0.0, f64::INFINITY))
                .into_iter()
                .map(|h| h.triangle)
                .collect();
            fast.sort_unstable();
            slow.sort_unstable();
            assert_eq!(fast, slow, "{origin:?} {direction:?}");
            found += fast.len();
        }
        assert!(found > 1000, "only {found} hits");
    }
}
