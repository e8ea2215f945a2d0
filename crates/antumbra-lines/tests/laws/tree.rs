//! The laws of occlusion trees: the nearest occluder owns each line, in whatever order they came.

use antumbra_lines::{
    Half, Leaf, Nearness, Occluder, OcclusionTree, Plane3, Space3, Visibility, primitive,
};

use crate::{Random, triangle};

/// Triangles in front of the origin, each on a plane of its own, some of them crossing.
struct Scene {
    space: Space3,
    cones: Vec<[[i64; 3]; 3]>,
    occluders: Vec<Occluder>,
}

fn scene(seed: u64, count: usize) -> Scene {
    let mut random = Random(seed * 2 + 88_172_645_463_325_253);
    let mut space = Space3::new();
    let (mut cones, mut occluders) = (Vec::new(), Vec::new());
    while cones.len() < count {
        let Some(d) = triangle(&mut random, 6, 6) else {
            continue;
        };
        // The plane of the three corners: n . a, with the normal pointing away.
        let sub = |u: [i64; 3], v: [i64; 3]| [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
        let (u, v) = (sub(d[1], d[0]), sub(d[2], d[0]));
        let n = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        let scale: i64 = (0..3).map(|k| n[k] * d[0][k]).sum();
        if scale == 0 {
            continue;
        }
        let sign = scale.signum();
        let nearness = Nearness {
            row: n.map(|c| i128::from(c * sign)),
            scale: i128::from(scale.abs()),
        };
        occluders.push(space.occluder(nearness, cones.len() as u32));
        cones.push(d);
    }
    Scene {
        space,
        cones,
        occluders,
    }
}

/// The upper half space, as the cone of a square.
fn framed(space: &mut Space3) -> OcclusionTree<Plane3> {
    let mut tree = OcclusionTree::new();
    for row in [[-1, 0, 9], [1, 0, 9], [0, -1, 9], [0, 1, 9]] {
        tree.restrict(space.plane(row), Half::Positive);
    }
    tree
}

fn grown(scene: &mut Scene, order: &[usize]) -> OcclusionTree<Plane3> {
    let mut tree = framed(&mut scene.space);
    for &i in order {
        let cone = scene.space.cone(&scene.cones[i]);
        tree.insert(&mut scene.space, cone, scene.occluders[i]);
    }
    tree
}

/// The owners of the leaves around a direction, sorted.
fn owners(scene: &mut Scene, tree: &OcclusionTree<Plane3>, d: [i64; 3]) -> Vec<Option<u32>> {
    let ray = scene.space.ray(d);
    let mut out = Vec::new();
    tree.visit_at(&scene.space, &ray, |leaf| match leaf {
        Leaf::Blocked(o) => out.push(Some(o.0)),
        Leaf::Open => out.push(None),
        Leaf::Outside => {}
    });
    out.sort_unstable();
    out.dedup();
    out
}

#[test]
fn the_order_of_insertion_does_not_matter() {
    let mut compared = 0;
    for seed in 0..60 {
        let mut scene = scene(seed, 7);
        let forward = grown(&mut scene, &[0, 1, 2, 3, 4, 5, 6]);
        let backward = grown(&mut scene, &[6, 5, 4, 3, 2, 1, 0]);
        let mut random = Random(seed + 5);
        for _ in 0..200 {
            let d = [
                random.between(-900, 900),
                random.between(-900, 900),
                random.between(300, 900),
            ];
            let (a, b) = (
                owners(&mut scene, &forward, d),
                owners(&mut scene, &backward, d),
            );
            // On a border more leaves may meet in one tree; inside a face there is one owner.
            if a.len() == 1 && b.len() == 1 {
                assert_eq!(a, b, "seed {seed}, {d:?}");
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}

#[test]
fn the_three_states_agree_with_insertion() {
    let mut seen = [0; 3];
    for seed in 0..300 {
        let count = 1 + seed as usize % 30;
        let mut scene = scene(1000 + seed, count + 1);
        let order: Vec<usize> = (0..count).collect();
        let mut tree = grown(&mut scene, &order);
        let last = scene.occluders[count];
        let cone = scene.space.cone(&scene.cones[count]);
        let state = tree.test(&mut scene.space, cone.clone(), last);
        // Without splitting nothing is called invisible that is not.
        let careful = tree.test_without_splitting(&scene.space, &cone, |old| {
            let corners = cone.corners.iter();
            let mut signs = corners.map(|c| scene.space.nearer(last, old, &c.ray));
            signs.all(|s| !s.is_positive())
        });
        if careful == Visibility::Invisible {
            assert_eq!(state, Visibility::Invisible, "seed {seed}");
        }
        let inserted = tree.insert(&mut scene.space, cone.clone(), last);
        assert_eq!(inserted, state != Visibility::Invisible, "seed {seed}");
        // What was inserted is not in front of itself.
        let again = tree.test(&mut scene.space, cone, last);
        assert_eq!(again, Visibility::Invisible, "seed {seed}");
        seen[match state {
            Visibility::Invisible => 0,
            Visibility::Partial => 1,
            Visibility::Full => 2,
        }] += 1;
    }
    assert!(seen.iter().all(|&n| n > 5), "{seen:?}");
}

#[test]
fn table_3_1() {
    use Visibility::{Full, Invisible, Partial};
    assert_eq!(Full.and(Full), Full);
    assert_eq!(Invisible.and(Invisible), Invisible);
    for (a, b) in [
        (Invisible, Full),
        (Partial, Partial),
        (Partial, Full),
        (Partial, Invisible),
    ] {
        assert_eq!((a.and(b), b.and(a)), (Partial, Partial));
    }
}

#[test]
fn equal_directions_have_equal_primitive_integers() {
    let mut space = Space3::new();
    let (x, y) = (space.plane([2, 0, 0]), space.plane([0, -3, 0]));
    let meet = space.meet(y, x);
    let given = space.ray([0, 0, 7]);
    let [a, b] = [meet, given].map(|ray| primitive(&space.exact(&ray)));
    assert_eq!(a, b);
}
