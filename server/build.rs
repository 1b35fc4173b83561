//! Gives the build its id, embeds the page and turns the contract into JSON.
//!
//! The id is a hash of everything that can change an answer, so equal ids mean equal answers, with or without git.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use xxhash_rust::xxh3::Xxh3;

/// Inputs of the answers: code, dependencies, contract, page.
const SOURCES: [&str; 4] = ["Cargo.lock", "openapi.yaml", "server", "web"];

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let version = env::var("CARGO_PKG_VERSION").expect("cargo sets it");

    let mut files = Vec::new();
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
        list(&root, source.to_owned(), &mut files).unwrap_or_else(|error| panic!("cannot list {source}: {error}"));
    }
    println!("cargo::rustc-env=EQUIPOISE_BUILD={version}+{}", hash(&root, &files));

    fs::write(out.join("assets.rs"), assets(&files)).expect("OUT_DIR can be written");
    let contract = fs::read_to_string(root.join("openapi.yaml")).expect("openapi.yaml is at the root");
    fs::write(out.join("openapi.json"), to_json(&contract)).expect("OUT_DIR can be written");
}

/// Adds all files at or under `path`, relative to `root` with `/`, in a fixed order. Hidden files are skipped.
fn list(root: &Path, path: String, files: &mut Vec<String>) -> io::Result<()> {
    let place = root.join(&path);
    if place.is_file() {
        files.push(path);
    } else if place.is_dir() {
        let names = fs::read_dir(place)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        let mut names = names.collect::<io::Result<Vec<_>>>()?;
        names.sort();
        for name in names.iter().filter(|name| !name.starts_with('.')) {
            list(root, format!("{path}/{name}"), files)?;
        }
    }
    Ok(())
}

/// Twelve hexadecimal digits of the names and contents of these files.
fn hash(root: &Path, files: &[String]) -> String {
    let mut hash = Xxh3::new();
    for file in files {
        let content = fs::read(root.join(file)).unwrap_or_else(|error| panic!("cannot read {file}: {error}"));
        for part in [file.as_bytes(), &content] {
            hash.update(&(part.len() as u64).to_le_bytes());
            hash.update(part);
        }
    }
    format!("{:016x}", hash.digest())[..12].to_owned()
}

/// The table of the page's files: path under `web/`, content.
fn assets(files: &[String]) -> String {
    let mut table = String::from("pub(super) static ASSETS: &[(&str, &[u8])] = &[\n");
    for name in files.iter().filter_map(|file| file.strip_prefix("web/")) {
        let path = format!("concat!(env!(\"CARGO_MANIFEST_DIR\"), {:?})", format!("/web/{name}"));
        writeln!(table, "    ({name:?}, include_bytes!({path})),").expect("text takes all text");
    }
    table + "];\n"
}

/// The contract as JSON, in its own order. A contract that is not YAML stops the build with the place of the error.
fn to_json(yaml: &str) -> Vec<u8> {
    let mut json = Vec::new();
    let mut serializer = serde_json::Serializer::new(&mut json);
    serde_saphyr::with_deserializer_from_str(yaml, |deserializer| {
        serde_transcode::transcode(deserializer, &mut serializer).map_err(serde::de::Error::custom)
    })
    .unwrap_or_else(|error| panic!("openapi.yaml: {error}"));
    json
}
