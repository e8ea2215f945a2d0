//! `antumbra cull`: real-time culling along a camera path, measured, drawn and verified.

mod chart;
mod frames;
mod methods;
mod top;
mod verify;

use std::path::PathBuf;
use std::time::Instant;

use antumbra::cull::{Camera, CullWork, Culler};
use antumbra_scene::{ObjectId, Scene};
use clap::Args;
use serde_json::{Value, json};

use crate::cli::Global;
use crate::failure::Failure;
use crate::load::{SceneArgs, load};
use crate::output::{check_outputs, seconds, write_file};
use crate::values::pixels;

use methods::MethodArgs;
use verify::Verdict;

/// Options of `cull`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CullArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The camera path: one camera a line, `ex ey ez dx dy dz ux uy uz fovy`, also gzip'd
    #[arg(long, value_name = "FILE")]
    path: PathBuf,
    /// Width over height of the view
    #[arg(long, value_name = "W:H", default_value = "16:9", value_parser = ratio)]
    aspect: f64,
    #[command(flatten)]
    methods: MethodArgs,
    /// Run the path so often; a frame's time is the median of its runs
    #[arg(long, value_name = "N", default_value_t = 1)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeat: u16,
    /// Render an item buffer of each frame and list every wrong cull
    #[arg(long)]
    verify: bool,
    /// Width and height of the item buffer; its aspect is that of --aspect [default: 1080 pixels high]
    #[arg(long, value_name = "WxH", value_parser = pixels, requires = "verify")]
    size: Option<[usize; 2]>,
    /// Write one line a frame
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the cost of the frames and the visible objects
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Draw the cells of one frame from above
    #[arg(long, value_name = "FILE")]
    top: Option<PathBuf>,
    /// The frame of the top view
    #[arg(long, value_name = "N", default_value_t = 0, requires = "top")]
    frame: usize,
    /// Write the result as JSON to a file, too
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra cull house.glb --path walk.path --json
  antumbra cull house.glb --path walk.path --verify --svg frames.svg --csv frames.csv
  antumbra cull house.glb --path walk.path --doors door --open door-12
  antumbra cull house.glb --path walk.path --method fme --best 32 --top cells.svg --frame 40

Culling runs on one thread; --threads is for reading, building and --verify.";

/// A width to height, written `W:H`.
fn ratio(text: &str) -> Result<f64, String> {
    let wrong = || "expected a width and a height like 16:9".to_owned();
    let (w, h) = text.split_once(':').ok_or_else(wrong)?;
    let side = |s: &str| {
        s.trim()
            .parse::<f64>()
            .ok()
            .filter(|n| n.is_finite() && *n > 0.0)
            .ok_or_else(wrong)
    };
    let ratio = side(w)? / side(h)?;
    let sensible = (1e-3..=1e3).contains(&ratio);
    sensible.then_some(ratio).ok_or_else(|| {
        "a view at most 1000 times as wide as high, or as high as wide, is expected".to_owned()
    })
}

/// What a frame gave.
pub(super) struct Frame {
    pub visible: Vec<u32>,
    pub seconds: f64,
    pub work: CullWork,
}

impl CullArgs {
    /// Width and height of the item buffer.
    fn buffer(&self) -> Result<[usize; 2], Failure> {
        let Some(size) = self.size else {
            let width = (1080.0 * self.aspect).round().clamp(16.0, 8192.0);
            return Ok([width as usize, 1080]);
        };
        let [w, h] = size.map(|n| n as f64);
        // As near as whole pixels come.
        if (w - h * self.aspect).abs() > 1.0 {
            return Err(Failure::Usage(format!(
                "--size {w}x{h} has not the aspect of the view; give both, as --size 1920x1080 --aspect 16:9"
            )));
        }
        Ok(size)
    }
}

/// Culls the path, writes what was asked for, prints the frames.
pub(crate) fn run(args: &CullArgs, global: &Global) -> Result<(), Failure> {
    let inputs = [args.scene.scene.as_path(), args.path.as_path()];
    let outputs = [
        (args.csv.as_ref(), &["csv"][..]),
        (args.svg.as_ref(), &["svg"]),
        (args.top.as_ref(), &["svg"]),
        (args.output.as_ref(), &["json"]),
    ];
    check_outputs(&outputs, &inputs)?;
    let size = args.buffer()?;
    let cameras = frames::read(&args.path, args.aspect)?;
    if args.top.is_some() && args.frame >= cameras.len() {
        return Err(Failure::Usage(format!(
            "--frame {} is not on the path, which has frames 0 to {}",
            args.frame,
            cameras.len() - 1
        )));
    }
    let loaded = load(&args.scene, global, None)?;
    let scene = &loaded.scene;
    let (options, open) = args.methods.options(scene, global.seed)?;
    let make = || {
        let mut culler = Culler::with_options(scene, options.clone());
        for &door in &open {
            culler
                .set_open(door, true)
                .map_err(|e| Failure::Usage(e.to_string()))?;
        }
        Ok(culler)
    };
    let start = Instant::now();
    let mut culler = make()?;
    let prepared = start.elapsed();
    let frames = walk(&mut culler, &cameras, args, make)?;
    let verdict = args
        .verify
        .then(|| check(size, global, scene, &open, &cameras, &frames));
    let start = Instant::now();
    let truth = verdict.as_ref().map(|v| v.by_frame.as_slice());
    write(args, scene, &frames, truth, &cameras, make)?;
    let mut result = report(&frames, &culler);
    let called: u64 = frames.iter().map(|f| f.visible.len() as u64).sum();
    if let (Some(verdict), Value::Object(keys)) = (&verdict, &mut result) {
        keys.insert("verify".into(), verdict.json(called, size, scene));
    }
    if let Value::Object(keys) = &mut result {
        keys.insert("load_seconds".into(), json!(seconds(loaded.load_time)));
        let build = loaded.build_time + prepared;
        keys.insert("build_seconds".into(), json!(seconds(build)));
        keys.insert("write_seconds".into(), json!(seconds(start.elapsed())));
    }
    if let Some(path) = &args.output {
        write_file(path, result.to_string().as_bytes())?;
    }
    let text = sentence(scene, &frames, &result, called, verdict.as_ref());
    global.output().result(&result, &text)
}

