/** The castings of a machine, drawn from its geometry: from the tool back to the bed, and from the part down to it. */

import type { Axis, Vec3 } from "../evaluator/types";
import { isUpright, type Layout, middle, motion, stroke } from "./layout";
import { ball, bar, beam, box, type Material, type Shape } from "./shapes";
import { across, along, cross, dot, foot, isAcross, isParallel, minus, norm, scaled, unit } from "./vectors";

/** Shapes by the body that carries them: the name of an axis, or `bed`. */
export type Castings = Map<string, Shape[]>;

export function castings(of: Layout): Castings {
  const builder = new Builder(of);
  if (of.kind === "robot") builder.robot();
  else builder.machine();
  return builder.shapes;
}

/** Where the next body joins, and the body that the axes so far have ended in. */
interface Joint {
  at: Vec3;
  /** Direction in which the castings go on. */
  out: Vec3;
}

class Builder {
  readonly shapes: Castings = new Map();
  private readonly s: number;
  /** Height of the floor along `up`. */
  private floor = 0;
  /** Where the part stands. */
  private place: { body: string; at: Vec3; normal: Vec3 } | null = null;

  constructor(private readonly of: Layout) {
    this.s = of.size;
  }

  private put(body: string, ...shapes: Shape[]): void {
    this.shapes.set(body, [...(this.shapes.get(body) ?? []), ...shapes]);
  }

  private height(point: Vec3): number {
    return dot(point, this.of.up);
  }

  private atFloor(point: Vec3): Vec3 {
    return along(point, this.of.up, this.floor - this.height(point));
  }

  machine(): void {
    const bottom = this.workpieceSide();
    this.floor = this.height(bottom) - 0.9 * this.s;
    if (this.of.kind === "lathe")
      this.floor = Math.min(this.floor, this.height(this.of.chain.workpiece_origin_mm) - 4 * this.s);
    if (this.of.kind === "lathe") this.headstock(bottom);
    this.toolSide();
    this.part();
  }

  /** Largest extent of what is drawn of these bodies along a direction. */
  private extent(direction: Vec3, bodies: string[]): number {
    const ends = bodies.flatMap((body) => this.shapes.get(body) ?? []).map((shape) => farthest(shape, direction));
    return Math.max(-Infinity, ...ends);
  }

  /** The bed and what carries the part. */
  private get below(): string[] {
    return ["bed", ...this.of.workpiece.map((axis) => axis.name)];
  }

  /** What holds the spindle of a lathe, down to the floor. */
  private headstock(at: Vec3): void {
    const { s, of } = this;
    const under = along(at, of.toolInUse.direction, 1.1 * s);
    this.put(
      "bed",
      beam("bed", along(under, of.up, -1.4 * s), this.atFloor(under), of.toolInUse.direction, 2.2 * s, 3 * s),
    );
    const run = Math.max(...of.tool.map(stroke)) + 3 * s;
    const bed = along(along(this.atFloor(under), of.toolInUse.direction, run / 2), of.up, 0.2 * s);
    this.put("bed", box("bed", bed, of.toolInUse.direction, of.up, [run, 3 * s, 0.4 * s]));
  }

  // The part and what carries it.

  /** Draws the part and its bodies down to the bed, and returns the point where the bed begins. */
  private workpieceSide(): Vec3 {
    const { workpiece, up, chain } = this.of;
    const list = [...workpiece].reverse();
    const first = list[0];
    const normal = first?.kind === "rotary" ? this.normalOf(first) : up;
    const joint: Joint = { at: chain.workpiece_origin_mm, out: scaled(normal, -1) };
    this.place = { body: first?.name ?? "bed", at: joint.at, normal };
    list.forEach((axis, i) => {
      const parent = list[i + 1]?.name ?? "bed";
      const carries = i === 0;
      if (axis.kind === "linear") this.slide(axis, parent, joint, carries);
      else if (isParallel(axis.direction, joint.out)) this.turntable(axis, parent, joint, carries);
      else if (isAcross(axis.direction, this.of.up)) this.cradle(axis, parent, joint, carries);
      else this.wedge(axis, parent, joint);
    });
    this.bedUnder(joint, list);
    return joint.at;
  }

  /** Direction from the table to the part. */
  private normalOf(table: Axis): Vec3 {
    const { up, kind, toolInUse } = this.of;
    const wanted = kind === "lathe" ? toolInUse.direction : up;
    return isAcross(table.direction, wanted) ? wanted : this.towards(table.direction, wanted);
  }

  private towards(direction: Vec3, wanted: Vec3): Vec3 {
    return dot(direction, wanted) < 0 ? scaled(direction, -1) : direction;
  }

