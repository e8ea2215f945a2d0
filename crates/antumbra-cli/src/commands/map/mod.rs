//! `antumbra map`: the visibility map of a view, and hidden-line drawings of it.

mod export;
mod paper;

use std::path::PathBuf;
use std::time::Instant;

use antumbra::map::{Dissolve, EdgeClass, MapError, MapOptions, Mapper, Viewpoint, VisibilityMap};
use antumbra_scene::{BoxContact, Scene, box_contact};
use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};

use crate::cli::Global;
use crate::failure::Failure;
use crate::load::{Loaded, SceneArgs, load};
use crate::output::{check_outputs, seconds, write_file};
use crate::values::{PointArg, crease_angle, pixels, view_angle};

pub(crate) use export::{element, polygon};

/// Options of `map`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MapArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The viewpoint, in scene units (z up)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: PointArg,
    /// What it looks at; without it the view is the whole sphere
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    to: Option<PointArg>,
    /// What is up in the picture
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        default_value = "0,0,1"
    )]
    up_is: PointArg,
    /// The full vertical angle of the view, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0, value_parser = view_angle)]
    fov: f64,
    /// Parallel lines along the line of sight, over the whole scene, instead of a perspective; DXF is then
    /// in scene units
    #[arg(long, requires = "to", conflicts_with = "fov")]
    ortho: bool,
    /// Two polygons that meet at a smaller angle, in degrees, go on smoothly
    #[arg(long, value_name = "DEG", default_value_t = 15.0, value_parser = crease_angle)]
    crease: f64,
    /// Which edges to remove from the map
    #[arg(long, value_enum, value_name = "EDGES", default_value_t)]
    dissolve: DissolveArg,
    /// Write a drawing as SVG
    #[arg(long, value_name = "FILE", requires = "to")]
    svg: Option<PathBuf>,
    /// Write a drawing as DXF
    #[arg(long, value_name = "FILE", requires = "to")]
    dxf: Option<PathBuf>,
    /// Draw what is behind as dashed lines, too
    #[arg(long)]
    hidden: bool,
    /// Draw flat edges, too: those of objects that are flush and, without `--dissolve flat`, those within
    /// an object
    #[arg(long)]
    flat: bool,
    /// Width and height of the drawing
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = pixels)]
    size: [usize; 2],
    /// Write the whole map with its adjacency as JSON
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra map house.glb --eye 3,2,1.6 --json
  antumbra map house.glb --eye -12,-9,6 --to 4,3,2 --svg house.svg --hidden
  antumbra map house.glb --eye 0,0,20 --to 0,0,0 --up-is 0,1,0 --ortho --dxf plan.dxf

A polygon in whose plane the viewpoint lies is seen edge-on: it is not in the map. What lets lines
through (--transparent, --occluders, materials that blend) is not in the map, either: the map shows
what is behind it.";

/// Which edges to remove.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum DissolveArg {
    /// None
    Nothing,
    /// The cuts of the occlusion tree
    #[default]
    Bsp,
    /// Flat edges within an object as well
    Flat,
}

impl MapArgs {
    fn options(&self) -> MapOptions {
        MapOptions {
            crease: self.crease.to_radians(),
            dissolve: match self.dissolve {
                DissolveArg::Nothing => Dissolve::Nothing,
                DissolveArg::Bsp => Dissolve::Bsp,
                DissolveArg::Flat => Dissolve::Flat,
            },
            ..MapOptions::default()
        }
    }

    /// Refuses what cannot work before any work is done.
    fn check(&self) -> Result<(), Failure> {
        let outputs = [
            (self.svg.as_ref(), &["svg"][..]),
            (self.dxf.as_ref(), &["dxf"]),
            (self.output.as_ref(), &["json"]),
        ];
        check_outputs(&outputs, &[self.scene.scene.as_path()])?;
        let drawn = self.svg.is_some() || self.dxf.is_some();
        for (given, option) in [(self.hidden, "--hidden"), (self.flat, "--flat")] {
            if given && !drawn {
                return Err(Failure::Usage(format!(
                    "{option} is about drawings: add --svg FILE or --dxf FILE"
                )));
            }
        }
        Ok(())
    }

    fn view(&self) -> Result<Viewpoint, Failure> {
        let eye = self.eye.0;
        let Some(PointArg(to)) = self.to else {
            return Ok(Viewpoint::Sphere(eye));
        };
        if self.ortho {
            let direction = std::array::from_fn(|k| to[k] - eye[k]);
            return Ok(Viewpoint::Parallel { direction });
        }
        let [w, h] = self.size.map(|n| n as f64);
        let view = Viewpoint::camera(eye, to, self.up_is.0, self.fov.to_radians(), w / h);
        view.map_err(|e| Failure::Usage(e.to_string()))
    }
}

