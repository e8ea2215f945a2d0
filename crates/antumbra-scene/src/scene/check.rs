//! The invariants of a scene, each checked anew from the corners alone.

use antumbra_kernel::{Aabb, LIMIT, Plane, Point};

use super::{PolygonId, PolygonRef, Scene};
use crate::kd;

/// The first broken invariant, as a sentence.
pub(super) fn check(scene: &Scene) -> Result<(), String> {
    check_arrays(scene)?;
    check_owners(scene)?;
    for polygon in scene.polygons() {
        check_polygon(&polygon).map_err(|what| format!("polygon {}: {what}", polygon.id.0))?;
    }
    let boxes: Vec<Aabb> = scene.polygons().map(|polygon| polygon.bounds()).collect();
    if let Some(bounds) = boxes.iter().copied().reduce(Aabb::union)
        && (scene.bounds != bounds || scene.kd.bounds() != bounds)
    {
        return Err(format!(
            "the box of the scene is {:?} and should be {bounds:?}",
            scene.bounds
        ));
    }
    kd::check(&scene.kd, &boxes, |i| {
        let PolygonRef { corners, plane, .. } = scene.polygon(PolygonId(i));
        Some(kd::Shape { corners, plane })
    })
}

fn check_arrays(scene: &Scene) -> Result<(), String> {
    let n = scene.planes.len();
    if scene.first.len() != n + 1 || scene.owners.len() != n || scene.occludes.len() != n {
        return Err("the arrays of the polygons differ in length".into());
    }
    if scene.first.windows(2).any(|w| w[1] < w[0] + 3) {
        return Err("a polygon has fewer than three corners".into());
    }
    if scene.first[0] != 0 || scene.first[n] as usize != scene.corners.len() {
        return Err("some corners belong to no polygon".into());
    }
    Ok(())
}

fn check_owners(scene: &Scene) -> Result<(), String> {
    let mut next = 0;
    for (id, object) in scene.objects.iter().enumerate() {
        if object.polygons.start != next || object.polygons.end < next {
            return Err(format!(
                "object {id} has polygons {:?}, but {next} comes next",
                object.polygons
            ));
        }
        next = object.polygons.end;
        for i in object.polygons.clone() {
            if scene.owners.get(i as usize).map(|owner| owner.index()) != Some(id) {
                return Err(format!("polygon {i} does not know its owner {id}"));
            }
        }
    }
    if next as usize == scene.planes.len() {
        Ok(())
    } else {
        Err("some polygons have no owner".into())
    }
}

fn check_polygon(polygon: &PolygonRef<'_>) -> Result<(), String> {
    let (corners, plane) = (polygon.corners, polygon.plane);
    let inside = |c: i32| -LIMIT < c && c < LIMIT;
    for corner in corners {
        if !corner.to_array().into_iter().all(inside) {
            return Err(format!("{corner:?} is outside the grid"));
        }
        if !plane.side(*corner).is_zero() {
            return Err(format!("{corner:?} is off the plane"));
        }
    }
    check_normal(plane)?;
    // Strictly convex: every corner that does not belong to an edge is strictly on its left. That
    // excludes repeated corners, straight corners and polygons that go around twice.
    let n = corners.len();
    for i in 0..n {
        let (a, b) = (corners[i], corners[(i + 1) % n]);
        for k in 2..n {
            let c = corners[(i + k) % n];
            if turn_about(plane, a, b, c) <= 0 {
                return Err(format!(
                    "not strictly convex at {c:?} seen from the edge {a:?} {b:?}"
                ));
            }
        }
    }
    Ok(())
}

fn check_normal(plane: &Plane) -> Result<(), String> {
    let gcd = |mut a: u64, mut b: u64| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let divisor = plane.normal.iter().fold(0, |d, n| gcd(d, n.unsigned_abs()));
    let first = plane.normal.iter().copied().find(|&n| n != 0).unwrap_or(0);
    if divisor == 1 && first > 0 {
        Ok(())
    } else {
        Err(format!("{:?} is no canonical normal", plane.normal))
    }
}

/// Positive if `a b c` turns counter-clockwise about the normal.
fn turn_about(plane: &Plane, a: Point, b: Point, c: Point) -> i128 {
    let normal = Plane::through(a, b, c).normal;
    (0..3)
        .map(|k| i128::from(normal[k]) * i128::from(plane.normal[k]))
        .sum::<i128>()
        .signum()
}
