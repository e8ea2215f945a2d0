//! SVG and DXF drawings as plans, right and wrong.

use antumbra_io::plan::{PlanReadOptions, parse_plan};
use antumbra_scene::plan::PlanInput;

fn parse(text: &str, file: &str) -> Result<PlanInput, String> {
    parse_plan(text.as_bytes(), file, &PlanReadOptions::default()).map_err(|e| e.to_string())
}

fn ends(plan: &PlanInput) -> Vec<[[f64; 2]; 2]> {
    plan.segments.iter().map(|s| s.ends).collect()
}

#[test]
fn an_svg_is_read_with_its_groups_and_transformations() {
    let svg = r##"<?xml version="1.0"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">
  <defs><line id="wall" x1="0" y1="0" x2="2" y2="0"/></defs>
  <g id="walls" transform="translate(10, 20) scale(2)">
    <line id="a" x1="0" y1="0" x2="1" y2="3"/>
    <polygon points="0,0 4,0 4,3"/>
    <use xlink:href="#wall" x="1"/>
  </g>
  <g style="display: none"><line x1="0" y1="0" x2="9" y2="9"/></g>
  <path class="door" d="M 0 0 h 5 v -1 z"/>
  <rect x="1" y="1" width="2" height="3"/>
  <text x="0" y="0">kitchen</text>
</svg>"##;
    let plan = parse(svg, "plan.svg").unwrap();
    let found = ends(&plan);
    assert_eq!(found[0], [[10.0, 20.0], [12.0, 26.0]]);
    assert_eq!(found[1], [[10.0, 20.0], [18.0, 20.0]]);
    assert_eq!(found[3], [[18.0, 26.0], [10.0, 20.0]]);
    assert_eq!(found[4], [[12.0, 20.0], [16.0, 20.0]]);
    assert_eq!(found.len(), 1 + 3 + 1 + 3 + 4);
    let class = |i: usize| plan.classes[plan.segments[i].class as usize].as_str();
    assert_eq!((class(0), class(5), class(8)), ("walls", "door", ""));
    assert_eq!(plan.features[0], "a");
    assert!(
        plan.notes
            .iter()
            .any(|n| n.starts_with("1 text or image is ")),
        "{:?}",
        plan.notes
    );
}

#[test]
fn curves_of_an_svg_are_chords_that_close() {
    let svg = r#"<svg><circle cx="1" cy="2" r="3"/><path d="M0 0 C 1 2 3 2 4 0"/></svg>"#;
    let plan = parse(svg, "plan.svg").unwrap();
    let circle: Vec<_> = plan.segments.iter().filter(|s| s.feature == 0).collect();
    assert_eq!(circle.len(), 64);
    assert_eq!(circle[0].ends[0], circle[63].ends[1]);
    let curve: Vec<_> = plan.segments.iter().filter(|s| s.feature == 1).collect();
    assert!(curve.len() > 4);
    assert_eq!(curve[curve.len() - 1].ends[1], [4.0, 0.0]);
}

/// Pairs of group codes and values.
fn dxf(entities: &str) -> String {
    let block = "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n8\n0\n2\nDOOR\n70\n0\n10\n1.0\n20\n0.0\n30\n0.0\n3\nDOOR\n\
                 0\nLINE\n8\n0\n10\n1.0\n20\n0.0\n30\n0.0\n11\n2.0\n21\n0.0\n31\n0.0\n0\nENDBLK\n8\n0\n0\nENDSEC\n";
    format!("{block}0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n")
}

