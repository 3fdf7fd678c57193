/** The first thing a review looks at: the 95 % value, its band, and whether it is within the limit. */

import type { Work } from "../evaluator/types";
import { type Findings, isSettled, type State } from "../session";
import { make } from "../ui/dom";
import { move, place } from "../ui/address";
import { counted, difference, figure, pair, rounded } from "./number";

/** The figure that decides, with the interval that is known of it. */
export interface Deciding {
  value: number;
  band: [number, number] | null;
  /** What it is, in a sentence. */
  words: string;
  /** Where the interval comes from; empty without one. */
  source: string;
  /** Number of poses of which the worst counts, where others of the volume may be worse. */
  worstOf?: number;
}

/** Of a machine that is measured the 95 % value over the volume; of one that is only bounded that of the budget. */
export function deciding(of: Findings): Deciding | null {
  if (of.map && of.sources?.errors.length) return measured(of.map);
  const drawn = of.budget?.position_um.monte_carlo.percentiles["p95"];
  if (!drawn || !of.budget) return null;
  return {
    value: drawn.value,
    band: [drawn.low, drawn.high],
    words: `95 of 100 machines built to these tolerances deviate less than this, ${STATISTICS[of.budget.statistic]?.(counted(of.budget.poses)) ?? of.budget.statistic}. Nothing of this machine is measured.`,
    source: `interval of ${counted(of.budget.samples)} drawn machines, at these poses`,
    ...(of.budget.statistic === "max" ? { worstOf: of.budget.poses } : {}),
  };
}

/** Of a number of poses of the volume: its corners, and random ones. */
const STATISTICS: Record<string, (poses: string) => string> = {
  max: (poses) => `at the worst of ${poses} poses in the volume, corners and random ones`,
  p95: (poses) => `at 95 % of ${poses} poses in the volume, corners and random ones`,
  rms: (poses) => `in the root mean square over ${poses} poses in the volume, corners and random ones`,
  mean: (poses) => `on average over ${poses} poses in the volume, corners and random ones`,
};

function measured(map: NonNullable<Findings["map"]>): Deciding {
  const band = map.uncertainty?.position_um.p95 ?? null;
  return {
    value: map.position_um.p95,
    band,
    words: `95 % of ${counted(map.poses)} random poses in the volume deviate less than this: functional point, actual minus nominal, in machine coordinates.`,
    source: band
      ? "interval by the uncertainties of the file, at these poses; other poses differ"
      : "The file states no uncertainties, so no interval is known.",
  };
}

export class Verdict {
  /** The figures over the part, above those over the volume. */
  readonly job = make("div", { id: "job" });

  constructor(private readonly parent: HTMLElement) {}

  /** The part is another one; null without one. */
  over(work: Work | null): void {
    this.job.replaceChildren(...(work ? overJob(work) : []));
  }

  show(state: State): void {
    this.job.classList.toggle("stale", !isSettled(state));
    const now = state.now && deciding(state.now);
    if (!now) return this.parent.replaceChildren(this.job, ...this.nothing(state));
    const kept = state.kept && deciding(state.kept);
    const band = now.band
      ? make("p", { class: "band" }, `${rounded(now.band[0])} to ${rounded(now.band[1])} µm: ${now.source}`)
      : make("p", { class: "band" }, now.source);
    this.parent.classList.toggle("stale", state.stale);
    const title = "Error of the machine over its volume";
    this.parent.replaceChildren(
      this.job,
      make("h2", {}, state.stale ? `${title}, before the last edit` : title),
      make(
        "p",
        { class: "headline" },
        figure("p95", now.value, "µm"),
        " ",
        difference(pair(now.value, kept?.value), "µm"),
      ),
      make("p", { class: "words" }, now.words + draft(state)),
      band,
      this.limit(now),
    );
  }

  private nothing(state: State): HTMLElement[] {
    const code = (words: string) => make("code", {}, words);
    const words = state.stale
      ? ["The file is refused: see the marks in the editor."]
      : [
          "No error has a value or a bound. Write some under ",
          ...[
            code("errors"),
            " or ",
            code("tolerances"),
            ", or take those of a class: ",
            code("class: production"),
            ".",
          ],
        ];
    return [make("h2", {}, "Error of the machine"), make("p", { class: "words" }, ...words)];
  }

  /** Pass or fail against the limit in the address. */
  private limit(of: Deciding): HTMLElement {
    const input = make("input", {
      type: "number",
      min: "0",
      step: "any",
      id: "limit",
      value: place().limit,
      placeholder: "none",
    });
    const answer = make("strong", {});
    const judge = () => {
      const limit = Number(input.value);
      const known = input.value !== "" && limit > 0;
      answer.textContent = known ? verdict(of, limit) : "";
      answer.className = known ? `verdict-${verdict(of, limit).split(/[ ,]/)[0]?.toLowerCase()}` : "";
    };
    input.addEventListener("input", () => {
      move({ limit: input.value });
      judge();
    });
    judge();
    return make(
      "p",
      { class: "limit" },
      make("label", { for: "limit" }, "Limit over the volume"),
      input,
      " µm ",
      answer,
    );
  }
}

/** The figure over the part, with the verdict of the limit that its job states. */
function overJob({ map, over, limit }: Work): HTMLElement[] {
  const drawn = map.bounds?.position_um.monte_carlo.p95;
  const held = map.limit?.held;
  const verdict = held ? "passes" : held === false ? "fails" : "open";
  const judged = limit
    ? [make("strong", { class: `verdict-${verdict}`, id: "job-limit" }, inMicrometres(limit)), " "]
    : [];
  const of = drawn === undefined ? " at most over the job. " : " or less over the job on 95 % of machines. ";
  const value = figure("job", drawn ?? map.position_um.max, "µm");
  return [make("p", { class: "words", id: "job-over", title: over }, make("strong", {}, value), of, ...judged)];
}

/** A sentence of the program with the unit as the page writes it, and a capital letter. */
function inMicrometres(words: string): string {
  return words.charAt(0).toUpperCase() + words.slice(1).replaceAll(" um", " µm");
}

/** What is only a draft says so. */
function draft({ effort, now }: State): string {
  if (!effort.isReduced) return "";
  return now?.map?.from === "bounds" ? ` Draft: ${effort.samples} drawn machines.` : ` Draft: ${effort.poses} poses.`;
}

/** A limit within the band decides nothing. */
export function verdict(of: Deciding, limit: number): string {
  const [low, high] = of.band ?? [of.value, of.value];
  const poses = of.worstOf ? ` at these ${counted(of.worstOf)} poses; others may be worse` : "";
  if (high <= limit) return `Passes by ${rounded(limit - of.value)} µm${poses}`;
  if (low > limit) return `Fails by ${rounded(of.value - limit)} µm`;
  return "Open: the limit lies within the band";
}