  /** A block that stands for the part, as high as the tool leaves room; none where it leaves none. */
  private part(): void {
    if (!this.place) return;
    const { body, at, normal } = this.place;
    const half = Math.min(this.of.table * 0.5, 1.1 * this.s);
    if (this.of.kind === "lathe") {
      this.put(body, bar("part", along(at, normal, 0.02 * this.s), at, half * 0.7));
      return;
    }
    const side = unit(across(this.of.right, normal));
    const width = half * 1.5;
    const height = Math.min(half, this.room(at, normal, side, width / 2) - 0.04 * this.s);
    if (height < 0.04 * this.s) return;
    this.put(body, box("part", along(at, normal, height / 2), side, normal, [width, width, height]));
  }

  /** Height up to the first of the tool's bodies above a square place. */
  private room(at: Vec3, normal: Vec3, side: Vec3, half: number): number {
    const directions = [side, cross(normal, side)];
    const own = this.of.tool.map((axis) => axis.name);
    const bodies = own.length ? own : ["bed"];
    const shapes = bodies.flatMap((body) => this.shapes.get(body) ?? []);
    const above = shapes.filter((shape) =>
      directions.every((direction) => {
        const middle = dot(at, direction);
        return farthest(shape, direction) > middle - half && -farthest(shape, scaled(direction, -1)) < middle + half;
      }),
    );
    return Math.min(Infinity, ...above.map((shape) => -farthest(shape, scaled(normal, -1)) - dot(at, normal)));
  }

  /** A round table on its housing, or the spindle of a lathe in its headstock. */
  private turntable(axis: Axis, parent: string, joint: Joint, carries: boolean): void {
    const { s, of } = this;
    const radius = carries ? of.table : of.table * 1.15;
    const top = foot(joint.at, axis.origin_mm, axis.direction);
    const under = along(top, joint.out, 0.28 * s);
    const end = along(under, joint.out, (of.kind === "lathe" ? 2.2 : 0.75) * s);
    if (of.kind === "lathe") {
      this.put(axis.name, bar("rotary", top, under, 1.1 * s));
      this.put(
        parent,
        box("bed", scaledSum(under, end), of.up, unit(joint.out), [3 * s, 3 * s, norm(minus(end, under))]),
      );
    } else {
      this.put(axis.name, bar("rotary", top, under, radius));
      this.put(axis.name, ...this.slots(top, joint.out, radius));
      this.put(parent, bar("axis", under, end, radius * 0.86, radius * 0.92));
    }
    joint.at = end;
  }

  /** T-slots of a table. */
  private slots(top: Vec3, out: Vec3, radius: number): Shape[] {
    const side = unit(across(this.of.right, out));
    const other = cross(side, out);
    const middles = [-0.5, 0, 0.5].map((k) => along(top, other, k * radius));
    const half = [0.8, 0.94, 0.8].map((k) => k * radius);
    return middles.map((at, i) => {
      const [from, to] = [along(at, side, -(half[i] ?? 0)), along(at, side, half[i] ?? 0)];
      return beam("guide", from, to, other, 0.09 * this.s, 0.012 * this.s);
    });
  }

  /** A cradle between two bearings: it tilts what it carries about a line across the vertical. */
  private cradle(axis: Axis, parent: string, joint: Joint, carries: boolean): void {
    const { s, of } = this;
    const a = axis.direction;
    const line = foot(joint.at, axis.origin_mm, a);
    const width = of.table * (carries ? 1 : 1.02) + 0.3 * s;
    const plate = along(joint.at, joint.out, 0.2 * s);
    this.put(axis.name, box("rotary", plate, a, of.up, [2 * width + 0.6 * s, of.table * 1.5, 0.4 * s]));
    const reach = Math.max(norm(minus(along(plate, joint.out, 0.2 * s), line)), 0.9 * s) + 0.55 * of.table;
    const base = along(line, of.up, -reach - 0.25 * s);
    for (const way of [-1, 1]) {
      const inner = along(line, a, way * width);
      const outer = along(line, a, way * (width + 0.45 * s));
      const low = along(along(plate, a, way * (width + 0.15 * s)), of.up, -0.2 * s);
      this.put(
        axis.name,
        beam("rotary", low, along(inner, a, way * 0.15 * s), a, 0.3 * s, 0.9 * s),
        bar("rotary", inner, outer, 0.5 * s),
      );
      const post = along(line, a, way * (width + 0.75 * s));
      this.put(
        parent,
        beam("axis", along(post, of.up, 0.65 * s), along(post, of.up, -reach - 0.25 * s), a, 0.55 * s, 1.5 * s),
      );
      this.put(
        axis.name,
        bar("guide", along(line, a, way * (width + 1.025 * s)), along(line, a, way * (width + 1.1 * s)), 0.34 * s),
      );
    }
    this.put(
      parent,
      box("axis", along(base, of.up, -0.2 * s), a, of.up, [
        2 * width + 2.1 * s,
        Math.max(1.5 * s, of.table * 1.4),
        0.45 * s,
      ]),
    );
    joint.at = along(base, of.up, -0.42 * s);
    joint.out = scaled(of.up, -1);
  }

