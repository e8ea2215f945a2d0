//! No ray of the independent ray caster may hit first what was culled.

use antumbra::cull::{
    Camera, Coherence, CullOptions, Culler, LeafTest, Method, MinimumCost, Order, Probability,
    Selection,
};
use antumbra::scene::synth::{MazeParams, TriangleParams, maze, random_triangles};
use antumbra::scene::{Scene, SceneBuilder, SceneInput};
use antumbra_io::read_scene;
use antumbra_testkit::environment::{data, long, skip};
use antumbra_testkit::random::Random;
use antumbra_testkit::ray_caster::{RayCaster, Triangle};

fn caster(scene: &Scene) -> RayCaster {
    let mut triangles = Vec::new();
    for polygon in scene.polygons() {
        let at = |i: usize| scene.grid().to_scene(polygon.corners[i]);
        for i in 1..polygon.corners.len() - 1 {
            triangles.push(Triangle {
                corners: [at(0), at(i), at(i + 1)],
                owner: polygon.object.0,
            });
        }
    }
    RayCaster::new(triangles)
}

/// Culls a random walk with leaps and shoots rays; returns how many objects were culled. Surfaces
/// within 1e-9 of the first hit count as coincident.
fn judge(
    name: &str,
    scene: &Scene,
    culler: &mut Culler,
    frames: usize,
    rays: usize,
    seed: u64,
) -> usize {
    let caster = caster(scene);
    let mut random = Random::new(seed);
    let bounds = scene.bounds();
    let (low, high) = (
        scene.grid().to_scene(bounds.min),
        scene.grid().to_scene(bounds.max),
    );
    let mut between = |a: f64, b: f64| a + (b - a) * random.unit();
    let mut eye = [0.0; 3];
    let mut culled = 0;
    for frame in 0..frames {
        for k in 0..3 {
            let size = high[k] - low[k];
            eye[k] = if frame % 8 == 0 {
                between(low[k] - 0.1 * size, high[k] + 0.1 * size)
            } else if frame % 8 > 4 {
                // The head turns, the eye rests.
                eye[k]
            } else {
                eye[k] + between(-0.005, 0.005) * size
            };
        }
        let direction = [between(-1.0, 1.0), between(-1.0, 1.0), between(-0.4, 0.4)];
        let up = [0.0, 0.1, 1.0];
        let Ok(camera) = Camera::new(eye, direction, up, between(20.0, 110.0), 16.0 / 9.0) else {
            continue;
        };
        let visible = culler.cull(&camera).clone();
        culled += scene.objects().len() - visible.objects().len();
        let [right, top, forward] = camera.axes();
        let [w, h] = camera.half_extents();
        for _ in 0..rays {
            let (x, y) = (between(-w, w), between(-h, h));
            let ray = std::array::from_fn(|k| forward[k] + x * right[k] + y * top[k]);
            let hits = caster.hits(eye, ray, (0.0, f64::INFINITY));
            let Some(first) = hits.first() else { continue };
            for hit in hits.iter().take_while(|h| h.t <= first.t * (1.0 + 1e-9)) {
                let id = antumbra::scene::ObjectId(hit.owner);
                assert!(
                    visible.contains(id),
                    "{name}: frame {frame} from {eye:?} along {direction:?} culls object {}, \
                     seen along {ray:?}",
                    hit.owner
                );
            }
        }
    }
    culled
}

fn build(input: SceneInput) -> Scene {
    SceneBuilder::new(input).build().expect("a sound scene").0
}

/// Every method, selection, order and kind of coherence.
fn variants() -> Vec<(&'static str, CullOptions)> {
    let standard = CullOptions::default;
    let coherent = |coherence: Coherence| CullOptions {
        coherence,
        ..standard()
    };
    let chance = Some(Probability::Fixed(0.5));
    vec![
        ("default", standard()),
        ("tight", CullOptions::tight()),
        ("F", CullOptions::paper(Method::Frustum, 16)),
        ("FSE", CullOptions::paper(Method::Standard, 32)),
        (
            "FME",
            CullOptions::paper(Method::Modified(LeafTest::Exact), 32),
        ),
        (
            "FMC",
            CullOptions::paper(Method::Modified(LeafTest::Conservative), 32),
        ),
        ("inner", CullOptions::paper(Method::Inner, 32)),
        (
            "inner sweep",
            CullOptions {
                method: Method::Inner,
                ..CullOptions::tight()
            },
        ),
        (
            "standard sweep",
            CullOptions {
                method: Method::Standard,
                ..CullOptions::tight()
            },
        ),
        (
            "region",
            CullOptions {
                selection: Selection::Region {
                    occluders: 64,
                    sweep: true,
                },
                ..standard()
            },
        ),
        (
            "region only",
            CullOptions {
                selection: Selection::Region {
                    occluders: 64,
                    sweep: false,
                },
                ..standard()
            },
        ),
        (
            "reused tree",
            coherent(Coherence {
                updating: true,
                reuse_tree: true,
                ..Coherence::NONE
            }),
        ),
        (
            "autopartition",
            CullOptions {
                order: Order::Autopartition,
                ..standard()
            },
        ),
        (
            "automatic cost",
            CullOptions {
                minimum_cost: MinimumCost::Automatic {
                    object: 0.0,
                    triangle: 2.0,
                },
                ..standard()
            },
        ),
        (
            "updating",
            coherent(Coherence {
                updating: true,
                ..Coherence::NONE
            }),
        ),
        (
            "skipping",
            coherent(Coherence {
                updating: true,
                skip: chance,
                ..Coherence::NONE
            }),
        ),
        (
            "propagation",
            coherent(Coherence {
                updating: true,
                propagation: chance,
                ..Coherence::NONE
            }),
        ),
        (
            "self-tuned",
            coherent(Coherence {
                updating: true,
                skip: Some(Probability::SelfTuned),
                propagation: Some(Probability::SelfTuned),
                reuse_tree: true,
            }),
        ),
    ]
}

