//! Certificates: why something is hidden, in a form that a checker needs no search for.
//!
//! The format and its meaning are described in `docs/formats/certificates.md`.

mod plan;

use antumbra_kernel::{Aabb, Point};
use antumbra_scene::PolygonId;

pub use plan::{PlanProof, PlanProofChild, PlanProofFragment, PlanProofNode, PlanProofTree};

/// What a claim is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Everything inside a closed box.
    Box(Aabb),
    /// One polygon.
    Polygon(PolygonId),
}

/// The name of a hyperplane in a certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RowName {
    /// The edge from corner `edge` to the next corner of a polygon.
    Edge {
        /// The polygon.
        polygon: PolygonId,
        /// The number of its edge.
        edge: u32,
    },
    /// The common line of the source's plane and a polygon's, positive where a line along the
    /// polygon's normal crosses it in front of the source.
    SourceLine {
        /// The polygon.
        polygon: PolygonId,
    },
    /// The common line of the target's plane and a polygon's, positive where a line along the
    /// polygon's normal crosses it before the target.
    TargetLine {
        /// The polygon.
        polygon: PolygonId,
    },
    /// The line from a corner of the source gate to a corner of the target gate.
    Chord {
        /// Number of the source gate's corner.
        from: u32,
        /// Number of the target gate's corner.
        to: u32,
    },
}

/// A node of a [`Tree`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// All lines of this piece cross one occluder between source and target.
    Blocked {
        /// The occluder.
        polygon: PolygonId,
        /// Whether they cross it against its normal.
        negative: bool,
    },
    /// This piece holds no open set of real lines.
    Imaginary,
    /// This piece is smaller than the angle that the user asked to ignore.
    Ignored,
    /// The piece is cut by a hyperplane: the part inside follows, then the part outside.
    Split {
        /// The hyperplane.
        row: RowName,
        /// Whether *inside* is the side where the row is negative.
        negative: bool,
    },
}

/// A binary tree over the lines between a source gate and a target gate, in preorder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tree {
    /// Each split is followed by its inside part, then its outside part.
    pub nodes: Vec<Node>,
}

/// One source gate and one target gate of a claim.
///
/// Source gates of a box cell are its faces 0..6 (-x, +x, -y, +y, -z, +z), outward; of an object
/// cell its k-th polygon along (2k) and against (2k + 1) its normal. Target gates of a box are
/// its faces 0..6, inward; of a polygon: along (0) and against (1) its normal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GateProof {
    /// Number of the source gate.
    pub source: u32,
    /// Number of the target gate.
    pub target: u32,
    /// Why no line between them is free.
    pub tree: Tree,
}

/// Why a target is hidden from a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reason {
    /// One occluder blocks all lines: its plane separates, and every edge has one weak sign on
    /// all pairs of vertices.
    Covered {
        /// The occluder.
        polygon: PolygonId,
    },
    /// Gate by gate; pairs of gates without lines between them are left out.
    Gates(Vec<GateProof>),
}

/// A hidden target and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// What is hidden.
    pub target: Target,
    /// Why.
    pub reason: Reason,
}

/// All claims of one view cell: together they cover every polygon of every hidden object.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CellProof {
    /// In the order in which they were proved.
    pub claims: Vec<Claim>,
}