  /** A body that turns about an inclined line: it and what carries it meet in a plane across that line, below all of
   * the body. */
  private wedge(axis: Axis, parent: string, joint: Joint): void {
    const { of } = this;
    const a = this.towards(axis.direction, joint.out);
    const inner = of.workpiece.slice(of.workpiece.indexOf(axis)).map((other) => other.name);
    const pivot = foot(joint.at, axis.origin_mm, a);
    const radius = of.table * 0.6;
    const below = (this.height(pivot) - this.height(joint.at) + radius) / Math.max(-dot(a, of.up), 0.3);
    const clear = this.extent(a, inner) + 0.1 * this.s - dot(pivot, a);
    const plane = along(pivot, a, Math.max(clear, below + radius));
    const [before, behind] = [along(plane, a, -radius), along(plane, a, radius)];
    this.put(axis.name, bar("rotary", joint.at, before, radius * 0.5, radius * 0.6), ball("rotary", before, radius));
    this.put(axis.name, bar("rotary", along(plane, a, -0.25 * radius), plane, radius));
    this.put(parent, bar("axis", plane, along(plane, a, 0.4 * radius), radius * 1.1), ball("axis", behind, radius));
    joint.at = along(behind, of.up, -radius);
    joint.out = scaled(of.up, -1);
  }

  /** A slide on rails; a vertical one hangs on a column behind it. */
  private slide(axis: Axis, parent: string, joint: Joint, carries: boolean): void {
    const { s, of } = this;
    const a = axis.direction;
    if (isUpright(of, axis)) return this.knee(axis, parent, joint);
    const side = unit(cross(of.up, a));
    const half = Math.max(of.table * (carries ? 1.1 : 1), 1.3 * s);
    const length = 2 * half;
    const plate = along(joint.at, of.up, -0.22 * s);
    this.put(axis.name, box("axis", plate, a, of.up, [length, 2 * half * 0.9, 0.44 * s]));
    const low = along(joint.at, of.up, -0.44 * s);
    const shift = along(low, a, -middle(axis));
    const run = stroke(axis) + length;
    for (const way of [-1, 1]) {
      const rail = along(along(shift, side, way * half * 0.6), of.up, -0.1 * s);
      this.put(parent, box("guide", rail, a, of.up, [run, 0.26 * s, 0.2 * s]));
    }
    const bed = along(shift, of.up, -0.45 * s);
    this.put(parent, box(parent === "bed" ? "bed" : "axis", bed, a, of.up, [run, 2 * half * 0.85, 0.5 * s]));
    joint.at = along(shift, of.up, -0.7 * s);
    joint.out = scaled(of.up, -1);
  }

  private knee(axis: Axis, parent: string, joint: Joint): void {
    const { s, of } = this;
    const plate = along(joint.at, of.up, -0.3 * s);
    this.put(axis.name, box("axis", plate, of.right, of.up, [2 * of.table, 2 * of.table, 0.6 * s]));
    const back = along(plate, of.back, of.table + 0.25 * s);
    const shift = along(back, axis.direction, -middle(axis));
    this.column(parent, shift, axis, 0.5 * s);
    joint.at = along(joint.at, of.up, -stroke(axis) - 0.8 * s);
  }

  /** The bed under the last body of the part. */
  private bedUnder(joint: Joint, list: Axis[]): void {
    const { s, of } = this;
    if (of.kind === "lathe") return;
    const last = list[list.length - 1];
    if (!last) return this.fixedTable(joint);
    const run = last.kind === "linear" ? stroke(last) + 2.4 * of.table : 2.6 * of.table;
    const a = last.kind === "linear" && !isUpright(of, last) ? last.direction : of.right;
    this.put(
      "bed",
      box("bed", along(joint.at, of.up, -0.45 * s), a, of.up, [run, Math.max(2.4 * of.table, 3 * s), 0.9 * s]),
    );
  }

