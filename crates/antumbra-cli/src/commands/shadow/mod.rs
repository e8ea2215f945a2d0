//! `antumbra shadow`: what a light reaches, and where shadows begin and end.

mod export;
mod light;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use antumbra::map::{MapError, Mapper, camera_axes};
use antumbra::shadow::{DiscontinuityMesh, Event, Lighting, Shadows, area_light, point_light};
use antumbra_io::{GlbOptions, write_glb};
use antumbra_scene::Scene;
use clap::Args;
use serde_json::{Map, Value, json};

use crate::cli::Global;
use crate::failure::Failure;
use crate::load::{Loaded, SceneArgs, load};
use crate::output::{check_writable, seconds, write_file};
use crate::picture::{Lamp, LightPicture, light_picture, png};
use crate::values::{PointArg, pixels, view_angle};
use light::{Light, LightArg};

/// Options of `shadow`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ShadowArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// A point `x,y,z`; for an area light four corners `"x,y,z x,y,z x,y,z x,y,z"` in order, or
    /// `object` or `object:polygon`
    #[arg(long, value_name = "ID", allow_hyphen_values = true)]
    light: LightArg,
    /// Of an area light, find the discontinuity mesh nearly: from the views of its four corners
    #[arg(long)]
    approximate: bool,
    /// Write the fragments as .glb or .json, a mesh as .json
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a picture
    #[arg(long, value_name = "FILE", requires = "eye")]
    png: Option<PathBuf>,
    /// Where the picture is taken from, in scene units (z up)
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires_all = ["to", "png"]
    )]
    eye: Option<PointArg>,
    /// What it looks at
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    to: Option<PointArg>,
    /// The full vertical angle of the picture, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0, value_parser = view_angle)]
    fov: f64,
    /// Width and height of the picture
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = pixels)]
    size: [usize; 2],
}

const EXAMPLES: &str = "\
Examples:
  antumbra shadow house.glb --light 3,2,2.4 -o lit.glb
  antumbra shadow house.glb --light 20,-15,30 --png noon.png --eye 12,-9,6 --to 4,3,2
  antumbra shadow room.glb --light lamp --approximate -o mesh.json

Polygons are lit on both sides. What does not occlude is lit and shaded, but casts no shadow. A
polygon in whose plane a point light lies is edge-on: nothing reaches it, and it casts no shadow.";

/// What was computed.
enum Answer {
    Fragments(Shadows),
    Mesh(DiscontinuityMesh),
}

/// Computes, writes what was asked for, prints counts and areas.
pub(crate) fn run(args: &ShadowArgs, global: &Global) -> Result<(), Failure> {
    let format = check(args)?;
    let loaded = load(&args.scene, global, args.light.hull())?;
    let scene = &loaded.scene;
    let light = args.light.resolve(scene)?;
    let start = Instant::now();
    let mapper = Mapper::new(scene);
    let prepared = start.elapsed();
    let start = Instant::now();
    fits(matches!(light, Light::Area(_)), args.approximate)?;
    let answer = match light {
        Light::Point(at) => point_light(&mapper, at).map(Answer::Fragments),
        Light::Area(corners) => area_light(&mapper, corners).map(Answer::Mesh),
    };
    let answer = answer.map_err(|e: MapError| Failure::Content(e.to_string()))?;
    let took = start.elapsed();
    let start = Instant::now();
    write(args, format, scene, &answer)?;
    report(
        args,
        global,
        &loaded,
        &answer,
        [took, prepared, start.elapsed()],
    )
}

/// Only the meshes of area lights are approximate, and they are nothing else.
fn fits(area: bool, approximate: bool) -> Result<(), Failure> {
    let text = match (area, approximate) {
        (false, true) => {
            "--approximate is for area lights: give --light four corners, or a polygon"
        }
        (true, false) => "the mesh of an area light is only found nearly: add --approximate",
        _ => return Ok(()),
    };
    Err(Failure::Usage(text.to_owned()))
}

/// How results are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Glb,
    Json,
}

/// Refuses what cannot work before any work is done.
fn check(args: &ShadowArgs) -> Result<Format, Failure> {
    match &args.light {
        LightArg::Point(_) => fits(false, args.approximate)?,
        LightArg::Corners(_) => fits(true, args.approximate)?,
        LightArg::Name(_) => {}
    }
    for path in [&args.output, &args.png].into_iter().flatten() {
        check_writable(path, &[args.scene.scene.as_path()])?;
    }
    if let (Some(PointArg(eye)), Some(PointArg(to))) = (args.eye, args.to) {
        camera_axes(eye, to, UP).map_err(|e| Failure::Usage(e.to_string()))?;
    }
    let Some(path) = &args.output else {
        return Ok(Format::Json);
    };
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match (extension.as_deref(), args.approximate) {
        (Some("json"), _) => Ok(Format::Json),
        (Some("glb"), false) => Ok(Format::Glb),
        (_, approximate) => {
            let what = if approximate {
                "discontinuity meshes are written as .json"
            } else {
                "fragments are written as .glb or .json"
            };
            let path = path.display();
            Err(Failure::Usage(format!(
                "{path}: {what}; change the file's extension"
            )))
        }
    }
}