/// Culls all frames, so often as asked, each time as if for the first time.
fn walk(
    culler: &mut Culler,
    cameras: &[Camera],
    args: &CullArgs,
    make: impl Fn() -> Result<Culler, Failure>,
) -> Result<Vec<Frame>, Failure> {
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); cameras.len()];
    let mut frames = Vec::with_capacity(cameras.len());
    for run in 0..args.repeat {
        let mut fresh = if run == 0 { None } else { Some(make()?) };
        let culler = fresh.as_mut().unwrap_or(culler);
        for (camera, times) in cameras.iter().zip(&mut times) {
            let start = Instant::now();
            let visible = culler.cull(camera);
            times.push(start.elapsed().as_secs_f64());
            if run == 0 {
                frames.push(Frame {
                    visible: visible.objects().iter().map(|o| o.0).collect(),
                    seconds: 0.0,
                    work: *visible.work(),
                });
            }
        }
    }
    for (frame, times) in frames.iter_mut().zip(&mut times) {
        frame.seconds = share(times, 0.5);
    }
    Ok(frames)
}

/// The value below which a share of some numbers lies.
fn share(values: &mut [f64], share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    let at = (share * values.len() as f64) as usize;
    values.get(at.min(last)).copied().unwrap_or(0.0)
}

fn check(
    size: [usize; 2],
    global: &Global,
    scene: &Scene,
    open: &[ObjectId],
    cameras: &[Camera],
    frames: &[Frame],
) -> Verdict {
    let bar = global
        .output()
        .progress(cameras.len() as u64, "item buffers");
    let visible: Vec<Vec<u32>> = frames.iter().map(|f| f.visible.clone()).collect();
    let verdict = verify::verify(scene, open, cameras, &visible, size, || bar.inc(1));
    bar.finish_and_clear();
    verdict
}

fn write(
    args: &CullArgs,
    scene: &Scene,
    frames: &[Frame],
    truth: Option<&[usize]>,
    cameras: &[Camera],
    make: impl Fn() -> Result<Culler, Failure>,
) -> Result<(), Failure> {
    let name = args
        .scene
        .scene
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    if let Some(path) = &args.csv {
        write_file(path, chart::csv(frames, truth).as_bytes())?;
    }
    if let Some(path) = &args.svg {
        let title = format!("{name}: {} frames, {}", frames.len(), args.methods.name());
        write_file(path, chart::svg(&title, frames, truth).as_bytes())?;
    }
    if let Some(path) = &args.top {
        let mut culler = make()?;
        for camera in &cameras[..=args.frame] {
            culler.cull(camera);
        }
        let title = format!("{name}: frame {}, at the height of the eye", args.frame);
        let drawing = top::svg(scene, &culler, &cameras[args.frame], &title);
        write_file(path, drawing.as_bytes())?;
    }
    Ok(())
}

/// The keys that scripts rely on.
fn report(frames: &[Frame], culler: &Culler) -> Value {
    let list: Vec<Value> = frames
        .iter()
        .map(|f| {
            json!({
                "visible": f.visible,
                "seconds": f.seconds,
                "tests": f.work.node_tests + f.work.item_tests + f.work.polygon_tests,
                "node_tests": f.work.node_tests,
                "occluders": f.work.occluders,
                "tree_nodes": f.work.tree_nodes,
            })
        })
        .collect();
    let mut times: Vec<f64> = frames.iter().map(|f| f.seconds).collect();
    let total: f64 = times.iter().sum();
    json!({
        "frames": list,
        "median_seconds": share(&mut times, 0.5),
        "p95_seconds": share(&mut times, 0.95),
        "seconds": total,
        "potential_occluders": culler.potential_occluders(),
    })
}

fn sentence(
    scene: &Scene,
    frames: &[Frame],
    result: &Value,
    called: u64,
    verdict: Option<&Verdict>,
) -> String {
    let ms = |key: &str| result[key].as_f64().unwrap_or_default() * 1e3;
    let mut text = format!(
        "{} frames, median {:.3} ms, 95th percentile {:.3} ms; {:.1} of {} objects may be seen on average",
        frames.len(),
        ms("median_seconds"),
        ms("p95_seconds"),
        called as f64 / frames.len().max(1) as f64,
        scene.objects().len()
    );
    if let Some(verdict) = verdict {
        text += &format!(
            "\nverified: {} object-frames have pixels, {called} were called visible ({:.3} times), \
             {} wrong culls",
            verdict.truth,
            called as f64 / verdict.truth.max(1) as f64,
            verdict.wrong.len()
        );
        for w in verdict.wrong.iter().take(20) {
            let name = &scene.object(ObjectId(w.object)).name;
            let [x, y] = w.pixels[0];
            text += &format!(
                "\nframe {}: object {} \"{name}\" was culled, {} pixels show it, the first at {x},{y}",
                w.frame,
                w.object,
                w.pixels.len()
            );
        }
    }
    text
}
