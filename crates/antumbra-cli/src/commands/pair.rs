//! `antumbra pair`: can two things of a scene see each other?

use std::io::BufRead as _;
use std::time::Instant;

use antumbra::pair::{PairAnswer, PairEnd, PairOptions, PairVerdict, Pairs};
use antumbra_scene::Scene;
use clap::Args;
use serde_json::{Value, json};

use crate::cancel::on_interrupt;
use crate::cli::Global;
use crate::ends::{End, end};
use crate::failure::Failure;
use crate::load::{SceneArgs, load};
use crate::output::{line, seconds};

/// Options of `pair`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct PairArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// One end: an object, `object:polygon` (numbers or names) or a point `x,y,z`
    #[arg(
        long,
        value_name = "ID",
        allow_hyphen_values = true,
        required_unless_present = "all"
    )]
    from: Option<String>,
    /// The other end
    #[arg(
        long,
        value_name = "ID",
        allow_hyphen_values = true,
        required_unless_present = "all"
    )]
    to: Option<String>,
    /// Read pairs from stdin, one a line, the ends separated by a tab or blanks; print one JSON
    /// object a line
    #[arg(long, conflicts_with_all = ["from", "to"])]
    all: bool,
    /// Give up after this many splits: the verdict is then unknown
    #[arg(long, value_name = "N")]
    max_splits: Option<u64>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra pair house.glb --from lamp --to table
  antumbra pair house.glb --from 12:0 --to -1.5,2,1.6 --json
  printf '0 1\\n0 2\\n' | antumbra pair house.glb --all";

/// Answers one question or many.
pub(crate) fn run(args: &PairArgs, global: &Global) -> Result<(), Failure> {
    let loaded = load(&args.scene, global, None)?;
    let asker = Asker {
        scene: &loaded.scene,
        pairs: Pairs::new(&loaded.scene),
        options: PairOptions {
            seed: global.seed,
            max_splits: args.max_splits,
            cancel: Some(on_interrupt()?),
        },
    };
    if args.all {
        return all(&asker);
    }
    let (Some(from), Some(to)) = (&args.from, &args.to) else {
        return Err(Failure::Usage(
            "--from and --to are both needed; see `antumbra pair --help`".to_owned(),
        ));
    };
    let result = asker.ask(from, to)?;
    let text = sentence(from, to, &result);
    global.output().result(&result, &text)
}

/// What all questions share.
struct Asker<'a> {
    scene: &'a Scene,
    pairs: Pairs<'a>,
    options: PairOptions,
}

impl Asker<'_> {
    fn ask(&self, from: &str, to: &str) -> Result<Value, Failure> {
        let (from, to) = (pair_end(self.scene, from)?, pair_end(self.scene, to)?);
        let start = Instant::now();
        let answer = self
            .pairs
            .decide(&from, &to, &self.options)
            .map_err(|error| Failure::Content(error.to_string()))?;
        Ok(report(&answer, seconds(start.elapsed())))
    }
}

/// Reads pairs line by line; a line that cannot be answered ends the run with its number.
fn all(asker: &Asker<'_>) -> Result<(), Failure> {
    for (number, text) in std::io::stdin().lock().lines().enumerate() {
        let number = number + 1;
        let text =
            text.map_err(|cause| Failure::Path(format!("stdin cannot be read ({cause})")))?;
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let at_line =
            |failure: Failure| Failure::Content(format!("stdin, line {number}: {failure}"));
        let halves = match text.split_once('\t') {
            Some((from, to)) => Some((from.trim(), to.trim())),
            None => match text.split_whitespace().collect::<Vec<_>>()[..] {
                [from, to] => Some((from, to)),
                _ => None,
            },
        };
        let Some((from, to)) = halves else {
            let text = "expected two ends; separate them by a tab if names contain blanks";
            return Err(at_line(Failure::Content(text.to_owned())));
        };
        line(&asker.ask(from, to).map_err(at_line)?.to_string())?;
    }
    Ok(())
}

fn pair_end(scene: &Scene, text: &str) -> Result<PairEnd, Failure> {
    Ok(match end(scene, text)? {
        End::Object(id) => PairEnd::Object(id),
        End::Polygon(id) => PairEnd::Polygon(id),
        End::Point(point) => PairEnd::Point(point),
    })
}

fn report(answer: &PairAnswer, seconds: f64) -> Value {
    let verdict = match answer.verdict {
        PairVerdict::Visible => "visible",
        PairVerdict::Hidden => "hidden",
        PairVerdict::Unknown => "unknown",
    };
    let witness = answer
        .witness
        .map(|[from, to]| json!({"from": from, "to": to}));
    json!({
        "verdict": verdict,
        "witness": witness,
        "leaves": answer.leaves,
        "splits": answer.splits,
        "seconds": seconds,
    })
}

fn sentence(from: &str, to: &str, result: &Value) -> String {
    let along = match &result["witness"] {
        Value::Null => String::new(),
        witness => format!(
            ", for example from {} to {}",
            witness["from"], witness["to"]
        ),
    };
    let verdict = result["verdict"].as_str().unwrap_or_default();
    format!("{from} and {to}: {verdict}{along}")
}
