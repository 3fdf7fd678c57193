
/* The report around its views: controls, keys, links, printing. */

const root = shadow(document.getElementById("report"));
let data = null;
let views = [];

/** The JSON of an element, which the page holds compressed. */
async function unpacked(element) {
  const bytes = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).json();
}

/** The root of the report, whose style is its own; browsers of before 2024 leave the template to the script. */
function shadow(host) {
  if (host.shadowRoot) return host.shadowRoot;
  const made = host.attachShadow({ mode: "open" });
  made.append(host.querySelector("template").content);
  return made;
}

async function start() {
  data = await unpacked(document.getElementById("data"));
  views = [...root.querySelectorAll(".field")].map((section) => connect(section));
  redraw();
  inUnits();
  new MutationObserver(inUnits).observe(document.body, { attributeFilter: ["data-units"] });
}

/** Units of the reader, a length and an angle: name, and size in um or urad. The workbench above chooses them. */
function units() { return JSON.parse(document.body.dataset.units ?? '[{"name":"µm","size":1},{"name":"µrad","size":1}]'); }

/** Writes figures and words of the report in the units of the reader; those of pictures stay. */
function inUnits() {
  const [length, angle] = units();
  const isOwn = length.size === 1 && angle.size === 1;
  root.querySelector(".pictures-in").hidden = isOwn;
  const of = (unit) => (unit === "um" ? length : unit === "urad" ? angle : { size: 1 });
  for (const span of root.querySelectorAll(".n")) {
    span.dataset.own ??= span.textContent;
    const path = span.dataset.at.split("/").slice(1), value = path.reduce((at, key) => at?.[key], data);
    const size = unitSize(path, of);
    if (size === 1 || typeof value !== "number") { span.textContent = span.dataset.own; continue; }
    const number = value / size, { digits } = span.dataset;
    const text = digits ? String(Number(number.toPrecision(Number(digits)))) : number.toFixed(2);
    span.textContent = (span.dataset.own.startsWith("+") && number > 0 ? "+" : "") + text.replace("-", "−");
  }
  // Orientation stands there in urad and arcsec: once is enough.
  for (const cell of root.querySelectorAll('.n[data-at*="/rotation_arcsec/"]')) {
    const line = cell.closest("tr");
    if (line) line.hidden = angle.size !== 1;
  }
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    if (!node.parentElement || node.parentElement.closest(".n, svg, .said, style, script, .pictures-in, #conventions")) continue;
    words.set(node, words.get(node) ?? node.data);
    const text = inWords(words.get(node), length, angle);
    if (node.data !== text) node.data = text;
  }
  views.forEach((view) => view.show());
}

/** Words as the program wrote them. */
const words = new WeakMap();

/** A sentence with its numbers in the units of the reader; um/m is a ratio. */
function inWords(text, length, angle) {
  const number = (digits, size) => String(Number((Number(digits.replace("−", "-")) / size).toPrecision(4))).replace("-", "−");
  return text
    .replaceAll("µm/m", "ppm")
    .replace(/([−-]?\d[\d.]*)( to [−-]?\d[\d.]*)?([ \u00a0])(µm|µrad|um|urad)\b/g, (_, first, second, space, unit) => {
      const { name, size } = unit.endsWith("m") ? length : angle;
      return `${number(first, size)}${second ? ` to ${number(second.slice(4), size)}` : ""}${space}${name}`;
    })
    .replaceAll("µm", length.name)
    .replaceAll("µrad", angle.name);
}

/** Size of the unit of a figure, by the names that lead to it. */
function unitSize(path, of) {
  const last = path.findLast((key) => /(^|_)(um|urad)(_|$)/.test(key)) ?? "";
  const own = path.slice(0, -1).reduce((at, key) => at?.[key], data)?.unit;
  const isListed = path.at(-2) === "tolerance", list = path.slice(0, isListed ? -2 : -1);
  if (path.includes("tolerance") || path.includes("locations"))
    return of((own ?? list.reduce((at, key) => at?.[key], data)?.unit ?? "").replace("µ", "u")).size;
  if (last === "um_per_unit") return of("um").size / of(own).size;
  if (last.includes("um_per_m")) return 1;
  if (/(errors|contributions)\/\d+\/minus_first/.test(path.join("/"))) return of("um").size;
  return of(/(^|_)urad(_|$)/.test(last) ? "urad" : last ? "um" : "").size;
}

