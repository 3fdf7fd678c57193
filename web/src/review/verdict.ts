/** The first thing a review looks at: the figure over the job or the volume, its band, and whether it is within the
 * limit. */

import type { ReferenceKind } from "../evaluator/results";
import type { Over } from "../evaluator/types";
import type { Findings, State } from "../session";
import { button, make } from "../ui/dom";
import { move, place } from "../ui/address";
import { counted, difference, figure, pair } from "./number";
import { between, fromField, named, quantity, said, toField } from "../units";

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
  /** Why no limit is held, whatever the figure: in words. */
  undecided?: string;
  /** The limit that the job states, um, with the verdict of the program. */
  limit?: { um: number; held: boolean | null };
}

/** What figures are over, in few words. */
export function scopeOf(over: Over | undefined): string {
  if (over?.kind !== "job") return "over the volume";
  const poses = `${over.reached < over.poses ? `${counted(over.reached)} of ` : ""}${counted(over.poses)}`;
  return `over the job: ${poses} tool poses, ${referenceOf(over)}`;
}

/** True for figures over a job. */
export const isOverJob = (of: Findings | null): boolean => of?.map?.over.kind === "job";

function referenceOf({ reference, minimum_zone }: Over): string {
  const words: Record<ReferenceKind, string> = {
    machine: "machine coordinates",
    "machine-less-unheld": "machine coordinates less what is not held",
    zero: "zero",
    "zero-less-unheld": "zero, less rotations that are not held",
    datum: "datum",
    "best-fit": "best fit",
  };
  return minimum_zone ? "minimum zone" : words[reference];
}

/** Over a job the figure that its limit judges: the largest deviation, of machines that are drawn that of 95 % of them. */
function ofJob({ map, budget }: Findings & { map: NonNullable<Findings["map"]> }): Deciding | null {
  const { limit, over } = map;
  const missed = over.poses - over.reached;
  const undecided = missed ? { undecided: `${missed} of ${over.poses} tool poses are out of reach` } : {};
  const p95 = budget?.position_um.monte_carlo.percentiles["p95"];
  const drawn = limit ? limit.drawn : (map.from === "bounds" || !!map.bounds_add) && !!p95;
  const judged = limit ? { limit: { um: limit.limit_um, held: limit.held } } : {};
  if (drawn) {
    const value = limit?.um ?? p95?.value;
    if (value === undefined) return null;
    const band = limit ? (limit.interval_um ?? null) : p95 ? ([p95.low, p95.high] as [number, number]) : null;
    const words = "95 of 100 machines built to these tolerances stay within this at every tool pose of the job.";
    const source = `interval of ${counted(budget?.samples ?? 0)} drawn machines, at all tool poses of the job`;
    return { value, band, words, source, ...undecided, ...judged };
  }
  const band = limit ? limit.interval_um : map.uncertainty?.position_um.max;
  return {
    value: limit?.um ?? map.position_um.max,
    band: band ?? null,
    words: "Largest deviation at the tool poses of the job: functional point, actual minus nominal.",
    source: band
      ? "interval by the uncertainties of the file"
      : "The file states no uncertainties, so no interval is known.",
    ...undecided,
    ...judged,
  };
}

/** Over a job what its limit judges. Over the volume, of a machine that is measured, the value that 95 % of poses keep;
 * of one that is only bounded that of the budget. */
export function deciding(of: Findings): Deciding | null {
  const { map, sources, budget } = of;
  if (map && isOverJob(of)) return sources?.errors.length || budget ? ofJob({ ...of, map }) : null;
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
  const stated = map.uncertainty?.position_um.p95 ?? null;
  const value = map.position_um.p95;
  // The poses are some of the volume: others have another value.
  const { low, high } = map.p95_over_volume ?? {};
  const [less, more] = [Math.min(0, (low ?? value) - value), Math.max(0, (high ?? value) - value)];
  const [from, to] = stated ?? [value, value];
  const isKnown = stated !== null || (typeof low === "number" && typeof high === "number");
  return {
    value,
    band: isKnown ? [Math.max(0, from + less), to + more] : null,
    words: `95 % of ${counted(map.poses)} random poses in the volume deviate less than this: functional point, actual minus nominal, in machine coordinates.`,
    source: stated
      ? "interval by the uncertainties of the file and by the choice of poses"
      : isKnown
        ? "interval by the choice of poses; the file states no uncertainties"
        : "The file states no uncertainties, so no interval is known.",
  };
}

