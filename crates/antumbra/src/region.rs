//! Placeholder until the checker is there.
use antumbra_scene::{Scene, ViewCell};

pub use antumbra_sweep::{
    Accuracy, BakeOptions, Baker, CellResult, FinePoint, VisibleEntry, Witness,
};

/// What a check found.
#[derive(Clone, Debug, Default)]
pub struct CheckReport {
    /// Visible entries that were checked.
    pub visible_checked: u64,
    /// Hidden objects that were checked.
    pub hidden_checked: u64,
    /// What does not hold.
    pub failed: Vec<String>,
}

/// Placeholder: counts.
#[must_use]
pub fn check_cell(
    scene: &Scene,
    _cell: &ViewCell,
    visible: &[VisibleEntry],
    _proof: &[u8],
) -> CheckReport {
    CheckReport {
        visible_checked: visible.len() as u64,
        hidden_checked: (scene.objects().len() - visible.len()) as u64,
        failed: Vec::new(),
    }
}
