//! Plain plan text: a segment a line, `x1 y1 x2 y2`, optionally followed by the name of its class, which is no
//! number; `#` begins a comment.

use antumbra_scene::plan::{PlanInput, PlanSegment};

use crate::error::{Damage, Place};

pub(super) fn read(text: &str) -> Result<PlanInput, Damage> {
    let mut plan = PlanInput::default();
    let unnamed = plan.class("");
    for (number, line) in text.lines().enumerate() {
        let data = line.split('#').next().unwrap_or_default();
        let mut words = data
            .split(|c: char| c.is_whitespace() || c == ',')
            .filter(|w| !w.is_empty());
        let Some(first) = words.next() else { continue };
        let place = Place::Line(number as u64 + 1);
        let mut numbers = [0.0; 4];
        let mut word = Some(first);
        for slot in &mut numbers {
            let Some(found) = word else {
                return Err(Damage::new(
                    place,
                    "there are fewer than four numbers",
                    "write a segment as `x1 y1 x2 y2`",
                ));
            };
            *slot = found
                .parse()
                .ok()
                .filter(|v: &f64| v.is_finite())
                .ok_or_else(|| {
                    Damage::new(
                        place.clone(),
                        format!("`{}` is not a number", shortened(found)),
                        "write a segment as `x1 y1 x2 y2`",
                    )
                })?;
            word = words.next();
        }
        if let Some(number) = word.filter(|w| is_number(w)) {
            return Err(Damage::new(
                place,
                format!(
                    "a fifth number, `{}`, follows the segment",
                    shortened(number)
                ),
                "write one segment `x1 y1 x2 y2` a line; the name of a class is no number",
            ));
        }
        let class = word.map_or(unnamed, |name| plan.class(name));
        if let Some(more) = words.next() {
            return Err(Damage::new(
                place,
                format!("`{}` follows the segment and its class", shortened(more)),
                "write one segment a line",
            ));
        }
        let [a, b, c, d] = numbers;
        let feature = plan.segments.len() as u32;
        plan.segments.push(PlanSegment {
            ends: [[a, b], [c, d]],
            class,
            feature,
        });
    }
    Ok(plan)
}

/// Whether a word reads as a number: then it names no class. Without a digit (`inf`, `nan`) it is a name.
pub(super) fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok() && word.contains(|c: char| c.is_ascii_digit())
}

/// At most twenty characters of a word, for messages.
pub(super) fn shortened(word: &str) -> String {
    word.chars().filter(|c| !c.is_control()).take(20).collect()
}
