/** Which errors dominate: bars, largest first, in plain words. A bar leads to the line of its error in the file. */

import type { Findings, State } from "../session";
import { button, make } from "../ui/dom";
import { download } from "../ui/download";
import { barChart } from "./chart";
import { difference, figure, pair } from "./number";

/** A bar of the chart. */
export interface Bar {
  error: string;
  words: string;
  um: number;
  /** Half the interval of the value, um; 0 where none is known. */
  sigma: number;
}

const FEW = 7;

/** Each error alone where errors are measured; what tightening each tolerance would gain where they are bounded. */
export function bars(of: Findings): Bar[] {
  if (of.sources?.errors.length)
    return of.sources.errors.map(({ error, words, p95_um }) => ({ error, words, um: p95_um, sigma: 0 }));
  return (of.budget?.tighten ?? []).map((entry) => ({
    error: entry.error,
    words: `bounded by ±${Number(entry.tolerance.toPrecision(4))} ${entry.unit.replace("u", "µ")}`,
    um: entry.um_of_p95,
    sigma: entry.um_of_p95_sigma,
  }));
}

export class Pareto {
  private whole = false;
  private last: State | null = null;

  /** `find` leads to an error in the file. */
  constructor(
    private readonly parent: HTMLElement,
    private readonly find: (error: string) => void,
  ) {}

  show(state: State): void {
    this.last = state;
    const list = state.now ? bars(state.now) : [];
    if (!state.now || !list.length) return this.parent.replaceChildren();
    const kept = new Map((state.kept ? bars(state.kept) : []).map((bar) => [bar.error, bar.um]));
    const most = Math.max(...list.map((bar) => bar.um), ...kept.values(), 1e-9);
    const shown = this.whole ? list : list.slice(0, FEW);
    const measured = state.now.sources?.errors.length;
    const more =
      list.length > FEW
        ? [button(this.whole ? "Show the largest only" : `Show all ${list.length}`, () => this.toggle())]
        : [];
    this.parent.classList.toggle("stale", state.stale);
    const head = measured ? "What dominates" : "What to tighten";
    const words = measured
      ? "Each error alone: 95 % of the poses deviate less."
      : "By how much the 95 % value hangs on each tolerance.";
    this.parent.replaceChildren(
      make("p", { class: "words" }, words),
      make("ol", { class: "bars" }, ...shown.map((bar) => this.bar(bar, kept.get(bar.error) ?? null, most))),
      make("p", {}, ...more, ...downloads(`${state.now.chain.machine}: ${head.toLowerCase()}`, words, list)),
    );
  }

  private toggle(): void {
    this.whole = !this.whole;
    if (this.last) this.show(this.last);
  }

  private bar(bar: Bar, kept: number | null, most: number): HTMLElement {
    const fill = make("span", { class: "fill" });
    fill.style.width = `${(100 * bar.um) / most}%`;
    const before = make("span", { class: "before" });
    before.style.left = `${(100 * (kept ?? bar.um)) / most}%`;
    before.hidden = kept === null || Math.abs(kept - bar.um) < most * 2e-3;
    const name = button(bar.error, () => this.find(bar.error), {
      class: "error-name",
      "data-error": bar.error,
    });
    const value = make(
      "span",
      { class: "value" },
      figure(`source-${bar.error}`, bar.um, "µm"),
      " ",
      difference(pair(bar.um, kept), "µm"),
    );
    return make(
      "li",
      {},
      name,
      make("span", { class: "what" }, bar.words),
      value,
      make("span", { class: "track" }, fill, before),
    );
  }
}

/** The chart as a file. */
function downloads(title: string, note: string, list: Bar[]): (Node | string)[] {
  const chart = () =>
    barChart(
      title,
      note,
      list.map(({ error, words, um }) => ({ name: error, words, um })),
    );
  const rows = list.map(({ error, words, um }) => [error, words, um]);
  const png = () => {
    const { svg, width, height } = chart();
    void download.png("errors", svg, width, height);
  };
  const files: [string, () => void][] = [
    ["CSV", () => download.csv("errors", [["error", "words", "um"], ...rows])],
    ["SVG", () => download.svg("errors", chart().svg)],
    ["PNG", png],
  ];
  return files.flatMap(([label, save]) => [" ", button(label, save, { title: `Download as ${label}` })]);
}
