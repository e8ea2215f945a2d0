//! `antumbra gen KIND`: synthetic scenes, with their parameters in the file's metadata.

use std::path::{Path, PathBuf};

use antumbra_io::plan::{write_geojson, write_seg};
use antumbra_io::{GlbOptions, Instancing, write_glb, write_obj};
use antumbra_scene::SceneInput;
use antumbra_scene::synth::{
    LayerParams, LayerPattern, MazeParams, OfficeKind, SegmentParams, TriangleParams, face_count,
    floor, layers, maze, office, random_segments, random_triangles,
};
use clap::{Args, Subcommand, ValueEnum};
use serde_json::{Value, json};

use crate::cli::Global;
use crate::failure::Failure;
use crate::output::{check_writable, write_file};
use crate::values::positive;

/// Options of `gen`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct GenArgs {
    #[command(subcommand)]
    kind: Kind,
    /// The file to write: .glb or .obj; of random-segments .seg or .geojson
    #[arg(long, short, global = true, value_name = "FILE")]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra gen walls --layers 20 --source-area 2 -o walls.glb
  antumbra bake walls.glb --cells object:source
  antumbra gen random-triangles --count 10000 --area 12.5 --source-area 200 -o r9.glb
  antumbra gen office --kind floor --seed 7 -o floor.glb";

/// Which scene.
#[derive(Debug, Subcommand)]
enum Kind {
    /// Equilateral triangles, randomly placed and turned in a cube of 100 m
    RandomTriangles {
        /// How many
        #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=2_000_000))]
        count: u32,
        /// Area of each triangle in square metres, at most 5000
        #[arg(long, value_name = "A", default_value_t = 50.0, value_parser = positive)]
        area: f64,
        /// Area of the source in square metres
        #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = positive)]
        source_area: f64,
    },
    /// Random segments with their middles in a square of 100 m: a plan, written as .seg or .geojson
    RandomSegments {
        /// How many
        #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=2_000_000))]
        count: u32,
        /// The longest that one may be, from 0.01 to 1000 metres (default: 130 / sqrt(N))
        #[arg(long, value_name = "L", value_parser = segment_length)]
        length: Option<f64>,
    },
    /// Walls of 20 x 20 quads, one behind the other
    Walls(Layers),
    /// Chessboards of 20 x 20 fields, one behind the other, alternating
    Chessboard(Layers),
    /// A furnished room with a light, or a whole furnished floor
    Office {
        /// Which one
        #[arg(long, value_enum, default_value_t = Office::Office1)]
        kind: Office,
    },
    /// A maze of furnished rooms
    Maze {
        /// Rooms along each side
        #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=500))]
        rooms: u32,
        /// Pieces of furniture a room
        #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=16))]
        furniture: u32,
    },
}

/// Parameters of the layered scenes.
#[derive(Args, Clone, Copy, Debug)]
struct Layers {
    /// How many layers
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=5000))]
    layers: u32,
    /// Area of the source in square metres
    #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = positive)]
    source_area: f64,
}

/// The kinds of office.
#[derive(Clone, Copy, Debug, ValueEnum)]
#[allow(clippy::enum_variant_names, reason = "the names of the options")]
enum Office {
    /// 139 polygons: one desk
    Office1,
    /// 211 polygons: with visitors' chairs, a screen and pictures
    Office2,
    /// 333 polygons: two desks
    Office3,
    /// 751 polygons: six workplaces and a meeting table
    Office4,
    /// 751 polygons: the same, turned a little
    Office4star,
    /// Ten furnished rooms along a corridor
    Floor,
}

/// Makes the scene and writes it.
pub(crate) fn run(args: &GenArgs, global: &Global) -> Result<(), Failure> {
    let path = args.output.as_deref().ok_or_else(|| {
        let file = match args.kind {
            Kind::RandomSegments { .. } => "FILE.seg",
            _ => "FILE.glb",
        };
        Failure::Usage(format!(
            "the file to write is missing; give it with -o {file}"
        ))
    })?;
    if let Kind::RandomSegments { count, length } = args.kind {
        let mut params = SegmentParams::new(count, global.seed);
        params.length = length.unwrap_or(params.length);
        return plan(path, &params, global);
    }
    let format = format_of(path)?;
    check_writable(path, &[])?;
    let (scene, mut parameters) = make(&args.kind, global.seed)?;
    let bytes = match format {
        Format::Glb => {
            // The quads of a raster are one mesh in many places: rounding cannot part them, because
            // they overlap.
            let instancing = match args.kind {
                Kind::Walls(_) | Kind::Chessboard(_) => Instancing::Always,
                _ => Instancing::default(),
            };
            let options = GlbOptions {
                instancing,
                metadata: Some(parameters.clone()),
            };
            write_glb(&scene, &options)
        }
        Format::Obj => write_obj(&scene).into_bytes(),
    };
    write_file(path, &bytes)?;
    let polygons = face_count(&scene);
    parameters["objects"] = scene.objects.len().into();
    parameters["polygons"] = polygons.into();
    parameters["bytes"] = bytes.len().into();
    let text = format!(
        "{}: {} objects, {polygons} polygons ({})",
        path.display(),
        scene.objects.len(),
        scene.source_name
    );
    global.output().result(&parameters, &text)
}

