/** Dragging a body moves one of the axes that carry it, the one that moves most nearly as the hand does: along its
 * direction, or about its line, as far as the travel goes. */

import * as three from "three";
import type { Axis, Vec3 } from "../evaluator/types";
import { motion } from "./layout";
import { across, along, cross, dot, foot, minus, norm, scaled, unit } from "./vectors";

/** A ray of sight, or the line of an axis; the direction is a unit vector. */
export interface Line {
  origin: Vec3;
  direction: Vec3;
}

/** An axis as it stands at the pose at which a body of it was taken. */
export interface Grip {
  axis: Axis;
  /** Its position then, mm or deg. */
  position: number;
  /** Its line in the machine's coordinates; the body moves along or about it with the sense of the picture. */
  line: Line;
  /** The point that was taken. */
  point: Vec3;
}

/** Where the sine between two lines is below this, no place on one of them is under the pointer. */
const ASTRIDE = 0.05;
/** Where the line of sight is this much along the plane of a turn, a turn follows the tangent. */
const FLAT = 0.25;

/** Returns how far along `line` the place is that `ray` comes nearest to; `null` where they are nearly parallel. */
export function nearest(line: Line, ray: Line): number | null {
  const cosine = dot(line.direction, ray.direction);
  const below = 1 - cosine * cosine;
  if (below < ASTRIDE * ASTRIDE) return null;
  const between = minus(ray.origin, line.origin);
  return (dot(between, line.direction) - dot(between, ray.direction) * cosine) / below;
}

/** Returns the angle, deg, by which the point that was taken must turn to come under the ray. */
export function turned(line: Line, point: Vec3, ray: Line): number | null {
  const centre = foot(point, line.origin, line.direction);
  const arm = minus(point, centre);
  const radius = norm(arm);
  if (radius < 1e-6) return null;
  const slope = dot(ray.direction, line.direction);
  const tangent = cross(line.direction, unit(arm));
  if (Math.abs(slope) < FLAT) {
    const way = nearest({ origin: point, direction: tangent }, ray);
    return way === null ? null : (way / radius) * (180 / Math.PI);
  }
  const hit = along(ray.origin, ray.direction, dot(minus(centre, ray.origin), line.direction) / slope);
  const now = across(minus(hit, centre), line.direction);
  return Math.atan2(dot(now, tangent), dot(now, unit(arm))) * (180 / Math.PI);
}

/** Returns the position to which a ray drags an axis; `null` where the picture does not tell. */
export function dragged(grip: Grip, ray: Line, last: number): number | null {
  const { axis, line, point, position } = grip;
  const way = axis.kind === "linear" ? nearest({ ...line, origin: point }, ray) : turned(line, point, ray);
  if (way === null) return null;
  let next = position + way * motion(axis);
  // A turn goes on where it was: not back by the other way round.
  if (axis.kind === "rotary") next += 360 * Math.round((last - next) / 360);
  return axis.continuous ? next : Math.min(Math.max(next, axis.travel[0]), axis.travel[1]);
}

type Place = [number, number];

/** Of two axes that move nearly alike the one nearer to the body is meant: cosine for each axis between them. */
const NEARER = 0.05;

/** Returns the grip whose axis moves the point, as `project` shows it, most nearly along `by`. */
export function meant(grips: Grip[], project: (point: Vec3) => Place, by: Place): Grip | null {
  const fit = ({ axis, line, point }: Grip, order: number): number => {
    const arm = across(minus(point, line.origin), line.direction);
    const motion = axis.kind === "linear" ? line.direction : scaled(cross(line.direction, arm), 1e-3);
    const [from, to] = [project(point), project(along(point, motion, 1))];
    const way: Place = [to[0] - from[0], to[1] - from[1]];
    const length = Math.hypot(...way) * Math.hypot(...by);
    return length > 0 ? Math.abs(way[0] * by[0] + way[1] * by[1]) / length - NEARER * order : -1;
  };
  const fits = grips.map(fit);
  const best = Math.max(...fits);
  return best > 0 ? (grips[fits.indexOf(best)] ?? null) : null;
}

/** Way of the pointer after which it is clear what is meant, pixels. */
const MEANT = 5;

/** What a drag needs of the picture. */
export interface Handles {
  /** Grips of the axes that carry the body under the pointer, the nearest first; none where a mark hides it. */
  grips: (ray: three.Raycaster) => Grip[];
  moved: (axis: Axis, position: number, rests: boolean) => void;
}

/** Listens on the canvas; made before the camera's controls, which do not hear of a press that takes a body. */
export class Drag {
  private readonly ray = new three.Raycaster();
  private held: { grips: Grip[]; from: Place; grip: Grip | null; last: number } | null = null;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly camera: three.Camera,
    private readonly handles: Handles,
  ) {
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(end, (event) => this.release(event));
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0 || !event.isPrimary || event.shiftKey || event.ctrlKey || event.metaKey) return;
    this.aim(event);
    const grips = this.handles.grips(this.ray);
    if (!grips.length) return;
    event.stopImmediatePropagation();
    this.canvas.focus();
    this.canvas.setPointerCapture(event.pointerId);
    this.held = { grips, from: [event.offsetX, event.offsetY], grip: null, last: 0 };
  }

  private move(event: PointerEvent): void {
    if (!this.held) {
      if (!event.buttons) this.hint(event);
      return;
    }
    event.stopImmediatePropagation();
    this.aim(event);
    const grip = this.taken(this.held, event);
    if (!grip) return;
    const { origin, direction } = this.ray.ray;
    const next = dragged(grip, { origin: origin.toArray(), direction: direction.toArray() }, this.held.last);
    if (next === null) return;
    this.held.last = next;
    this.handles.moved(grip.axis, next, false);
  }

  /** The grip, once the way of the pointer tells which is meant. */
  private taken(held: NonNullable<typeof this.held>, event: PointerEvent): Grip | null {
    if (held.grip) return held.grip;
    const by: Place = [event.offsetX - held.from[0], event.offsetY - held.from[1]];
    if (Math.hypot(...by) < MEANT) return null;
    held.grip = meant(held.grips, (point) => this.project(point), by);
    held.last = held.grip?.position ?? 0;
    return held.grip;
  }

  private project(point: Vec3): Place {
    const { x, y } = new three.Vector3(...point).project(this.camera);
    return [(x * this.canvas.clientWidth) / 2, (-y * this.canvas.clientHeight) / 2];
  }

  private release(event: PointerEvent): void {
    if (!this.held) return;
    event.stopImmediatePropagation();
    const { grip, last } = this.held;
    this.held = null;
    if (grip) this.handles.moved(grip.axis, last, true);
  }

  private hinting = false;

  /** The pointer says that a body can be taken. */
  private hint(event: PointerEvent): void {
    if (this.hinting) return;
    this.hinting = true;
    requestAnimationFrame(() => {
      this.hinting = false;
      this.aim(event);
      this.canvas.style.cursor = this.handles.grips(this.ray).length ? "grab" : "";
    });
  }

  private aim(event: PointerEvent): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const at = new three.Vector2((2 * event.offsetX) / width - 1, 1 - (2 * event.offsetY) / height);
    this.ray.setFromCamera(at, this.camera);
  }
}
