//! Rules of the code as tests: imports, length of files, names, and everything that keeps answers the same on every CPU.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A source file: its path under the root, with `/`, and its text.
struct Source {
    path: String,
    text: String,
}

impl Source {
    /// Lines of code with their numbers, without comments and without the unit tests at the end of a file.
    fn code(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text
            .lines()
            .enumerate()
            .take_while(|(_, line)| !line.starts_with("#[cfg(test)]"))
            .map(|(index, line)| (index + 1, line.split("//").next().unwrap_or_default()))
            .filter(|(_, line)| !line.trim().is_empty())
    }

    fn is_under(&self, folder: &str) -> bool {
        self.path.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'))
    }
}

fn sources(extensions: &[&str]) -> Vec<Source> {
    fn gather(root: &Path, folder: &Path, extensions: &[&str], found: &mut Vec<Source>) {
        let Ok(entries) = fs::read_dir(folder) else { return };
        for path in entries.map(|entry| entry.expect("a readable folder").path()) {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            let generated = ["target", "node_modules", "vendor", "reference"].contains(&name.as_str());
            if name.starts_with('.') || generated {
                continue;
            }
            if path.is_dir() {
                gather(root, &path, extensions, found);
            } else if extensions.iter().any(|extension| path.extension().is_some_and(|own| own == *extension)) {
                let relative = path.strip_prefix(root).expect("under the root");
                let text = fs::read_to_string(&path).expect("a text file");
                found.push(Source { path: relative.to_string_lossy().replace('\\', "/"), text });
            }
        }
    }
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for folder in ["server", "tests", "benches", "web"] {
        gather(&root, &root.join(folder), extensions, &mut found);
    }
    found.sort_by(|one, other| one.path.cmp(&other.path));
    assert!(!found.is_empty(), "the sources are where they were");
    found
}

fn none(faults: Vec<String>) {
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// A floor of the server, and the names that must not occur there.
const FLOORS: &[(&str, &[&str])] = &[
    ("server/physics", &["tokio", "axum", "serde_json", "std::time", "std::thread", "hyper", "equipoise::"]),
    (
        "server/charts",
        &["axum", "tokio", "serde", "equipoise_physics", "crate::http", "crate::api", "crate::live", "crate::runs"],
    ),
    ("server/failure_cases", &["axum", "tokio", "serde", "crate::http", "crate::api", "crate::live", "crate::runs"]),
    ("server/comparison", &["axum", "tokio", "serde", "crate::http", "crate::api", "crate::live", "crate::runs"]),
    ("server/http", &["equipoise_physics", "crate::api", "crate::live", "crate::runs"]),
    (
        "server/compute",
        &["axum", "hyper", "equipoise_physics", "crate::http", "crate::api", "crate::live", "crate::runs"],
    ),
    (
        "server/integrators",
        &[
            "tokio",
            "axum",
            "serde_json",
            "std::time",
            "std::thread",
            "hyper",
            "crate::compute",
            "crate::http",
            "crate::charts",
            "crate::api",
            "crate::live",
            "crate::runs",
        ],
    ),
    ("server/runs", &["axum", "tokio", "crate::live", "crate::router", "crate::middleware"]),
    ("server/live", &["axum::Router", "axum::routing", "crate::router", "crate::middleware"]),
    ("server/api", &["crate::router", "crate::middleware", "crate::transport"]),
    ("server/transport", &["equipoise_physics", "crate::api", "crate::live", "crate::runs"]),
    ("server/limits.rs", &["equipoise_physics", "axum", "crate::http", "crate::api", "crate::live", "crate::runs"]),
];

/// Names that must not occur in answers, which know no route.
const ANSWERS: [&str; 5] = ["axum::Router", "axum::routing", "tokio", "crate::live", "crate::router"];

#[test]
fn answers_know_of_no_route() {
    let mut faults = Vec::new();
    for source in sources(&["rs"]).iter().filter(|source| source.is_under("server/api")) {
        // Routes are files at the top of `api`, and the `mod.rs` of each resource.
        let inside = source.path["server/api/".len()..].to_owned();
        if !inside.contains('/') || inside.ends_with("mod.rs") || inside.starts_with("ops/") {
            continue;
        }
        for (number, line) in source.code() {
            for name in ANSWERS.iter().filter(|name| mentions(line, name)) {
                faults.push(format!("{}:{number}: {name} is not for an answer: {}", source.path, line.trim()));
            }
        }
    }
    none(faults);
}

#[test]
fn no_files_import_one_another_in_a_circle() {
    let sources = sources(&["rs"]);
    let imports = Imports::read(&sources);
    assert!(imports.count() > 500, "only {} imports were found", imports.count());
    none(
        imports.circles().iter().map(|circle| format!("a circle of {}: {}", circle.len(), circle.join(", "))).collect(),
    );
}

/// Most files in a folder, at one level.
const FILES: usize = 14;

/// The same of the analyses, whose closed forms stand beside those of the return map.
const ANALYSES: (&str, usize) = ("server/physics/analysis", 28);

#[test]
fn folders_are_small() {
    let mut folders: BTreeMap<String, usize> = BTreeMap::new();
    for source in sources(&["rs", "js", "mjs", "css"]) {
        let folder = source.path.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
        *folders.entry(folder).or_default() += 1;
    }
    let is_test = |folder: &str| folder.split('/').any(|part| part == "tests");
    let most = |folder: &str| if folder == ANALYSES.0 { ANALYSES.1 } else { FILES };
    let faults = folders.iter().filter(|(folder, count)| **count > most(folder) && !is_test(folder));
    none(faults.map(|(folder, count)| format!("{folder}: {count} files; at most {}", most(folder))).collect());
}

/// A file without its line would be no error, and its tests would not run.
#[test]
fn every_file_of_the_server_tests_is_in_the_test_program() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/server");
    let listed = fs::read_to_string(folder.join("main.rs")).expect("a text file");
    let files = fs::read_dir(folder).expect("a readable folder").map(|entry| entry.expect("a file").path());
    let names = files.filter(|path| path.is_file()).map(|path| path.file_stem().expect("a name").to_owned());
    let names = names.map(|name| name.into_string().expect("a name in UTF-8")).filter(|name| name != "main");
    let faults = names.filter(|name| !listed.contains(&format!("\nmod {name};\n")));
    none(faults.map(|name| format!("tests/server/main.rs: no `mod {name};`")).collect());
}

