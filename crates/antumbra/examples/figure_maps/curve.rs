//! A curve as SVG.

use std::fmt::Write as _;

const SIZE: [f64; 2] = [720.0, 360.0];
const MARGIN: f64 = 56.0;

/// Nodes of the tree over polygons inserted.
pub(super) fn svg(points: &[(usize, usize)]) -> String {
    let largest = |pick: fn(&(usize, usize)) -> usize| points.iter().map(pick).max().unwrap_or(1);
    let (columns, rows) = (largest(|p| p.0), largest(|p| p.1));
    let x = |n: usize| MARGIN + (SIZE[0] - 2.0 * MARGIN) * n as f64 / columns as f64;
    let y = |n: usize| SIZE[1] - MARGIN - (SIZE[1] - 2.0 * MARGIN) * n as f64 / rows as f64;
    let mut path = String::new();
    for (i, &(n, nodes)) in points.iter().enumerate() {
        let verb = if i == 0 { 'M' } else { 'L' };
        // Writing to a string cannot fail.
        let _ = write!(path, "{verb}{:.1} {:.1}", x(n), y(nodes));
    }
    let [w, h] = SIZE;
    let (left, low, right) = (MARGIN, h - MARGIN, w - MARGIN);
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}">
<rect width="{w}" height="{h}" fill="#fff"/>
<g font-family="sans-serif" font-size="13" fill="#333">
<path d="M{left} {MARGIN}V{low}H{right}" fill="none" stroke="#333"/>
<text x="{left}" y="{:.1}">nodes of the tree (up to {rows})</text>
<text x="{right}" y="{:.1}" text-anchor="end">polygons inserted, front to back, without box tests (up to {columns})</text>
<path d="{path}" fill="none" stroke="#a8001c" stroke-width="2"/>
</g>
</svg>
"##,
        MARGIN - 16.0,
        low + 24.0
    )
}
