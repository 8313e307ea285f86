//! The layers that ARCHITECTURE.md states, compared with the code: a module uses only modules listed
//! before its own, and the files of a room use one another in one direction.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The paths in a source file's code that begin with `crate`, `super` or `self`, as lists of their names; a group in
/// braces gives a path for each of its entries. Comments and tests do not count.
fn paths(source: &str) -> Vec<Vec<String>> {
    let code = source
        .split("#[cfg(test)]\nmod ")
        .next()
        .unwrap_or_default();
    let is_comment = |line: &&str| line.trim_start().starts_with("//");
    let code: Vec<&str> = code.lines().filter(|line| !is_comment(line)).collect();
    let code = code.join("\n");
    let mut found = Vec::new();
    for root in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(root) {
            if !code[..at].ends_with(|c: char| is_part(c) || c == ':') {
                tree(&code[at..], &mut Vec::new(), &mut found);
            }
        }
    }
    found
}

fn is_part(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Adds the paths of a use tree (`a::{b::c, d}`), each behind `prefix`, and returns what follows the tree.
fn tree<'a>(text: &'a str, prefix: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        while !rest.is_empty() {
            rest = rest.trim_start_matches(|c: char| c == ',' || c.is_whitespace());
            if let Some(behind) = rest.strip_prefix('}') {
                return behind;
            }
            let before = rest.len();
            rest = tree(rest, prefix, found);
            if rest.len() == before {
                break;
            }
        }
        return rest;
    }
    let end = text.find(|c| !is_part(c)).unwrap_or(text.len());
    let (name, rest) = text.split_at(end);
    if name.is_empty() {
        // `a::*` uses `a`.
        found.push(prefix.clone());
        return rest.strip_prefix('*').unwrap_or(rest);
    }
    prefix.push(name.to_owned());
    let rest = match rest.strip_prefix("::") {
        Some(behind) => tree(behind, prefix, found),
        None => {
            found.push(prefix.clone());
            // `name as other`: what it is called here.
            rest.strip_prefix(" as ")
                .map_or(rest, |other| other.trim_start_matches(is_part))
        }
    };
    prefix.pop();
    rest
}

/// A path from the crate's root: `super` and `self` taken from the module that says them.
fn absolute(path: &[String], module: &[String]) -> Vec<String> {
    let mut from_root = module.to_vec();
    for name in path {
        match name.as_str() {
            "crate" => from_root.clear(),
            "super" => drop(from_root.pop()),
            "self" => {}
            name => from_root.push(name.to_owned()),
        }
    }
    from_root
}

/// What a module's page re-exports (`pub use file::{Name, …};`): the file of each name.
fn reexports(page: &Path) -> BTreeMap<String, String> {
    let source = fs::read_to_string(page).unwrap_or_default();
    let mut files = BTreeMap::new();
    for (at, _) in source.match_indices("use ") {
        let statement = source[at + 4..].split(';').next().unwrap_or_default();
        let mut paths = Vec::new();
        tree(statement, &mut Vec::new(), &mut paths);
        for path in paths {
            if let [file, .., name] = &path[..]
                && !["crate", "super", "std"].contains(&file.as_str())
            {
                files.insert(name.clone(), file.clone());
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

/// The path of the module that a file is, from the crate's root, which has none.
fn module_path(folder: &Path, file: &Path) -> Vec<String> {
    let below = file.strip_prefix(folder).expect("a file below the folder");
    let names = below.with_extension("");
    let names = names.iter().map(|name| name.to_string_lossy().into_owned());
    names
        .filter(|name| !["lib", "main", "mod"].contains(&name.as_str()))
        .collect()
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
            let Some(own) = module_path(&folder, &file).into_iter().next() else {
                continue;
            };
            let Some(own_place) = place(&own) else {
                wrong.push(format!("{}: `{own}` is not listed", file.display()));
                continue;
            };
            seen.insert(own.clone());
            let source = fs::read_to_string(&file).expect("a source file");
            for path in paths(&source) {
                let path = absolute(&path, &module_path(&folder, &file));
                let Some(name) = path.first() else { continue };
                let name = at_root.get(name).unwrap_or(name);
                if *name != own && place(name).is_none_or(|used| used >= own_place) {
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

/// Which modules each module's children use of one another, at every level of a crate: `children[page][child]` are the
/// siblings of `child` that its files name, those of its own children included. A module's own page lists its children, and
/// may use any.
fn siblings(folder: &Path) -> BTreeMap<Vec<String>, BTreeMap<String, BTreeSet<String>>> {
    let mut children: BTreeMap<_, BTreeMap<_, BTreeSet<_>>> = BTreeMap::new();
    let files: Vec<_> = sources(folder)
        .into_iter()
        .map(|file| (module_path(folder, &file), file))
        .collect();
    let modules: BTreeSet<_> = files.iter().map(|(module, _)| module.clone()).collect();
    let mut pages = BTreeMap::new();
    for (module, file) in &files {
        pages.insert(module.clone(), reexports(file));
    }
    for (module, file) in &files {
        let source = fs::read_to_string(file).expect("a source file");
        for path in paths(&source) {
            let path = absolute(&path, module);
            let shared = module.iter().zip(&path).take_while(|(a, b)| a == b).count();
            let (Some(own), Some(name)) = (module.get(shared), path.get(shared)) else {
                continue;
            };
            let page = module[..shared].to_vec();
            let file = pages.get(&page).and_then(|files| files.get(name));
            let used = file.unwrap_or(name).clone();
            let is_module = modules.contains(&[&page[..], std::slice::from_ref(&used)].concat());
            if is_module && used != *own {
                let uses = children.entry(page).or_default();
                uses.entry(own.clone()).or_default().insert(used);
            }
        }
    }
    children
}

#[test]
fn the_files_of_a_room_use_one_another_in_one_direction() {
    let mut circles = Vec::new();
    let mut arrows = 0;
    for (folder, _) in stated(&root()) {
        for (page, mut uses) in siblings(&folder) {
            arrows += uses.values().map(BTreeSet::len).sum::<usize>();
            // A file that uses none of those left can go: what cannot go is in a circle, or above one.
            while let Some(leaf) = uses
                .iter()
                .find(|(_, used)| used.iter().all(|used| !uses.contains_key(used)))
                .map(|(name, _)| name.clone())
            {
                uses.remove(&leaf);
            }
            if !uses.is_empty() {
                let page = folder.join(page.join("/"));
                circles.push(format!("{}: {uses:?}", page.display()));
            }
        }
    }
    assert!(arrows > 1000, "only {arrows} uses were found");
    assert!(circles.is_empty(), "\n{}", circles.join("\n"));
}

#[test]
fn what_a_file_uses_is_read_from_its_paths() {
    let source = "use crate::scene::Mesh;\n// crate::formats\nfn f() { crate::num::g(); mycrate::x(); }\n\
        use crate::{Hit, ray::{self, Ray as R},\n bvh};\nuse super::super::a::B;\nuse crate::shade::*;\n\
        #[cfg(test)]\nmod tests { use crate::render::View; }\n";
    let module = ["packet", "cast", "eyes"].map(str::to_owned);
    let paths = paths(source);
    let mut names: Vec<_> = paths
        .iter()
        .map(|path| absolute(path, &module).join("::"))
        .collect();
    names.sort();
    let expected = [
        "Hit",
        "bvh",
        "num::g",
        "packet::a::B",
        "ray",
        "ray::Ray",
        "scene::Mesh",
        "shade",
    ];
    assert_eq!(names, expected);
}
