/** Vectors of three numbers. */

import type { Vec3 } from "../evaluator/types";

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const scaled = (a: Vec3, k: number): Vec3 => [a[0] * k, a[1] * k, a[2] * k];
export const minus = (a: Vec3, b: Vec3): Vec3 => add(a, scaled(b, -1));
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a: Vec3): number => Math.sqrt(dot(a, a));
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const unit = (a: Vec3): Vec3 => scaled(a, 1 / (norm(a) || 1));
export const along = (a: Vec3, b: Vec3, k: number): Vec3 => add(a, scaled(b, k));
export const isParallel = (a: Vec3, b: Vec3): boolean => Math.abs(dot(a, b)) > 0.94;
export const isAcross = (a: Vec3, b: Vec3): boolean => Math.abs(dot(a, b)) < 0.34;

/** Returns the point of a line that is nearest to a point. */
export const foot = (point: Vec3, origin: Vec3, direction: Vec3): Vec3 =>
  along(origin, direction, dot(minus(point, origin), direction));

/** Returns the vector without its part along a direction. */
export const across = (a: Vec3, direction: Vec3): Vec3 => along(a, direction, -dot(a, direction));