function redraw() { views.forEach((view) => view.draw()); }

/** Wires a section's controls to its view. */
function connect(section) {
  const machine = Number(section.dataset.machine), field = data.machines[machine].field;
  const view = new FieldView(section.querySelector("canvas"), field, data.colours);
  const find = (name) => section.querySelector(`[data-set="${name}"]`);
  const out = (name) => section.querySelector(`[data-out="${name}"]`);

  const show = () => {
    const c = view.choice, sliced = c.part !== "surface";
    find("slice").disabled = !sliced;
    if (sliced) {
      const grid = field.grid[Number(c.part)];
      find("slice").max = grid.positions.length - 1;
      c.slice = Math.min(c.slice, grid.positions.length - 1);
      find("slice").value = c.slice;
      out("slice").textContent = `${grid.name} = ${shown(grid.positions[c.slice], 6)} ${grid.unit}`;
    } else out("slice").textContent = "–";
    find("slice").setAttribute("aria-valuetext", out("slice").textContent);
    out("exaggeration").textContent = `${thousands(view.factor())} times`;
    find("exaggeration").setAttribute("aria-valuetext", out("exaggeration").textContent);
    showScale(section, view.scale());
    const said = sentence(view);
    section.querySelector(".said").textContent = said;
    const what = view.at().length_nm ? "Volume" : "Deformed volume";
    view.canvas.setAttribute("aria-label", `${what} of ${data.machines[machine].name}. ${said}`);
    for (const radio of section.querySelectorAll('[name="state"]')) radio.checked = radio.value === c.layer;
    find("layer").value = c.layer;
    view.draw();
  };

  const set = (name, value) => { view.choice[name] = value; if (name === "part") view.choice.node = null; show(); };
  find("layer").addEventListener("change", (e) => set("layer", e.target.value));
  find("part").addEventListener("change", (e) => set("part", e.target.value));
  if (find("station")) find("station").addEventListener("change", (e) => set("station", Number(e.target.value)));
  for (const name of ["slice", "exaggeration"]) find(name).addEventListener("input", (e) => set(name, Number(e.target.value)));
  for (const name of ["colour", "arrows", "fixed"]) find(name).addEventListener("change", (e) => set(name, e.target.checked));
  for (const radio of section.querySelectorAll('[name="state"]')) radio.addEventListener("change", (e) => set("layer", e.target.value));
  for (const button of section.querySelectorAll("[data-look]")) button.addEventListener("click", () => look(view, button.dataset.look, set));
  section.querySelector("form").addEventListener("submit", (e) => e.preventDefault());
  listen(view, set);
  view.show = show;
  show();
  return view;
}

/** What is seen, in words and with the data's numbers. */
function sentence(view) {
  const { field, choice } = view, layer = view.layer(), at = view.at();
  const [{ name, size }] = units(), um = (value, digits) => shown(value / size, digits);
  const place = (positions) => field.grid.map((axis, k) => `${axis.name} = ${shown(positions[k], 6)} ${axis.unit}`).join(", ");
  const worst = field.grid.map((axis) => at.worst_at[axis.name]);
  let text = `Field: ${layer.label}`;
  if (field.stations.length > 1) text += ` at ${field.stations[choice.station].label}`;
  text += `. Largest ${um(at.max_um, 4)} ${name} at ${place(worst)}; mean of the nodes ${um(at.mean_um, 4)} ${name}.`;
  if (choice.node === null) return text;
  const node = place(view.place(choice.node).slice(0, field.grid.length).map((i, k) => field.grid[k].positions[i]));
  if (at.length_nm) return `${text} Node ${node}: ${um(at.length_nm[choice.node] / 1000, 5)} ${name}.`;
  const d = [0, 1, 2].map((k) => um(at.deviation_nm[3 * choice.node + k] / 1000, 5));
  return `${text} Node ${node}: d = (${d.join(", ")}) ${name}.`;
}