export class Verdict {
  private last: State | null = null;

  constructor(
    private readonly parent: HTMLElement,
    /** True if there is a part besides the volume. */
    private readonly hasPart: () => boolean,
    /** Hears that figures are to be over the other one. */
    private readonly turned: () => void,
  ) {}

  /** There is a part, or none. */
  again(): void {
    if (this.last) this.show(this.last);
  }

  show(state: State): void {
    this.last = state;
    const now = state.now && deciding(state.now);
    if (!now) return this.parent.replaceChildren(...this.scope(), ...this.nothing(state));
    const kept = state.kept && deciding(state.kept);
    const band = now.band
      ? make("p", { class: "band" }, `${between(now.band)}: ${now.source}`)
      : make("p", { class: "band" }, now.source);
    this.parent.classList.toggle("stale", state.stale);
    const title = `Error ${scopeOf(state.now?.map?.over)}`;
    this.parent.replaceChildren(
      ...this.scope(),
      make("h2", { id: "scope" }, state.stale ? `${title}, before the last edit` : title),
      make(
        "p",
        { class: "headline" },
        figure(isOverJob(state.now) ? "job" : "p95", now.value, "µm"),
        " ",
        difference(pair(now.value, kept?.value), "µm"),
      ),
      make("p", { class: "words" }, now.words + draft(state)),
      band,
      this.limit(now),
    );
  }

  /** The switch between job and volume, where there is a job. */
  private scope(): HTMLElement[] {
    if (!this.hasPart()) return [];
    const isVolume = place().over === "volume";
    const one = (words: string, over: string, id: string) =>
      button(words, () => (move({ over }), this.turned()), {
        id,
        "aria-pressed": String((over === "volume") === isVolume),
      });
    return [make("p", { class: "choice" }, one("Job", "", "over-job"), one("Volume", "volume", "over-volume"))];
  }

  private nothing(state: State): HTMLElement[] {
    const code = (words: string) => make("code", {}, words);
    const refused = state.now?.refused ?? [];
    if (refused.length && !state.stale)
      return [
        make("h2", {}, "No figure over the job"),
        ...refused.map((reason) => make("p", { class: "refused" }, said(`${reason}.`))),
      ];
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

  /** Pass or fail of the headline against the limit in the address, or else that of the job. */
  private limit(of: Deciding): HTMLElement {
    const input = make("input", {
      type: "number",
      min: "0",
      step: "any",
      id: "limit",
      value: toField(place().limit),
      placeholder: of.limit ? toField(String(of.limit.um)) : "none",
    });
    const answer = make("strong", {});
    const judge = () => {
      const found = verdict(of, fromField(input.value));
      answer.textContent = found;
      answer.className = found ? `verdict-${found.split(/[ :,]/)[0]?.toLowerCase()}` : "";
    };
    input.addEventListener("input", () => {
      move({ limit: fromField(input.value) });
      judge();
    });
    judge();
    return make("p", { class: "limit" }, make("label", { for: "limit" }, "Limit"), input, ` ${named("um")} `, answer);
  }
}

/** What is only a draft says so. */
function draft({ effort, now }: State): string {
  if (!effort.isReduced) return "";
  return now?.map?.from === "bounds" ? ` Draft: ${effort.samples} drawn machines.` : ` Draft: ${effort.poses} poses.`;
}

/** The verdict on the limit that is typed (um), or else on that of the job; empty without one. A limit within the band
 * decides nothing. */
export function verdict(of: Deciding, typed: string): string {
  const own = of.limit;
  const limit = typed === "" && own ? own.um : Number(typed);
  if (!(limit > 0)) return "";
  const [low, high] = of.band ?? [of.value, of.value];
  const fails = `Fails by ${quantity(of.value - limit)}`;
  if (own && limit === own.um) {
    if (own.held === false) return fails;
    if (own.held === null && high <= limit)
      return `Open: ${of.undecided ?? "errors without value or bound, or left out, could turn it"}`;
  }
  const poses = of.worstOf ? ` at these ${counted(of.worstOf)} poses; others may be worse` : "";
  if (low > limit) return fails;
  if (high > limit) return "Open: the limit lies within the band";
  return of.undecided ? `Open: ${of.undecided}` : `Passes by ${quantity(limit - of.value)}${poses}`;
}