#[test]
fn no_ray_sees_what_was_culled() {
    let scenes = [
        (
            "maze",
            build(maze(&MazeParams {
                rooms: 4,
                furniture: 5,
                seed: 3,
            })),
        ),
        (
            "triangles",
            build(random_triangles(&TriangleParams {
                count: 300,
                area: 200.0,
                source_area: 50.0,
                seed: 5,
            })),
        ),
    ];
    for (scene_name, scene) in &scenes {
        for (name, options) in variants() {
            let mut culler = Culler::with_options(scene, options);
            let name = format!("{scene_name}, {name}");
            let culled = judge(&name, scene, &mut culler, 64, 200, 11);
            assert!(culled > 100, "{name}: culls {culled}");
        }
    }
}

/// Polygons on a lattice of nine points a side: everything touches, coincides and crosses, and the eye
/// lies in planes and on lines.
#[test]
fn no_ray_sees_what_was_culled_among_touching_polygons() {
    use antumbra::scene::{Faces, ObjectInput, PartInput};
    let mut random = Random::new(77);
    for round in 0..if long() { 2000 } else { 60 } {
        let mut point = || -> [f64; 3] { std::array::from_fn(|_| random.index(9) as f64) };
        let objects = (0..14).map(|i| {
            let (a, b) = (point(), point());
            let k = i % 3;
            // Rectangles in axis planes, and triangles.
            let corners = if i < 10 {
                let (u, v) = ((k + 1) % 3, (k + 2) % 3);
                let mut ring = [a; 4];
                ring[1][u] = b[u];
                ring[2][u] = b[u];
                ring[2][v] = b[v];
                ring[3][v] = b[v];
                ring.to_vec()
            } else {
                vec![a, b, point()]
            };
            let mut faces = Faces::default();
            faces.push(&(0..corners.len() as u32).collect::<Vec<_>>());
            ObjectInput {
                name: None,
                parts: vec![PartInput {
                    vertices: corners,
                    faces,
                    ..PartInput::default()
                }],
            }
        });
        let input = SceneInput {
            objects: objects.collect(),
            source_name: "lattice".into(),
        };
        let Ok((scene, _)) = SceneBuilder::new(input).grid(Some(0.25)).build() else {
            continue;
        };
        let caster = caster(&scene);
        let mut culler = Culler::with_options(&scene, CullOptions::tight());
        for _ in 0..6 {
            let eye: [f64; 3] = std::array::from_fn(|_| random.index(19) as f64 / 2.0);
            let direction: [f64; 3] = std::array::from_fn(|_| random.index(5) as f64 - 2.0);
            let Ok(camera) = Camera::new(eye, direction, [0.1, 0.2, 1.0], 90.0, 1.0) else {
                continue;
            };
            let visible = culler.cull(&camera);
            let [right, top, forward] = camera.axes();
            for _ in 0..300 {
                let (x, y) = (2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0);
                let ray = std::array::from_fn(|k| forward[k] + x * right[k] + y * top[k]);
                let hits = caster.hits(eye, ray, (1e-9, f64::INFINITY));
                let Some(first) = hits.first() else { continue };
                for hit in hits.iter().take_while(|h| h.t <= first.t * (1.0 + 1e-9)) {
                    assert!(
                        visible.contains(antumbra::scene::ObjectId(hit.owner)),
                        "round {round}: from {eye:?} along {ray:?} object {} is seen",
                        hit.owner
                    );
                }
            }
        }
    }
}

/// Real scenes, a few views or many; the command line has whole item buffers.
#[test]
fn no_ray_sees_what_was_culled_in_measured_scenes() {
    for name in ["duplex", "kit_institute", "quake_e1m1", "delft_block"] {
        let path = data().map(|d| d.join(format!("walk/{name}.glb")));
        let Some(input) = path.and_then(|p| read_scene(&p).ok()) else {
            skip(&format!("walk/{name}.glb is absent"));
            continue;
        };
        let scene = build(input);
        let (frames, rays) = if long() { (2_000, 1_000) } else { (40, 300) };
        let mut culler = Culler::new(&scene);
        judge(name, &scene, &mut culler, frames, rays, 21);
        let mut culler = Culler::with_options(&scene, CullOptions::tight());
        judge(name, &scene, &mut culler, frames / 8, rays, 22);
    }
}
