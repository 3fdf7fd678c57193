/** The axis at hand: its travel with both ends, and of a rotary axis the arm from its line to the tip of the tool. */

import * as three from "three";
import type { Axis, Vec3 } from "../evaluator/types";
import { motion } from "./layout";
import type { Line } from "./drag";
import { across, along, foot, minus, norm, unit } from "./vectors";

/** Steps of an arc. */
const STEPS = 48;

/** Points of the way on which an axis takes a point that is where it is at `position`, from one end of the travel to
 * the other; a whole turn where there are no ends. */
export function way(axis: Axis, line: Line, point: Vec3, position: number): Vec3[] {
  const [low, high] = axis.continuous ? [position - 180, position + 180] : axis.travel;
  const sense = motion(axis);
  if (axis.kind === "linear") return [low, high].map((end) => along(point, line.direction, sense * (end - position)));
  const direction = new three.Vector3(...line.direction);
  const origin = new three.Vector3(...line.origin);
  return Array.from({ length: STEPS + 1 }, (_, k) => {
    const angle = ((low + ((high - low) * k) / STEPS - position) * sense * Math.PI) / 180;
    return new three.Vector3(...point).sub(origin).applyAxisAngle(direction, angle).add(origin).toArray() as Vec3;
  });
}

/** A place on the edge of a table, where it stands at `position`. */
export function rim(axis: Axis, line: Line, radius: number, position: number): Vec3 {
  const aside = Math.abs(line.direction[2]) < 0.9 ? ([0, 0, 1] as Vec3) : ([1, 0, 0] as Vec3);
  const zero = along(line.origin, unit(across(aside, line.direction)), radius);
  const turn = { ...axis, continuous: false, travel: [position, position] as [number, number] };
  return way(turn, line, zero, 0)[0] ?? zero;
}

/** What the guide of an axis is drawn for. */
export interface Guided {
  axis: Axis;
  line: Line;
  position: number;
  /** The point that the axis moves. */
  moved: Vec3;
  /** The tip of the tool. */
  tip: Vec3;
  /** Width of a casting, and half that of the table, mm. */
  size: number;
  table: number;
}

export class Guide {
  readonly group = new three.Group();
  private readonly material = new three.LineBasicMaterial({ color: 0xc2185b, depthTest: false, transparent: true });
  private readonly solid = new three.MeshBasicMaterial({ color: 0xc2185b, depthTest: false, transparent: true });

  show({ axis, line, position, moved, tip, size, table }: Guided): void {
    this.clear();
    const onTable = axis.kind === "rotary" && axis.side === "workpiece";
    const point = onTable ? rim(axis, line, table, position) : moved;
    const points = way(axis, line, point, position);
    this.line(points);
    const ends = axis.continuous ? [] : [points[0], points[points.length - 1]];
    for (const end of ends) if (end) this.ball(end, 0.09 * size);
    if (onTable) this.ball(point, 0.05 * size);
    if (axis.kind === "rotary") this.arm(foot(tip, line.origin, line.direction), tip, size);
  }

  /** The arm by which a tilt of the axis moves the tip. */
  private arm(centre: Vec3, tip: Vec3, size: number): void {
    if (norm(minus(tip, centre)) < 1e-6) return;
    this.line([centre, tip]);
    this.ball(centre, 0.06 * size);
  }

  clear(): void {
    for (const old of [...this.group.children] as (three.Mesh | three.Line)[]) {
      old.geometry.dispose();
      old.removeFromParent();
    }
  }

  private line(points: Vec3[]): void {
    const shape = new three.BufferGeometry().setFromPoints(points.map((point) => new three.Vector3(...point)));
    this.put(new three.Line(shape, this.material));
  }

  private ball(at: Vec3, radius: number): void {
    const mesh = new three.Mesh(new three.SphereGeometry(radius, 14, 10), this.solid);
    mesh.position.set(...at);
    this.put(mesh);
  }

  private put(object: three.Object3D): void {
    object.renderOrder = 9;
    this.group.add(object);
  }
}
