//! The page that asks a person for the token, and its form.

use axum::http::Method;

use crate::access::{TOKEN, guarded};
use crate::support::Server;

/// `Accept` of a browser for an address that somebody opens.
const VISIT: (&str, &str) = ("accept", "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8");
const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");

#[tokio::test]
async fn a_person_is_asked_for_the_token_and_a_program_is_told() {
    let server = Server::with(&guarded());
    for (target, action, address) in [
        ("/", "./sign-in", ""),
        ("/?preset=case-2&x=%22%3E%3Cscript%3E", "./sign-in", "?preset=case-2&amp;x=%22%3E%3Cscript%3E"),
        ("/docs", "./sign-in", "docs"),
        ("/embed/map?preset=case-1", "../sign-in", "embed/map?preset=case-1"),
        ("/v1/stability?preset=case-1&format=svg", "../sign-in", "v1/stability?preset=case-1&amp;format=svg"),
        ("/sign-in", "./sign-in", ""),
    ] {
        let page = server.get_with(target, &[VISIT]).await.expect(401);
        assert_eq!(page.media_type(), "text/html", "{target}");
        assert_eq!(page.header("cache-control"), Some("no-store"), "{target}");
        assert_eq!(page.header("www-authenticate"), Some("Bearer realm=\"equipoise\""), "{target}");
        let framed = page.header("content-security-policy").unwrap().contains("frame-ancestors *");
        assert_eq!(framed, target.starts_with("/embed/"), "{target}");
        assert!(page.text().contains(&format!("<form method=\"post\" action=\"{action}\">")), "{}", page.text());
        let hidden = format!("name=\"address\" value=\"{address}\"");
        assert!(page.text().contains(&hidden) && !page.text().contains("not the token"), "{}", page.text());
        for program in [&[][..], &[("accept", "*/*")], &[("accept", "application/json")]] {
            let answer = server.get_with(target, program).await.expect(401);
            assert_eq!(answer.media_type(), "application/problem+json", "{target}");
        }
    }
    let wrong = server.get_with("/?preset=case-2&token=0123456789abcdef", &[VISIT]).await.expect(401);
    assert!(
        wrong.text().contains("not the token") && wrong.text().contains("value=\"?preset=case-2\""),
        "{}",
        wrong.text()
    );
    assert!(!wrong.text().contains("0123456789abcdef"));
}

#[tokio::test]
async fn the_form_leads_back_to_the_address_and_nowhere_else() {
    let server = Server::with(&guarded());
    let send = async |token: &str, address: &str| {
        let form = form_urlencoded::Serializer::new(String::new())
            .append_pair("address", address)
            .append_pair("token", token)
            .finish();
        server.send(Method::POST, "/sign-in", &[FORM], &form).await
    };
    for (address, location) in [
        ("", "./"),
        ("?preset=case-2&scene.table.tilt_gain=1.2", "./?preset=case-2&scene.table.tilt_gain=1.2"),
        ("embed/map?preset=case-1", "./embed/map?preset=case-1"),
        ("//elsewhere.example/", "./elsewhere.example/"),
        ("https://elsewhere.example/", "./https://elsewhere.example/"),
        ("\\\\elsewhere.example", "./"),
        ("a\r\nx: y", "./"),
        ("\u{e9}", "./"),
    ] {
        let answer = send(&format!(" {TOKEN} "), address).await.expect(303);
        assert_eq!(answer.header("location"), Some(location), "{address:?}");
        let cookie = answer.header("set-cookie").unwrap().split_once(';').unwrap().0;
        server.get_with("/v1/scenes", &[("cookie", cookie)]).await.expect(200);
    }
    let wrong = send(&TOKEN[1..], "docs").await.expect(401);
    assert!(wrong.header("set-cookie").is_none() && !wrong.text().contains(&TOKEN[1..]));
    assert!(wrong.text().contains("not the token") && wrong.text().contains("value=\"docs\""), "{}", wrong.text());
    // A form is read within the limits of every body, and only as a form.
    server.send(Method::POST, "/sign-in", &[("content-type", "application/json")], "{}").await.expect(415);
    server.send(Method::POST, "/sign-in", &[FORM], &"x".repeat(300_000)).await.expect(413);
    Server::start().send(Method::POST, "/sign-in", &[FORM], "").await.expect(404);
}

#[tokio::test]
async fn a_frame_of_another_site_is_not_asked_for_a_token_that_the_browser_would_not_keep() {
    let server = Server::with(&guarded());
    let frame = [VISIT, ("sec-fetch-site", "cross-site"), ("sec-fetch-dest", "iframe")];
    let page = server.get_with("/embed/map?preset=case-1", &frame).await.expect(401);
    assert!(
        !page.text().contains("<form") && page.text().contains("href=\"../embed/map?preset=case-1\""),
        "{}",
        page.text()
    );
    let own = [VISIT, ("sec-fetch-site", "same-origin"), ("sec-fetch-dest", "iframe")];
    assert!(server.get_with("/embed/map", &own).await.expect(401).text().contains("<form"));
}
