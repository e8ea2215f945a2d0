//! From a path to a scene on the grid: the options, the reading, the building.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use antumbra_io::{ReadError, ReadOptions, Up, read_scene_with};
use antumbra_scene::{BuildReport, OccluderPolicy, Scene, SceneBuilder, SceneInput};
use clap::{Args, ValueEnum};

use crate::classes::check_classes;
use crate::cli::Global;
use crate::failure::Failure;

/// The scene and how to understand it.
#[derive(Args, Clone, Debug)]
pub(crate) struct SceneArgs {
    /// The scene: .glb, .gltf, .obj, .ply or .stl, also gzip'd
    pub scene: PathBuf,
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// How to understand a scene file.
#[derive(Args, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ReadingArgs {
    /// Which axis points up in formats that do not say (glTF does)
    #[arg(long, value_enum, value_name = "AXIS", default_value_t)]
    pub up: UpArg,
    /// Only these classes block the view (class or material names, without case)
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        conflicts_with = "transparent"
    )]
    pub occluders: Vec<String>,
    /// These classes do not block the view
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub transparent: Vec<String>,
}

/// An axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpArg {
    /// y is up
    Y,
    /// z is up
    #[default]
    Z,
}

impl ReadingArgs {
    /// Which classes block.
    pub(crate) fn policy(&self) -> OccluderPolicy {
        if !self.occluders.is_empty() {
            OccluderPolicy::Only(self.occluders.clone())
        } else if !self.transparent.is_empty() {
            OccluderPolicy::Except(self.transparent.clone())
        } else {
            OccluderPolicy::Default
        }
    }
}

/// A box in scene units.
pub(crate) type SceneBox = ([f64; 3], [f64; 3]);

/// A scene on its grid, and how long that took.
pub(crate) struct Loaded {
    pub scene: Scene,
    pub report: BuildReport,
    pub load_time: Duration,
    pub build_time: Duration,
}

/// Reads a scene file.
pub(crate) fn read(path: &Path, reading: &ReadingArgs) -> Result<SceneInput, Failure> {
    let up = match reading.up {
        UpArg::Y => Up::Y,
        UpArg::Z => Up::Z,
    };
    read_scene_with(path, &ReadOptions { up }).map_err(|error| read_failure(&error))
}

/// Puts a scene on its grid; `cells` is the box around the view cells if it is known.
pub(crate) fn build(
    input: SceneInput,
    reading: &ReadingArgs,
    grid: Option<f64>,
    cells: Option<SceneBox>,
) -> Result<(Scene, BuildReport), Failure> {
    let builder = SceneBuilder::new(input)
        .grid(grid)
        .cells_box(cells)
        .policy(reading.policy());
    builder
        .build()
        .map_err(|error| Failure::Content(error.to_string()))
}

/// Reads and builds.
pub(crate) fn load(
    args: &SceneArgs,
    global: &Global,
    cells: Option<SceneBox>,
) -> Result<Loaded, Failure> {
    let start = Instant::now();
    let input = read(&args.scene, &args.reading)?;
    let reading = &args.reading;
    let known = input.classes();
    check_classes(
        &reading.occluders,
        &reading.transparent,
        &known,
        global.output(),
    )?;
    let load_time = start.elapsed();
    let start = Instant::now();
    let (scene, report) = build(input, &args.reading, global.grid, cells)?;
    Ok(Loaded {
        scene,
        report,
        load_time,
        build_time: start.elapsed(),
    })
}

/// A file that cannot be read, by what is wrong.
pub(crate) fn read_failure(error: &ReadError) -> Failure {
    if error.is_path_error() {
        Failure::Path(error.to_string())
    } else {
        Failure::Content(error.to_string())
    }
}
