/** The pose: a slider for each axis, and the way to a pose as an animation. */

import { type Axis, type Chain, geometry, type Pose } from "../evaluator/types";
import { button, make } from "../ui/dom";
import { move, place } from "../ui/address";
import { position as asRead } from "../units";

/** Time of the way to a pose, ms; none for who asked for less motion. */
const WAY = 1400;

export class AxisSliders {
  pose: Pose = {};
  private axes: Axis[] = [];
  private known = "";
  private inputs = new Map<string, HTMLInputElement>();
  private running = 0;

  /** `moved` hears of each step, with `true` for the last one. */
  constructor(
    private readonly parent: HTMLElement,
    buttons: HTMLElement,
    private readonly moved: (pose: Pose, rests: boolean) => void,
    private readonly chosen: (axis: string) => void,
  ) {
    buttons.append(button("Zero pose", () => this.go(this.zero()), { id: "zero" }));
  }

  /** Shows the axes of a machine; positions beyond a travel come to its end. */
  show(chain: Chain): void {
    const shown = geometry(chain);
    if (shown === this.known) return;
    this.known = shown;
    if (!this.axes.length) this.pose = parsed(place().pose);
    this.axes = chain.axes;
    this.pose = Object.fromEntries(this.axes.map((axis) => [axis.name, within(axis, this.pose[axis.name] ?? 0)]));
    this.inputs.clear();
    this.parent.replaceChildren(...this.axes.map((axis) => this.row(axis)));
    this.shown();
  }

  /** Moves to a pose, visibly. */
  go(pose: Pose): void {
    cancelAnimationFrame(this.running);
    const from = { ...this.pose };
    const start = performance.now();
    const way = matchMedia("(prefers-reduced-motion: reduce)").matches ? 1 : WAY;
    const step = (now: number) => {
      const t = Math.min(Math.max((now - start) / way, 0), 1);
      const share = t * t * (3 - 2 * t);
      for (const axis of this.axes) {
        const [a, b] = [from[axis.name] ?? 0, pose[axis.name] ?? 0];
        this.pose[axis.name] = t === 1 ? b : a + (b - a) * share;
      }
      this.shown();
      this.moved(this.pose, t === 1);
      if (t < 1) this.running = requestAnimationFrame(step);
      else this.remember();
    };
    step(start);
  }

  /** Stands at a pose at once; the address keeps it when it rests. */
  stand(pose: Pose, rests: boolean): void {
    cancelAnimationFrame(this.running);
    for (const axis of this.axes) this.pose[axis.name] = pose[axis.name] ?? 0;
    this.shown();
    this.moved(this.pose, rests);
    if (rests) this.remember();
  }

  private zero(): Pose {
    return Object.fromEntries(this.axes.map((axis) => [axis.name, within(axis, 0)]));
  }

  private row(axis: Axis): HTMLElement {
    const [min, max] = axis.travel;
    const id = `axis-${axis.name}`;
    const input = make("input", { type: "range", id, min: String(min), max: String(max), step: "any" });
    input.addEventListener("input", () => this.set(axis, Number(input.value), false));
    input.addEventListener("change", () => this.set(axis, Number(input.value), true));
    input.addEventListener("focus", () => this.chosen(axis.name));
    input.addEventListener("blur", () => this.chosen(""));
    this.inputs.set(axis.name, input);
    const ends = axis.continuous ? "turns without end" : `${asRead(min, axis.unit, 4)} to ${asRead(max, axis.unit, 4)}`;
    return make(
      "div",
      { class: "axis-row", title: `${axis.name}: ${ends}` },
      make("label", { for: id }, axis.name),
      input,
      make("output", { for: id }),
    );
  }

  /** Moves one axis, and marks it as the one at hand until it rests. */
  drag(axis: Axis, position: number, rests: boolean): void {
    this.chosen(rests ? "" : axis.name);
    this.set(axis, position, rests);
  }

  private set(axis: Axis, position: number, rests: boolean): void {
    cancelAnimationFrame(this.running);
    this.pose[axis.name] = position;
    this.shown();
    this.moved(this.pose, rests);
    if (rests) this.remember();
  }

  private shown(): void {
    for (const axis of this.axes) {
      const input = this.inputs.get(axis.name);
      const position = this.pose[axis.name] ?? 0;
      if (!input) continue;
      input.value = String(position);
      const text = asRead(position, axis.unit);
      input.setAttribute("aria-valuetext", text);
      if (input.nextElementSibling) input.nextElementSibling.textContent = text;
    }
  }

  private remember(): void {
    const entries = Object.entries(this.pose).filter(([, position]) => position !== 0);
    move({ pose: entries.map(([name, position]) => `${name}=${Number(position.toFixed(4))}`).join(",") });
  }
}

function within(axis: Axis, position: number): number {
  if (axis.continuous) return position;
  return Math.min(Math.max(position, axis.travel[0]), axis.travel[1]);
}

function parsed(text: string): Pose {
  const pairs = text.split(",").map((part) => part.split("="));
  return Object.fromEntries(
    pairs.map(([name, value]) => [name ?? "", Number(value)]).filter(([name, value]) => name && Number.isFinite(value)),
  );
}
