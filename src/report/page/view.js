
"use strict";

/* The 3D view of a deviation field: a small renderer on a canvas, without any library. It draws what the
   embedded data hold and computes nothing that is shown as a number. */

/** Turns and zoom, shared by all views of the page, so that machines are seen from the same side. */
const camera = { yaw: -0.6, pitch: 0.45, zoom: 1 };

class FieldView {
  /** `field` is `machines[i].field` of the data, `colours` the page's scale, `canvas` where to draw. */
  constructor(canvas, field, colours) {
    this.canvas = canvas;
    this.field = field;
    this.colours = colours.map(rgb);
    this.counts = [0, 1, 2].map((k) => (field.grid[k] ? field.grid[k].positions.length : 1));
    this.choice = { layer: field.layers[0].id, station: 0, part: "surface", slice: 0, exaggeration: field.exaggeration,
      colour: true, arrows: false, fixed: true, node: null };
  }

  layer() { return this.field.layers.find((layer) => layer.id === this.choice.layer) || this.field.layers[0]; }
  at() { return this.layer().at[this.choice.station]; }
  nominal() { return this.field.stations[this.choice.station].nominal_mm; }
  factor() { return this.field.exaggerations[this.choice.exaggeration]; }

  /** What sets the colours: all errors together at this station, or the field shown. */
  scale() { return this.choice.fixed ? this.field.layers[0].at[this.choice.station] : this.at(); }

  /** Nodes along each axis as index: the first runs fastest. */
  index(i, j, k) { return i + this.counts[0] * (j + this.counts[1] * k); }

  /** Grid indices of a node. */
  place(node) {
    const [a, b] = this.counts;
    return [node % a, Math.floor(node / a) % b, Math.floor(node / (a * b))];
  }

  /** Where a node is drawn, mm. */
  displaced(node) {
    const p = this.nominal(), d = this.at().deviation_nm, times = this.factor() * 1e-6;
    if (!d) return this.exact(node);
    return [0, 1, 2].map((k) => p[3 * node + k] + d[3 * node + k] * times);
  }

  exact(node) { return [0, 1, 2].map((k) => this.nominal()[3 * node + k]); }

  length(node) {
    const { deviation_nm: d, length_nm: lengths } = this.at();
    if (lengths) return lengths[node] / 1000;
    return Math.hypot(d[3 * node], d[3 * node + 1], d[3 * node + 2]) / 1000;
  }

