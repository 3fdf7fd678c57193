/** The deviation at the present pose, enlarged, and the field around it. */

import { Newest } from "../evaluator/newest";
import type { Chain, Evaluated, Pose, Vec3 } from "../evaluator/types";
import { rounded } from "../review/number";
import type { Session } from "../session";
import { make } from "../ui/dom";
import type { FieldNode } from "./marks";
import type { Stage } from "./stage";

/** Nodes of the field along each linear axis. */
const NODES = 5;

export class Deviation {
  private readonly field = make("input", { type: "checkbox", id: "field" });
  private chain: Chain | null = null;
  private pose: Pose = {};
  private bounded = false;
  private readonly asking = new Newest(() => this.legend.replaceChildren());

  constructor(
    private readonly legend: HTMLElement,
    buttons: HTMLElement,
    private readonly stage: Stage | null,
    private readonly session: Session,
  ) {
    buttons.append(make("label", { class: "check" }, this.field, " Field around this pose"));
    this.field.addEventListener("change", () => void this.asking.do(() => this.ask()));
  }

  /** The machine is another one. */
  follow(chain: Chain, pose: Pose, bounded: boolean): void {
    [this.chain, this.bounded] = [chain, bounded];
    this.field.disabled = bounded;
    this.moved(pose, true);
  }

  moved(pose: Pose, _rests: boolean): void {
    this.pose = { ...pose };
    void this.asking.do(() => this.ask());
  }

  private async ask(): Promise<void> {
    const { chain } = this;
    if (!chain) return;
    if (this.bounded) return this.nothing();
    const around = this.field.checked ? nodes(chain, this.pose) : [];
    const found = await this.session.deviations(chain, [this.pose, ...around]);
    const here = found?.poses[0];
    if (!found || !here) return this.nothing();
    const list = found.poses.slice(1).map(node);
    const most = Math.max(...list.map((of) => of.length_um), length(here.deviation) * 1e3);
    const size = sizeOf(chain);
    const times = factor(size, most);
    this.stage?.deviation(here.nominal, here.deviation, times);
    this.stage?.marks.show(list, times, most, size / 12);
    this.stage?.draw();
    this.tell(here, times, list.length ? most : null);
  }

  private nothing(): void {
    this.stage?.deviation(null, [0, 0, 0], 1);
    this.stage?.marks.clear();
    this.legend.textContent = this.bounded
      ? "Errors that are only bounded have no direction: no deviation is drawn."
      : "";
  }

  private tell(here: Evaluated["poses"][number], times: number, most: number | null): void {
    const um = here.deviation.map((mm) => mm * 1e3);
    const parts = um.map((value, i) => `${"XYZ"[i]} ${rounded(value)}`).join(", ");
    const value = make(
      "strong",
      { "data-at": "here", "data-value": String(length(here.deviation) * 1e3) },
      `${rounded(length(here.deviation) * 1e3)} µm`,
    );
    const words = make("span", {}, "Deviation here ", value, ` (${parts}), drawn ${times} times as large`);
    this.legend.replaceChildren(words, ...(most === null ? [] : [this.scale(most)]));
  }

  private scale(most: number): HTMLElement {
    const bar = make("span", { class: "scale" });
    bar.style.background = `linear-gradient(to right, ${this.stage?.marks.colours.join(", ")})`;
    return make("span", { class: "colours" }, "0 ", bar, ` ${rounded(most)} µm`);
  }
}

const length = (v: Vec3) => Math.hypot(...v);

function node(of: Evaluated["poses"][number]): FieldNode {
  const deviation_um = of.deviation.map((mm) => mm * 1e3) as Vec3;
  return { nominal: of.nominal, deviation_um, length_um: Math.hypot(...deviation_um) };
}

/** Poses on a grid over the linear axes, the others as they are; over all axes of a machine without linear ones. */
function nodes(chain: Chain, pose: Pose): Pose[] {
  const linear = chain.axes.filter((axis) => axis.kind === "linear").slice(0, 3);
  let list: Pose[] = [{ ...pose }];
  for (const axis of linear) {
    const [min, max] = axis.travel;
    const places = Array.from({ length: NODES }, (_, i) => min + ((max - min) * i) / (NODES - 1));
    list = list.flatMap((at) => places.map((position) => ({ ...at, [axis.name]: position })));
  }
  return linear.length ? list : [];
}

/** Longest travel, or the reach of a robot. */
function sizeOf(chain: Chain): number {
  const travels = chain.axes.filter((axis) => axis.kind === "linear").map((axis) => axis.travel[1] - axis.travel[0]);
  const spread = chain.axes.map((axis) => Math.hypot(...axis.origin_mm));
  return travels.length ? Math.max(...travels) : Math.max(...spread, 100);
}

/** A round factor at which the largest deviation is a quarter of the size. */
function factor(size: number, most_um: number): number {
  if (!(most_um > 1e-6)) return 1;
  const exact = (0.22 * size) / (most_um * 1e-3);
  const power = 10 ** Math.floor(Math.log10(exact));
  return [5, 2, 1].map((k) => k * power).find((k) => k <= exact) ?? power;
}
