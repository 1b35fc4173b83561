//! The page's files.

mod support;

use clap::Parser;
use equipoise::config::Config;
use support::Server;

fn config(arguments: &[&str]) -> Config {
    Config::parse_from([&["equipoise"], arguments].concat())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_folder_is_served_with_its_changes_and_new_files() {
    let folder = std::env::temp_dir().join(format!("equipoise-page-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("panels/throws")).unwrap();
    for (name, text) in [("index.html", "<title>mine</title>"), ("panels/throws/panel.js", "1;"), ("{id}.js", "2;")] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let server = Server::with(&config(&["--web", folder.to_str().unwrap()]));
    let get = async |target: &str| server.send_unheld(axum::http::Method::GET, target, &[], "").await;

    assert!(get("/").await.expect(200).text().contains("<title>mine</title>"));
    let script = get("/panels/throws/panel.js").await.expect(200);
    assert_eq!((script.text(), script.media_type()), ("1;", "text/javascript"));
    std::fs::write(folder.join("panels/throws/panel.js"), "3;").unwrap();
    assert_eq!(get("/panels/throws/panel.js").await.expect(200).text(), "3;");

    // An embedded file that the folder lacks, a path out of the folder, and a name that a route would read as a parameter.
    for target in ["/style.css", "/panels/../../Cargo.toml", "/%2e%2e/Cargo.toml", "/any.js", "/none"] {
        get(target).await.expect(404);
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