  /** Quads of nodes: of the six faces of the volume, or of one slice. */
  quads() {
    const n = this.counts, list = [];
    const across = (axis, at) => {
      const [u, v] = [0, 1, 2].filter((k) => k !== axis);
      if (n[u] < 2 || n[v] < 2) return;
      const node = (i, j) => { const p = [0, 0, 0]; p[axis] = at; p[u] = i; p[v] = j; return this.index(...p); };
      for (let i = 0; i + 1 < n[u]; i++)
        for (let j = 0; j + 1 < n[v]; j++) list.push([node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
    };
    if (this.choice.part !== "surface") across(Number(this.choice.part), this.choice.slice);
    else for (let axis = 0; axis < 3; axis++) { across(axis, 0); if (n[axis] > 1) across(axis, n[axis] - 1); }
    return list;
  }

  /** Every node of the part that is shown. */
  nodes() {
    const all = Array.from({ length: this.counts[0] * this.counts[1] * this.counts[2] }, (_, node) => node);
    if (this.choice.part === "surface")
      return all.filter((node) => this.place(node).some((p, k) => p === 0 || p === this.counts[k] - 1));
    return all.filter((node) => this.place(node)[Number(this.choice.part)] === this.choice.slice);
  }

  /** Middle and size of the nominal box of this station. */
  box() {
    const p = this.nominal(), low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < p.length; i++) {
      low[i % 3] = Math.min(low[i % 3], p[i]);
      high[i % 3] = Math.max(high[i % 3], p[i]);
    }
    return { middle: low.map((x, k) => (x + high[k]) / 2), size: Math.hypot(...high.map((x, k) => x - low[k])) || 1 };
  }

  /** Machine coordinates to the screen: x to the right, y down, and depth towards the eye. */
  project(p) {
    const { middle, scale, width, height } = this.frame;
    const [x, y, z] = p.map((v, k) => v - middle[k]);
    const [cy, sy, cp, sp] = [Math.cos(camera.yaw), Math.sin(camera.yaw), Math.cos(camera.pitch), Math.sin(camera.pitch)];
    const right = cy * x + sy * y, away = -sy * x + cy * y;
    return [width / 2 + scale * right, height / 2 - scale * (sp * away + cp * z), sp * z - cp * away];
  }

  draw() {
    const ratio = window.devicePixelRatio || 1, { canvas } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const box = this.box();
    this.frame = { width, height, middle: box.middle, scale: (0.95 * camera.zoom * Math.min(width * 0.85, height * 1.15)) / box.size };
    this.ink = getComputedStyle(canvas);
    this.drawBox(pen);
    if (this.choice.colour) this.drawQuads(pen);
    if (this.choice.arrows) this.drawArrows(pen);
    if (this.choice.node !== null) this.drawMark(pen);
    this.drawNames(pen);
  }

  variable(name) { return this.ink.getPropertyValue(name).trim(); }

  line(pen, points) {
    pen.beginPath();
    points.forEach((p, i) => (i ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1])));
    pen.stroke();
  }

  /** Edges of the nominal volume, along its grid lines. */
  edges() {
    const n = this.counts, lines = [];
    for (let axis = 0; axis < 3; axis++) {
      if (n[axis] < 2) continue;
      const [u, v] = [0, 1, 2].filter((k) => k !== axis);
      for (const i of new Set([0, n[u] - 1]))
        for (const j of new Set([0, n[v] - 1])) {
          const nodes = [];
          for (let k = 0; k < n[axis]; k++) { const p = [0, 0, 0]; p[axis] = k; p[u] = i; p[v] = j; nodes.push(this.index(...p)); }
          lines.push({ axis, nodes });
        }
    }
    return lines;
  }

  drawBox(pen) {
    pen.strokeStyle = this.variable("--nominal");
    pen.lineWidth = 1;
    for (const { nodes } of this.edges()) this.line(pen, nodes.map((node) => this.project(this.exact(node))));
  }

  drawQuads(pen) {
    const quads = this.quads().map((quad) => {
      const corners = quad.map((node) => this.project(this.displaced(node)));
      const depth = corners.reduce((sum, c) => sum + c[2], 0);
      return { corners, depth, length: quad.reduce((sum, node) => sum + this.length(node), 0) / 4 };
    });
    quads.sort((a, b) => a.depth - b.depth);
    const end = this.scale().max_um || 1;
    pen.lineWidth = 0.8;
    pen.strokeStyle = this.variable("--edge");
    for (const { corners, length } of quads) {
      pen.beginPath();
      corners.forEach((c, i) => (i ? pen.lineTo(c[0], c[1]) : pen.moveTo(c[0], c[1])));
      pen.closePath();
      pen.fillStyle = this.colour(length / end);
      pen.fill();
      pen.stroke();
    }
    this.drawBoxInFront(pen);
  }

  /** The nominal edges again, faintly, over the surface. */
  drawBoxInFront(pen) {
    pen.globalAlpha = 0.35;
    this.drawBox(pen);
    pen.globalAlpha = 1;
  }

  drawArrows(pen) {
    pen.strokeStyle = pen.fillStyle = this.variable("--ink");
    pen.lineWidth = 1.2;
    for (const node of this.nodes()) {
      const from = this.project(this.exact(node)), to = this.project(this.displaced(node));
      const [dx, dy] = [to[0] - from[0], to[1] - from[1]], long = Math.hypot(dx, dy);
      pen.beginPath();
      pen.arc(from[0], from[1], 1.3, 0, 7);
      pen.fill();
      if (long < 2) continue;
      const head = Math.min(7, long), [ux, uy] = [dx / long, dy / long];
      this.line(pen, [from, to]);
      pen.beginPath();
      pen.moveTo(to[0], to[1]);
      pen.lineTo(to[0] - head * ux + 0.4 * head * uy, to[1] - head * uy - 0.4 * head * ux);
      pen.lineTo(to[0] - head * ux - 0.4 * head * uy, to[1] - head * uy + 0.4 * head * ux);
      pen.fill();
    }
  }

  drawMark(pen) {
    const at = this.project(this.displaced(this.choice.node));
    pen.strokeStyle = this.variable("--bad");
    pen.lineWidth = 3;
    pen.beginPath();
    pen.arc(at[0], at[1], 8, 0, 7);
    pen.stroke();
  }

  /** Name and ends of each axis, at the edge of the box that is nearest to the border of the picture. */
  drawNames(pen) {
    pen.fillStyle = this.variable("--ink");
    pen.font = "13px " + this.ink.fontFamily;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    const centre = this.project(this.frame.middle);
    for (let axis = 0; axis < 3; axis++) {
      const edges = this.edges().filter((edge) => edge.axis === axis);
      if (!edges.length) continue;
      const middle = (edge) => {
        const [a, b] = [edge.nodes[0], edge.nodes[edge.nodes.length - 1]].map((node) => this.project(this.exact(node)));
        return [(a[0] + b[0]) / 2 - centre[0], (a[1] + b[1]) / 2 - centre[1]];
      };
      const far = (edge) => { const m = middle(edge); return m[1] * 1.5 + Math.abs(m[0]); };
      const edge = edges.reduce((best, e) => (far(e) > far(best) ? e : best));
      const [mx, my] = middle(edge), long = Math.hypot(mx, my) || 1, push = 22;
      const grid = this.field.grid[axis], last = grid.positions.length - 1;
      const put = (node, text, more) => {
        const p = this.project(this.exact(node));
        pen.fillText(text, p[0] + (mx / long) * (push + more), p[1] + (my / long) * (push + more));
      };
      const unit = grid.unit === "mm" ? "" : "°";
      put(edge.nodes[0], shown(grid.positions[0], 5) + unit, 0);
      put(edge.nodes[last], shown(grid.positions[last], 5) + unit, 0);
      pen.font = "bold 15px " + this.ink.fontFamily;
      put(edge.nodes[Math.floor(last / 2)], grid.unit === "mm" ? grid.name + ", mm" : grid.name, 8);
      pen.font = "13px " + this.ink.fontFamily;
    }
  }

  colour(share) {
    const place = Math.min(Math.max(share, 0), 1) * (this.colours.length - 1);
    const i = Math.min(Math.floor(place), this.colours.length - 2), t = place - i;
    return "rgb(" + [0, 1, 2].map((k) => Math.round(this.colours[i][k] + (this.colours[i + 1][k] - this.colours[i][k]) * t)).join(",") + ")";
  }

  /** The node drawn nearest to a point of the canvas, if one is near. */
  nearest(x, y) {
    let best = null, least = 18;
    for (const node of this.nodes()) {
      const p = this.project(this.displaced(node)), far = Math.hypot(p[0] - x, p[1] - y);
      if (far < least - 1e-9) { least = far; best = node; }
    }
    return best;
  }
}

function rgb(hex) { return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)); }

/** A number with so many significant digits, a real minus and no trailing zeros: as the tables show it. */
function shown(value, digits) {
  if (Math.abs(value) < 5e-10) return "0";
  const decimals = Math.min(Math.max(digits - 1 - Math.floor(Math.log10(Math.abs(value))), 0), 12);
  const text = value.toFixed(decimals);
  return (text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text).replace("-", "−");
}
