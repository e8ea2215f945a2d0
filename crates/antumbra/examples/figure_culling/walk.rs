//! The measured walks, slowed down.

use std::error::Error;
use std::path::Path;

use antumbra::cull::Camera;
use antumbra::scene::{ObjectId, Scene, SceneBuilder};
use antumbra_io::read_scene;

/// A scene and a way through it.
pub(crate) struct Walk {
    pub scene: Scene,
    /// Eye, direction and angle of each camera of the path.
    stations: Vec<([f64; 3], [f64; 3], f64)>,
    /// Triangles of each object.
    triangles: Vec<f64>,
}

impl Walk {
    /// Reads `NAME.glb` and `NAME.path`.
    pub(crate) fn read(folder: &Path, name: &str) -> Result<Self, Box<dyn Error>> {
        let input = read_scene(&folder.join(format!("{name}.glb")))?;
        let (scene, _) = SceneBuilder::new(input).build()?;
        let text = std::fs::read_to_string(folder.join(format!("{name}.path")))?;
        let mut stations = Vec::new();
        for line in text.lines().filter(|l| !l.starts_with('#')) {
            let n = line
                .split_whitespace()
                .map(str::parse)
                .collect::<Result<Vec<f64>, _>>()?;
            stations.push(([n[0], n[1], n[2]], [n[3], n[4], n[5]], n[9]));
        }
        let mut triangles = vec![0.0; scene.objects().len()];
        for polygon in scene.polygons() {
            triangles[polygon.object.index()] += polygon.corners.len() as f64 - 2.0;
        }
        Ok(Self {
            scene,
            stations,
            triangles,
        })
    }

    /// How many triangles a graphics card would be given for an object.
    pub(crate) fn triangles(&self, object: ObjectId) -> f64 {
        self.triangles[object.index()]
    }

    /// Cameras along the way, a step apart. If these are more than `most`, nine pieces of the way, evenly
    /// spread, so that every speed sees the same places.
    pub(crate) fn cameras(&self, step: f64, most: usize) -> Vec<Camera> {
        let all = self.all_cameras(step);
        if all.len() <= most {
            return all;
        }
        let (length, between) = (most / 9, all.len() / 9);
        let piece = |k: usize| &all[k * between..k * between + length];
        (0..9).flat_map(piece).copied().collect()
    }

    /// The head turns between two stations from the one's direction to the other's.
    fn all_cameras(&self, step: f64) -> Vec<Camera> {
        let mut cameras = Vec::new();
        // How far the next camera is beyond the station.
        let mut ahead = 0.0;
        for pair in self.stations.windows(2) {
            let ((a, u, angle), (b, v, _)) = (pair[0], pair[1]);
            let length = (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
            while ahead < length {
                let t = ahead / length;
                let between = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] {
                    std::array::from_fn(|k| p[k] + t * (q[k] - p[k]))
                };
                let up = [0.0, 0.0, 1.0];
                let camera = Camera::new(between(a, b), between(u, v), up, angle, 16.0 / 9.0);
                // Half way through a turn about there is no direction.
                cameras.extend(camera.ok());
                ahead += step;
            }
            ahead -= length;
        }
        cameras
    }
}