  /** The table of a machine whose part stands still: under the whole volume. */
  private fixedTable(joint: Joint): void {
    const { s, of } = this;
    const flat = of.tool.filter((axis) => axis.kind === "linear" && !isUpright(of, axis));
    const size = (direction: Vec3) =>
      Math.max(...flat.map((axis) => Math.abs(dot(axis.direction, direction)) * stroke(axis)), 4 * s);
    const centre = flat.reduce((at, axis) => along(at, axis.direction, middle(axis)), this.of.toolInUse.tip_mm);
    const top = along(centre, of.up, this.tableHeight(joint.at) - this.height(centre));
    this.put(
      "bed",
      box("bed", along(top, of.up, -0.45 * s), of.right, of.up, [
        size(of.right) + 2 * s,
        size(of.back) + 0.8 * s,
        0.9 * s,
      ]),
    );
    joint.at = top;
  }

  /** Height of a fixed table: that of the workpiece, or below the lowest tip where the tool stands below that. */
  private tableHeight(workpiece: Vec3): number {
    const { tool, toolInUse, up } = this.of;
    const tip = this.height(toolInUse.tip_mm);
    if (tip >= this.height(workpiece)) return this.height(workpiece);
    const rise = (axis: Axis) => Math.min(...axis.travel.map((q) => q * dot(axis.direction, up)));
    const lowest = tool.filter((axis) => axis.kind === "linear").reduce((sum, axis) => sum + rise(axis), tip);
    return Math.min(lowest, tip) - 0.6 * this.s;
  }

  // The tool and what carries it.

  private toolSide(): void {
    const { tool, toolInUse, s } = this.of as Layout & { s: number };
    const { gauge_mm: gauge, tip_mm: tip, direction: d } = toolInUse;
    const list = [...tool].reverse();
    const body = list[0]?.name ?? "bed";
    const size = s ?? this.s;
    const radius = Math.max(Math.min(0.13 * size, norm(minus(tip, gauge)) * 0.12), 2);
    this.put(
      body,
      bar("tool", tip, gauge, radius * 0.8, radius),
      bar("spindle", gauge, along(gauge, d, 0.28 * size), 0.26 * size, 0.4 * size),
    );
    const joint: Joint = { at: along(gauge, d, 1.5 * size), out: d };
    const inclined = list[0]?.kind === "rotary" && !isAcross(list[0].direction, d) && !isParallel(list[0].direction, d);
    if (!inclined) {
      const end = along(gauge, d, this.spindleLength(list[0]));
      this.put(body, bar("spindle", along(gauge, d, 0.28 * size), end, this.spindleRadius()));
    }
    list.forEach((axis, i) => this.toolBody(axis, list, i, joint));
    this.standing(list, joint);
  }

  /** A spindle in a fork ends behind its pivot. */
  private spindleLength(first: Axis | undefined): number {
    const { gauge_mm: gauge, direction: d } = this.of.toolInUse;
    if (first?.kind !== "rotary" || !isAcross(first.direction, d)) return 1.5 * this.s;
    const pivot = dot(minus(foot(gauge, first.origin_mm, first.direction), gauge), d);
    return Math.min(Math.max(pivot, 0) + 0.5 * this.s, 1.5 * this.s);
  }

  /** A horizontal spindle passes above the table. */
  private spindleRadius(): number {
    const { toolInUse, up, chain } = this.of;
    const above = this.height(toolInUse.gauge_mm) - this.height(chain.workpiece_origin_mm);
    const isLow = isAcross(toolInUse.direction, up) && this.of.kind === "horizontal" && above > 0;
    return Math.min(0.42 * this.s, isLow ? 0.9 * above : Infinity);
  }

  private toolBody(axis: Axis, list: Axis[], i: number, joint: Joint): void {
    const parent = list[i + 1]?.name ?? "bed";
    const { s } = this;
    if (axis.kind === "linear") return this.carriage(axis, list, i, joint);
    if (isParallel(axis.direction, joint.out)) {
      const neck = along(joint.at, joint.out, 0.35 * s);
      const end = along(neck, joint.out, 0.9 * s);
      this.put(axis.name, bar("rotary", joint.at, neck, 0.7 * s));
      this.put(parent, bar("axis", neck, end, 0.82 * s));
      joint.at = end;
    } else if (!isAcross(axis.direction, joint.out)) this.nutator(axis, list[i + 1], joint);
    else if (i === 0) this.fork(axis, parent, joint);
    else this.bearing(axis, parent, joint);
  }