/// Makes the map, writes what was asked for, prints counts and solid angles.
pub(crate) fn run(args: &MapArgs, global: &Global) -> Result<(), Failure> {
    let (options, view) = (args.options(), args.view()?);
    args.check()?;
    let eye = args.eye.0;
    let hull = (!args.ortho).then_some((eye, eye));
    let loaded = load(&args.scene, global, hull)?;
    let scene = &loaded.scene;
    let start = Instant::now();
    let mapper = Mapper::new(scene);
    let prepared = start.elapsed();
    let start = Instant::now();
    let map = mapper.map(&view, &options).map_err(|e| match e {
        MapError::Snap(_) => Failure::Content(e.to_string()),
        _ => Failure::Usage(e.to_string()),
    })?;
    let took = seconds(start.elapsed());
    let start = Instant::now();
    write(args, global, scene, &map)?;
    let written = seconds(start.elapsed());
    let mut result = report(scene, &map);
    let mut add = |key: &str, value: f64| result.insert(key.to_owned(), json!(value));
    add("seconds", took);
    add("load_seconds", seconds(loaded.load_time));
    add("build_seconds", seconds(loaded.build_time + prepared));
    add("write_seconds", written);
    note_edge_on(args, global, &loaded);
    if let Some(used) = map.eye(scene) {
        note_moved(global, "viewpoint", eye, used);
    }
    let text = sentence(&map, &result);
    global.output().result(&Value::Object(result), &text)
}

fn write(
    args: &MapArgs,
    global: &Global,
    scene: &Scene,
    map: &VisibilityMap,
) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        write_file(path, export::export(scene, map).to_string().as_bytes())?;
    }
    if args.svg.is_none() && args.dxf.is_none() {
        return Ok(());
    }
    let drawing = paper::draw(args, scene, map)?;
    if drawing.layers.iter().all(|layer| layer.lines.is_empty()) {
        let text = "note: nothing is in view: the drawing is empty";
        global.output().note(text);
    }
    if let Some(path) = &args.svg {
        let svg = antumbra_io::drawing::write_svg(&drawing);
        write_file(path, svg.as_bytes())?;
    }
    if let Some(path) = &args.dxf {
        let dxf = antumbra_io::drawing::write_dxf(&drawing);
        write_file(path, dxf.as_bytes())?;
    }
    Ok(())
}

/// Says if the viewpoint lies on a polygon.
fn note_edge_on(args: &MapArgs, global: &Global, loaded: &Loaded) {
    if args.ortho {
        return;
    }
    if let Some(name) = touched(&loaded.scene, args.eye.0) {
        global.output().note(&format!(
            "note: the viewpoint lies on a polygon of `{name}`, which is seen edge-on and hides nothing"
        ));
    }
}

/// Says if a point was moved by a grid that was asked for; by the finest one it is moved by nothing that
/// counts.
pub(crate) fn note_moved(global: &Global, what: &str, given: [f64; 3], used: [f64; 3]) {
    if global.grid.is_some() && given != used {
        let [x, y, z] = used;
        global.output().note(&format!(
            "note: the {what} was moved to {x},{y},{z}, a point of the grid"
        ));
    }
}

/// The name of an object with an occluder on which a point lies, once snapped.
pub(crate) fn touched(scene: &Scene, point: [f64; 3]) -> Option<&str> {
    let point = scene.grid().snap(point).ok()?;
    let place = antumbra::kernel::Aabb::new(point, point);
    let on = scene
        .polygons()
        .find(|p| p.occludes && box_contact(p, &place) != BoxContact::Apart)?;
    Some(&scene.object(on.object).name)
}

/// The keys that scripts rely on.
fn report(scene: &Scene, map: &VisibilityMap) -> Map<String, Value> {
    let mut classes = Map::new();
    for class in EdgeClass::ALL {
        let count = map.edges().iter().filter(|e| e.class == class).count();
        classes.insert(class.name().to_owned(), json!(count));
    }
    let mut polygons: Vec<_> = map
        .faces()
        .iter()
        .flat_map(|f| f.polygon().into_iter().chain(f.joined.iter().copied()))
        .collect();
    polygons.sort_unstable();
    polygons.dedup();
    let measures: Map<String, Value> = map
        .object_measures(scene)
        .into_iter()
        .map(|(object, size)| (object.0.to_string(), json!(size)))
        .collect();
    let background: f64 = map
        .faces()
        .iter()
        .filter(|f| f.polygon().is_none())
        .map(|f| f.measure)
        .fold(0.0, |sum, m| sum + m);
    let work = map.work();
    let leaves = work.sweep.leaves.max(1) as f64;
    let culled = 1.0 - work.sweep.leaves_opened as f64 / leaves;
    let mut result = Map::new();
    let mut add = |key: &str, value: Value| result.insert(key.to_owned(), value);
    if let Some(eye) = map.eye(scene) {
        add("eye", json!(eye));
    }
    add("vertices", json!(map.vertices().len()));
    add("edges", json!(map.edges().len()));
    add("faces", json!(map.faces().len()));
    add("visible_polygons", json!(polygons.len()));
    add("edges_by_class", Value::Object(classes));
    let key = if map.direction().is_some() {
        "area_by_object"
    } else {
        "solid_angle_by_object"
    };
    add(key, Value::Object(measures));
    add("background", json!(background));
    add("culled_leaves", json!(culled));
    add("tree_nodes", json!(work.tree_nodes));
    result
}

fn sentence(map: &VisibilityMap, result: &Map<String, Value>) -> String {
    let classes = EdgeClass::ALL.map(|class| {
        let count = map.edges().iter().filter(|e| e.class == class).count();
        format!("{count} {}", class.name())
    });
    let polygons = &result["visible_polygons"];
    format!(
        "{} vertices, {} edges ({}), {} faces, {polygons} {}, in {:.1} ms",
        map.vertices().len(),
        map.edges().len(),
        classes.join(", "),
        map.faces().len(),
        if *polygons == 1 {
            "polygon"
        } else {
            "polygons"
        },
        result["seconds"].as_f64().unwrap_or_default() * 1e3
    )
}