impl CellProof {
    /// The canonical bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        put(&mut out, self.claims.len() as u64);
        for claim in &self.claims {
            match claim.target {
                Target::Box(b) => {
                    out.push(0);
                    for c in b.min.to_array().into_iter().chain(b.max.to_array()) {
                        put(&mut out, zigzag(i64::from(c)));
                    }
                }
                Target::Polygon(id) => {
                    out.push(1);
                    put(&mut out, u64::from(id.0));
                }
            }
            match &claim.reason {
                Reason::Covered { polygon } => {
                    out.push(0);
                    put(&mut out, u64::from(polygon.0));
                }
                Reason::Gates(gates) => {
                    out.push(1);
                    put(&mut out, gates.len() as u64);
                    for gate in gates {
                        put(&mut out, u64::from(gate.source));
                        put(&mut out, u64::from(gate.target));
                        put_tree(&mut out, &gate.tree);
                    }
                }
            }
        }
        out
    }

    /// Reads canonical bytes.
    ///
    /// # Errors
    /// A sentence with the byte offset if they are no certificate.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ProofError> {
        let mut reader = Reader { bytes, at: 0 };
        let count = reader.number()?;
        let mut claims = Vec::new();
        for _ in 0..count {
            let target = match reader.byte()? {
                0 => {
                    let mut c = [0_i32; 6];
                    for v in &mut c {
                        *v = reader.coordinate()?;
                    }
                    if (0..3).any(|k| c[k] > c[3 + k]) {
                        return Err(reader.error("an inverted box"));
                    }
                    Target::Box(Aabb::new(
                        Point::new(c[0], c[1], c[2]),
                        Point::new(c[3], c[4], c[5]),
                    ))
                }
                1 => Target::Polygon(reader.polygon()?),
                _ => return Err(reader.error("an unknown target kind")),
            };
            let reason = match reader.byte()? {
                0 => Reason::Covered {
                    polygon: reader.polygon()?,
                },
                1 => {
                    let n = reader.number()?;
                    let mut gates = Vec::new();
                    for _ in 0..n {
                        let source = reader.index()?;
                        let target = reader.index()?;
                        let tree = reader.tree()?;
                        gates.push(GateProof {
                            source,
                            target,
                            tree,
                        });
                    }
                    Reason::Gates(gates)
                }
                _ => return Err(reader.error("an unknown reason kind")),
            };
            claims.push(Claim { target, reason });
        }
        if reader.at != bytes.len() {
            return Err(reader.error("bytes after the last claim"));
        }
        Ok(Self { claims })
    }
}

/// Bytes that are no certificate.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "byte {offset} of the certificate: {found}; the proof file does not belong to this bake or is damaged: bake again"
)]
pub struct ProofError {
    /// Where.
    pub offset: usize,
    /// What was found there.
    pub found: &'static str,
}

const BLOCKED: u8 = 0;
const IMAGINARY: u8 = 2;
const IGNORED: u8 = 3;
const EDGE: u8 = 4;
const SOURCE_LINE: u8 = 6;
const TARGET_LINE: u8 = 8;
const CHORD: u8 = 10;

fn put(out: &mut Vec<u8>, mut v: u64) {
    while v >= 0x80 {
        out.push(v as u8 | 0x80);
        v >>= 7;
    }
    out.push(v as u8);
}

fn zigzag(v: i64) -> u64 {
    ((v << 1) ^ (v >> 63)) as u64
}

