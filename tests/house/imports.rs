//! The import graph of the Rust sources: one node for each file, one arrow for each file that another one names.

use std::collections::{BTreeMap, BTreeSet};

use super::Source;

/// Imports between files, by path.
pub(crate) struct Imports {
    arrows: BTreeMap<String, BTreeSet<String>>,
}

/// The module tree: module paths such as `crate::http::problem`, the file of each, and names that a module re-exports.
struct Modules {
    files: BTreeMap<String, String>,
    exports: BTreeMap<String, String>,
}

/// The crates of the workspace: the folder, the name that others call it by.
const CRATES: [(&str, &str); 2] = [("server/physics/", "equipoise_physics"), ("server/", "equipoise")];

impl Imports {
    /// Reads `use` declarations and paths in the code of the crates' own sources.
    pub(crate) fn read(sources: &[Source]) -> Self {
        let own: Vec<(&Source, String)> =
            sources.iter().filter_map(|source| Some((source, module(&source.path)?))).collect();
        let mut modules = Modules { files: BTreeMap::new(), exports: BTreeMap::new() };
        for (source, module) in &own {
            modules.files.insert(module.clone(), source.path.clone());
        }
        for (source, module) in &own {
            for (public, path, name) in uses(&code(source), module) {
                if public {
                    modules.exports.insert(format!("{module}::{name}"), path);
                }
            }
        }
        let mut arrows = BTreeMap::new();
        for (source, module) in &own {
            let code = code(source);
            let mut named: BTreeSet<String> = BTreeSet::new();
            let declared = uses(&code, module);
            named.extend(declared.iter().filter(|(public, ..)| !public).map(|(_, path, _)| path.clone()));
            named.extend(paths(&without_uses(&code), module, &declared));
            let targets = named.iter().filter_map(|path| modules.file(path)).filter(|file| **file != source.path);
            arrows.insert(source.path.clone(), targets.cloned().collect());
        }
        Self { arrows }
    }

    /// Number of imports.
    pub(crate) fn count(&self) -> usize {
        self.arrows.values().map(BTreeSet::len).sum()
    }

    /// Groups of files that import one another in a circle, directly or through others.
    pub(crate) fn circles(&self) -> Vec<Vec<&str>> {
        let reach: BTreeMap<&str, BTreeSet<&str>> =
            self.arrows.keys().map(|file| (file.as_str(), self.reach(file))).collect();
        let mut seen = BTreeSet::new();
        let mut circles = Vec::new();
        for (file, reached) in &reach {
            if !reached.contains(file) || seen.contains(file) {
                continue;
            }
            let circle: Vec<&str> = reached.iter().copied().filter(|other| reach[other].contains(file)).collect();
            seen.extend(circle.iter().copied());
            circles.push(circle);
        }
        circles
    }

    fn reach(&self, file: &str) -> BTreeSet<&str> {
        let mut reached = BTreeSet::new();
        let mut open = vec![file];
        while let Some(file) = open.pop() {
            for next in &self.arrows[file] {
                if reached.insert(next.as_str()) {
                    open.push(next);
                }
            }
        }
        reached
    }
}

impl Modules {
    /// The file that defines what a path names, through re-exports.
    fn file(&self, path: &str) -> Option<&String> {
        let mut path = path.to_owned();
        for _ in 0..8 {
            let mut prefix = path.as_str();
            let exported = loop {
                if let Some(target) = self.exports.get(prefix) {
                    break Some(format!("{target}{}", &path[prefix.len()..]));
                }
                if self.files.contains_key(prefix) {
                    break None;
                }
                prefix = &prefix[..prefix.rfind("::")?];
            };
            match exported {
                Some(target) => path = target,
                None => return self.files.get(prefix),
            }
        }
        None
    }
}

/// The module path of a source of one of the crates, from the crate's name on; `None` for tests, benches and build scripts.
fn module(file: &str) -> Option<String> {
    let (folder, name) = CRATES.into_iter().find(|(folder, _)| file.starts_with(folder))?;
    let inside = file[folder.len()..].strip_suffix(".rs")?;
    if inside.starts_with("tests/") || inside.ends_with("tests") || ["main", "build"].contains(&inside) {
        return None;
    }
    let inside = inside.strip_suffix("/mod").unwrap_or(inside);
    Some(if inside == "lib" { name.to_owned() } else { format!("{name}::{}", inside.replace('/', "::")) })
}

