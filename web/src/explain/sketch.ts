/** A sketch of an error, from the letters of its name and the direction of its axis: nominal grey, actual coloured. */

import type { Axis, Vec3 } from "../evaluator/types";
import { add, along, cross, dot, scaled, unit } from "../machine/vectors";
import type { ErrorName } from "./name";

const SVG = "http://www.w3.org/2000/svg";

/** X to the right, Y to the back, Z up, as on a drawing. */
const RIGHT: [number, number][] = [
  [0.92, 0.2],
  [0.5, -0.44],
  [0, -1],
];

const UNITS: Vec3[] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];

type Motion = (point: Vec3) => Vec3;

/** What the picture shows to who does not see it. */
const WORDS = "Sketch of the error: nominal grey, actual coloured, with X, Y and Z as on the machine";

/** Half the length of an axis, and the shift and turn that stand for an error. */
const HALF = 46;
const SHIFT = 15;
const TURN = 0.3;

export function sketch(name: ErrorName, axis: Axis | null): SVGSVGElement {
  const direction = axis?.direction ?? [0, 0, 1];
  const isLinear = axis?.kind === "linear";
  const error = UNITS[name.along] ?? [0, 0, 1];
  const motion: Motion = name.isRotation
    ? (point) => turned(point, error, TURN)
    : (point) => along(point, error, SHIFT);
  const body = isLinear ? carriage(direction) : disc(direction);
  const line = [scaled(direction, -HALF), scaled(direction, HALF)];
  const still: Motion = (point) => point;
  const moved = name.isLocation
    ? [drawn(line, motion, "actual line"), ...outline(body, motion)]
    : outline(body, motion);
  const guide = isLinear && !name.isLocation && !name.isRotation ? [wave(direction, error)] : [];
  const svg = element("svg", { viewBox: "-64 -58 128 116", class: "sketch", role: "img", "aria-label": WORDS });
  svg.append(drawn(line, still, "nominal line"), ...outline(body, still, "nominal"), ...guide, ...moved);
  svg.append(name.isRotation ? arc(error) : drawn([[0, 0, 0], scaled(error, SHIFT * 2.4)], still, "arrow"));
  svg.append(...triad());
  return svg as SVGSVGElement;
}

/** Corners of the faces of a carriage on its guide. */
function carriage(direction: Vec3): Vec3[][] {
  const [side, up] = normals(direction);
  const corner = (a: number, b: number, c: number): Vec3 =>
    add(scaled(direction, 17 * a), add(scaled(side, 12 * b), scaled(up, 9 * c)));
  const face = (c: number) => [
    corner(-1, -1, c),
    corner(1, -1, c),
    corner(1, 1, c),
    corner(-1, 1, c),
    corner(-1, -1, c),
  ];
  const posts = [-1, 1].flatMap((a) => [-1, 1].map((b) => [corner(a, b, -1), corner(a, b, 1)]));
  return [face(-1), face(1), ...posts];
}

/** A table with a mark on its rim. */
function disc(direction: Vec3): Vec3[][] {
  const [side, up] = normals(direction);
  const rim = Array.from({ length: 33 }, (_, i) => {
    const angle = (i * Math.PI) / 16;
    return add(scaled(side, 30 * Math.cos(angle)), scaled(up, 30 * Math.sin(angle)));
  });
  return [rim, [[0, 0, 0], scaled(side, 30)]];
}

/** Two directions across one. */
function normals(direction: Vec3): [Vec3, Vec3] {
  const helper = UNITS.find((of) => Math.abs(dot(of, direction)) < 0.7) ?? [1, 0, 0];
  const side = unit(cross(direction, helper));
  return [side, unit(cross(side, direction))];
}

function outline(lines: Vec3[][], motion: Motion, kind = "actual"): SVGElement[] {
  return lines.map((line) => drawn(line, motion, kind));
}

/** The path that a slide takes: its error as a function of the position. */
function wave(direction: Vec3, error: Vec3): SVGElement {
  const points = Array.from({ length: 41 }, (_, i) => {
    const at = (i / 20 - 1) * HALF;
    return along(scaled(direction, at), error, SHIFT * Math.cos((at / HALF) * Math.PI * 0.9) ** 2);
  });
  return drawn(points, (point) => point, "path");
}

/** An arrow about a direction. */
function arc(about: Vec3): SVGElement {
  const [side, up] = normals(about);
  const points = Array.from({ length: 25 }, (_, i) => {
    const angle = ((i / 24) * 1.25 - 0.15) * Math.PI;
    return add(scaled(side, 24 * Math.cos(angle)), scaled(up, 24 * Math.sin(angle)));
  });
  return drawn(points, (point) => point, "arrow");
}

function triad(): SVGElement[] {
  const corner: [number, number] = [-54, 46];
  return UNITS.flatMap((of, i) => {
    const [x, y] = flat(scaled(of, 16));
    const text = element("text", { x: String(corner[0] + x * 1.45 - 3), y: String(corner[1] + y * 1.45 + 3) });
    text.textContent = "XYZ"[i] ?? "";
    const d = `M${corner.join(" ")}l${x} ${y}`;
    return [element("path", { d, class: "triad" }), text];
  });
}

/** A line, with a head where it is an arrow. */
function drawn(points: Vec3[], motion: Motion, kind: string): SVGElement {
  const list = points.map((point) => flat(motion(point)));
  const d = list.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
  return element("path", { d: kind === "arrow" ? d + head(list) : d, class: kind });
}

function head(list: [number, number][]): string {
  const [[x0, y0], [x, y]] = [list.at(-2) ?? [0, 0], list.at(-1) ?? [0, 0]];
  const angle = Math.atan2(y - y0, x - x0);
  const barb = (by: number) =>
    `${(x - 8 * Math.cos(angle + by)).toFixed(1)} ${(y - 8 * Math.sin(angle + by)).toFixed(1)}`;
  return `M${barb(0.45)}L${x.toFixed(1)} ${y.toFixed(1)}L${barb(-0.45)}`;
}

function flat(point: Vec3): [number, number] {
  const sum = (k: 0 | 1) => point.reduce((total, value, i) => total + value * (RIGHT[i]?.[k] ?? 0), 0);
  return [sum(0), sum(1)];
}

function turned(point: Vec3, about: Vec3, angle: number): Vec3 {
  const parallel = scaled(about, dot(point, about));
  const rest = add(point, scaled(parallel, -1));
  return add(parallel, add(scaled(rest, Math.cos(angle)), scaled(cross(about, rest), Math.sin(angle))));
}

function element(tag: string, attributes: Record<string, string>): SVGElement {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}
