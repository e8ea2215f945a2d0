//! Claims that a target is hidden, one by one.

use antumbra_kernel::{Aabb, Point, Sign, plucker};
use antumbra_scene::{BoxContact, PolygonId, Scene, box_contact};

use super::ends::{Openings, Source, gates_between, target_openings};
use super::tree::{Question, check_tree};
use crate::proof::{Claim, GateProof, Reason, Target};

/// Checks a claim.
///
/// # Errors
/// What is wrong with it.
pub(super) fn check_claim(
    scene: &Scene,
    source: &Source,
    may_ignore: bool,
    claim: &Claim,
) -> Result<(), String> {
    if let Target::Polygon(id) = claim.target
        && id.index() >= scene.polygon_count()
    {
        return Err(format!("the scene has no polygon {}", id.0));
    }
    match &claim.reason {
        Reason::Covered { polygon } => covered(scene, source, &claim.target, *polygon),
        Reason::Gates(proofs) => gates(scene, source, may_ignore, &claim.target, proofs),
    }
}

/// One occluder covers everything.
fn covered(scene: &Scene, source: &Source, target: &Target, by: PolygonId) -> Result<(), String> {
    if by.index() >= scene.polygon_count() {
        return Err(format!("the scene has no polygon {}", by.0));
    }
    let occluder = scene.polygon(by);
    if !occluder.occludes || source.own.contains(&by.0) {
        return Err(format!("polygon {} is no occluder of this cell", by.0));
    }
    let box_corners;
    let targets: &[Point] = match target {
        Target::Box(bounds) => {
            box_corners = bounds.corners();
            &box_corners
        }
        Target::Polygon(id) => scene.polygon(*id).corners,
    };
    let from = range(source.corners.iter().map(|&p| occluder.plane.side(p)));
    let to = range(targets.iter().map(|&p| occluder.plane.side(p)));
    // Lines cross along the normal if the source is on the negative side.
    let way = match (from, to) {
        (Some((Sign::Negative, high)), Some((low, Sign::Positive)))
            if !high.is_positive() && !low.is_negative() =>
        {
            Sign::Positive
        }
        (Some((low, Sign::Positive)), Some((Sign::Negative, high)))
            if !low.is_negative() && !high.is_positive() =>
        {
            Sign::Negative
        }
        _ => {
            return Err(format!(
                "the plane of polygon {} does not separate the cell from the target",
                by.0
            ));
        }
    };
    if let (Target::Box(_), Some((low, high))) = (target, to)
        && (low.is_zero() || high.is_zero())
    {
        return Err(format!(
            "the target box is not strictly behind the plane of polygon {}",
            by.0
        ));
    }
    if !source.is_box
        && source.openings.iter().flatten().any(|o| {
            occluder
                .corners
                .iter()
                .all(|&p| o.gate().plane.side(p).is_zero())
        })
    {
        return Err(format!("polygon {} lies in the plane of the source", by.0));
    }
    let n = occluder.corners.len();
    for i in 0..n {
        let (u, v) = (occluder.corners[i], occluder.corners[(i + 1) % n]);
        for &p in &source.corners {
            for &q in targets {
                if plucker::side(u, v, p, q).times(way).is_negative() {
                    return Err(format!(
                        "polygon {} does not cover the target: a line passes outside its edge {i}",
                        by.0
                    ));
                }
            }
        }
    }
    Ok(())
}

fn range(signs: impl Iterator<Item = Sign>) -> Option<(Sign, Sign)> {
    signs.fold(None, |range, s| match range {
        None => Some((s, s)),
        Some((low, high)) => Some((low.min(s), high.max(s))),
    })
}

/// A tree for each pair of gates.
fn gates(
    scene: &Scene,
    source: &Source,
    may_ignore: bool,
    target: &Target,
    proofs: &[GateProof],
) -> Result<(), String> {
    if let Target::Box(bounds) = target
        && meets(scene, source, bounds)
    {
        // Lines could start inside the box without crossing a face.
        return Err("the target box meets the cell".into());
    }
    let targets = target_openings(scene, target);
    let mut open = open_pairs(&source.openings, &targets);
    for proof in proofs {
        let key = (proof.source, proof.target);
        let opening =
            |openings: &Openings, number: u32| openings.get(number as usize).and_then(Clone::clone);
        let (Some(from), Some(to)) = (
            opening(&source.openings, proof.source),
            opening(&targets, proof.target),
        ) else {
            return Err(format!(
                "there is no source gate {} or no target gate {}",
                proof.source, proof.target
            ));
        };
        open.retain(|pair| *pair != key);
        let Some((from, to)) = gates_between(&from, &to) else {
            continue;
        };
        let question = Question {
            scene,
            from: &from,
            to: &to,
            source_plane_blocks: source.is_box,
            absent: &source.own,
            may_ignore,
        };
        check_tree(&question, &proof.tree)
            .map_err(|what| format!("source gate {}, target gate {}: {what}", key.0, key.1))?;
    }
    match open.first() {
        None => Ok(()),
        Some((from, to)) => Err(format!(
            "lines leave source gate {from} and cross target gate {to}, but there is no tree for them"
        )),
    }
}

fn open_pairs(sources: &Openings, targets: &Openings) -> Vec<(u32, u32)> {
    let mut out = Vec::new();
    for (i, from) in sources.iter().enumerate() {
        for (j, to) in targets.iter().enumerate() {
            if let (Some(from), Some(to)) = (from, to)
                && gates_between(from, to).is_some()
            {
                out.push((i as u32, j as u32));
            }
        }
    }
    out
}

fn meets(scene: &Scene, source: &Source, bounds: &Aabb) -> bool {
    if source.is_box {
        return bounds.touches(&source.bounds);
    }
    source
        .own
        .clone()
        .any(|i| box_contact(&scene.polygon(PolygonId(i)), bounds) != BoxContact::Apart)
}
