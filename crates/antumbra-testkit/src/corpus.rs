//! The corpus: small scenes with queries, expected verdicts and reasons, read from `corpus/*.toml`.
//!
//! The format is described in `corpus/README.md`. Every engine that can runs all of it.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::environment::workspace_root;
use crate::rational::RationalPoint;
use crate::sampler::Segment;
use crate::scene::{Polygon, Source, meets_box};

/// One scene with its queries.
#[derive(Clone, Debug)]
pub struct Case {
    /// The name of the file, without `.toml`.
    pub name: String,
    /// What the scene is about.
    pub about: String,
    /// The polygons, on the grid.
    pub polygons: Vec<Polygon>,
    /// The questions.
    pub queries: Vec<Query>,
}

/// A question about a scene, and its answer.
#[derive(Clone, Debug)]
pub struct Query {
    /// What one looks from.
    pub from: From,
    /// The object one looks at.
    pub to: String,
    /// The right answer.
    pub expect: Expect,
    /// For a cell: whether the object meets the closed cell, which makes it visible.
    pub touching: bool,
    /// For a cell: whether an occluder meets its open interior, so that its result is conservative.
    pub conservative: bool,
    /// A free segment, where one is hard to find.
    pub witness: Option<Segment>,
    /// Why the answer is right.
    pub why: String,
}

/// What a query looks from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum From {
    /// The polygons of an object.
    Object(String),
    /// A view cell.
    Cell {
        /// Smallest coordinates.
        min: [i64; 3],
        /// Largest coordinates.
        max: [i64; 3],
    },
}

/// An expected verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Expect {
    /// An open set of segments is free.
    Visible,
    /// None is.
    Hidden,
}

/// Why a corpus file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", file.display())]
pub struct CorpusError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it, and where.
    pub why: String,
}

impl Case {
    /// The indices of an object's polygons.
    pub fn polygons_of<'a>(&'a self, object: &'a str) -> impl Iterator<Item = usize> + 'a {
        let owned = move |i: &usize| self.polygons[*i].object == object;
        (0..self.polygons.len()).filter(owned)
    }

    /// The sources of a query for the oracles: each polygon of the object, or the cell.
    #[must_use]
    pub fn sources(&self, query: &Query) -> Vec<Source> {
        match &query.from {
            From::Object(name) => self.polygons_of(name).map(Source::Polygon).collect(),
            From::Cell { min, max } => vec![Source::Cell {
                min: *min,
                max: *max,
            }],
        }
    }

    /// The names of all objects, in order of first appearance: their zero-based ids.
    #[must_use]
    pub fn objects(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for polygon in &self.polygons {
            if !names.contains(&polygon.object.as_str()) {
                names.push(&polygon.object);
            }
        }
        names
    }
}

/// Reads the corpus of this repository, in the order of file names.
///
/// # Panics
/// If a file cannot be read or is wrong: tests want to stop there.
#[must_use]
pub fn load() -> Vec<Case> {
    match load_from(&workspace_root().join("corpus")) {
        Ok(cases) => cases,
        Err(e) => panic!("{e}"),
    }
}

/// Reads all `*.toml` files of a folder, in the order of their names.
///
/// # Errors
/// The first file that cannot be read or is wrong.
pub fn load_from(folder: &Path) -> Result<Vec<Case>, CorpusError> {
    let fail = |file: &Path, why: String| CorpusError {
        file: file.to_owned(),
        why,
    };
    let entries = std::fs::read_dir(folder).map_err(|e| fail(folder, e.to_string()))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    files.sort();
    let read = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).map_err(|e| fail(file, e.to_string()))?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        parse(&name, &text).map_err(|why| fail(file, why))
    };
    files.iter().map(read).collect()
}