#[test]
fn imports_go_downwards_only() {
    let mut faults = Vec::new();
    for source in sources(&["rs"]) {
        for (floor, above) in FLOORS {
            if !(source.is_under(floor) || source.path == *floor) || source.path.contains("/tests/") {
                continue;
            }
            for (number, line) in source.code() {
                for name in above.iter().filter(|name| mentions(line, name)) {
                    faults.push(format!("{}:{number}: {name} is not for {floor}: {}", source.path, line.trim()));
                }
            }
        }
    }
    none(faults);
}

/// True if a line contains this path, and not only a longer name around it.
fn mentions(line: &str, name: &str) -> bool {
    line.match_indices(name).any(|(start, _)| {
        let before = line[..start].chars().next_back();
        let after = line[start + name.len()..].chars().next();
        let is_word = |character: Option<char>| character.is_some_and(|c| c.is_alphanumeric() || c == '_');
        !is_word(before) && (name.ends_with("::") || !is_word(after))
    })
}

/// Most lines of a file. A smaller limit splits what belongs together.
const LINES: usize = 800;

#[test]
fn files_are_short() {
    let faults = sources(&["rs", "js", "mjs", "css"])
        .iter()
        .filter(|source| source.text.lines().count() > LINES)
        .map(|source| format!("{}: {} lines; at most {LINES}", source.path, source.text.lines().count()))
        .collect();
    none(faults);
}

#[test]
fn every_module_opens_with_what_it_is_for() {
    let faults = sources(&["rs"])
        .iter()
        .filter(|source| !source.text.starts_with("//! "))
        .map(|source| format!("{}: no //! at the top", source.path))
        .collect();
    none(faults);
}

/// Most doc comments that may open with one of [`VAGUE`]. A doc comment says what a thing is or does: it opens with a noun or a verb.
const VAGUE_OPENINGS: usize = 30;

const VAGUE: [&str; 4] = ["What", "Whether", "Where", "Its"];

#[test]
fn doc_comments_open_with_a_noun_or_a_verb() {
    let mut found = Vec::new();
    for source in sources(&["rs", "js", "mjs"]) {
        let lines: Vec<&str> = source.text.lines().map(str::trim).collect();
        for (index, line) in lines.iter().enumerate() {
            let follows = |mark: &str| index > 0 && lines[index - 1].starts_with(mark);
            let text = if let Some(text) = line.strip_prefix("/**") {
                let next = lines.get(index + 1).copied().unwrap_or_default();
                if text.is_empty() { next.trim_start_matches('*') } else { text }
            } else {
                let mark = ["///", "//!"].into_iter().find(|mark| line.starts_with(mark) && !follows(mark));
                mark.map_or("", |mark| &line[mark.len()..])
            };
            let first = text.trim_start().split(|character: char| !character.is_alphanumeric()).next();
            if first.is_some_and(|word| VAGUE.contains(&word)) {
                found.push(format!("{}:{}: {line}", source.path, index + 1));
            }
        }
    }
    let count = found.len();
    assert!(count <= VAGUE_OPENINGS, "\n{}\n{count} of at most {VAGUE_OPENINGS}\n", found.join("\n"));
}

