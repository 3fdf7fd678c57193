/** The deviation at the present pose, enlarged, and the field around it: of the machine, and of what stands beside it,
 * on one scale. */

import { Newest } from "../evaluator/newest";
import {
  accepted,
  type Chain,
  type Evaluated,
  type Pose,
  type Question,
  refusals,
  type Rows,
  type Vec3,
} from "../evaluator/types";
import { counted } from "../review/number";
import type { Session } from "../session";
import { move, place } from "../ui/address";
import { make } from "../ui/dom";
import type { FieldNode } from "./marks";
import type { Stage } from "./stage";
import { bare, named, quantity } from "../units";

/** Nodes of the field along each linear axis, and of a slice. */
const [NODES, SLICE] = [5, 11];

/** Machines that are drawn for what bounds lead to at each pose. */
const SAMPLES = 300;

/** A machine in a picture: its text where it is not that of the editor, and the control whose files correct it. */
export interface View {
  stage: Stage;
  chain: Chain;
  text?: string;
  target?: string;
}

/** What a view shows: the deviation at the pose first, then the nodes of the field. */
interface Seen {
  view: View;
  nodes: FieldNode[];
  rotation_rad: Vec3 | null;
}

export class Deviation {
  private readonly field = make("select", { id: "field", "aria-label": "Field around this pose" });
  private chain: Chain | null = null;
  private pose: Pose = {};
  private bounded = false;
  private rests = true;
  /** Why the last question has no answer. */
  private reason = "";
  private readonly asking = new Newest((failure) => {
    this.reason = failure instanceof Error ? failure.message : String(failure);
    this.nothing();
  });

  constructor(
    private readonly legend: HTMLElement,
    buttons: HTMLElement,
    private readonly stage: Stage | null,
    private readonly session: Session,
    /** What stands beside the machine. */
    private readonly beside: () => View | null,
  ) {
    buttons.append(this.field);
    this.field.addEventListener("change", () => {
      move({ field: this.field.value });
      this.update();
    });
  }

  /** The machine is another one. */
  follow(chain: Chain, pose: Pose, bounded: boolean): void {
    if (chain !== this.chain) this.list(chain);
    [this.chain, this.bounded] = [chain, bounded];
    this.moved(pose, true);
  }

  moved(pose: Pose, rests: boolean): void {
    [this.pose, this.rests] = [{ ...pose }, rests];
    this.update();
  }

  update(): void {
    void this.asking.do(() => this.ask());
  }

  private list(chain: Chain): void {
    const linear = chain.axes.filter((axis) => axis.kind === "linear").slice(0, 3);
    const slices = linear.length > 1 ? linear.map(({ name }) => [name, `Slice across ${name}`]) : [];
    const all = linear.length ? [["all", `Field, ${linear.map(() => NODES).join(" × ")} nodes`]] : [];
    const list = [["", "No field"], ...all, ...slices];
    const chosen = place().field;
    this.field.replaceChildren(...list.map(([value, words]) => make("option", { value: value ?? "" }, words ?? "")));
    this.field.value = list.some(([value]) => value === chosen) ? chosen : "";
  }

  private async ask(): Promise<void> {
    const { chain, stage } = this;
    if (!chain || !stage) return;
    const poses = [this.pose, ...nodes(chain, this.pose, this.field.value)];
    const beside = this.beside();
    const views: View[] = [{ stage, chain }, ...(beside ? [beside] : [])];
    const seen = (await Promise.all(views.map((view) => this.seen(view, poses)))).filter((of) => of !== null);
    const first = seen[0];
    if (first?.view.stage !== stage) return this.nothing();
    const most = Math.max(...seen.flatMap((of) => of.nodes.map((node) => node.length_um)));
    const turn = Math.max(0, ...seen.map((of) => Math.hypot(...(of.rotation_rad ?? [0, 0, 0]))));
    const size = sizeOf(chain);
    const times = factor(size, most, turn);
    for (const { view, nodes, rotation_rad } of seen) {
      const [here, ...around] = nodes;
      view.stage.deviation(here ?? null, rotation_rad, times);
      view.stage.marks.show(around, times, most, size / 12);
      view.stage.draw();
    }
    this.tell(seen, times, most);
  }