  /** Two arms hold a head that swivels between them. */
  private fork(axis: Axis, parent: string, joint: Joint): void {
    const { s } = this;
    const { gauge_mm: gauge, direction: d } = this.of.toolInUse;
    const a = axis.direction;
    const pivot = foot(gauge, axis.origin_mm, a);
    const top = along(pivot, d, 0.5 * s);
    this.put(
      axis.name,
      beam("rotary", along(gauge, d, 0.9 * s), top, a, 1.0 * s, 1.0 * s),
      bar("rotary", along(pivot, a, -0.62 * s), along(pivot, a, 0.62 * s), 0.55 * s),
    );
    for (const way of [-1, 1]) {
      const arm = along(pivot, a, way * 0.85 * s);
      this.put(
        parent,
        beam("axis", along(arm, joint.out, -0.6 * s), along(arm, joint.out, 1.5 * s), a, 0.4 * s, 1.1 * s),
      );
      this.put(axis.name, bar("guide", along(pivot, a, way * 1.05 * s), along(pivot, a, way * 1.14 * s), 0.36 * s));
    }
    const bridge = along(pivot, joint.out, 1.5 * s);
    this.put(parent, box("axis", bridge, a, joint.out, [2.1 * s, 1.1 * s, 0.5 * s]));
    joint.at = along(bridge, joint.out, 0.25 * s);
  }

  /** A head that turns about an inclined line: it and what carries it meet in a plane across that line. */
  private nutator(axis: Axis, next: Axis | undefined, joint: Joint): void {
    const { s, of } = this;
    const parent = next?.name ?? "bed";
    const { gauge_mm: gauge, direction: d } = of.toolInUse;
    const a = this.towards(axis.direction, d);
    const pivot = crossing(axis.origin_mm, a, gauge, d);
    const lean = norm(cross(a, d)) / dot(a, d);
    const length = dot(minus(pivot, gauge), d) - 0.28 * s;
    const radius = Math.min(0.42 * s, (0.9 * length) / lean);
    if (radius > 0.05 * s) {
      const foot = along(gauge, d, 0.28 * s);
      this.put(axis.name, bar("spindle", foot, along(foot, d, length - radius * lean), radius));
    }
    const disc = 0.75 * s;
    this.put(axis.name, bar("rotary", along(pivot, a, -0.45 * s), pivot, disc * 0.8, disc));
    const centre = along(pivot, a, disc);
    this.put(parent, bar("axis", pivot, along(pivot, a, 0.4 * disc), disc), ball("axis", centre, disc));
    joint.at = centre;
    joint.out = of.up;
    if (next?.kind === "rotary" && isAcross(next.direction, of.up)) return;
    joint.at = along(centre, of.up, 1.5 * s);
    this.put(parent, bar("axis", centre, joint.at, 0.6 * s));
  }

  /** A head on one side of what carries it: both meet in a plane across the line, behind all of the head. */
  private bearing(axis: Axis, parent: string, joint: Joint): void {
    const { s, of } = this;
    const a = this.towards(axis.direction, isAcross(axis.direction, of.back) ? of.right : of.back);
    const inner = of.tool.slice(of.tool.indexOf(axis)).map((other) => other.name);
    const start = foot(joint.at, axis.origin_mm, a);
    const plane = along(start, a, this.extent(a, inner) - dot(start, a));
    this.put(axis.name, bar("rotary", start, plane, 0.75 * s));
    const end = along(plane, a, 0.5 * s);
    this.put(parent, bar("axis", plane, end, 0.82 * s));
    joint.at = along(along(plane, a, 0.7 * s), of.up, 1.5 * s);
    this.put(parent, beam("axis", along(joint.at, of.up, -2.1 * s), joint.at, a, 1.4 * s, 1.3 * s));
    joint.out = of.up;
  }

  /** A carriage on a beam, a column or a ram. */
  private carriage(axis: Axis, list: Axis[], i: number, joint: Joint): void {
    const parent = list[i + 1]?.name ?? "bed";
    const { s, of } = this;
    const a = axis.direction;
    const inner = list.slice(0, i).some((other) => other.kind === "linear");
    if (inner && !isUpright(of, axis) && this.standsOnFloor(list, i)) return this.foot(axis, parent, joint);
    if (this.isGantry(list, i)) return this.gantry(axis, list[i - 1] ?? axis, joint);
    const normal = this.normal(axis, list[i + 1]);
    const isRam = isParallel(a, joint.out);
    const reach = isRam ? stroke(axis) * 0.5 + 1.6 * s : 1.5 * s;
    const end = isRam ? along(joint.at, joint.out, reach) : along(joint.at, normal, 0);
    if (isRam) this.put(axis.name, beam("axis", joint.at, end, of.right, 1.3 * s, 1.3 * s));
    const centre = isRam ? along(joint.at, joint.out, reach - 0.8 * s) : along(end, normal, 0.5 * s);
    const block: Vec3 = [1.6 * s, 1.6 * s, 1.0 * s];
    this.put(axis.name, box("axis", along(centre, normal, isRam ? 0.4 * s : 0), a, normal, block));
    const near = along(centre, normal, (isRam ? 0.9 : 0.5) * s);
    const face = along(
      near,
      normal,
      Math.max(this.throat(near, normal, list, i), this.headDepth(near, normal, list, i)),
    );
    if (face[0] !== near[0] || face[1] !== near[1] || face[2] !== near[2])
      this.put(axis.name, beam("axis", near, face, a, 1.4 * s, 1.2 * s));
    this.guides(parent, face, axis, normal, 1.6 * s);
    joint.at = along(along(face, a, middle(axis)), normal, this.behind(axis, list, i));
    joint.out = normal;
  }

