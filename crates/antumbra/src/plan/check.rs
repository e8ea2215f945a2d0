//! The independent check of what a cell sees.

use antumbra_scene::plan::{PieceId, Plan};
use antumbra_sweep::{PlanCheck, PlanProof, check_plan};

/// Checks a certificate against a plan: every visible fragment by its line, every other part of every segment by
/// the occluders that the certificate names. Shares no code with the engine but integers.
#[must_use]
pub fn check(plan: &Plan, proof: &PlanProof) -> PlanCheck {
    let n = plan.pieces().len() as u32;
    let blocks: Vec<bool> = (0..n).map(|i| plan.occludes(PieceId(i))).collect();
    check_plan(plan.pieces(), &blocks, proof)
}
