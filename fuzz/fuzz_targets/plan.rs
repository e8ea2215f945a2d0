//! What all plan targets do: read bytes as the format that a file name promises, and build the plan.

use antumbra_io::plan::{PlanReadOptions, parse_plan};
use antumbra_scene::plan::{Plan, PlanOptions};

/// Reads bytes as a plan: good segments, or a sentence with the file and the place.
pub fn read(bytes: &[u8], file: &str) {
    let plan = match parse_plan(bytes, file, &PlanReadOptions::default()) {
        Ok(plan) => plan,
        Err(error) => {
            assert!(error.to_string().starts_with(file) && !error.is_path_error());
            return;
        }
    };
    for segment in &plan.segments {
        assert!(segment.ends.iter().flatten().all(|c| c.is_finite()));
        assert!((segment.class as usize) < plan.classes.len());
        let named = plan.features.len();
        assert!(named == 0 || (segment.feature as usize) < named);
    }
    if plan.segments.len() < 200 {
        match Plan::build(&plan, &PlanOptions::default()) {
            Ok(built) => assert_eq!(built.segment_count(), plan.segments.len()),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}
