/** The path of a part is played: the machine moves from row to row, and each row says its deviation and the axes that
 * make it. Between rows the axes are drawn on straight lines; figures are of rows alone. */

import type { PlayedRow, Pose, Vec3, Work, WorkRow } from "../evaluator/types";
import { button, make } from "../ui/dom";
import { bare, named, quantity, rounded } from "../units";

/** A row at its place of the way. */
export interface Stop {
  row: WorkRow;
  axes: Pose;
  played: PlayedRow | undefined;
  /** Way of the tip up to here, mm; a turn in place counts a mm for each degree. */
  at: number;
}

/** An event of the path, in words. */
export interface Mark {
  kind: "rewind" | "pole";
  at: number;
  words: string;
}

/** Way of the tip in a second at speed 1, mm: 3 m/min. */
const FEED = 50;

/** Axes that are named at a row, at most. */
const NAMED = 3;

/** The reached rows along the way. */
export function stops(work: Work): Stop[] {
  const tips = new Map(work.tips.map(({ line, tip_mm }) => [line, tip_mm]));
  const played = new Map(work.played.map((row) => [row.line, row]));
  const list: Stop[] = [];
  let before: { tip: Vec3; axes: Pose } | null = null;
  let at = 0;
  for (const row of work.rows.poses) {
    const [tip, axes] = [tips.get(row.line), row.axes];
    if (!axes || !tip) continue;
    // No more digits than a slider keeps.
    if (before) at = Number((at + way(before, { tip, axes })).toFixed(6));
    list.push({ row, axes, played: played.get(row.line), at });
    before = { tip, axes };
  }
  return list;
}

function way(from: { tip: Vec3; axes: Pose }, to: { tip: Vec3; axes: Pose }): number {
  const distance = Math.hypot(...to.tip.map((x, i) => x - (from.tip[i] ?? 0)));
  if (distance > 0) return distance;
  return Math.max(...Object.entries(to.axes).map(([axis, q]) => Math.abs(q - (from.axes[axis] ?? 0))), 1e-5);
}