#[test]
fn a_dxf_is_read_with_its_layers_and_blocks() {
    let text = dxf(
        "0\nLINE\n8\nwall\n10\n0.0\n20\n0.0\n30\n0.0\n11\n4.0\n21\n0.0\n31\n0.0\n\
         0\nINSERT\n8\ndoors\n2\nDOOR\n10\n5.0\n20\n6.0\n30\n0.0\n50\n90.0\n41\n2.0\n\
         0\nTEXT\n8\nwall\n10\n0.0\n20\n0.0\n30\n0.0\n40\n1.0\n1\nhall\n\
         0\nARC\n8\nwall\n10\n0.0\n20\n0.0\n30\n0.0\n40\n2.0\n50\n0.0\n51\n90.0\n",
    );
    let plan = parse(&text, "plan.dxf").unwrap();
    let found = ends(&plan);
    assert_eq!(found[0], [[0.0, 0.0], [4.0, 0.0]]);
    let [[a, b], [c, d]] = found[1];
    assert!((a - 5.0).abs() + (b - 6.0).abs() < 1e-12, "{a} {b}");
    assert!((c - 5.0).abs() + (d - 8.0).abs() < 1e-12, "{c} {d}");
    let class = |i: usize| plan.classes[plan.segments[i].class as usize].as_str();
    assert_eq!((class(0), class(1), class(2)), ("wall", "doors", "wall"));
    assert_eq!(found.len(), 2 + 16, "a quarter of an arc has 16 chords");
    assert!(
        plan.notes.iter().any(|n| n.starts_with("1 text, hatch, ")),
        "{:?}",
        plan.notes
    );
}

#[test]
fn damaged_drawings_say_where() {
    for (text, file, said) in [
        ("<svg><line x1='0'", "a.svg", "a.svg: line 1"),
        ("<html/>", "a.svg", "`html`, not `svg`"),
        (
            "<svg>\n<line x1='wide'/></svg>",
            "a.svg",
            "a.svg: line 2: `wide` is not a number",
        ),
        ("<svg><path d='M 0 0 L x'/></svg>", "a.svg", "path data"),
        (
            "<svg><polyline points='1 2 3'/></svg>",
            "a.svg",
            "odd number",
        ),
        (
            "<svg><g transform='turn(3)'/></svg>",
            "a.svg",
            "transformation",
        ),
        (
            "<svg><g id='a'><use href='#a'/></g></svg>",
            "a.svg",
            "nested",
        ),
        ("<svg><use href='#b'/></svg>", "a.svg", "no element `b`"),
        ("<svg/>", "a.svg", "no segments"),
        (
            "0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n1.0\n",
            "a.dxf",
            "stops before its end",
        ),
        ("walls", "a.dxf", "a.dxf: "),
    ] {
        let error = parse(text, file).unwrap_err();
        assert!(error.contains(said), "{text:?}: {error}");
        assert!(!error.contains('\n'), "{error:?}");
    }
    let broken = dxf("0\nLINE\n8\nwall\n10\nwide\n20\n0.0\n");
    let error = parse(&broken, "a.dxf").unwrap_err();
    assert!(error.contains("a.dxf: line "), "{error}");
    let many =
        dxf("0\nINSERT\n8\n0\n2\nDOOR\n10\n0.0\n20\n0.0\n70\n3000\n71\n3000\n44\n1.0\n45\n1.0\n");
    let error = parse(&many, "a.dxf").unwrap_err();
    assert!(error.contains("more than"), "{error}");
    let laughs: String = (1..16)
        .map(|i| {
            let of = format!("<use href='#g{}'/>", i - 1).repeat(8);
            format!("<g id='g{i}'>{of}</g>")
        })
        .collect();
    let error = parse(
        &format!("<svg><defs><g id='g0'/>{laughs}</defs><use href='#g15'/></svg>"),
        "a.svg",
    )
    .unwrap_err();
    assert!(error.contains("more than"), "{error}");
    for depth in [300, 100_000] {
        let deep = "<g>".repeat(depth) + &"</g>".repeat(depth);
        let error = parse(&format!("<svg>{deep}</svg>"), "a.svg").unwrap_err();
        assert!(error.contains("nested"), "{error}");
    }
    let missing = dxf("0\nINSERT\n8\n0\n2\nWINDOW\n10\n0.0\n20\n0.0\n30\n0.0\n");
    let error = parse(&missing, "a.dxf").unwrap_err();
    assert!(error.contains("no block `WINDOW`"), "{error}");
}
