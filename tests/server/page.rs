//! The page's files, and its tags for link previews.

use crate::support::Server;
use clap::Parser;
use equipoise::config::Config;

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

/// The content of a tag of the page's head.
fn tag(html: &str, name: &str) -> Option<String> {
    let start = html.find(&format!("=\"{name}\" content=\""))?;
    let content = html[start..].split('"').nth(3)?;
    Some(
        content
            .replace("&quot;", "\"")
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&#39;", "'")
            .replace("&amp;", "&"),
    )
}

#[tokio::test]
async fn the_page_tells_what_its_address_shows() {
    let server = Server::start();
    let page =
        server.get("/?preset=case-1&scene.table.tilt_gain=1.52&scene.release.theta=0.2&tab=map").await.expect(200);
    let title = tag(page.text(), "og:title").unwrap();
    assert!(title.starts_with("Falls at bounce "), "{title}");
    assert!(tag(page.text(), "og:description").unwrap().contains("κ = 1.52"));
    assert_eq!(tag(page.text(), "twitter:card").as_deref(), Some("summary_large_image"));
    let query = "preset=case-1&scene.table.tilt_gain=1.52&scene.release.theta=0.2";
    assert_eq!(tag(page.text(), "og:url").unwrap(), format!("http://localhost/?{query}&tab=map"));
    let image = tag(page.text(), "og:image").unwrap();
    assert_eq!(image, format!("http://localhost/v1/previews?{query}&format=png"));

    // The picture exists, has the size that the tags say, and belongs to the same run.
    let target = image.strip_prefix("http://localhost").unwrap();
    let picture = server.get(target).await.expect(200);
    let reader = png::Decoder::new(std::io::Cursor::new(&picture.raw)).read_info().unwrap();
    let said: [u32; 2] =
        ["og:image:width", "og:image:height"].map(|name| tag(page.text(), name).unwrap().parse().unwrap());
    assert_eq!([reader.info().width, reader.info().height], said);
    let json = server.get(&target.replace("format=png", "format=json")).await.expect(200).json();
    assert_eq!(json["title"], title);
    assert_eq!(json["outcome"]["kind"], "sinking");

    // Nothing else of the page differs, and each address has its entity tag.
    let plain = server.get("/").await.expect(200);
    assert!(tag(plain.text(), "og:title").unwrap().starts_with("Keeps balance for 1000 bounces"));
    assert_eq!(tag(plain.text(), "og:image").unwrap(), "http://localhost/v1/previews?preset=case-1&format=png");
    let without =
        |text: &str| text.lines().filter(|line| !line.contains("<meta property=\"og:")).collect::<Vec<_>>().join("\n");
    assert_eq!(without(page.text()), without(plain.text()));
    assert_ne!(page.etag(), plain.etag());
    server.get_with("/", &[("if-none-match", plain.etag())]).await.expect(304);
    server.get_with("/?preset=case-2", &[("if-none-match", plain.etag())]).await.expect(200);
    assert_eq!(plain.etag(), server.get("/index.html").await.expect(200).etag());
}

#[tokio::test]
async fn hostile_addresses_get_a_page_with_the_default_tags() {
    let server = Server::start();
    let default = server.get("/").await.expect(200);
    let long = format!("preset=case-1&scene.table.tilt_gain=1.{}", "1".repeat(8000));
    let many: String = (0..1100).map(|n| format!("a{n}=&")).collect();
    for query in [
        "preset=%22%3E%3Cscript%3Ealert(1)%3C/script%3E",
        "preset=case-1&scene.%22%3E%3Cb%3E=1",
        "preset=case-1&scene.table.tilt_gain=NaN",
        "preset=case-1&scene.table.tilt_gain=1e999",
        "preset=case-1&scene.table=1&scene.table.tilt_gain=1",
        "preset=case-1&preset=case-2",
        "scene.release.height=1",
        "preset=case-1&interventions.99999999999999999999.impact=1",
        "preset=case-1&interventions.0.impact=1&interventions.0.kick.theta_dot=1e9",
        "%ff%fe=%00&preset=%ff",
        "&&==&=%&%2",
        &long,
        &many,
    ] {
        let page = server.get(&format!("/?{query}")).await.expect(200);
        let expected = if query == long { None } else { tag(default.text(), "og:image") };
        if expected.is_some() {
            assert_eq!(tag(page.text(), "og:image"), expected, "{query}");
            assert_eq!(tag(page.text(), "og:title"), tag(default.text(), "og:title"), "{query}");
        }
        let head = page.text().split("</head>").next().unwrap();
        assert_eq!(head.matches("<script").count(), 1, "{query}");
        assert!(!head.contains("alert(1)</"), "{query}");
        assert!(head.lines().filter(|line| line.contains("og:")).all(|line| line.matches('"').count() == 4), "{query}");
    }
    // Values of an address never leave its attribute, even in the address of the page itself.
    let page = server.get("/?a=%22onload=%22x&b='%3E%3Cimg%20src=x%3E&token=secret").await.expect(200);
    let url = tag(page.text(), "og:url").unwrap();
    assert!(!url.contains(['"', '<', '>', '\'']) && !page.text().contains("secret"), "{url}");
}

