//! The pixels of a picture: a drawing of this server, as PNG.
//!
//! Only the fonts in `fonts` are used, never those of the system, and only exact instructions of the CPU, so that the bytes are the
//! same everywhere.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Paint, Pixmap, PixmapMut, Transform};
use resvg::usvg;
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Group, Node, Options, Path, Tree};

use crate::limits;

/// DejaVu Sans, with the characters that pictures have. It is among the fonts that every SVG names.
const FONTS: [&[u8]; 3] = [
    include_bytes!("../fonts/DejaVuSans.ttf"),
    include_bytes!("../fonts/DejaVuSans-Bold.ttf"),
    include_bytes!("../fonts/DejaVuSans-Oblique.ttf"),
];

static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut database = Database::new();
    for font in FONTS {
        database.load_font_data(font.to_vec());
    }
    database.set_sans_serif_family("DejaVu Sans");
    Arc::new(database)
});

/// The reason why there are no pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoPixels {
    /// `go_on` returned false.
    Cancelled,
    /// More pixels than `limits::PICTURE_PIXELS`, or not SVG: an error of this server.
    Unfit,
}

/// Draws an SVG of this server at its own size, a pixel for each px. `go_on` is asked between the steps.
pub fn png(svg: &str, go_on: impl Fn() -> bool) -> Result<Vec<u8>, NoPixels> {
    let check = || if go_on() { Ok(()) } else { Err(NoPixels::Cancelled) };
    check()?;
    let options = Options { fontdb: DATABASE.clone(), font_family: "DejaVu Sans".to_owned(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|_| NoPixels::Unfit)?;
    check()?;
    let size = tree.size().to_int_size();
    if u64::from(size.width()) * u64::from(size.height()) > limits::PICTURE_PIXELS {
        return Err(NoPixels::Unfit);
    }
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or(NoPixels::Unfit)?;
    draw(tree.root(), &mut pixels.as_mut(), &check)?;
    written(size.width(), size.height(), &pixels.take_demultiplied()).map_err(|_| NoPixels::Unfit)
}

/// Same as [`resvg::render`], node by node.
fn draw(group: &Group, pixels: &mut PixmapMut<'_>, check: &impl Fn() -> Result<(), NoPixels>) -> Result<(), NoPixels> {
    for node in group.children() {
        check()?;
        match node {
            Node::Group(group) if !group.should_isolate() && group.transform().is_identity() => {
                draw(group, pixels, check)?;
            }
            // A node that is drawn alone is moved to the origin; this moves it back.
            _ => match (node.abs_layer_bounding_box(), node) {
                (Some(place), _) => {
                    resvg::render_node(node, Transform::from_translate(place.x(), place.y()), pixels);
                }
                (None, Node::Path(path)) => draw_line(path, pixels),
                (None, Node::Group(_) | Node::Image(_) | Node::Text(_)) => {}
            },
        }
    }
    check()
}

/// Draws a horizontal or vertical line. It encloses no area, so it has no box and [`resvg::render_node`] leaves it out.
fn draw_line(path: &Path, pixels: &mut PixmapMut<'_>) {
    let Some(stroke) = path.stroke().filter(|_| path.is_visible()) else { return };
    let usvg::Paint::Color(colour) = stroke.paint() else { return };
    let mut paint = Paint { anti_alias: path.rendering_mode().use_shape_antialiasing(), ..Paint::default() };
    paint.set_color_rgba8(colour.red, colour.green, colour.blue, stroke.opacity().to_u8());
    pixels.stroke_path(path.data(), &paint, &stroke.to_tiny_skia(), path.abs_transform(), None);
}

fn written(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    // Fast compression: a picture is sent once, and flat areas are small in any case.
    encoder.set_compression(png::Compression::Fast);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn horizontal_and_vertical_lines_are_drawn() {
        for line in ["M2 10H18", "M10 2V18", "M2 9L18 11"] {
            let svg = format!(
                r##"<svg xmlns="http://www.w3.org/2000/svg" width="20" height="20"><g><path d="{line}" stroke="#0080ff" stroke-width="4"/></g></svg>"##
            );
            let bytes = png(&svg, || true).expect("a picture");
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
            let mut pixels = vec![0; 20 * 20 * 4];
            reader.next_frame(&mut pixels).expect("its pixels");
            let at = |x: usize, y: usize| &pixels[(y * 20 + x) * 4..][..4];
            assert_eq!(at(10, 10), [0, 128, 255, 255], "{line}");
            assert_eq!(at(2, 2), [0, 0, 0, 0], "{line}");
        }
    }
}
