//! What Antumbra's tests are judged by: oracles, a corpus with expected verdicts, and laws.
//!
//! Nothing here shares code with the engine, and everything takes plain arrays of numbers, so that
//! any crate can use it in its tests. In order of trust:
//!
//! | module | answers | arithmetic |
//! |---|---|---|
//! | [`determinant`] | signs of every predicate | big integers, naive expansion |
//! | [`segment`] | does this segment meet that polygon, and where | big rationals |
//! | [`sampler`] | a free segment between source and target, if one is found | big rationals |
//! | [`prover`] | a proof that there is none, if one is found | big rationals |
//! | [`ray_caster`], [`item_buffer`] | first hits, pictures of owners | floats: re-decide before you complain |

pub mod corpus;
pub mod determinant;
pub mod environment;
pub mod flat;
pub mod item_buffer;
pub mod laws;
pub mod plane;
pub mod points;
pub mod prover;
pub mod random;
pub mod rational;
pub mod ray_caster;
pub mod sampler;
pub mod scene;
pub mod segment;