  /** Deviations at poses; `null` where they are refused. What a control leaves is asked for when the pose rests. */
  private async seen(view: View, poses: Pose[]): Promise<Seen | null> {
    const { chain, text, target } = view;
    if (target && !this.rests) return null;
    const rows = poses.map((pose) => chain.axes.map((axis) => pose[axis.name] ?? 0));
    const listed = { poses: { listed: rows }, samples: SAMPLES, ...(target ? { target } : {}) };
    const more: Question[] = this.bounded || target ? [{ rows: listed }] : [];
    const answers = await this.session.ask([{ eval: { poses: rows } }, ...more], {}, text);
    const nominal = accepted<Evaluated>(answers[0]);
    const mapped = accepted<Rows>(answers[1])?.rows.poses;
    if (!nominal || (more.length && !mapped)) {
      this.reason = answers.flatMap(refusals).join(" ");
      return null;
    }
    const list = nominal.poses.map((pose, i) => node(pose, mapped?.[i]));
    // Of bounds it is no vector.
    const turned = this.bounded ? undefined : mapped?.[0]?.rotation_urad?.map((urad) => urad * 1e-6);
    return {
      view,
      nodes: list,
      rotation_rad: this.bounded ? null : ((turned as Vec3 | undefined) ?? nominal.poses[0]?.rotation ?? null),
    };
  }

  private nothing(): void {
    for (const view of [this.stage, this.beside()?.stage]) {
      view?.deviation(null, null, 1);
      view?.marks.clear();
    }
    this.legend.replaceChildren(...(this.reason ? [`No value at this pose. ${this.reason}`] : []));
  }

  private tell(seen: Seen[], times: number, most: number): void {
    const [here, other] = seen.map((of) => of.nodes[0]);
    if (!here) return;
    const value = strong("here", here.length_um);
    const parts = here.deviation_um?.map((um, i) => `${"XYZ"[i]} ${bare(um)}`).join(", ");
    const scale = this.field.value ? [this.scale(most)] : [];
    if (!parts) {
      const words = "95 % of machines with these bounds deviate here less than ";
      return this.legend.replaceChildren(make("span", {}, words, value), ...scale);
    }
    if (here.length_um === 0 && !other?.length_um)
      return this.legend.replaceChildren("No error that has a value acts at this pose.");
    const drawn = ` (${parts} ${named("um")}), drawn ${counted(times)} times as large: nominal tool yellow, actual red`;
    const beside = other ? [make("span", {}, "Beside it ", strong("beside", other.length_um))] : [];
    this.legend.replaceChildren(
      make("span", {}, "Deviation here, machine coordinates, ", value, drawn),
      ...beside,
      ...scale,
    );
  }

  private scale(most: number): HTMLElement {
    const bar = make("span", { class: "scale" });
    bar.style.background = `linear-gradient(to right, ${this.stage?.marks.colours.join(", ")})`;
    return make("span", { class: "colours", id: "scale", "data-most": String(most) }, "0 ", bar, ` ${quantity(most)}`);
  }
}

function strong(at: string, um: number): HTMLElement {
  const words = um > 0 && um < 5e-4 ? `< 0.001 ${named("um")}` : quantity(um);
  return make("strong", { "data-at": at, "data-value": String(um) }, words);
}

function node(of: Evaluated["poses"][number], mapped: Rows["rows"]["poses"][number] | undefined): FieldNode {
  if (mapped?.position_um) return { nominal: of.nominal, deviation_um: null, length_um: mapped.position_um.p95 };
  const deviation_um = mapped?.deviation_um ?? (of.deviation.map((mm) => mm * 1e3) as Vec3);
  return { nominal: of.nominal, deviation_um, length_um: Math.hypot(...deviation_um) };
}

/** Poses on a grid over the linear axes, the others as they are; `across` names the axis that stays in a slice. */
function nodes(chain: Chain, pose: Pose, across: string): Pose[] {
  if (!across) return [];
  const linear = chain.axes.filter((axis) => axis.kind === "linear").slice(0, 3);
  const count = across === "all" ? NODES : SLICE;
  let list: Pose[] = [{ ...pose }];
  for (const axis of linear.filter(({ name }) => name !== across)) {
    const [min, max] = axis.travel;
    const places = Array.from({ length: count }, (_, i) => min + ((max - min) * i) / (count - 1));
    list = list.flatMap((at) => places.map((position) => ({ ...at, [axis.name]: position })));
  }
  return list;
}

/** Longest travel, or the reach of a robot. */
function sizeOf(chain: Chain): number {
  const travels = chain.axes.filter((axis) => axis.kind === "linear").map((axis) => axis.travel[1] - axis.travel[0]);
  const spread = chain.axes.map((axis) => Math.hypot(...axis.origin_mm));
  return travels.length ? Math.max(...travels) : Math.max(...spread, 100);
}

/** A round factor at which the largest deviation is a quarter of the size, and the tool tilts by 20 deg at most. */
function factor(size: number, most_um: number, turn_rad: number): number {
  if (!(most_um > 1e-6)) return 1;
  const exact = Math.min((0.22 * size) / (most_um * 1e-3), 0.35 / Math.max(turn_rad, 1e-9));
  const power = 10 ** Math.floor(Math.log10(exact));
  return [5, 2, 1].map((k) => k * power).find((k) => k <= exact) ?? power;
}