/// Functions that the standard library takes from the platform; their last bits differ between platforms. Square roots, rounding and
/// fused multiplication are exact everywhere. The physics has its own versions under other names.
const PLATFORM: [&str; 27] = [
    "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh",
    "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "powi", "cbrt", "hypot", "gamma",
];

#[test]
fn no_answer_depends_on_the_platforms_mathematics() {
    let mut faults = Vec::new();
    for source in sources(&["rs"]) {
        let is_test = ["/tests/", "/benches/", "/examples/"].iter().any(|folder| source.path.contains(folder));
        if !source.is_under("server") || is_test {
            continue;
        }
        for (number, line) in source.code() {
            for name in PLATFORM {
                let called = [format!(".{name}("), format!("f64::{name}("), format!("f64::{name})")];
                if called.iter().any(|call| line.contains(call.as_str())) {
                    faults.push(format!("{}:{number}: {name} is the platform's: {}", source.path, line.trim()));
                }
            }
        }
    }
    none(faults);
}

#[test]
fn no_map_without_an_order_decides_over_bytes() {
    let mut faults = Vec::new();
    for source in sources(&["rs"]) {
        let answers = ["server/physics", "server/api", "server/runs", "server/comparison"]
            .iter()
            .any(|floor| source.is_under(floor));
        if !answers || source.path.contains("/tests/") {
            continue;
        }
        for (number, line) in source.code() {
            if line.contains("HashMap") || line.contains("HashSet") {
                faults.push(format!("{}:{number}: its order changes from run to run: {}", source.path, line.trim()));
            }
        }
    }
    none(faults);
}

#[test]
fn names_say_what_things_are() {
    let faults = sources(&["rs", "js", "mjs"])
        .iter()
        .filter(|source| {
            let name = source.path.rsplit('/').next().unwrap_or_default().split('.').next().unwrap_or_default();
            ["util", "utils", "helper", "helpers", "manager", "data", "common", "misc"].contains(&name)
        })
        .map(|source| format!("{}: a name that says nothing", source.path))
        .collect();
    none(faults);
}

#[test]
fn the_page_loads_nothing_from_elsewhere() {
    let mut faults = Vec::new();
    for source in sources(&["html", "js", "mjs", "css"]).iter().filter(|source| source.is_under("web")) {
        for (number, line) in source.text.lines().enumerate().map(|(index, line)| (index + 1, line)) {
            let loads =
                ["src=\"http", "src=\"//", "url(http", "url(\"http", "@import \"http", "from \"http", "import(\"http"];
            for load in loads.iter().filter(|load| line.contains(**load)) {
                faults.push(format!("{}:{number}: {load}", source.path));
            }
            if source.path.ends_with(".html") {
                let inline = [" onclick=", " onload=", " style=", "javascript:"];
                for inline in inline.iter().filter(|inline| line.contains(**inline)) {
                    faults.push(format!("{}:{number}: inline {inline}", source.path));
                }
            }
        }
    }
    none(faults);
}

#[test]
fn files_that_documents_name_are_there() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let folders = ["server/", "web/", "tests/", "docs/", "benches/"];
    let mut faults = Vec::new();
    for document in
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md", "docs/physics.md", "docs/determinism.md"]
    {
        let text = fs::read_to_string(root.join(document)).expect("a document");
        let folder = Path::new(document).parent().expect("a folder");
        let code =
            text.split('`').skip(1).step_by(2).filter(|name| folders.iter().any(|folder| name.starts_with(folder)));
        let code =
            code.filter(|name| name.chars().all(|letter| letter.is_ascii_alphanumeric() || "/._-".contains(letter)));
        let links = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
        let links = links.filter(|link| !link.is_empty() && !link.contains("://"));
        let named: Vec<_> = code.map(PathBuf::from).chain(links.map(|link| folder.join(link))).collect();
        assert!(!named.is_empty(), "{document} names files");
        let missing = named.iter().filter(|path| !root.join(path).exists());
        faults.extend(missing.map(|path| format!("{document}: {} is not there", path.display())));
    }
    none(faults);
}

// The import graph of the Rust sources: one node for each file, one arrow for each file that another one names.

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