/// What is up in pictures.
const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn write(args: &ShadowArgs, format: Format, scene: &Scene, answer: &Answer) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        let bytes = match (answer, format) {
            (Answer::Fragments(shadows), Format::Glb) => {
                write_glb(&export::lit_scene(scene, shadows), &GlbOptions::default())
            }
            (Answer::Fragments(shadows), Format::Json) => {
                export::fragments(scene, shadows).to_string().into_bytes()
            }
            (Answer::Mesh(mesh), _) => export::mesh(scene, mesh).to_string().into_bytes(),
        };
        write_file(path, &bytes)?;
    }
    match (&args.png, args.eye, args.to) {
        (Some(path), Some(PointArg(eye)), Some(PointArg(to))) => {
            write_picture(args, scene, answer, path, [eye, to])
        }
        _ => Ok(()),
    }
}

fn write_picture(
    args: &ShadowArgs,
    scene: &Scene,
    answer: &Answer,
    path: &Path,
    [eye, to]: [[f64; 3]; 2],
) -> Result<(), Failure> {
    let axes = camera_axes(eye, to, UP).map_err(|e| Failure::Usage(e.to_string()))?;
    let (faces, lines, lamp) = match answer {
        Answer::Fragments(shadows) => (
            export::faces(scene, shadows),
            Vec::new(),
            Lamp::Point(shadows.light(scene)),
        ),
        Answer::Mesh(mesh) => (
            export::plain_faces(scene),
            export::lines(mesh),
            Lamp::Area(mesh.light),
        ),
    };
    let picture = LightPicture {
        faces,
        lines,
        lamp,
        eye,
        axes,
        fov: args.fov.to_radians(),
        size: args.size,
    };
    let bytes = png(args.size, &light_picture(&picture)).map_err(|cause| {
        let path = path.display();
        Failure::Content(format!("{path}: the picture cannot be encoded ({cause})"))
    })?;
    write_file(path, &bytes)
}

fn report(
    args: &ShadowArgs,
    global: &Global,
    loaded: &Loaded,
    answer: &Answer,
    [took, prepared, written]: [Duration; 3],
) -> Result<(), Failure> {
    let mut result = Map::new();
    let scene = &loaded.scene;
    let text = match answer {
        Answer::Fragments(shadows) => {
            if let Some(name) = super::map::touched(scene, shadows.light(scene)) {
                global.output().note(&format!(
                    "note: the light lies on a polygon of `{name}`, which is edge-on and casts no shadow"
                ));
            }
            if let LightArg::Point(given) = args.light {
                super::map::note_moved(global, "light", given, shadows.light(scene));
            }
            result.insert("light".to_owned(), json!(shadows.light(scene)));
            of_fragments(shadows, &mut result)
        }
        Answer::Mesh(mesh) => {
            result.insert("light".to_owned(), json!(mesh.light));
            of_mesh(mesh, &mut result)
        }
    };
    let mut add = |key: &str, time: Duration| result.insert(key.to_owned(), json!(seconds(time)));
    add("seconds", took);
    add("load_seconds", loaded.load_time);
    add("build_seconds", loaded.build_time + prepared);
    add("write_seconds", written);
    let text = format!("{text}, in {:.1} ms", took.as_secs_f64() * 1e3);
    let written = args
        .output
        .iter()
        .chain(&args.png)
        .map(|p| p.display().to_string());
    let text = written.fold(text, |text, path| format!("{text}\n{path}"));
    global.output().result(&Value::Object(result), &text)
}

fn of_fragments(shadows: &Shadows, result: &mut Map<String, Value>) -> String {
    let kinds = [Lighting::Lit, Lighting::Shadowed, Lighting::EdgeOn];
    let counts = kinds.map(|k| {
        shadows
            .fragments()
            .iter()
            .filter(|f| f.lighting == k)
            .count()
    });
    let areas = kinds.map(|k| shadows.area(k));
    let by_name = |values: [Value; 3]| -> Value {
        let pairs = kinds.iter().map(|k| k.name().to_owned()).zip(values);
        Value::Object(pairs.collect())
    };
    result.insert("fragments".to_owned(), by_name(counts.map(|n| json!(n))));
    result.insert("areas".to_owned(), by_name(areas.map(|a| json!(a))));
    format!(
        "{} fragments lit (area {:.6}), {} shadowed ({:.6}), {} edge-on ({:.6})",
        counts[0], areas[0], counts[1], areas[1], counts[2], areas[2]
    )
}

fn of_mesh(mesh: &DiscontinuityMesh, result: &mut Map<String, Value>) -> String {
    let mut ends: Vec<[u64; 3]> = mesh
        .pieces
        .iter()
        .flat_map(|p| p.ends)
        .map(|e| e.map(f64::to_bits))
        .collect();
    ends.sort_unstable();
    ends.dedup();
    let counts = Event::ALL.map(|e| mesh.pieces.iter().filter(|p| p.event == e).count());
    let names = Event::ALL.map(|e| e.name().to_owned());
    let by_event = names.into_iter().zip(counts.map(|n| json!(n))).collect();
    let mut polygons: Vec<_> = mesh.pieces.iter().map(|p| p.polygon).collect();
    polygons.sort_unstable();
    polygons.dedup();
    result.insert("vertices".to_owned(), json!(ends.len()));
    result.insert("edges_by_event".to_owned(), Value::Object(by_event));
    result.insert("polygons".to_owned(), json!(polygons.len()));
    result.insert("accuracy".to_owned(), json!("approximate"));
    format!(
        "{} edges by corners of the light, {} by its edges, {} by three edges, on {} polygons (approximate)",
        counts[0],
        counts[1],
        counts[2],
        polygons.len()
    )
}