fn code(source: &Source) -> String {
    source.code().map(|(_, line)| line).collect::<Vec<_>>().join("\n")
}

/// Every name that `use` declarations import: true if it is re-exported, its full path, and its name here.
fn uses(code: &str, module: &str) -> Vec<(bool, String, String)> {
    let mut found = Vec::new();
    for (start, _) in code.match_indices("use ") {
        let before = code[..start].lines().next_back().unwrap_or_default();
        let before = if code[..start].ends_with('\n') || start == 0 { "" } else { before };
        let public = match before.trim() {
            "" => false,
            "pub" | "pub(crate)" => true,
            _ => continue,
        };
        let Some(end) = code[start..].find(';') else { continue };
        for (path, name) in leaves(&code[start + 4..start + end]) {
            found.push((public, absolute(&path, module), name));
        }
    }
    found
}

fn without_uses(code: &str) -> String {
    let mut rest = String::new();
    let mut inside = false;
    for line in code.lines() {
        let begins = ["use ", "pub use ", "pub(crate) use "].iter().any(|start| line.trim_start().starts_with(start));
        inside |= begins;
        if !inside {
            rest.push_str(line);
            rest.push('\n');
        }
        inside &= !line.trim_end().ends_with(';');
    }
    rest
}

/// The paths and names in a tree of imports.
fn leaves(tree: &str) -> Vec<(String, String)> {
    let tree = tree.trim();
    if let Some((prefix, inner)) = tree.split_once('{') {
        let inner = &inner[..inner.rfind('}').unwrap_or(inner.len())];
        let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
        for (index, character) in inner.char_indices() {
            match character {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    parts.push(&inner[start..index]);
                    start = index + 1;
                }
                _ => {}
            }
        }
        parts.push(&inner[start..]);
        let prefix = prefix.trim();
        let parts = parts.into_iter().filter(|part| !part.trim().is_empty());
        return parts.flat_map(leaves).map(|(path, name)| (format!("{prefix}{path}"), name)).map(of_self).collect();
    }
    let (path, alias) = tree.split_once(" as ").unwrap_or((tree, ""));
    let last = path.rsplit("::").next().unwrap_or(path);
    vec![(path.trim().to_owned(), if alias.is_empty() { last.trim() } else { alias.trim() }.to_owned())]
}

fn of_self((path, name): (String, String)) -> (String, String) {
    match path.strip_suffix("::self") {
        Some(module) if name == "self" => (module.to_owned(), module.rsplit("::").next().unwrap_or(module).to_owned()),
        Some(module) => (module.to_owned(), name),
        None => (path, name),
    }
}

/// A path from its crate's name on.
fn absolute(path: &str, module: &str) -> String {
    let root = module.split("::").next().unwrap_or(module);
    let parent = module.rfind("::").map_or(module, |end| &module[..end]);
    if let Some(rest) = path.strip_prefix("crate::") {
        format!("{root}::{rest}")
    } else if let Some(rest) = path.strip_prefix("super::") {
        format!("{parent}::{rest}")
    } else if let Some(rest) = path.strip_prefix("self::") {
        format!("{module}::{rest}")
    } else if CRATES.iter().any(|(_, name)| path == *name || path.starts_with(&format!("{name}::"))) {
        path.to_owned()
    } else {
        format!("{module}::{path}")
    }
}

/// Paths written out in the code: from `crate`, from `super`, and from a module that the file imports or has below it.
fn paths(code: &str, module: &str, declared: &[(bool, String, String)]) -> Vec<String> {
    let is_part = |character: char| character.is_alphanumeric() || character == '_' || character == ':';
    let words = code.split(|character: char| !is_part(character)).filter(|word| word.contains("::"));
    words
        .map(|word| {
            let first = word.split("::").next().unwrap_or(word);
            match declared.iter().find(|(_, _, name)| name == first) {
                Some((_, path, _)) => format!("{path}{}", &word[first.len()..]),
                None => absolute(word, module),
            }
        })
        .collect()
}
