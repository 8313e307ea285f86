//! The layers that ARCHITECTURE.md states, compared with the code: a module uses only modules listed
//! before its own, and the files of a room use one another in one direction.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The names that a source file's paths have next behind `prefix` (`crate::` or `super::`): modules,
/// and what is re-exported beside them. Its comments and its tests do not count.
fn used(source: &str, prefix: &str) -> BTreeSet<String> {
    let code = source
        .split("#[cfg(test)]\nmod ")
        .next()
        .unwrap_or_default();
    let is_comment = |line: &&str| line.trim_start().starts_with("//");
    let code: Vec<&str> = code.lines().filter(|line| !is_comment(line)).collect();
    let code = code.join("\n");
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut names = BTreeSet::new();
    for (at, _) in code.match_indices(prefix) {
        if code[..at].ends_with(|c: char| is_part(c) || c == ':') {
            continue;
        }
        let rest = &code[at + prefix.len()..];
        for path in first_paths(rest) {
            let end = path.find(|c| !is_part(c)).unwrap_or(path.len());
            names.insert(path[..end].to_owned());
        }
    }
    names.remove("");
    names
}

/// What stands behind a path's `::`: the one path, or those of a group in braces.
fn first_paths(rest: &str) -> Vec<&str> {
    let Some(group) = rest.strip_prefix('{') else {
        return vec![rest];
    };
    let (mut paths, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                paths.push(group[start..at].trim());
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                paths.push(group[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
    }
    paths
}

/// What a module's page re-exports (`pub use file::{Name, …};`): the file of each name.
fn reexports(page: &Path) -> BTreeMap<String, String> {
    let source = fs::read_to_string(page).unwrap_or_default();
    let mut files = BTreeMap::new();
    for (at, _) in source.match_indices("use ") {
        let statement = source[at + 4..].split(';').next().unwrap_or_default();
        let Some((file, names)) = statement.split_once("::") else {
            continue;
        };
        if !["crate", "super", "std"].contains(&file) {
            for name in first_paths(names) {
                let name = name.rsplit([':', ' ']).next().unwrap_or_default();
                files.insert(name.to_owned(), file.to_owned());
            }
        }
    }
    files
}

/// The Rust files below a folder, test files aside.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|end| end == "rs") && !name.ends_with("tests") {
            found.push(path.clone());
        }
    }
    found.sort();
    found
}

/// The blocks of ARCHITECTURE.md that open with "```layers FOLDER": the folder, and its modules in
/// their order.
fn stated(root: &Path) -> Vec<(PathBuf, Vec<String>)> {
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(folder) = line.strip_prefix("```layers ") {
            let block = lines.by_ref().take_while(|line| *line != "```");
            // Behind the names of a line stands what they are.
            let names = block.flat_map(|line| {
                let names = line.split("  ").next().unwrap_or_default();
                names
                    .split_whitespace()
                    .map(str::to_owned)
                    .collect::<Vec<_>>()
            });
            blocks.push((root.join(folder), names.collect()));
        }
    }
    blocks
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The module that a file below `folder` belongs to; `None` for the crate's own root.
fn module(folder: &Path, file: &Path) -> Option<String> {
    let below = file.strip_prefix(folder).expect("a file below the folder");
    let first = below.components().next().expect("a name");
    let name = Path::new(first.as_os_str()).file_stem().expect("a name");
    let name = name.to_string_lossy().into_owned();
    (!["lib", "main"].contains(&name.as_str())).then_some(name)
}

#[test]
fn a_module_uses_only_those_listed_before_it() {
    let blocks = stated(&root());
    assert!(blocks.len() >= 2, "{} blocks of layers", blocks.len());
    let mut wrong = Vec::new();
    for (folder, order) in blocks {
        let place = |name: &str| order.iter().position(|listed| listed == name);
        let at_root = reexports(&folder.join("lib.rs"));
        let mut seen = BTreeSet::new();
        for file in sources(&folder) {
            let Some(own) = module(&folder, &file) else {
                continue;
            };
            let Some(own_place) = place(&own) else {
                wrong.push(format!("{}: `{own}` is not listed", file.display()));
                continue;
            };
            seen.insert(own.clone());
            let source = fs::read_to_string(&file).expect("a source file");
            for name in used(&source, "crate::") {
                let name = at_root.get(&name).cloned().unwrap_or(name);
                if name != own && place(&name).is_none_or(|used| used >= own_place) {
                    wrong.push(format!("{}: `{own}` uses `{name}`", file.display()));
                }
            }
        }
        for listed in order.iter().filter(|listed| !seen.contains(*listed)) {
            wrong.push(format!("{}: there is no `{listed}`", folder.display()));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn the_files_of_a_room_use_one_another_in_one_direction() {
    let mut circles = Vec::new();
    for (folder, order) in stated(&root()) {
        for room in order
            .iter()
            .map(|name| folder.join(name))
            .filter(|room| room.is_dir())
        {
            let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
            let on_page = reexports(&room.join("mod.rs"));
            for file in sources(&room) {
                let name = file
                    .file_stem()
                    .expect("a name")
                    .to_string_lossy()
                    .into_owned();
                // The room's own page lists its files, and may use any.
                if name != "mod" {
                    let source = fs::read_to_string(&file).expect("a source file");
                    let used = used(&source, "super::").into_iter();
                    let used = used.map(|name| on_page.get(&name).cloned().unwrap_or(name));
                    uses.insert(name, used.collect());
                }
            }
            // A file that uses none of those left can go: what cannot go is in a circle, or above one.
            while let Some(leaf) = uses
                .iter()
                .find(|(name, used)| {
                    used.iter()
                        .all(|used| used == *name || !uses.contains_key(used))
                })
                .map(|(name, _)| name.clone())
            {
                uses.remove(&leaf);
            }
            if !uses.is_empty() {
                let left: Vec<_> = uses.keys().cloned().collect();
                circles.push(format!("{}: {}", room.display(), left.join(", ")));
            }
        }
    }
    assert!(circles.is_empty(), "\n{}", circles.join("\n"));
}

#[test]
fn what_a_file_uses_is_read_from_its_paths() {
    let source = "use crate::scene::Mesh;\n// crate::formats\nfn f() { crate::num::g(); mycrate::x(); }\n\
        use crate::{Hit, ray::{self, Ray},\n bvh};\n#[cfg(test)]\nmod tests { use crate::render::View; }\n";
    let names: Vec<_> = used(source, "crate::").into_iter().collect();
    assert_eq!(names, ["Hit", "bvh", "num", "ray", "scene"]);
}
