//! Single terms of fitted curves in words, as reports name them.

/// Returns the basis that holds a term: `poly2` of `x^2`, `fourier3` of `sin3`, `slope` of itself; `None` of others.
pub(crate) fn basis_of_term(term: &str) -> Option<String> {
    if term == "slope" {
        return Some(term.to_owned());
    }
    let order = |digits: &str| digits.parse::<u8>().ok().filter(|order| order.to_string() == digits);
    let power = term.strip_prefix("x^").and_then(order).map(|power| format!("poly{}", power.max(1)));
    let harmonic = || term.strip_prefix("cos").or_else(|| term.strip_prefix("sin")).and_then(order);
    power.or_else(|| harmonic().map(|order| format!("fourier{}", order.max(1))))
}