  /** Way from the face of a carriage to the axis of the next one: behind its rails, and where the next beam lies along
   * them also beside that. */
  private behind(axis: Axis, list: Axis[], i: number): number {
    const next = list[i + 1];
    const beside = next?.kind === "linear" && Math.abs(dot(this.normal(next, list[i + 2]), axis.direction)) > 0.7;
    return (beside && !this.isGantry(list, i + 1) ? 1.76 : 0.96) * this.s;
  }

  /** How far a head reaches behind the face of the carriage that bears it. */
  private headDepth(face: Vec3, normal: Vec3, list: Axis[], i: number): number {
    if (list[i - 1]?.kind !== "rotary" || !isAcross(normal, this.of.up)) return 0;
    const inner = list.slice(0, i + 1).map((axis) => axis.name);
    return Math.max(0, this.extent(normal, inner) - dot(face, normal));
  }

  /** What is missing between a carriage and a column that stands on the floor, so that the table passes before it. */
  private throat(face: Vec3, normal: Vec3, list: Axis[], i: number): number {
    const { of } = this;
    const axis = list[i];
    const next = list[i + 1];
    if (!axis || !isUpright(of, axis) || (next && !this.standsOnFloor(list, i + 1))) return 0;
    const shifts = (of: Axis[], sign: 1 | -1) =>
      of
        .filter((other) => other.kind === "linear")
        .map((other) => {
          const ends = other.travel.map((q) => motion(other) * q * dot(other.direction, normal));
          return sign * Math.max(0, ...ends.map((end) => sign * end));
        });
    const total = (list: number[]) => list.reduce((sum, x) => sum + x, 0);
    const moved = dot(of.chain.workpiece_origin_mm, normal) + 1.3 * of.table + total(shifts(of.workpiece, 1));
    // The foot of the column stands before its rails.
    const table = Math.max(moved, this.extent(normal, this.below) + (next ? 0.35 * this.s : 0));
    return Math.max(0, table - total(shifts(list.slice(i + 1), -1)) - dot(face, normal));
  }

  /** True for the outermost axis of a bridge on two rows of posts. */
  private isGantry(list: Axis[], i: number): boolean {
    const [axis, bridge] = [list[i], list[i - 1]];
    if (!axis || bridge?.kind !== "linear" || i !== list.length - 1) return false;
    return !isUpright(this.of, axis) && !isUpright(this.of, bridge);
  }

  /** Two rows of posts, on which the ends of a bridge run. */
  private gantry(axis: Axis, bridge: Axis, joint: Joint): void {
    const { s, of } = this;
    const run = stroke(axis) + 3 * s;
    const middleOf = along(along(joint.at, joint.out, -0.4 * s), of.up, -0.85 * s);
    for (const way of [-1, 1]) {
      const end = along(middleOf, bridge.direction, way * (stroke(bridge) / 2 + 1.5 * s));
      const low = along(end, of.up, -0.9 * s);
      this.put(axis.name, beam("axis", along(end, of.up, 1.7 * s), low, axis.direction, 2.2 * s, 1.2 * s));
      const wall = along(low, axis.direction, middle(axis));
      this.put("bed", box("guide", along(wall, of.up, -0.08 * s), axis.direction, of.up, [run, 0.5 * s, 0.16 * s]));
      const rail = along(wall, of.up, -0.56 * s);
      this.put("bed", box("bed", rail, axis.direction, of.up, [run, 1.1 * s, 0.8 * s]));
      // Two of them: more would stand before the part.
      for (const share of [-0.48, 0.48]) {
        const top = along(rail, axis.direction, share * (run - s));
        this.put("bed", beam("bed", top, this.atFloor(top), axis.direction, 0.9 * s, 0.9 * s));
      }
    }
    joint.at = this.atFloor(middleOf);
    joint.out = scaled(of.up, -1);
  }

  /** Rails on a beam behind a carriage. */
  private guides(parent: string, face: Vec3, axis: Axis, normal: Vec3, block: number): void {
    const { s } = this;
    const a = axis.direction;
    const side = cross(normal, a);
    const run = stroke(axis) + block;
    const shift = along(face, a, middle(axis));
    for (const way of [-1, 1])
      this.put(
        parent,
        box("guide", along(along(shift, side, way * 0.55 * s), normal, 0.07 * s), a, normal, [run, 0.2 * s, 0.14 * s]),
      );
    const material: Material = parent === "bed" ? "bed" : "axis";
    this.put(parent, box(material, along(shift, normal, 0.55 * s), a, normal, [run, 1.6 * s, 0.82 * s]));
  }

