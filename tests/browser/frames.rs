//! What a frame of the picture costs: draw calls and triangles are held, frames a second are printed.

use crate::workbench::Bench;

/// Moves an axis from frame to frame, as a hand does: frames a second, most draw calls and triangles of a frame.
const DRAGGED: &str = "const input = document.getElementById('axis-X'), canvas = document.querySelector('#stage canvas');
    const [low, high] = [Number(input.min), Number(input.max)], from = performance.now();
    let frames = 0, calls = 0, triangles = 0;
    return new Promise((done) => {
        const step = () => {
            calls = Math.max(calls, Number(canvas.dataset.calls));
            triangles = Math.max(triangles, Number(canvas.dataset.triangles));
            const spent = performance.now() - from;
            if (spent > 3000) return done([frames / (spent / 1000), calls, triangles, document.querySelectorAll('.notes span').length]);
            frames += 1;
            input.value = String(low + (high - low) * (frames % 50) / 50);
            input.dispatchEvent(new Event('input'));
            requestAnimationFrame(step);
        };
        step();
    });";

/// A frame is at most so many draw calls and triangles, without a field and with one: figures of the machine, not of
/// the computer.
pub fn draw_calls() {
    for (machine, calls, triangles) in
        [("trunnion.yaml", 75.0, 20_000.0), ("hh-ca-gantry.yaml", 75.0, 20_000.0), ("tt-ac-800.yaml", 75.0, 20_000.0)]
    {
        let bench = Bench::of_config("bench-frames", machine);
        for field in ["", "all"] {
            crate::review::fill(&bench, "field", field);
            std::thread::sleep(std::time::Duration::from_secs(1));
            let found = bench.browser.run(DRAGGED);
            let [frames, drawn, shapes, names] = [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap());
            let with = if field.is_empty() { "no field" } else { "field" };
            println!(
                "  {machine}, {with}: {frames:.0} frames a second, {drawn} draw calls, {shapes} triangles a frame"
            );
            assert!(drawn > 10.0 && drawn <= calls, "{machine}, {with}: {drawn} draw calls");
            let most = if field.is_empty() { triangles } else { 2.5 * triangles };
            assert!(shapes > 500.0 && shapes <= most, "{machine}, {with}: {shapes} triangles");
            assert!(names >= 4.0, "{machine}: {names} axes have their names");
        }
        bench.quiet();
    }
}

/// Does nothing for three seconds, or moves the slider with an id from frame to frame: frames a second of the browser,
/// draw calls, new figures a second, questions of the page.
const COUNTED: &str = "const canvas = document.querySelector('#stage canvas'), gl = canvas.getContext('webgl2');
    let draws = 0, asked = 0, figures = 0, frames = 0;
    const draw = gl.drawElements, post = window.fetch;
    gl.drawElements = (...all) => { draws += 1; return draw.apply(gl, all); };
    window.fetch = (...all) => { asked += String(all[0]).endsWith('/ask') ? 1 : 0; return post(...all); };
    const input = document.getElementById(id), from = performance.now();
    const value = () => document.querySelector('[data-at=p95]')?.dataset.value;
    let last = value();
    return new Promise((done) => {
        const step = () => {
            if (value() !== last) [figures, last] = [figures + 1, value()];
            if (performance.now() - from > 3000) {
                [gl.drawElements, window.fetch] = [draw, post];
                return done([frames / 3, draws, figures / 3, asked]);
            }
            frames += 1;
            if (input) {
                const [low, high] = [Number(input.min), Number(input.max)];
                input.value = String(low + (high - low) * (frames % 50) / 50);
                input.dispatchEvent(new Event('input'));
            }
            requestAnimationFrame(step);
        };
        step();
    });";

/// An idle page draws nothing; a figure of a held slider takes few questions. Rates are printed.
pub fn idle() {
    let bench = Bench::of_config("bench-idle", "trunnion.yaml");
    std::thread::sleep(std::time::Duration::from_secs(1));
    let count = |id: &str| {
        let found = bench.browser.run(&format!("const id = '{id}'; {COUNTED}"));
        [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap())
    };
    // At rest the page asks control by control what each could repair; behind the last one it is idle.
    let is_quiet = |found: &[f64; 4]| found[1] + found[3] == 0.0;
    let mut found = count("");
    for _ in 0..20 {
        if is_quiet(&found) {
            break;
        }
        found = count("");
    }
    let [empty, drawn, _, asked] = found;
    println!("  idle: {empty:.0} frames a second of the browser, {drawn} draw calls, {asked} questions in 3 s");
    assert_eq!((drawn, asked), (0.0, 0.0), "an idle page draws and asks nothing");
    let [held, drawn, ..] = count("axis-X");
    println!("  an axis is moved: {held:.0} frames a second, {:.1} times as dear as an idle one", empty / held);
    assert!(drawn > 0.0);
    let _ = bench.browser.run("document.getElementById('axis-X').dispatchEvent(new Event('change'));");
    bench.settled();
    let [frames, _, figures, asked] = count("number");
    println!("  a number is moved: {figures:.1} figures a second, {frames:.0} frames, {asked} questions in 3 s");
    assert!(figures > 0.3 && asked < 3.0 * 3.0 * figures + 6.0, "{asked} questions for {figures} figures a second");
}
