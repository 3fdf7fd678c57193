//! Ticks at round numbers, and colours whose differences look like the differences they show.

use crate::units::Interval;

/// Returns the 1, 2 or 5 times a power of ten that divides `range` into at most `max_steps` steps.
pub fn round_step(range: f64, max_steps: usize) -> f64 {
    if !(range > 0.0 && range.is_finite()) {
        return 1.0;
    }
    let raw = range / max_steps.max(1) as f64;
    let power = libm::pow(10.0, libm::floor(libm::log10(raw)));
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= raw * (1.0 - 1e-9)).unwrap_or(10.0);
    factor * power
}

/// Multiples of the step within the interval.
pub fn ticks(range: Interval, step: f64) -> Vec<f64> {
    let (first, last) = (libm::ceil(range.min / step - 1e-6), libm::floor(range.max / step + 1e-6));
    // A step that suits the interval makes a few dozen at most.
    let count = (last - first).clamp(-1.0, 200.0) as i64;
    (0..=count).map(|i| (first + i as f64) * step + 0.0).collect()
}

/// A tick as text, with the decimals its step has.
pub fn tick_text(value: f64, step: f64) -> String {
    let decimals = (-libm::floor(libm::log10(step) + 1e-9)).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

/// A colour in OKLab's cylinder: lightness, chroma, hue in degrees.
type Lch = (f64, f64, f64);

/// Light for little to blue for much; black arrows stay visible on all of it.
const RISING: [Lch; 4] = [(0.97, 0.035, 105.0), (0.87, 0.09, 140.0), (0.73, 0.105, 205.0), (0.56, 0.125, 255.0)];

/// Blue for minus, white for zero, red for plus.
const SIGNED: [Lch; 5] =
    [(0.56, 0.14, 255.0), (0.78, 0.075, 250.0), (0.975, 0.0, 0.0), (0.80, 0.085, 40.0), (0.60, 0.165, 28.0)];

/// Colour of a fraction of the largest value, 0 to 1.
pub fn rising(fraction: f64) -> String {
    blend(&RISING, fraction)
}

/// Colour of a fraction of the largest absolute value, -1 to 1.
pub fn diverging_colour(fraction: f64) -> String {
    blend(&SIGNED, 0.5 + 0.5 * fraction)
}

fn blend(stops: &[Lch], fraction: f64) -> String {
    let place = fraction.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let i = (place as usize).min(stops.len() - 2);
    let (a, b, t) = (lab(stops[i]), lab(stops[i + 1]), place - i as f64);
    hex([0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t))
}

fn lab((lightness, chroma, hue): Lch) -> [f64; 3] {
    let (sine, cosine) = libm::sincos(hue.to_radians());
    [lightness, chroma * cosine, chroma * sine]
}

/// OKLab to sRGB (the constants are those of its definition).
fn hex([l, a, b]: [f64; 3]) -> String {
    let cubed = |x: f64| x * x * x;
    let long = cubed(l + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let medium = cubed(l - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let short = cubed(l - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    let red = 4.076_741_662_1 * long - 3.307_711_591_3 * medium + 0.230_969_929_2 * short;
    let green = -1.268_438_004_6 * long + 2.609_757_401_1 * medium - 0.341_319_396_5 * short;
    let blue = -0.004_196_086_3 * long - 0.703_418_614_7 * medium + 1.707_614_701_0 * short;
    let [r, g, b] = [red, green, blue].map(channel);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn channel(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(round_step(500.0, 6), 100.0);
        assert_eq!(round_step(0.7, 5), 0.2);
        assert_eq!(round_step(0.0, 5), 1.0);
        assert_eq!(ticks(Interval::new(-400.0, 0.0), 100.0), [-400.0, -300.0, -200.0, -100.0, 0.0]);
        assert_eq!([tick_text(-0.0, 0.5), tick_text(-1.5, 0.5), tick_text(200.0, 100.0)], ["0.0", "-1.5", "200"]);
    }

    #[test]
    fn colours_run_from_light_to_dark_and_through_white() {
        assert_eq!(diverging_colour(0.0), "#f7f7f7");
        let brightness = |colour: String| u32::from_str_radix(&colour[3..5], 16).unwrap();
        assert!((0..10).all(|i| brightness(rising(f64::from(i) / 10.0)) > brightness(rising(f64::from(i + 1) / 10.0))));
    }
}
