//! A plan to ask.

use serde_json::Value;

use super::{Folder, Run};

/// A square room with a gap in a wall inside.
const ROOM: &str = "# a room\n0 0 10 0\n10 0 10 10\n10 10 0 10\n0 10 0 0\n4 4 6 4 screen\n";

pub(crate) fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("room.seg", ROOM);
    folder
}

pub(crate) fn plan(folder: &Folder, file: &str, cell: &str, more: &[&str]) -> Run {
    let mut args = vec!["plan", file, "--cell", cell, "--json", "--quiet"];
    args.extend(more);
    folder.run_args(&args, b"")
}

pub(crate) fn fragments(result: &Value, id: u64) -> Value {
    let list = result["visible"].as_array().expect("a list");
    let found = list.iter().find(|v| v["id"] == id);
    found.map_or(Value::Null, |v| v["fragments"].clone())
}
