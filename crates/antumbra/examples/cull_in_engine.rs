//! Culling in an engine's frame loop, without any renderer: see `docs/guides/culling.md`.

use antumbra::cull::{Camera, CameraError, CullOptions, Culler};
use antumbra::scene::synth::{MazeParams, maze};
use antumbra::scene::{ObjectId, SceneBuilder};

/// What an engine keeps for each object of the scene, by id.
struct Mesh {
    name: String,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Once: the scene. An engine fills `SceneInput` from its own meshes, one object each.
    let input = maze(&MazeParams {
        rooms: 8,
        furniture: 6,
        seed: 1,
    });
    let (scene, _) = SceneBuilder::new(input).build()?;
    let objects = scene.objects().iter();
    let meshes: Vec<Mesh> = objects
        .map(|o| Mesh {
            name: o.name.clone(),
        })
        .collect();
    let door = ObjectId(2);
    let mut culler = Culler::with_options(
        &scene,
        CullOptions {
            doors: vec![door],
            ..CullOptions::default()
        },
    );

    let mut drawn = 0;
    for frame in 0..120 {
        if frame == 60 {
            culler.set_open(door, true)?;
        }
        let t = f64::from(frame) * 0.05;
        let camera = match camera_of_player(t) {
            Ok(camera) => camera,
            // Numbers that are no camera: draw the frame before once more.
            Err(_) => continue,
        };
        for id in culler.cull(&camera).objects() {
            draw(&meshes[id.index()]);
            drawn += 1;
        }
        // Things that move are no part of the scene: their box is tested.
        if culler.may_see_box([t, 4.0, 0.0], [t + 0.5, 4.5, 1.8]) {
            drawn += 1;
        }
    }
    assert!(
        drawn < 120 * meshes.len() / 2,
        "half of everything at least was culled"
    );
    Ok(())
}

fn camera_of_player(t: f64) -> Result<Camera, CameraError> {
    let eye = [4.0 + t, 4.5, 1.6];
    Camera::new(eye, [1.0, t.sin(), 0.0], [0.0, 0.0, 1.0], 60.0, 16.0 / 9.0)
}

/// Where the engine would queue a draw call.
fn draw(mesh: &Mesh) {
    std::hint::black_box(&mesh.name);
}
