//! Culling in an engine's frame loop, without any renderer: see `docs/guides/culling.md`.

use antumbra::cull::{Camera, CameraError, CullOptions, Culler};
use antumbra::scene::synth::{MazeParams, maze};
use antumbra::scene::{ObjectId, ObjectInput, OccluderPolicy, PartInput, SceneBuilder, SceneInput};

/// What this engine keeps for each thing it draws: triangles in world space, with y up.
#[derive(Default)]
struct Mesh {
    name: String,
    material: String,
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Once: the scene. Meshes with a material that one looks through must not hide.
    let meshes = load_level();
    let policy = OccluderPolicy::Except(vec!["glass".into(), "fence".into()]);
    let (scene, _) = SceneBuilder::new(scene_input(&meshes))
        .policy(policy)
        .build()?;
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

/// An object for each mesh, in the same order: the id of an object is the position of its mesh.
fn scene_input(meshes: &[Mesh]) -> SceneInput {
    let object = |mesh: &Mesh| ObjectInput {
        name: Some(mesh.name.clone()),
        parts: vec![PartInput {
            class: Some(mesh.material.clone()),
            vertices: mesh.positions.iter().map(|&p| z_up(p)).collect(),
            faces: mesh.triangles.iter().copied().collect(),
            ..PartInput::default()
        }],
    };
    SceneInput {
        objects: meshes.iter().map(object).collect(),
        source_name: "level".into(),
    }
}

/// From the engine's axes to those of scenes.
fn z_up([x, y, z]: [f32; 3]) -> [f64; 3] {
    [x, -z, y].map(f64::from)
}

fn camera_of_player(t: f64) -> Result<Camera, CameraError> {
    let t = t as f32;
    let (eye, direction) = ([4.0 + t, 1.6, -4.5], [1.0, 0.0, -t.sin()]);
    let up = z_up([0.0, 1.0, 0.0]);
    Camera::new(z_up(eye), z_up(direction), up, 60.0, 16.0 / 9.0)
}

/// Where the engine would queue a draw call.
fn draw(mesh: &Mesh) {
    std::hint::black_box(&mesh.name);
}

/// Where the engine would read a file: here a maze is turned into meshes.
fn load_level() -> Vec<Mesh> {
    let mut meshes = Vec::new();
    for object in maze(&MazeParams {
        rooms: 8,
        furniture: 6,
        seed: 1,
    })
    .objects
    {
        let mut mesh = Mesh {
            name: object.name.unwrap_or_default(),
            ..Mesh::default()
        };
        for part in object.parts {
            let first = mesh.positions.len() as u32;
            mesh.material = part.class.unwrap_or_default();
            let y_up = |&[x, y, z]: &[f64; 3]| [x, z, -y].map(|c| c as f32);
            mesh.positions.extend(part.vertices.iter().map(y_up));
            for face in part.faces.iter() {
                let fan = face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]);
                mesh.triangles.extend(fan.map(|t| t.map(|i| first + i)));
            }
        }
        meshes.push(mesh);
    }
    meshes
}
