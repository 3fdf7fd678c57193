use abbe::diagnostic::{Diagnostics, Rendering, render, summary};
#[test]
fn scratch() {
    for p in std::env::var("SCRATCH").unwrap_or_default().split_whitespace() {
        let mut d = Diagnostics::default();
        let t=std::time::Instant::now();
        let doc = abbe::syntax::load(std::path::Path::new(p), &abbe::cli::files::Disk, &mut d);
        let m = doc.and_then(|doc| abbe::machine::resolve(&doc, &abbe::cli::files::Disk, &mut d));
        println!("=== {p}: {} {:?}\n{}{}", m.is_some(), t.elapsed(), render(&d, Rendering::default()), summary(&d));
    }
}
