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
use crate::load::{SceneArgs, SceneBox, load};
use crate::output::{line, seconds};
use crate::values::PointArg;

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
    let questions = match (&args.from, &args.to) {
        (Some(from), Some(to)) => vec![Question::new(0, from, to)],
        _ => from_stdin()?,
    };
    // Points take part in the choice of the grid, so all of them are read first.
    let points = questions.iter().flat_map(|q| [&q.from, &q.to]);
    let hull = points
        .filter_map(|text| text.parse::<PointArg>().ok())
        .map(|PointArg(p)| (p, p))
        .reduce(join);
    let loaded = load(&args.scene, global, hull)?;
    let asker = Asker {
        scene: &loaded.scene,
        pairs: Pairs::new(&loaded.scene),
        options: PairOptions {
            seed: global.seed,
            max_splits: args.max_splits,
            cancel: Some(on_interrupt()?),
        },
    };
    if !args.all {
        let Question { from, to, .. } = &questions[0];
        let result = asker.ask(from, to)?;
        return global
            .output()
            .result(&result, &sentence(from, to, &result));
    }
    for Question {
        line: number,
        from,
        to,
    } in &questions
    {
        line(
            &asker
                .ask(from, to)
                .map_err(|f| at_line(*number, &f))?
                .to_string(),
        )?;
    }
    Ok(())
}

/// The box around two boxes.
fn join((a, b): SceneBox, (c, d): SceneBox) -> SceneBox {
    (
        std::array::from_fn(|k| a[k].min(c[k])),
        std::array::from_fn(|k| b[k].max(d[k])),
    )
}

/// Two ends, and the line they were read from.
struct Question {
    line: usize,
    from: String,
    to: String,
}

impl Question {
    fn new(line: usize, from: &str, to: &str) -> Self {
        Self {
            line,
            from: from.trim().to_owned(),
            to: to.trim().to_owned(),
        }
    }
}

fn at_line(line: usize, failure: &Failure) -> Failure {
    Failure::Content(format!("stdin, line {line}: {failure}"))
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

/// Reads pairs, one a line; empty lines and comments are left out.
fn from_stdin() -> Result<Vec<Question>, Failure> {
    let mut questions = Vec::new();
    for (index, text) in std::io::stdin().lock().lines().enumerate() {
        let text =
            text.map_err(|cause| Failure::Path(format!("stdin cannot be read ({cause})")))?;
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = match text.split_once('\t') {
            Some((from, to)) => vec![from, to],
            None => text.split_whitespace().collect(),
        };
        let [from, to] = words[..] else {
            let text = "expected two ends; separate them by a tab if names contain blanks";
            return Err(at_line(index + 1, &Failure::Content(text.to_owned())));
        };
        questions.push(Question::new(index + 1, from, to));
    }
    Ok(questions)
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
