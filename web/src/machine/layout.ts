/** What a machine stands like: its vertical, its back, and the size of its castings. Drawing only: no number that is
 * shown comes from here. */

import type { Axis, Chain, Tool, Vec3 } from "../evaluator/types";
import { across, cross, dot, isAcross, isParallel, minus, norm, unit } from "./vectors";

/** Axes from the bed outwards, by side. */
export interface Sides {
  tool: Axis[];
  /** From the bed to the workpiece. */
  workpiece: Axis[];
}

export interface Layout extends Sides {
  chain: Chain;
  toolInUse: Tool;
  up: Vec3;
  /** Horizontal, away from the operator. */
  back: Vec3;
  /** Horizontal, to the right of the operator. */
  right: Vec3;
  /** Width of a casting, mm. */
  size: number;
  /** Half the width of the table, mm. */
  table: number;
  kind: Kind;
}

/** Kinds that stand differently. */
export type Kind = "robot" | "lathe" | "horizontal" | "vertical";

export function sides(chain: Chain): Sides {
  const on = (side: Axis["side"]) => chain.axes.filter((axis) => axis.side === side);
  // The chain begins at the workpiece.
  return { tool: on("tool"), workpiece: on("workpiece").reverse() };
}

export function layout(chain: Chain, tool: string): Layout | null {
  const toolInUse = chain.tools.find((of) => of.name === tool) ?? chain.tools[0];
  if (!toolInUse) return null;
  const both = sides(chain);
  const usual = kindOf(both, toolInUse);
  const kind = chain.up ? kindBy(chain.up, toolInUse, usual) : usual;
  const up = chain.up ?? upward(both, toolInUse, kind);
  const right = rightward(both, toolInUse, up, kind);
  const size = casting(chain, toolInUse);
  return { ...both, chain, toolInUse, up, right, back: cross(up, right), size, table: tableHalf(chain, size), kind };
}

const linear = (axes: Axis[]) => axes.filter((axis) => axis.kind === "linear");

function kindOf({ tool, workpiece }: Sides, of: Tool): Kind {
  const [spindle, ...more] = workpiece;
  if (linear(tool).length + linear(workpiece).length === 0) return "robot";
  const first = tool[0];
  const turns = spindle?.kind === "rotary" && more.length === 0 && isParallel(spindle.direction, of.direction);
  if (turns && first && isParallel(first.direction, of.direction)) return "lathe";
  const table = workpiece.filter((axis) => axis.kind === "rotary");
  const swivels = tool.some((axis) => axis.kind === "rotary");
  const upright =
    table.length === 1 && workpiece.length > 1 && isAcross(table[0]?.direction ?? of.direction, of.direction);
  return upright && !swivels ? "horizontal" : "vertical";
}

/** The kind that a vertical of the file leaves: a spindle across it is horizontal. */
function kindBy(up: Vec3, of: Tool, usual: Kind): Kind {
  if (usual === "robot") return usual;
  const isHorizontal = isAcross(up, of.direction);
  if (usual === "lathe" && isHorizontal) return usual;
  return isHorizontal ? "horizontal" : "vertical";
}

function upward({ tool, workpiece }: Sides, of: Tool, kind: Kind): Vec3 {
  if (kind === "robot") return tool[0]?.direction ?? [0, 0, 1];
  if (kind === "lathe")
    return linear(tool).find((axis) => isAcross(axis.direction, of.direction))?.direction ?? [1, 0, 0];
  const table = workpiece.find((axis) => axis.kind === "rotary");
  if (kind === "horizontal" && table) return table.direction;
  return unit(of.direction);
}

/** Across the tool of a horizontal machine, along the spindle of a lathe, along X of the others. */
function rightward({ tool, workpiece }: Sides, of: Tool, up: Vec3, kind: Kind): Vec3 {
  if (kind === "lathe") return unit(across(of.direction, up));
  if (kind === "horizontal") return unit(cross(across(of.direction, up), up));
  const flat = (axes: Axis[]) => linear(axes).filter((axis) => isAcross(axis.direction, up));
  // A single one on the side of the tool is a beam: it is seen from the front.
  const candidates = flat(tool).length === 1 ? flat(tool) : [...flat(tool), ...flat(workpiece)];
  const x = candidates.find((axis) => axis.name.startsWith("X")) ?? candidates[0];
  // Without one anything across.
  const aside: Vec3 = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
  return unit(across(x?.direction ?? aside, up));
}

/** A sixth of a middling travel; of a robot of its reach. */
function casting(chain: Chain, tool: Tool): number {
  const travels = linear(chain.axes)
    .map((axis) => axis.travel[1] - axis.travel[0])
    .sort((a, b) => a - b);
  const middle = travels[Math.floor(travels.length / 2)];
  const spread = chain.axes.map((axis) => norm(minus(axis.origin_mm, tool.gauge_mm)));
  const reach = Math.max(...spread, norm(minus(tool.gauge_mm, chain.workpiece_origin_mm)), 100);
  return middle === undefined ? reach / 9 : Math.max(middle / 6, 20);
}

/** Half the shortest travel across, within what a casting carries. */
function tableHalf(chain: Chain, size: number): number {
  const travels = linear(chain.axes).map((axis) => axis.travel[1] - axis.travel[0]);
  const least = travels.length ? Math.min(...travels) : 4 * size;
  return Math.min(Math.max(least * 0.42, 1.2 * size), 2.6 * size);
}

/** Motion of the body that an axis carries, for +1 mm or +1 deg. */
export function motion(axis: Axis): 1 | -1 {
  return axis.side === "workpiece" && axis.sense === "iso841" ? -1 : 1;
}

/** Middle of the travel of the body along the direction of the axis; 0 for a rotary one. */
export function middle(axis: Axis): number {
  return axis.kind === "linear" ? (motion(axis) * (axis.travel[0] + axis.travel[1])) / 2 : 0;
}

export const stroke = (axis: Axis): number => axis.travel[1] - axis.travel[0];

/** True if the axis is vertical. */
export const isUpright = (of: Layout, axis: Axis): boolean => Math.abs(dot(axis.direction, of.up)) > 0.7;