/// Reads one scene from TOML.
///
/// # Errors
/// A sentence that says what is wrong and where.
pub fn parse(name: &str, text: &str) -> Result<Case, String> {
    let raw: RawCase = toml::from_str(text).map_err(|e| e.to_string())?;
    let mut polygons = Vec::new();
    for (i, p) in raw.polygon.into_iter().enumerate() {
        if let Some(why) = malformed(&p.corners) {
            return Err(format!("polygon {i} (object {:?}) {why}", p.object));
        }
        polygons.push(Polygon {
            object: p.object,
            corners: p.corners,
            occludes: p.occludes,
        });
    }
    let mut case = Case {
        name: name.to_owned(),
        about: raw.about,
        polygons,
        queries: Vec::new(),
    };
    for (i, q) in raw.query.into_iter().enumerate() {
        let query = finish(&case, q).map_err(|why| format!("query {i} {why}"))?;
        case.queries.push(query);
    }
    if case.queries.is_empty() {
        return Err("there are no queries".to_owned());
    }
    Ok(case)
}

fn finish(case: &Case, raw: RawQuery) -> Result<Query, String> {
    let RawQuery {
        kind,
        from,
        to,
        object,
        min,
        max,
        ..
    } = raw;
    let (from, to) = match (kind.as_str(), from, to, object, min, max) {
        ("pair", Some(from), Some(to), None, None, None) => (From::Object(from), to),
        ("cell", None, None, Some(object), Some(min), Some(max)) => {
            (From::Cell { min, max }, object)
        }
        ("pair", ..) => return Err("of kind \"pair\" needs exactly `from` and `to`".to_owned()),
        ("cell", ..) => {
            return Err("of kind \"cell\" needs exactly `min`, `max` and `object`".to_owned());
        }
        (other, ..) => return Err(format!("has the unknown kind {other:?}: use pair or cell")),
    };
    let known = |name: &str| case.polygons.iter().any(|p| p.object == name);
    let source_known = match &from {
        From::Object(name) => known(name),
        From::Cell { min, max } => {
            if (0..3).any(|k| min[k] >= max[k]) {
                return Err(format!("has an empty cell, {min:?} to {max:?}"));
            }
            true
        }
    };
    if !source_known || !known(&to) {
        return Err(format!("names an unknown object: {from:?} to {to:?}"));
    }
    if raw.why.trim().is_empty() {
        return Err("does not say why".to_owned());
    }
    let witness = match raw.witness {
        None => None,
        Some([a, b]) => match (RationalPoint::from_f64(a), RationalPoint::from_f64(b)) {
            (Some(a), Some(b)) => Some([a, b]),
            _ => return Err("has a witness that is not finite".to_owned()),
        },
    };
    let (touching, conservative) = match &from {
        From::Object(_) => (false, false),
        From::Cell { min, max } => {
            let meets = |p: &Polygon, open| meets_box(&p.corners, *min, *max, open);
            let target = case.polygons.iter().filter(|p| p.object == to);
            let occluders = case.polygons.iter().filter(|p| p.occludes);
            (
                target.into_iter().any(|p| meets(p, false)),
                occluders.into_iter().any(|p| meets(p, true)),
            )
        }
    };
    for (what, said, found) in [
        ("touching", raw.touching, touching),
        ("conservative", raw.conservative, conservative),
    ] {
        if said != found {
            return Err(format!("says {what} = {said}, but it is {found}"));
        }
    }
    if touching && raw.expect == Expect::Hidden {
        return Err("calls an object hidden that touches the cell".to_owned());
    }
    let (expect, why) = (raw.expect, raw.why);
    Ok(Query {
        from,
        to,
        expect,
        touching,
        conservative,
        witness,
        why,
    })
}

