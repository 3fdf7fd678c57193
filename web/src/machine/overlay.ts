/** What stands over the picture in letters: names of axes, X Y Z of the machine, a scale, and lever arms on demand. */

import * as three from "three";
import type { Axis, Vec3 } from "../evaluator/types";
import { make } from "../ui/dom";
import { position, roundLength } from "../units";
import type { Figure } from "./figure";
import { across, along, dot, foot, minus, norm, scaled } from "./vectors";

const [SVG, TRIAD, ARM, ROW] = ["http://www.w3.org/2000/svg", 84, 26, 15];

/** Colours of X, Y and Z that are told apart without red and green. */
const COLOURS = ["#0072b2", "#b8480a", "#6b5b00"];

/** Words at a place of the machine. */
interface Note {
  at: Vec3;
  words: string;
  kind: "axis" | "arm";
}

export class Overlay {
  /** True if lever arms and distances of pivots have their lengths. */
  hasArms = false;
  private readonly notes = make("div", { class: "notes", "aria-hidden": "true" });
  private readonly triad = document.createElementNS(SVG, "svg");
  private readonly scale = make("div", { class: "scale-bar", "aria-hidden": "true" });

  constructor(parent: HTMLElement) {
    for (const [name, value] of Object.entries({
      class: "triad",
      viewBox: `0 0 ${TRIAD} ${TRIAD}`,
      "aria-hidden": "true",
    }))
      this.triad.setAttribute(name, value);
    parent.append(this.notes, this.triad, this.scale);
  }

  /** Draws it for a camera; `pixel` is the length of one in the middle, mm. */
  draw(figure: Figure, camera: three.Camera, width: number, height: number, pixel: number): void {
    const taken: [number, number, number][] = [];
    const list = [...names(figure), ...(this.hasArms ? arms(figure) : [])];
    this.notes.replaceChildren(
      ...list.flatMap(({ at, words, kind }) => {
        const { x, y, z } = new three.Vector3(...at).project(camera);
        if (z > 1 || Math.abs(x) > 1 || Math.abs(y) > 1) return [];
        const span = make("span", { class: kind }, words);
        const half = 4 * words.length + 6;
        const left = (0.5 + x / 2) * width;
        let top = (0.5 - y / 2) * height;
        // No name stands on another one.
        while (taken.some(([l, t, h]) => Math.abs(l - left) < h + half && Math.abs(t - top) < ROW)) top += ROW / 3;
        taken.push([left, top, half]);
        [span.style.left, span.style.top] = [`${left.toFixed(1)}px`, `${top.toFixed(1)}px`];
        return [span];
      }),
    );
    this.directions(camera);
    const { mm, words } = roundLength(170 * pixel);
    this.scale.textContent = words;
    this.scale.style.width = `${(mm / pixel).toFixed(1)}px`;
  }

  /** X, Y and Z of the machine as the camera sees them. */
  private directions(camera: three.Camera): void {
    const middle = TRIAD / 2;
    const ends = [0, 1, 2].map((k) =>
      new three.Vector3().setComponent(k, 1).transformDirection(camera.matrixWorldInverse),
    );
    const part = (name: string, attributes: Record<string, string | number>, words = "") => {
      const made = document.createElementNS(SVG, name);
      for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
      made.textContent = words;
      return made;
    };
    this.triad.replaceChildren(
      ...ends.flatMap(({ x, y }, k) => {
        const [to, from] = [middle + ARM * x, middle - ARM * y];
        const colour = COLOURS[k] ?? "";
        const far = { x: middle + 1.38 * ARM * x, y: middle - 1.38 * ARM * y + 4 };
        return [
          part("path", {
            d: `M${middle} ${middle}L${to.toFixed(1)} ${from.toFixed(1)}`,
            stroke: colour,
            "stroke-width": 2.4,
          }),
          part("text", { ...far, fill: colour, "text-anchor": "middle" }, "XYZ"[k]),
        ];
      }),
    );
  }

  /** Writes the names and lengths onto a copy of the picture, as paper has it. */
  print(brush: CanvasRenderingContext2D, ratio: number): void {
    brush.font = `600 ${13 * ratio}px "DejaVu Sans", Helvetica, Arial, sans-serif`;
    brush.textAlign = "center";
    for (const of of this.notes.children as HTMLCollectionOf<HTMLElement>)
      brush.fillText(of.textContent ?? "", ratio * parseFloat(of.style.left), ratio * (parseFloat(of.style.top) + 4));
    const [right, low] = [brush.canvas.width - 14 * ratio, brush.canvas.height - 14 * ratio];
    const long = ratio * parseFloat(this.scale.style.width);
    brush.fillRect(right - long, low, long, 2 * ratio);
    brush.fillText(this.scale.textContent ?? "", right - long / 2, low - 6 * ratio);
  }
}

/** Each axis by its name: a linear one at its body, a rotary one at the end of its line. */
function names(figure: Figure): Note[] {
  const { chain, table, size } = figure.layout;
  return chain.axes.map((axis) => {
    const { origin, direction } = figure.line(axis);
    const end = along(origin, direction, (axis.side === "tool" ? -1 : 1) * (1.5 * table + size));
    return { at: axis.kind === "rotary" ? end : figure.middle(axis), words: axis.name, kind: "axis" };
  });
}

/** The arm of each rotary axis to the tip of the tool, and the distances of neighbouring pivots, mm. */
function arms(figure: Figure): Note[] {
  const { tip, layout } = figure;
  const rotary = [layout.workpiece, layout.tool].map((side) => side.filter(({ kind }) => kind === "rotary"));
  const length = (mm: number) => position(mm, "mm", 2);
  const arm = (axis: Axis): Note => {
    const { origin, direction } = figure.line(axis);
    const centre = foot(tip, origin, direction);
    const words = `${axis.name} arm ${length(norm(minus(tip, centre)))}`;
    return { at: halfway(tip, centre), words, kind: "arm" };
  };
  const between = (one: Axis, other: Axis): Note => {
    const [a, b] = [figure.line(one), figure.line(other)];
    const gap = minus(b.origin, a.origin);
    // Across both lines; of parallel ones across one.
    const normal = new three.Vector3(...a.direction).cross(new three.Vector3(...b.direction));
    const mm =
      normal.length() > 1e-9 ? Math.abs(dot(gap, normal.normalize().toArray())) : norm(across(gap, a.direction));
    return { at: halfway(a.origin, b.origin), words: `${one.name} to ${other.name} ${length(mm)}`, kind: "arm" };
  };
  const pairs = rotary.flatMap((side) => side.slice(1).map((axis, i) => between(side[i] ?? axis, axis)));
  return [...rotary.flat().map(arm), ...pairs];
}

const halfway = (a: Vec3, b: Vec3): Vec3 => scaled([a[0] + b[0], a[1] + b[1], a[2] + b[2]], 0.5);