  /** Direction from a carriage to its beam: horizontal, across its motion, and if it can be across the next one's. */
  private normal(axis: Axis, next: Axis | undefined): Vec3 {
    const { of } = this;
    const candidates = [of.back, of.right, of.up].filter((n) => isAcross(n, axis.direction));
    const free = candidates.filter((n) => next?.kind !== "linear" || isAcross(n, next.direction));
    return (isUpright(of, axis) ? free.filter((n) => isAcross(n, of.up)) : free)[0] ?? candidates[0] ?? of.back;
  }

  /** True if the table turns and goes nowhere: then a bridge runs above it. */
  private get isFixedTurntable(): boolean {
    return this.of.workpiece.length > 0 && this.of.workpiece.every(({ kind }) => kind === "rotary");
  }

  /** True if the axis and all that carry it are horizontal: a column that travels over the floor. */
  private standsOnFloor(list: Axis[], i: number): boolean {
    const rest = list.slice(i);
    // A single one above a moving table is a beam on posts.
    if (this.of.kind === "vertical" && this.flat(list) < 2 && this.flat(this.of.workpiece) > 0) return false;
    if (this.of.kind === "vertical" && this.isFixedTurntable) return false;
    const isLow = Math.max(...rest.map(stroke)) < 1400 || this.of.kind !== "vertical";
    return isLow && rest.every((axis) => axis.kind === "linear" && !isUpright(this.of, axis));
  }

  /** Number of horizontal slides. */
  private flat(axes: Axis[]): number {
    return axes.filter((axis) => axis.kind === "linear" && !isUpright(this.of, axis)).length;
  }

  /** The foot of a travelling column. */
  private foot(axis: Axis, parent: string, joint: Joint): void {
    const { s, of } = this;
    const a = axis.direction;
    const low = along(this.atFloor(joint.at), of.up, (parent === "bed" ? 0.8 : 1.5) * s);
    if (this.height(joint.at) - this.height(low) > 0.5 * s)
      this.put(
        axis.name,
        beam(
          "axis",
          along(joint.at, joint.out, -0.07 * s),
          along(low, joint.out, -0.07 * s),
          of.right,
          1.6 * s,
          1.5 * s,
        ),
      );
    this.put(axis.name, box("axis", along(low, of.up, -0.2 * s), a, of.up, [2.6 * s, 2.4 * s, 0.4 * s]));
    const shift = along(along(low, a, middle(axis)), of.up, -0.55 * s);
    this.put(
      parent,
      box(parent === "bed" ? "bed" : "axis", shift, a, of.up, [stroke(axis) + 2.6 * s, 2.0 * s, 0.3 * s]),
    );
    joint.at = along(shift, of.up, -0.15 * s);
    joint.out = scaled(of.up, -1);
  }

  /** A column with rails, as high as the travel of what hangs on it, down to the floor. */
  private column(body: string, face: Vec3, axis: Axis, block: number): void {
    this.guides(body, face, axis, this.of.back, 2 * block);
  }

  /** What holds the last beam up. */
  private standing(list: Axis[], joint: Joint): void {
    const { s, of } = this;
    const last = list[list.length - 1];
    if (this.isGantry(list, list.length - 1)) return;
    if (this.height(joint.at) - this.floor < 1.2 * s && last) return this.plinth(joint);
    const isBeam = last?.kind === "linear" && !isUpright(of, last);
    const half = isBeam ? this.halfBeam(last, joint) : 0;
    const ends = isBeam ? [-1, 1].map((way) => along(joint.at, last.direction, way * half)) : [joint.at];
    if (half > (stroke(last as Axis) + 1.6 * s) / 2)
      this.put(
        "bed",
        box("bed", along(joint.at, joint.out, -0.41 * s), last?.direction ?? of.right, joint.out, [
          2 * half,
          1.6 * s,
          0.82 * s,
        ]),
      );
    for (const end of ends) {
      const top = along(along(end, joint.out, isBeam ? -0.35 * s : 0.1 * s), of.up, isBeam ? 0.85 * s : 0);
      this.put("bed", beam("bed", top, this.atFloor(top), of.right, 1.4 * s, 1.2 * s));
    }
    const foot = this.atFloor(joint.at);
    const width = isBeam ? 2 * half + 1.4 * s : 3 * s;
    this.put(
      "bed",
      box("bed", along(foot, of.up, 0.25 * s), isBeam ? last.direction : of.right, of.up, [width, 2.2 * s, 0.5 * s]),
    );
    this.tie(foot);
  }

