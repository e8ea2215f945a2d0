//! Polygon pairs with another exact code's verdicts and times.

use std::io::Read;
use std::time::Instant;

use antumbra::pair::{PairEnd, PairOptions, PairVerdict, Pairs};
use antumbra::scene::{Faces, ObjectId, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};
use antumbra_testkit::environment::{data, skip};
use criterion::Criterion;
use serde_json::Value;

struct Case {
    scene: Scene,
    /// Whether a free segment is known.
    open: bool,
}

/// Every set: all verdicts once, the distribution of times, then the sum of each class.
pub(crate) fn all(c: &mut Criterion) {
    for set in ["random_large", "random_small", "structured"] {
        match read(set) {
            Some(cases) => run(c, set, &cases),
            None => skip(&format!("pairs/{set}.jsonl.gz is absent")),
        }
    }
}

fn run(c: &mut Criterion, set: &str, cases: &[Case]) {
    let prepared: Vec<Pairs<'_>> = cases.iter().map(|case| Pairs::new(&case.scene)).collect();
    let mut classes = [
        (PairVerdict::Visible, Vec::new()),
        (PairVerdict::Hidden, Vec::new()),
    ];
    for (i, case) in cases.iter().enumerate() {
        let mut times: Vec<f64> = Vec::new();
        let mut verdict = PairVerdict::Unknown;
        for _ in 0..3 {
            let start = Instant::now();
            verdict = ask(&prepared[i]);
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        assert_ne!(
            verdict,
            PairVerdict::Unknown,
            "pair {i} of {set} is undecided"
        );
        assert!(
            !(case.open && verdict == PairVerdict::Hidden),
            "pair {i} of {set} is falsely hidden"
        );
        times.sort_by(f64::total_cmp);
        for (class, list) in &mut classes {
            if *class == verdict {
                list.push((times[1], i));
            }
        }
    }
    let mut group = c.benchmark_group(format!("pairs/{set}"));
    for (class, list) in &mut classes {
        if list.is_empty() {
            continue;
        }
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |part: usize| list[((list.len() - 1) * part).div_ceil(100)].0;
        report(&format!(
            "{set} {class:?}: {} pairs, median {:.3} ms, 99 % {:.3} ms, most {:.3} ms",
            list.len(),
            at(50),
            at(99),
            at(100)
        ));
        let indices: Vec<usize> = list.iter().map(|l| l.1).collect();
        group.bench_function(format!("all {} {class:?}", indices.len()), |b| {
            b.iter(|| {
                indices
                    .iter()
                    .filter(|&&i| ask(&prepared[i]) == *class)
                    .count()
            });
        });
    }
    group.finish();
}

/// The distribution is the figure; criterion only reports sums.
#[allow(clippy::print_stdout)]
fn report(line: &str) {
    println!("{line}");
}

fn ask(pairs: &Pairs<'_>) -> PairVerdict {
    let end = |id| PairEnd::Object(ObjectId(id));
    pairs
        .decide(&end(0), &end(1), &PairOptions::default())
        .expect("no points")
        .verdict
}

fn read(set: &str) -> Option<Vec<Case>> {
    let bytes = std::fs::read(data()?.join(format!("pairs/{set}.jsonl.gz"))).ok()?;
    let mut text = String::new();
    flate2::read::GzDecoder::new(&bytes[..])
        .read_to_string(&mut text)
        .ok()?;
    text.lines()
        .map(|line| case(&serde_json::from_str(line).ok()?))
        .collect()
}

fn case(value: &Value) -> Option<Case> {
    let mut triangles = vec![value.get("source")?, value.get("target")?];
    triangles.extend(value.get("occluders")?.as_array()?);
    let objects = triangles
        .into_iter()
        .map(triangle)
        .collect::<Option<Vec<_>>>()?;
    let input = SceneInput {
        objects,
        source_name: "pair".to_owned(),
    };
    let (scene, _) = SceneBuilder::new(input).build().ok()?;
    Some(Case {
        scene,
        open: !value.get("open_ray")?.is_null(),
    })
}

fn triangle(value: &Value) -> Option<ObjectInput> {
    let c: Vec<f64> = value.as_array()?.iter().filter_map(Value::as_f64).collect();
    let vertices = c.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let mut faces = Faces::default();
    faces.push(&[0, 1, 2]);
    let part = PartInput {
        class: None,
        translucent: false,
        vertices,
        faces,
    };
    Some(ObjectInput {
        name: None,
        parts: vec![part],
    })
}
