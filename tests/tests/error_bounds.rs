//! The table of docs/error-bounds.md, compared with the code: the tests that see the error terms exist.

use std::fs;
use std::path::Path;

/// All Rust sources of a folder, one after another.
fn sources(folder: &Path) -> String {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    let text = paths.iter().map(|path| match path.is_dir() {
        true => sources(path),
        false => fs::read_to_string(path).expect("text"),
    });
    text.collect()
}

#[test]
fn every_error_term_has_a_test_that_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = fs::read_to_string(root.join("docs/error-bounds.md")).expect("the page");
    let (_, table) = page.split_once("## Terms").expect("the table");
    let code = root.join("crates/core/src");
    let all = sources(&code);
    let mut rows = 0;
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        let mut cells = row.split('|').map(|cell| cell.trim().trim_matches('`'));
        let (file, test) = (cells.nth(1).expect("a file"), cells.nth(1).expect("a test"));
        assert!(code.join(file).with_extension("rs").is_file(), "{row}");
        assert!(all.contains(&format!("fn {test}()")), "{row}");
        rows += 1;
    }
    assert!(rows > 30, "{rows}");
}