/// A length that leaves most random segments one on their raster of 1/8192 m, and all near their square.
fn segment_length(text: &str) -> Result<f64, String> {
    positive(text)
        .ok()
        .filter(|length| (0.01..=1000.0).contains(length))
        .ok_or_else(|| "expected a length from 0.01 to 1000 metres".to_owned())
}

/// Makes a plan and writes it.
fn plan(path: &Path, params: &SegmentParams, global: &Global) -> Result<(), Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let made = random_segments(params);
    let mut used = json!({"kind": "random-segments", "count": params.count, "length": params.length,
        "seed": global.seed});
    let bytes = match extension.as_deref() {
        Some("seg") => write_seg(&made, &used.to_string()),
        Some("geojson" | "json") => write_geojson(&made, &used),
        _ => {
            return Err(Failure::Usage(format!(
                "{}: plans are written as .seg or .geojson; change the file's extension",
                path.display()
            )));
        }
    };
    check_writable(path, &[])?;
    write_file(path, bytes.as_bytes())?;
    used["segments"] = made.segments.len().into();
    used["bytes"] = bytes.len().into();
    let text = format!("{}: {} segments", path.display(), made.segments.len());
    global.output().result(&used, &text)
}

enum Format {
    Glb,
    Obj,
}

fn format_of(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("glb") => Ok(Format::Glb),
        Some("obj") => Ok(Format::Obj),
        _ => Err(Failure::Usage(format!(
            "{}: scenes are written as .glb or .obj; change the file's extension",
            path.display()
        ))),
    }
}

/// The scene and the parameters that were used.
fn make(kind: &Kind, seed: u64) -> Result<(SceneInput, Value), Failure> {
    let made = match *kind {
        Kind::RandomTriangles {
            count,
            area,
            source_area,
        } => {
            if area > 5000.0 {
                let text = "triangles of more than 5000 square metres do not fit the cube of 100 m; give a smaller --area";
                return Err(Failure::Usage(text.to_owned()));
            }
            let params = TriangleParams {
                count,
                area,
                source_area,
                seed,
            };
            let used = json!({"kind": "random-triangles", "count": count, "area": area,
                "source_area": source_area, "seed": seed});
            (random_triangles(&params), used)
        }
        Kind::RandomSegments { .. } => {
            return Err(Failure::Usage("plans are no scenes".to_owned()));
        }
        Kind::Walls(params) => layered("walls", LayerPattern::Walls, params),
        Kind::Chessboard(params) => layered("chessboard", LayerPattern::Chessboard, params),
        Kind::Office { kind } => {
            let single = match kind {
                Office::Office1 => OfficeKind::Office1,
                Office::Office2 => OfficeKind::Office2,
                Office::Office3 => OfficeKind::Office3,
                Office::Office4 => OfficeKind::Office4,
                Office::Office4star => OfficeKind::Office4Star,
                Office::Floor => {
                    let used = json!({"kind": "office", "office": "floor", "seed": seed});
                    return Ok((floor(seed).scene, used));
                }
            };
            (
                office(single),
                json!({"kind": "office", "office": single.name()}),
            )
        }
        Kind::Maze { rooms, furniture } => {
            let used =
                json!({"kind": "maze", "rooms": rooms, "furniture": furniture, "seed": seed});
            (
                maze(&MazeParams {
                    rooms,
                    furniture,
                    seed,
                }),
                used,
            )
        }
    };
    Ok(made)
}

fn layered(name: &str, pattern: LayerPattern, params: Layers) -> (SceneInput, Value) {
    let Layers {
        layers: count,
        source_area,
    } = params;
    let used = json!({"kind": name, "layers": count, "source_area": source_area});
    (
        layers(&LayerParams {
            pattern,
            layers: count,
            source_area,
        }),
        used,
    )
}
