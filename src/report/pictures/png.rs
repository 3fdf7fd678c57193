//! Pictures as PNG: the SVG with its text as outlines, drawn in pixels. Needs the feature `png`.

use super::lettering::Text;

/// Pixels of a PNG for a px of the drawing: sharp in print at the usual size.
#[cfg(feature = "png")]
const SCALE: f32 = 2.0;

/// Reason why a picture has no PNG.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PictureFailure {
    /// The drawing cannot be read back.
    #[error("{0}")]
    Drawing(String),
    /// The picture has too many pixels.
    #[error("the picture is too large")]
    TooLarge,
    /// The pixels cannot be encoded.
    #[error("{0}")]
    Encoding(String),
    /// The program was built without the feature `png`.
    #[error("this build of abbe has no PNG (feature `png`)")]
    Unsupported,
}

/// Returns the PNG of the SVG that `svg` makes with a writer of texts.
#[cfg(feature = "png")]
pub(super) fn pixels(svg: impl FnOnce(fn(&Text) -> String) -> String) -> Result<Vec<u8>, PictureFailure> {
    use resvg::{tiny_skia, usvg};
    let text = svg(super::outlines::path_elements);
    let tree = usvg::Tree::from_str(&text, &usvg::Options::default())
        .map_err(|failure| PictureFailure::Drawing(failure.to_string()))?;
    let size = tree.size().to_int_size().scale_by(SCALE).ok_or(PictureFailure::TooLarge)?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or(PictureFailure::TooLarge)?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|failure| PictureFailure::Encoding(failure.to_string()))
}

/// Refuses: this build has no PNG.
#[cfg(not(feature = "png"))]
pub(super) fn pixels(_: impl FnOnce(fn(&Text) -> String) -> String) -> Result<Vec<u8>, PictureFailure> {
    Err(PictureFailure::Unsupported)
}
