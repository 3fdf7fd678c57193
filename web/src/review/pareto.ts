/** Which errors dominate: bars, largest first, in plain words. A bar leads to the line of its error in the file. */

import { Newest } from "../evaluator/newest";
import { accepted, type Axis, type Pose, type Source, type Sources } from "../evaluator/types";
import { type Findings, isSettled, type Session, type State } from "../session";
import { button, make } from "../ui/dom";
import { fileButtons } from "../ui/files";
import { barChart } from "./chart";
import { plainly } from "../explain/name";
import type { Answer, Tell } from "./answers";
import { difference, figure, pair } from "./number";
import { isOverJob, scopeOf } from "./verdict";
import { bound, position, quantity } from "../units";

/** A bar of the chart. */
export interface Bar {
  error: string;
  words: string;
  /** Its length; a part along the deviation may shorten it. */
  um: number;
  /** Half the interval of the value, um; 0 where none is known. */
  sigma: number;
}

const FEW = 7;

/** What ranks first, and below it the rest: errors with values, or bounds, of a machine that has both. */
export function bars(of: Findings): [first: Bar[], rest: Bar[]] {
  const [values, bounds] = [valued(of), bounded(of)];
  const [first, rest] = values.length && !ofMachines(of) ? [values, bounds] : [bounds, values];
  return [first, rest.filter(({ error }) => !first.some((bar) => bar.error === error))];
}

/** Each error alone, largest first. */
function valued(of: Findings): Bar[] {
  return ranked(of).map(({ error, words, ...um }) => ({ error, words, um: um[judged(of)], sigma: 0 }));
}

/** What tightening each tolerance would gain. */
function bounded(of: Findings): Bar[] {
  return (of.budget?.tighten ?? []).map((entry) => ({
    error: entry.error,
    words: `${of.words[entry.error] ?? ""} Bound: ±${bound(entry.tolerance, entry.unit)}`,
    um: entry.um_of_p95,
    sigma: entry.um_of_p95_sigma,
  }));
}

/** The figure of an error alone: as the headline, over a job the largest deviation. */
const judged = (of: Findings): "max_um" | "p95_um" => (isOverJob(of) ? "max_um" : "p95_um");

/** True where the headline is of drawn machines, bounds beside values: then the values alone do not rank. */
const ofMachines = (of: Findings): boolean => isOverJob(of) && !!of.map?.bounds_add && of.budget !== null;

/** The errors that have values, largest first. */
function ranked(of: Findings): Source[] {
  const by = judged(of);
  return [...(of.sources?.errors ?? [])].sort((a, b) => b[by] - a[by]);
}

export class Pareto {
  private whole = false;
  private last: State | null = null;
  /** True if the bars are those at the present pose. */
  private here = false;
  private pose: Pose = {};
  private there: Bar[] = [];
  private readonly asking: Newest;

