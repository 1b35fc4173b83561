//! PNG pictures: the drawing of the SVG, with the same bytes everywhere, and an answer like any other.

use crate::support::Server;
use axum::http::Method;

const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.6&x.to=1.4&x.count=8\
                   &y.field=release.theta&y.from=0.02&y.to=0.08&y.count=4&bounces=300";

const TARGETS: [&str; 9] = [
    MAP,
    "/v1/trajectories?preset=case-1",
    "/v1/stability?preset=case-4",
    "/v1/controllers?preset=case-1",
    "/v1/periodic-orbits?preset=case-1&family=symmetric&theta=0.05&sweep.field=table.tilt_gain&sweep.from=1.4\
     &sweep.to=1.7&sweep.points=20",
    "/v1/failures/order-three",
    "/v1/ensembles?preset=case-1-noise&runs=50",
    "/v1/catches?preset=case-1&scene.release.theta=0.1&strategy=bounce_down",
    "/v1/throws?preset=case-1&apex.height=0.3&apex.theta=0.1",
];

fn formatted(target: &str, format: &str) -> String {
    format!("{target}{}format={format}", if target.contains('?') { '&' } else { '?' })
}

/// Width, height and the pixels, four bytes each.
fn decoded(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut pixels).expect("all pixels");
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
    (frame.width as usize, frame.height as usize, pixels)
}

#[tokio::test]
async fn pixels_are_the_drawing_at_its_own_size() {
    let server = Server::start();
    for target in TARGETS {
        let drawing = server.get(&formatted(target, "svg")).await.expect(200);
        let picture = server.get(&formatted(target, "png")).await.expect(200);
        assert_eq!(picture.media_type(), "image/png");
        let (width, height, pixels) = decoded(&picture.raw);
        let root = roxmltree::Document::parse(drawing.text()).unwrap();
        let size = |name| root.root_element().attribute(name).unwrap().parse::<f64>().unwrap();
        assert!((width as f64 - size("width")).abs() < 1.0 && (height as f64 - size("height")).abs() < 1.0, "{target}");
        let at = |x: usize, y: usize| &pixels[4 * (y * width + x)..][..4];
        assert_eq!(at(width / 2, 4), [255; 4], "{target}: paper");
        assert_eq!(at(0, 0)[3], 0, "{target}: nothing outside of its rounded corner");
        // The title has dark pixels, so text is drawn.
        let dark = (20..44).flat_map(|y| (28..300).map(move |x| (x, y))).filter(|(x, y)| at(*x, *y)[0] < 90).count();
        assert!(dark > 200, "{target}: {dark} dark pixels in the title");
    }
}

#[tokio::test]
async fn every_cell_has_its_colour() {
    let server = Server::start();
    let map = server.get(MAP).await.expect(200).json();
    let drawing = server.get(&format!("{MAP}&format=svg")).await.expect(200);
    let (width, _, pixels) = decoded(&server.get(&format!("{MAP}&format=png")).await.expect(200).raw);
    // Place of the cells in the drawing: matrix(width 0 0 -height left bottom).
    let place = drawing.text().split("matrix(").nth(1).unwrap().split(')').next().unwrap();
    let place: Vec<f64> = place.split(' ').map(|number| number.parse().unwrap()).collect();
    let (mut completed, mut fell) = (0, 0);
    for row in 0..4 {
        for column in 0..8 {
            let x = place[4] + (column as f64 + 0.5) * place[0];
            let y = place[5] + (row as f64 + 0.5) * place[3];
            let pixel = &pixels[4 * (y as usize * width + x as usize)..][..4];
            let value = map["values"][row][column].as_u64().unwrap();
            if value == 300 {
                completed += 1;
                assert_eq!(pixel, [0xfe, 0xe8, 0x38, 0xff], "{row} {column}");
            } else {
                fell += 1;
                assert!(value < 100 && pixel[2] > pixel[0], "{row} {column}: {value} is {pixel:?}");
            }
        }
    }
    assert!(completed > 5 && fell > 5, "{completed} {fell}");
}

#[tokio::test]
async fn the_same_picture_is_the_same_bytes_and_is_not_compressed_again() {
    for target in TARGETS {
        let target = formatted(target, "png");
        let (server, other) = (Server::start(), Server::start());
        let one = server.get(&target).await.expect(200);
        let two = other.get_with(&target, &[("accept-encoding", "gzip")]).await.expect(200);
        assert_eq!((&one.raw, one.etag()), (&two.raw, two.etag()), "{target}");
        assert_eq!(two.header("content-encoding"), None, "{target}");
        server.get_with(&target, &[("if-none-match", one.etag())]).await.expect(304);
        let head = server.send(Method::HEAD, &target, &[], "").await.expect(200);
        assert_eq!(head.header("etag"), one.header("etag"), "{target}");
        assert_eq!(head.header("content-type"), Some("image/png"), "{target}");
    }
}

#[tokio::test]
async fn an_image_may_ask_by_accept_and_a_matrix_has_no_picture() {
    let server = Server::start();
    let asked = server.get_with(MAP, &[("accept", "image/png")]).await.expect(200);
    assert_eq!(asked.media_type(), "image/png");
    // In the Accept header of an <img>, SVG is the closest match.
    let image = server.get_with(MAP, &[("accept", "image/avif,image/svg+xml,image/*,*/*;q=0.8")]).await.expect(200);
    assert_eq!(image.media_type(), "image/svg+xml");
    server.get("/v1/jacobians?preset=case-1&format=png").await.expect(406);
    server.get("/v1/periodic-orbits?preset=case-1&period=1&format=png").await.expect(422);
}

#[tokio::test]
async fn what_a_mean_hides_is_counted() {
    let server = Server::start();
    // Each drawn cell stands for two cells.
    let target = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1.3&x.to=1.6&x.count=1024\
                  &y.field=release.theta&y.from=0.15&y.to=0.15&y.count=1&bounces=40";
    let map = server.get(target).await.expect(200).json();
    let outcomes = map["outcomes"][0].as_array().unwrap();
    let mixed = outcomes.chunks(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(mixed > 0 && mixed < 512, "{mixed}");
    let drawing = server.get(&formatted(target, "svg")).await.expect(200);
    assert!(drawing.text().contains(&format!("Mixed are {mixed}: ")), "{mixed}: {}", drawing.text());
}
