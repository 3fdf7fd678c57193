//! Pictures as PNG: the SVG with its text as outlines, drawn in pixels. Needs the feature `png`.

use super::svg::Text;

/// Pixels of a PNG for a px of the drawing: sharp in print at the usual size.
#[cfg(feature = "png")]
const SCALE: f32 = 2.0;

/// Returns the PNG of the SVG that `svg` makes with a writer of texts.
#[cfg(feature = "png")]
pub(super) fn pixels(svg: impl FnOnce(fn(&Text) -> String) -> String) -> Result<Vec<u8>, String> {
    use resvg::{tiny_skia, usvg};
    let text = svg(super::outlines::path_elements);
    let tree = usvg::Tree::from_str(&text, &usvg::Options::default()).map_err(|f| f.to_string())?;
    let size = tree.size().to_int_size().scale_by(SCALE).ok_or("the picture is too large")?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("the picture is too large")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|failure| failure.to_string())
}

/// Refuses: this build has no PNG.
#[cfg(not(feature = "png"))]
pub(super) fn pixels(_: impl FnOnce(fn(&Text) -> String) -> String) -> Result<Vec<u8>, String> {
    Err("this build of abbe has no PNG (feature `png`)".to_owned())
}
