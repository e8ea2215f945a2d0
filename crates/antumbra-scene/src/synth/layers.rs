//! Walls and chessboards: layer upon layer of quads, of which only the first few can be seen.

use super::{SOURCE, shape, shape::Shape};
use crate::SceneInput;

/// Quads in a row and in a column of a layer.
const RASTER: u32 = 20;
/// Distance of neighboring quads, in metres.
const PITCH: f64 = 2.0;
/// Half the side of a quad: 2.02 m squared are the 4.0804 square metres of the thesis.
const HALF_QUAD: f64 = 1.01;
/// Distance of neighboring layers, in metres.
const SPACING: f64 = 1.0;
/// Distance of the source from the first layer, in metres.
const GAP: f64 = 15.0;

/// Which quads of the raster a layer has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerPattern {
    /// All 400.
    Walls,
    /// Every other one, 200 in all; the next layer has the other 200.
    Chessboard,
}

/// The parameters of [`layers`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerParams {
    /// Full walls or chessboards.
    pub pattern: LayerPattern,
    /// How many layers.
    pub layers: u32,
    /// The area of the source in square metres.
    pub source_area: f64,
}

/// Structured scenes: tests S1 to S6 of \[Bittner02, 8.14.2\].
///
/// Layer `k` lies in the plane `x = k`; its quads, 2.02 m squares on a 2 m raster centered on
/// the `x` axis, are the objects `k-row-column`, so neighbors overlap by 2 cm and a full layer has
/// no gap. Neighboring quads lie in one plane, so none hides another: from a source no larger than
/// a wall exactly the first 400 quads of `walls` are visible. A full chessboard lets light through
/// its holes, but not at their corners, where quads overlap by 2 cm too.
///
/// The object [`SOURCE`] comes last: a square at `x = -15` that faces `+x`, centered on the axis.
/// The thesis states neither distance. These were fitted: of some fifteen pairs that were tried, they come closest
/// to its Table 8.2. From sources of 2, 50 and 200 square metres 976, 1140 and 1430 quads of 20 chessboards are
/// visible, where the table has 924, 1132 and 1430; so those counts are no test of the engine.
#[must_use]
pub fn layers(params: &LayerParams) -> SceneInput {
    let middle = f64::from(RASTER - 1) / 2.0;
    let center = |i: u32| (f64::from(i) - middle) * PITCH;
    let mut objects = Vec::new();
    for layer in 0..params.layers {
        for row in 0..RASTER {
            for column in 0..RASTER {
                let kept = match params.pattern {
                    LayerPattern::Walls => true,
                    LayerPattern::Chessboard => (layer + row + column) % 2 == 0,
                };
                if kept {
                    let (x, y, z) = (f64::from(layer) * SPACING, center(column), center(row));
                    objects.push(quad(format!("{layer}-{row}-{column}"), [x, y, z]));
                }
            }
        }
    }
    let half = params.source_area.sqrt() / 2.0;
    objects.push(shape::square_facing_x(SOURCE, -GAP, [0.0, 0.0], half));
    let kind = match params.pattern {
        LayerPattern::Walls => "walls",
        LayerPattern::Chessboard => "chessboard",
    };
    let source_name = format!(
        "{kind} --layers {} --source-area {}",
        params.layers, params.source_area
    );
    SceneInput {
        objects,
        source_name,
    }
}

/// One quad, facing the source.
fn quad(name: String, [x, y, z]: [f64; 3]) -> crate::ObjectInput {
    let (a, b) = (y - HALF_QUAD, y + HALF_QUAD);
    let (c, d) = (z - HALF_QUAD, z + HALF_QUAD);
    Shape::fixed("quad")
        .quad([[x, b, c], [x, a, c], [x, a, d], [x, b, d]])
        .object(name)
}

#[cfg(test)]
mod tests {
    use super::{LayerParams, LayerPattern, layers};

    #[test]
    fn walls_have_400_quads_a_layer_and_no_gap() {
        let scene = layers(&LayerParams {
            pattern: LayerPattern::Walls,
            layers: 20,
            source_area: 2.0,
        });
        assert_eq!(scene.objects.len(), 8001);
        let corner = |i: usize, k: usize| scene.objects[i].parts[0].vertices[k];
        // The right edge of quad 0 lies beyond the left edge of quad 1.
        assert!(corner(0, 0)[1] > corner(1, 1)[1]);
        assert_eq!(corner(0, 1), [0.0, -20.01, -20.01]);
        let side = corner(0, 0)[1] - corner(0, 1)[1];
        assert!((side * side - 4.0804).abs() < 1e-9);
    }

    #[test]
    fn chessboards_alternate() {
        let params = LayerParams {
            pattern: LayerPattern::Chessboard,
            layers: 2,
            source_area: 50.0,
        };
        let scene = layers(&params);
        assert_eq!(scene.objects.len(), 401);
        assert_eq!(scene.objects[0].name.as_deref(), Some("0-0-0"));
        assert_eq!(scene.objects[200].name.as_deref(), Some("1-0-1"));
        assert_eq!(scene, layers(&params));
    }
}