function showScale(section, scale) {
  const list = section.querySelector(".ticks");
  const [{ name, size }] = units();
  section.querySelector(".scale p").textContent = name;
  list.replaceChildren(...scale.ticks_um.map((tick) => {
    const item = document.createElement("li");
    item.textContent = shown(tick / size, 4);
    item.style.bottom = scale.max_um > 0 ? `${(100 * tick) / scale.max_um}%` : "0";
    return item;
  }));
}

function thousands(value) { return String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f"); }

function look(view, where, set) {
  const sides = { reset: [-0.6, 0.45], X: [Math.PI / 2, 0], Y: [0, 0], Z: [0, Math.PI / 2] };
  if (where === "worst") return toWorst(view, set);
  [camera.yaw, camera.pitch] = sides[where];
  if (where === "reset") camera.zoom = 1;
  redraw();
}

function toWorst(view, set) {
  const { worst } = view.at();
  if (view.choice.part !== "surface") view.choice.slice = view.place(worst)[Number(view.choice.part)];
  set("node", worst);
}

function turn(yaw, pitch) {
  camera.yaw += yaw;
  camera.pitch = Math.min(Math.max(camera.pitch + pitch, -Math.PI / 2), Math.PI / 2);
  redraw();
}

function zoom(factor) { camera.zoom = Math.min(Math.max(camera.zoom * factor, 0.3), 8); redraw(); }

/** Pointer and keys of a canvas. */
function listen(view, set) {
  const { canvas } = view;
  let from = null;
  canvas.addEventListener("pointerdown", (e) => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointerup", () => { from = null; });
  canvas.addEventListener("pointercancel", () => { from = null; });
  canvas.addEventListener("pointermove", (e) => {
    if (from) {
      turn((e.clientX - from[0]) * 0.008, (e.clientY - from[1]) * 0.008);
      from = [e.clientX, e.clientY];
      return;
    }
    const box = canvas.getBoundingClientRect(), node = view.nearest(e.clientX - box.left, e.clientY - box.top);
    if (node !== null && node !== view.choice.node) set("node", node);
  });
  canvas.addEventListener("wheel", (e) => { if (e.ctrlKey || root.activeElement === canvas) { e.preventDefault(); zoom(Math.exp(-e.deltaY * 0.001)); } }, { passive: false });
  const slice = (by) => {
    if (view.choice.part === "surface") return;
    const last = view.counts[Number(view.choice.part)] - 1;
    set("slice", Math.min(Math.max(view.choice.slice + by, 0), last));
  };
  const step = (by) => {
    const nodes = view.nodes(), here = nodes.indexOf(view.choice.node);
    set("node", nodes[(here + by + nodes.length) % nodes.length] ?? nodes[0]);
  };
  const keys = {
    ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
    "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15), "−": () => zoom(1 / 1.15),
    "[": () => slice(-1), "]": () => slice(1), ",": () => step(-1), ".": () => step(1), w: () => toWorst(view, set), 0: () => look(view, "reset", set),
  };
  canvas.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.altKey || e.metaKey || !keys[e.key]) return;
    e.preventDefault();
    keys[e.key]();
  });
}

/** Links lead within the report: the page's address belongs to the workbench. */
root.addEventListener("click", (e) => {
  const link = e.target.closest('a[href^="#"]');
  if (!link) return;
  e.preventDefault();
  root.getElementById(link.getAttribute("href").slice(1)).scrollIntoView();
});

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
root.getElementById("print").addEventListener("click", () => window.print());
matchMedia("print").addEventListener("change", redraw);
window.addEventListener("beforeprint", redraw);
window.addEventListener("afterprint", redraw);
window.addEventListener("resize", redraw);

start();
