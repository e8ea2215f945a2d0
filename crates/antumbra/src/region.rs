//! The potentially visible set of a view cell in space, with a certificate for every answer.
//!
//! ```
//! use antumbra::region::{BakeOptions, Baker, check_cell};
//! use antumbra::scene::{CellSpec, SceneBuilder, make_cells};
//! # use antumbra::scene::{Faces, ObjectInput, PartInput, SceneInput};
//! # let wall = |x: f64| {
//! #     let mut faces = Faces::default();
//! #     faces.push(&[0, 1, 2, 3]);
//! #     let vertices = vec![[x, 0.0, 0.0], [x, 4.0, 0.0], [x, 4.0, 4.0], [x, 0.0, 4.0]];
//! #     let parts = vec![PartInput { class: None, translucent: false, vertices, faces }];
//! #     ObjectInput { name: None, parts }
//! # };
//! # let input = SceneInput { objects: vec![wall(0.0), wall(4.0)], source_name: "doc".into() };
//! let (scene, _report) = SceneBuilder::new(input).build()?;
//! let cells = make_cells(&scene, &CellSpec::Grid(2.0))?;
//! let baker = Baker::new(&scene);
//! for cell in &cells {
//!     let result = baker.bake_cell(cell, &BakeOptions::default());
//!     let report = check_cell(
//!         &scene, cell, &result.visible, &result.unknown, result.accuracy, &result.proof,
//!     );
//!     assert!(report.failed.is_empty());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use antumbra_sweep::{
    Accuracy, BakeOptions, Baker, CellResult, CheckReport, FINE_BITS, FinePoint, VisibleEntry,
    Witness, Work, check_cell,
};
