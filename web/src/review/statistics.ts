/** Further figures, each with its difference to the kept state, and the worst poses. */

import type { Pose } from "../evaluator/types";
import type { Findings, State } from "../session";
import { button, make } from "../ui/dom";
import { folding } from "../ui/table";
import { deciding, isOverJob } from "./verdict";
import { difference, figure, pair } from "./number";

type Pick = (of: Findings) => number | undefined;

/** Name for tests, words, unit, value. */
type Row = [string, string, string, Pick];

const MEASURED: Row[] = [
  ["max", "Largest deviation of these poses", "µm", (of) => of.map?.position_um.max],
  ["rms", "Root mean square", "µm", (of) => of.map?.position_um.rms],
  ["mean", "Mean", "µm", (of) => of.map?.position_um.mean],
  ["rotation", "Rotation of the tool, 95 % of the poses", "µrad", (of) => of.map?.rotation_urad.p95],
];

/** Over a job the headline is the largest deviation. */
const ON_JOB: Row[] = [
  ["p95-job", "95 % of the tool poses", "µm", (of) => of.map?.position_um.p95],
  ["rms", "Root mean square", "µm", (of) => of.map?.position_um.rms],
  ["mean", "Mean", "µm", (of) => of.map?.position_um.mean],
  ["rotation", "Rotation of the tool, largest", "µrad", (of) => of.map?.rotation_urad.max],
];

const BOUNDED: Row[] = [
  ["rss", "Root of the sum of squares", "µm", (of) => of.budget?.position_um.rss],
  ["worst_case", "All bounds at their worst", "µm", (of) => of.budget?.position_um.worst_case],
  ["bounds_p95", "95 % of machines, at 95 % of the poses", "µm", (of) => of.map?.position_um.p95],
  ["rotation", "Rotation, 95 % of machines, at 95 % of the poses", "µrad", (of) => of.map?.rotation_urad.p95],
];

/** The poses to look at first. */
export function worstPoses(of: Findings): { axes: Pose; um: number }[] {
  const bounded = of.map?.bounds?.worst.map(({ axes, p95_um }) => ({ axes, um: p95_um }));
  return bounded ?? of.map?.worst.map(({ axes, deviation_um }) => ({ axes, um: Math.hypot(...deviation_um) })) ?? [];
}

export class StatisticsTable {
  private worst: Pose = {};
  private readonly see = button("Show the worst pose", () => this.go(this.worst), { class: "primary", id: "worst" });

  private readonly body = make("div");

  constructor(
    private readonly parent: HTMLElement,
    buttons: HTMLElement,
    private readonly go: (pose: Pose) => void,
  ) {
    buttons.append(this.see);
    this.see.hidden = true;
    const fold = folding("Further figures", this.body);
    fold.open = false;
    parent.append(fold);
  }

  show(state: State): void {
    const { now, kept } = state;
    const worst = now?.map && deciding(now) ? worstPoses(now)[0] : undefined;
    this.see.hidden = !worst;
    if (worst) this.worst = worst.axes;
    this.parent.hidden = !now?.map || !deciding(now);
    if (!now?.map || this.parent.hidden) return this.body.replaceChildren();
    const measured = isOverJob(now) ? ON_JOB : MEASURED;
    const rows = (now.map.from ? BOUNDED : measured).flatMap((row) => this.row(row, now, kept));
    // The headline of such a machine has its bounds, too.
    const isPart = isOverJob(now) && now.map.bounds_add;
    const caption = isPart ? [make("caption", { class: "words" }, "Of the errors with values alone:")] : [];
    const table = make("table", {}, ...caption, make("tbody", {}, ...rows));
    this.parent.classList.toggle("stale", state.stale);
    this.body.replaceChildren(table);
  }

  private row([at, words, unit, pick]: Row, now: Findings, kept: Findings | null): HTMLElement[] {
    const value = pick(now);
    if (value === undefined) return [];
    const by = difference(pair(value, kept && pick(kept)), unit);
    return [
      make("tr", {}, make("th", { scope: "row" }, words), make("td", {}, figure(at, value, unit)), make("td", {}, by)),
    ];
  }
}
