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