fn put_tree(out: &mut Vec<u8>, tree: &Tree) {
    for node in &tree.nodes {
        match *node {
            Node::Blocked { polygon, negative } => {
                out.push(BLOCKED + u8::from(negative));
                put(out, u64::from(polygon.0));
            }
            Node::Imaginary => out.push(IMAGINARY),
            Node::Ignored => out.push(IGNORED),
            Node::Split { row, negative } => {
                let flag = u8::from(negative);
                let (kind, first, second) = match row {
                    RowName::Edge { polygon, edge } => (EDGE, polygon.0, Some(edge)),
                    RowName::SourceLine { polygon } => (SOURCE_LINE, polygon.0, None),
                    RowName::TargetLine { polygon } => (TARGET_LINE, polygon.0, None),
                    RowName::Chord { from, to } => (CHORD, from, Some(to)),
                };
                out.push(kind + flag);
                put(out, u64::from(first));
                if let Some(second) = second {
                    put(out, u64::from(second));
                }
            }
        }
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn error(&self, found: &'static str) -> ProofError {
        ProofError {
            offset: self.at,
            found,
        }
    }

    fn byte(&mut self) -> Result<u8, ProofError> {
        let b = *self
            .bytes
            .get(self.at)
            .ok_or(self.error("an unexpected end"))?;
        self.at += 1;
        Ok(b)
    }

    fn number(&mut self) -> Result<u64, ProofError> {
        let mut v = 0_u64;
        for shift in (0..64).step_by(7) {
            let b = self.byte()?;
            v |= u64::from(b & 0x7f) << shift;
            if b & 0x80 == 0 {
                return Ok(v);
            }
        }
        Err(self.error("a number of more than 64 bits"))
    }

    fn index(&mut self) -> Result<u32, ProofError> {
        let v = self.number()?;
        u32::try_from(v).map_err(|_| self.error("a number of more than 32 bits"))
    }

    fn polygon(&mut self) -> Result<PolygonId, ProofError> {
        Ok(PolygonId(self.index()?))
    }

    fn coordinate(&mut self) -> Result<i32, ProofError> {
        let v = self.number()?;
        let signed = (v >> 1) as i64 ^ -((v & 1) as i64);
        if signed.abs() >= i64::from(antumbra_kernel::LIMIT) {
            return Err(self.error("a coordinate off the grid"));
        }
        Ok(signed as i32)
    }

    fn tree(&mut self) -> Result<Tree, ProofError> {
        let mut nodes = Vec::new();
        let mut missing = 1_usize;
        while missing > 0 {
            let tag = self.byte()?;
            let negative = tag & 1 == 1;
            let node = match tag {
                IMAGINARY => Node::Imaginary,
                IGNORED => Node::Ignored,
                _ => match tag & !1 {
                    BLOCKED => Node::Blocked {
                        polygon: self.polygon()?,
                        negative,
                    },
                    EDGE => {
                        let row = RowName::Edge {
                            polygon: self.polygon()?,
                            edge: self.index()?,
                        };
                        Node::Split { row, negative }
                    }
                    SOURCE_LINE => Node::Split {
                        row: RowName::SourceLine {
                            polygon: self.polygon()?,
                        },
                        negative,
                    },
                    TARGET_LINE => Node::Split {
                        row: RowName::TargetLine {
                            polygon: self.polygon()?,
                        },
                        negative,
                    },
                    CHORD => {
                        let row = RowName::Chord {
                            from: self.index()?,
                            to: self.index()?,
                        };
                        Node::Split { row, negative }
                    }
                    _ => return Err(self.error("an unknown node kind")),
                },
            };
            missing = if matches!(node, Node::Split { .. }) {
                missing + 1
            } else {
                missing - 1
            };
            nodes.push(node);
        }
        Ok(Tree { nodes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> CellProof {
        let leaf = |p, negative| Node::Blocked {
            polygon: PolygonId(p),
            negative,
        };
        let edge = RowName::Edge {
            polygon: PolygonId(300),
            edge: 2,
        };
        let line = RowName::SourceLine {
            polygon: PolygonId(7),
        };
        let nodes = vec![
            Node::Split {
                row: edge,
                negative: true,
            },
            Node::Split {
                row: line,
                negative: false,
            },
            Node::Imaginary,
            leaf(9, true),
            leaf(1, false),
        ];
        let tree = Tree { nodes };
        let target = Target::Box(Aabb::new(Point::new(-5, 0, 1), Point::new(700_000, 0, 2)));
        let gates = vec![GateProof {
            source: 1,
            target: 0,
            tree,
        }];
        CellProof {
            claims: vec![
                Claim {
                    target,
                    reason: Reason::Gates(gates),
                },
                Claim {
                    target: Target::Polygon(PolygonId(4)),
                    reason: Reason::Covered {
                        polygon: PolygonId(70_000),
                    },
                },
            ],
        }
    }

    #[test]
    fn bytes_round_trip() {
        let proof = sample();
        assert_eq!(CellProof::from_bytes(&proof.to_bytes()), Ok(proof));
    }

    #[test]
    fn every_truncation_is_refused() {
        let bytes = sample().to_bytes();
        for n in 0..bytes.len() {
            assert!(
                CellProof::from_bytes(&bytes[..n]).is_err(),
                "{n} bytes were accepted"
            );
        }
    }
}