/** The number of the last stop at or before a place of the way. */
export function stopAt(list: Stop[], at: number): number {
  let [low, high] = [0, list.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if ((list[middle]?.at ?? Infinity) <= at) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** The axes at a place of the way, on a straight line between two rows. */
export function poseAt(list: Stop[], at: number): Pose {
  const k = stopAt(list, at);
  const [here, next] = [list[k], list[k + 1]];
  if (!here) return {};
  if (!next || at <= here.at) return here.axes;
  const share = Math.min((at - here.at) / (next.at - here.at), 1);
  const between = ([axis, q]: [string, number]) => [axis, q + ((next.axes[axis] ?? q) - q) * share] as const;
  return Object.fromEntries(Object.entries(here.axes).map(between));
}

/** Rewinds and poles along the way. */
export function marks(work: Work, list: Stop[]): Mark[] {
  const at = new Map(list.map((stop) => [stop.row.line, stop.at]));
  const { rewinds = [], pole_crossings = [] } = work.map.path ?? {};
  const rewind = rewinds.map(({ lines: [from, to], turns_deg }): Mark => {
    const turns = Object.entries(turns_deg).map(([axis, deg]) => `${axis} ${rounded(deg)}°`);
    return {
      kind: "rewind",
      at: at.get(to) ?? 0,
      words: `rewind between lines ${from} and ${to}: ${turns.join(", ")}`,
    };
  });
  const pole = pole_crossings.map(({ axis, nearest_line, nearest_deg }): Mark => {
    const words = `pole of ${axis} at line ${nearest_line}, ${rounded(nearest_deg)}° away`;
    return { kind: "pole", at: at.get(nearest_line) ?? 0, words };
  });
  return [...rewind, ...pole].sort((a, b) => a.at - b.at);
}

export class Player {
  readonly body = make("div", { id: "player", role: "group", "aria-label": "The path, played" });
  private readonly slider = make("input", {
    type: "range",
    id: "play-at",
    min: "0",
    step: "any",
    "aria-label": "Place along the path",
  });
  private readonly speed = make(
    "select",
    { id: "play-speed", "aria-label": "Speed" },
    ...[1, 3, 10, 30].map((times) => make("option", { value: String(times) }, `${times} ×`)),
  );
  private readonly toggle = button("Play", () => this.turn(), { id: "play", class: "primary" });
  private readonly words = make("p", { id: "play-words", "aria-live": "off" });
  private readonly track = make("div", { class: "marks" });
  private list: Stop[] = [];
  private events: Mark[] = [];
  private isBounded = false;
  private running = 0;
  private last = 0;

  /** `stand` puts the machine at a pose, with `true` where it rests. */
  constructor(private readonly stand: (pose: Pose, rests: boolean) => void) {
    this.slider.addEventListener("input", () => (this.pause(), this.stands(false)));
    this.slider.addEventListener("change", () => this.stands(true));
    this.clear();
  }

  clear(): void {
    this.pause();
    this.list = [];
    this.body.replaceChildren();
  }

  show(work: Work): void {
    this.pause();
    const before = JSON.stringify(this.list.map(({ axes }) => axes));
    this.list = stops(work);
    if (this.list.length < 2) return this.clear();
    this.events = marks(work, this.list);
    this.isBounded = !work.played.length;
    const length = this.list.at(-1)?.at ?? 0;
    this.slider.max = String(length);
    if (JSON.stringify(this.list.map(({ axes }) => axes)) !== before) this.slider.value = "0";
    this.track.replaceChildren(...this.events.map((of) => this.mark(of, length)));
    const row = make("p", { class: "play" }, this.toggle, this.step(-1), this.step(1), this.speed);
    const line = make("div", { class: "line" }, this.slider, this.track);
    const note = make("p", { class: "words" }, this.note(work));
    this.body.replaceChildren(make("h2", {}, "The path, row by row"), row, line, this.words, note);
    this.tell();
  }

  private note(work: Work): string {
    const single = work.map.path ? "" : " The tool poses are single ones: the way between them is not theirs.";
    const normal = this.list.some(({ played }) => played?.has_normal)
      ? ""
      : " The file states no normals: across is along the tool.";
    return `No collision test: bodies are drawn, not compared.${single}${this.isBounded ? "" : normal}`;
  }

  private mark({ kind, at, words }: Mark, length: number): HTMLElement {
    const mark = button("", () => ((this.slider.value = String(at)), this.stands(true)), {
      class: kind,
      title: words,
      "aria-label": words,
    });
    mark.style.left = `${(100 * at) / (length || 1)}%`;
    return mark;
  }

  private step(by: 1 | -1): HTMLElement {
    const go = () => {
      this.pause();
      const at = Number(this.slider.value);
      const k = stopAt(this.list, at);
      const to = by < 0 && at > (this.list[k]?.at ?? 0) ? k : Math.min(Math.max(k + by, 0), this.list.length - 1);
      this.slider.value = String(this.list[to]?.at ?? 0);
      this.stands(true);
    };
    const words = by > 0 ? "Next row" : "Row before";
    return button(by > 0 ? "›" : "‹", go, {
      id: by > 0 ? "play-next" : "play-before",
      "aria-label": words,
      title: words,
    });
  }

  private turn(): void {
    if (this.running) return this.pause();
    if (Number(this.slider.value) >= Number(this.slider.max)) this.slider.value = "0";
    this.toggle.textContent = "Pause";
    this.last = performance.now();
    this.running = requestAnimationFrame((now) => this.frame(now));
  }

  private pause(): void {
    if (!this.running) return;
    cancelAnimationFrame(this.running);
    this.running = 0;
    this.toggle.textContent = "Play";
    this.stands(true);
  }

  private frame(now: number): void {
    const by = (Math.max(now - this.last, 0) / 1000) * FEED * Number(this.speed.value);
    this.last = now;
    const end = Number(this.slider.max);
    const at = Math.min(Number(this.slider.value) + by, end);
    this.slider.value = String(at);
    if (at >= end || !this.body.isConnected) return this.pause();
    this.stands(false);
    this.running = requestAnimationFrame((next) => this.frame(next));
  }

  private stands(rests: boolean): void {
    this.stand(poseAt(this.list, Number(this.slider.value)), rests);
    this.tell();
  }

  /** The row that was passed last: its deviation, and the axes that make it. */
  private tell(): void {
    const at = Number(this.slider.value);
    const stop = this.list[stopAt(this.list, at)];
    if (!stop) return;
    const { row, played } = stop;
    const where = `Line ${row.line}${row.feature ? `, ${row.feature}` : ""}`;
    const near = this.events.filter((of) => of.at === stop.at).map(({ words }) => `; ${words}`);
    this.slider.setAttribute("aria-valuetext", where);
    this.words.dataset["line"] = String(row.line);
    this.words.textContent = `${where}: ${deviation(row, played)}${near.join("")}.`;
  }
}

function deviation(row: WorkRow, played: PlayedRow | undefined): string {
  if (!played) return `95 % of machines within ${quantity(row.position_um?.p95 ?? 0)}; bounds have no direction`;
  const { across_um, along_um, axes } = played;
  const parts = Object.entries(axes).slice(0, NAMED);
  const more = Object.keys(axes).length > NAMED ? ", …" : "";
  const by = parts.map(([axis, um]) => `${axis} ${bare(um)}`).join(", ");
  const made = parts.length ? `; by axis, along it: ${by}${more} ${named("um")}` : "";
  return `${quantity(across_um)} across the surface, ${quantity(along_um)} along it${made}`;
}