  /** Half the way between the posts of a beam: the carriage and the table pass between them. */
  private halfBeam(axis: Axis, joint: Joint): number {
    const { s, of } = this;
    const moving = of.chain.axes.flatMap(({ name }) => this.shapes.get(name) ?? []);
    const [front, rear] = [dot(joint.at, joint.out) - 0.95 * s, dot(joint.at, joint.out) + 0.25 * s];
    const beside = moving.filter(
      (shape) => farthest(shape, joint.out) > front + 1e-6 * s && -farthest(shape, scaled(joint.out, -1)) < rear,
    );
    const middle = dot(joint.at, axis.direction);
    const sides = [-1, 1].flatMap((way) =>
      beside.map((shape) => farthest(shape, scaled(axis.direction, way)) - way * middle + 0.75 * s),
    );
    return Math.max((stroke(axis) + 1.6 * s) / 2, ...sides);
  }

  private plinth(joint: Joint): void {
    const foot = this.atFloor(joint.at);
    this.put("bed", beam("bed", joint.at, foot, this.of.right, 2.4 * this.s, 2.4 * this.s));
    this.tie(foot);
  }

  /** The base that ties the column to the bed of the part. */
  private tie(foot: Vec3): void {
    const { s, of } = this;
    const under = this.atFloor(of.chain.workpiece_origin_mm);
    if (of.kind === "lathe") return;
    if (norm(minus(foot, under)) < s) return;
    this.put(
      "bed",
      beam(
        "bed",
        along(foot, of.up, 0.2 * s),
        along(under, of.up, 0.2 * s),
        cross(of.up, unit(minus(under, foot))),
        2.4 * s,
        0.4 * s,
      ),
    );
  }

  // A robot.

  /** Each joint is two housings that meet in a plane across its line: one of the link before, one of the next. */
  robot(): void {
    const { tool, toolInUse } = this.of;
    const { s } = this;
    const ends = [...tool.map((axis) => axis.origin_mm), toolInUse.gauge_mm];
    const way = (i: number) => norm(minus(ends[i + 1] as Vec3, ends[i] as Vec3)) || Infinity;
    const radii = tool.map((_, i) =>
      Math.min((0.52 - 0.05 * i) * s, 0.45 * way(i), 0.45 * (i ? way(i - 1) : Infinity)),
    );
    const lines = tool.map((axis, i) => {
      const [at, next] = [ends[i], ends[i + 1]] as [Vec3, Vec3];
      return dot(axis.direction, minus(next, at)) < 0 ? scaled(axis.direction, -1) : axis.direction;
    });
    tool.forEach((axis, i) => {
      const [at, next, line] = [ends[i], ends[i + 1], lines[i]] as [Vec3, Vec3, Vec3];
      const [radius, thin] = [radii[i] ?? s, radii[i + 1] ?? 0];
      const parent = tool[i - 1]?.name ?? "bed";
      this.put(parent, bar(i ? "axis" : "bed", along(at, line, -radius), at, i ? radius : 1.4 * radius, radius));
      this.put(axis.name, bar("rotary", at, along(at, line, radius), radius));
      const beside = lines[i + 1] ? scaled(lines[i + 1] as Vec3, -0.55 * thin) : ([0, 0, 0] as Vec3);
      const from = along(along(at, line, 0.55 * radius), across(beside, line), 1);
      const to = along(next, beside, 1);
      const wide = 0.42 * Math.min(radius, thin || radius);
      this.put(axis.name, bar("axis", from, to, wide));
    });
    const body = tool[tool.length - 1]?.name ?? "bed";
    this.put(body, bar("tool", toolInUse.gauge_mm, toolInUse.tip_mm, 0.12 * s));
    this.floor = this.height(this.of.chain.workpiece_origin_mm);
  }
}

/** How far a shape reaches along a direction. */
function farthest({ geometry }: Shape, direction: Vec3): number {
  const at = geometry.getAttribute("position");
  let most = -Infinity;
  for (let i = 0; i < at.count; i += 1) most = Math.max(most, dot([at.getX(i), at.getY(i), at.getZ(i)], direction));
  return most;
}

/** The point of a line that comes nearest to another one. */
function crossing(origin: Vec3, a: Vec3, other: Vec3, b: Vec3): Vec3 {
  const between = minus(other, origin);
  const k = dot(a, b);
  return along(origin, a, (dot(between, a) - k * dot(between, b)) / Math.max(1 - k * k, 1e-9));
}

const scaledSum = (a: Vec3, b: Vec3): Vec3 => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2];