#[tokio::test]
async fn addresses_of_a_preview_have_the_base_path_and_no_token() {
    let server = Server::with(&config(&["--base-path", "/lab/rig"]));
    let page = server.send_unheld(axum::http::Method::GET, "/lab/rig/?preset=case-2", &[], "").await.expect(200);
    let image = tag(page.text(), "og:image").unwrap();
    assert_eq!(image, "http://localhost/lab/rig/v1/previews?preset=case-2&format=png");
    assert_eq!(tag(page.text(), "og:url").unwrap(), "http://localhost/lab/rig/?preset=case-2");
}

#[tokio::test]
async fn a_preview_costs_what_it_says_and_is_cached_like_all_answers() {
    let server = Server::start();
    let target = "/v1/previews?preset=case-1&bounces=200";
    let answer = server.get(target).await.expect(200);
    server.get_with(target, &[("if-none-match", answer.etag())]).await.expect(304);
    let posted =
        server.post("/v1/previews", &serde_json::json!({"preset": "case-1", "bounces": 200})).await.expect(200);
    assert_eq!(posted.body, answer.body);
    server.get("/v1/previews?preset=case-1&bounces=10001").await.expect(422);
    server.get("/v1/previews?preset=case-1&format=csv").await.expect(406);
    for preset in [
        "point-mass",
        "triangle-polygon",
        "case-1-noise",
        "still-lossy",
        "critical-hard",
        "case-1&scene.release.height=100&scene.release.x_dot=100",
        "case-1&scene.release.y_dot=100&scene.release.theta_dot=200",
        "case-1&scene.body.contact_distance=0.001&scene.release.x=-1000",
        "case-1&scene.body.contact_distance=0.001&scene.body.radius_of_gyration=10&scene.release.height=0.001",
        "case-1&bounces=1",
    ] {
        let svg = server.get(&format!("/v1/previews?preset={preset}&format=svg")).await.expect(200);
        assert!(!svg.text().contains("NaN"), "{preset}");
        let root = roxmltree::Document::parse(svg.text()).unwrap();
        let size = ["width", "height"].map(|name| root.root_element().attribute(name).unwrap().to_owned());
        assert_eq!(size, ["1200", "630"], "{preset}");
    }
}

#[tokio::test]
async fn another_site_sets_the_page_to_no_work_and_no_dear_run_is_computed_for_it() {
    let server = Server::start();
    let title = async |query: &str, headers: &[(&str, &str)]| {
        let page = server.send(axum::http::Method::GET, &format!("/?preset=case-1{query}"), headers, "").await;
        tag(page.expect(200).text(), "og:title").unwrap()
    };
    const UNKNOWN: &str = "A rod bouncing on a tilting table";
    let changed = "&scene.table.tilt_gain=1.53";
    assert_eq!(title(changed, &[("sec-fetch-site", "cross-site")]).await, UNKNOWN);
    for site in ["same-origin", "none"] {
        assert!(title(changed, &[("sec-fetch-site", site)]).await.starts_with("Falls at bounce "));
    }
    // The words for another site are not kept for everyone, and those of the run are.
    assert!(title(changed, &[]).await.starts_with("Falls at bounce "));
    let caught = "&interventions.0.impact=3&interventions.0.catch.strategy=bounce_down";
    assert_eq!(title(caught, &[]).await, UNKNOWN);
}