  /** `find` leads to an error in the file. */
  constructor(
    private readonly parent: HTMLElement,
    private readonly find: (error: string) => void,
    private readonly session: Session,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed);
  }

  show(state: State): void {
    const isDrawn = this.last !== null && state.effort.draft && sameBars(state, this.last);
    this.last = state;
    this.tell("dominates", state.now ? dominates(state.now) : undefined);
    if (!isDrawn) this.drawn(state);
    if (isSettled(state)) this.update();
  }

  moved(pose: Pose, rests: boolean): void {
    this.pose = { ...pose };
    if (rests) this.update();
  }

  /** Asks for the parts at the present pose where they are shown. */
  private update(): void {
    const { now } = this.last ?? {};
    if (!this.here || !now?.sources?.errors.length) return;
    const at = now.chain.axes.map(({ name }) => this.pose[name] ?? 0);
    void this.asking.do(async () => {
      const [answer] = await this.session.ask([{ sources: { poses: 1, at } }]);
      const found = accepted<Sources>(answer);
      if (!found) return;
      this.there = found.errors.map(({ error, words, at_um }) => ({ error, words, um: at_um, sigma: 0 }));
      this.there.sort((a, b) => Math.abs(b.um) - Math.abs(a.um));
      if (this.last) this.drawn(this.last);
    });
  }

  private drawn(state: State): void {
    const { now, kept } = state;
    const isOfValues = !!now?.sources?.errors.length && !ofMachines(now);
    const isHere = this.here && this.there.length > 0 && isOfValues;
    const [first, rest] = now ? bars(now) : [[], []];
    const list = isHere ? this.there : first;
    if (!now || !list.length)
      return this.parent.replaceChildren(make("p", { class: "words" }, "No error has a value or a bound."));
    const [before, restBefore] = kept ? bars(kept) : [[], []];
    const longest = Math.max(list.length, rest.length);
    const more =
      longest > FEW ? [button(this.whole ? "Show the largest only" : `Show all ${longest}`, () => this.toggle())] : [];
    this.parent.classList.toggle("stale", state.stale);
    const head = isOfValues ? "What dominates" : "What to tighten";
    const words = isHere
      ? "Part of each error along the deviation at the present pose; the parts add up to it."
      : wordsOf(now, isOfValues);
    this.parent.replaceChildren(
      ...(isOfValues ? [this.choice()] : []),
      make("p", { class: "words" }, words),
      this.list(list, isHere ? [] : before),
      ...(rest.length && !isHere
        ? [make("p", { class: "words" }, wordsOf(now, !isOfValues)), this.list(rest, restBefore)]
        : []),
      make("p", { class: "files" }, ...more, ...downloads(`${now.chain.machine}: ${head.toLowerCase()}`, words, list)),
    );
  }

  private list(of: Bar[], before: Bar[]): HTMLElement {
    const kept = new Map(before.map((bar) => [bar.error, bar.um]));
    const most = Math.max(...of.map((bar) => Math.abs(bar.um)), ...kept.values(), 1e-9);
    const shown = this.whole ? of : of.slice(0, FEW);
    return make("ol", { class: "bars" }, ...shown.map((bar) => this.bar(bar, kept.get(bar.error) ?? null, most)));
  }

  private toggle(): void {
    this.whole = !this.whole;
    if (this.last) this.drawn(this.last);
  }

  /** Over the volume, or where the machine stands. */
  private choice(): HTMLElement {
    const one = (words: string, here: boolean, id: string) =>
      button(words, () => this.choose(here), { id, "aria-pressed": String(this.here === here) });
    return make(
      "p",
      { class: "choice" },
      one(isOverJob(this.last?.now ?? null) ? "Over the job" : "Over the volume", false, "all-poses"),
      one("At this pose", true, "here"),
    );
  }

  private choose(here: boolean): void {
    this.here = here;
    if (this.last) this.drawn(this.last);
    this.update();
  }

  private bar(bar: Bar, kept: number | null, most: number): HTMLElement {
    const fill = make("span", { class: "fill" });
    fill.style.width = `${(100 * Math.abs(bar.um)) / most}%`;
    fill.classList.toggle("less", bar.um < 0);
    const before = make("span", { class: "before" });
    before.style.left = `${(100 * (kept ?? Math.abs(bar.um))) / most}%`;
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

/** What the bars of errors with values, or of bounds, are. */
function wordsOf(of: Findings, areValues: boolean): string {
  const over = scopeOf(of.map?.over);
  if (!areValues) return `Part of each tolerance in what 95 % of the drawn machines keep, ${over}.`;
  const figure = isOverJob(of) ? "its largest deviation" : "95 % of the poses deviate less";
  return `Each error with a value alone, ${over}: ${figure}.`;
}

/** True if the bars of both are the same: a held slider brings each error alone less often than the map. */
function sameBars(one: State, other: State): boolean {
  const isSame = (a: Findings | null, b: Findings | null) =>
    a?.sources === b?.sources && a?.budget === b?.budget && a?.chain === b?.chain;
  return one.stale === other.stale && isSame(one.now, other.now) && isSame(one.kept, other.kept);
}

/** The largest error alone, in words, and the one that counts most at the worst pose. */
export function dominates(of: Findings): Answer | undefined {
  const { sources, map, budget, chain } = of;
  const [first] = ofMachines(of) ? [] : ranked(of);
  const named = (error: string) => make("span", { "data-error": error, tabindex: "0" }, error);
  const words = (error: string) => make("span", { "data-error": error, tabindex: "0" }, said(error, of));
  if (!first) {
    const [most] = budget?.tighten ?? [];
    if (!budget || !most) return undefined;
    const all = budget.position_um.monte_carlo.percentiles["p95"];
    const where = poseOf(chain.axes, map?.bounds?.worst[0]?.axes);
    const part = [figure("answer-first", most.um_of_p95, "µm"), all ? ` of ${quantity(all.value)}` : ""];
    return { words: words(most.error), figure: part, why: [named(most.error), where ? `; worst at ${where}.` : "."] };
  }
  const [there] = [...(sources?.errors ?? [])].sort((a, b) => Math.abs(b.at_um) - Math.abs(a.at_um));
  const size = ["makes ", figure("answer-first", first[judged(of)], "µm"), " alone"];
  if (!there) return { words: words(first.error), figure: size };
  const whole = map ? ` of ${quantity(map.position_um.max)}` : "";
  const at = poseOf(chain.axes, sources?.at);
  const why = [named(first.error), "; at the worst pose ", named(there.error), " makes "];
  return {
    words: words(first.error),
    figure: size,
    why: [...why, figure("answer-worst", there.at_um, "µm"), `${whole}${at && `: ${at}`}.`],
  };
}

/** An error in words, with its size where it is one number. */
function said(error: string, { chain, numbers }: Findings): string {
  const size = numbers[error];
  const words = plainly(error, chain);
  const by = size ? ` by ${size.bound ? "up to " : ""}${quantity(Math.abs(size.value), size.unit)}` : "";
  return words.charAt(0).toUpperCase() + words.slice(1) + by;
}

/** A pose in whole units (hundredths of an inch); empty without one. */
function poseOf(axes: Axis[], pose: Pose | undefined): string {
  const at = ({ name, unit }: Axis) => `${name} ${position(pose?.[name] ?? 0, unit, 0)}`.replaceAll(" ", "\u00a0");
  return pose ? axes.map(at).join(", ") : "";
}

/** The chart as a file. */
function downloads(title: string, note: string, list: Bar[]): HTMLElement[] {
  const bars = list.map(({ error, words, um }) => ({ name: error, words, um: Math.abs(um) }));
  const rows = list.map(({ error, words, um }) => [error, words, um]);
  const chart = () => barChart(title, note, bars);
  return fileButtons("errors", () => [["error", "words", "um"], ...rows], chart);
}