/// What is wrong with a polygon, if anything: it must be planar, convex, and turn one way.
fn malformed(corners: &[[i64; 3]]) -> Option<String> {
    use crate::determinant::sign;
    use crate::segment::{height, normal};
    let limit = crate::points::LIMIT;
    if corners.len() < 3 {
        return Some(format!("has {} corners", corners.len()));
    }
    if corners.iter().flatten().any(|c| c.abs() >= limit) {
        return Some(format!(
            "leaves the grid: coordinates are smaller than {limit}"
        ));
    }
    let n = normal(corners);
    if n.iter().all(|c| sign(c) == 0) {
        return Some("has no area".to_owned());
    }
    let on_plane = |c: &[i64; 3]| sign(&height(corners, &RationalPoint::from_grid(*c))) == 0;
    if let Some(c) = corners.iter().find(|c| !on_plane(c)) {
        return Some(format!("is not planar: see corner {c:?}"));
    }
    // Inside or on every edge: convex. Fan triangles that turn the wrong way show winding twice.
    let count = corners.len();
    for i in 0..count {
        let (a, b) = (corners[i], corners[(i + 1) % count]);
        for c in corners {
            let turn = normal(&[a, b, *c]);
            let along: dashu_int::IBig = (0..3).map(|k| &turn[k] * &n[k]).sum();
            if sign(&along) < 0 {
                return Some(format!("is not convex at {b:?}"));
            }
        }
    }
    None
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    about: String,
    #[serde(default)]
    polygon: Vec<RawPolygon>,
    #[serde(default)]
    query: Vec<RawQuery>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPolygon {
    object: String,
    corners: Vec<[i64; 3]>,
    #[serde(default = "yes")]
    occludes: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawQuery {
    kind: String,
    from: Option<String>,
    to: Option<String>,
    object: Option<String>,
    min: Option<[i64; 3]>,
    max: Option<[i64; 3]>,
    expect: Expect,
    #[serde(default)]
    touching: bool,
    #[serde(default)]
    conservative: bool,
    witness: Option<[[f64; 3]; 2]>,
    why: String,
}

fn yes() -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::{Expect, From, parse};

    const SCENE: &str = "about = 'a test'
[[polygon]]
object = 'a'
corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
";

    fn error(rest: &str) -> String {
        match parse("test", &format!("{SCENE}{rest}")) {
            Ok(case) => panic!("accepted: {case:?}"),
            Err(why) => why,
        }
    }

    #[test]
    fn a_small_file_is_read() {
        let query = "[[query]]\nkind = 'cell'\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nobject = 'a'
expect = 'visible'\ntouching = true\nwhy = 'it touches'\n";
        let case = parse("small", &format!("{SCENE}{query}")).expect("well formed");
        assert_eq!((case.name.as_str(), case.objects()), ("small", vec!["a"]));
        let query = &case.queries[0];
        assert_eq!(
            query.from,
            From::Cell {
                min: [0; 3],
                max: [1; 3]
            }
        );
        assert!(query.expect == Expect::Visible && query.touching && !query.conservative);
        assert!(case.polygons[0].occludes);
    }

    #[test]
    fn wrong_files_are_refused_with_a_sentence() {
        assert!(error("").contains("no queries"));
        let pair =
            "[[query]]\nkind = 'pair'\nfrom = 'a'\nto = 'zz'\nexpect = 'hidden'\nwhy = 'x'\n";
        assert!(error(pair).contains("unknown object"));
        assert!(error(&pair.replace("pair", "cell")).contains("needs exactly"));
        assert!(error(&pair.replace("zz", "a").replace("'x'", "' '")).contains("why"));
        assert!(error(&pair.replace("hidden", "perhaps")).contains("perhaps"));
        let bent = "[[polygon]]\nobject='b'\ncorners=[[0,0,0],[4,0,0],[4,4,1],[0,4,0]]\n";
        assert!(error(bent).contains("not planar"));
        let dented = "[[polygon]]\nobject='b'\ncorners=[[0,0,0],[4,0,0],[1,1,0],[0,4,0]]\n";
        assert!(error(dented).contains("not convex"));
        let cell = "[[query]]\nkind='cell'\nmin=[0,0,0]\nmax=[1,1,1]\nobject='a'\nexpect='visible'\nwhy='x'\n";
        assert!(error(cell).contains("touching = false, but it is true"));
    }
}
