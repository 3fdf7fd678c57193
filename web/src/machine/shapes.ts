/** Shapes of castings, in machine coordinates at the zero pose. */

import * as three from "three";
import type { Vec3 } from "../evaluator/types";
import { add, cross, isParallel, minus, norm, scaled, unit } from "./vectors";

/** What a shape is made of; its colour is that of the theme. */
export type Material = "bed" | "axis" | "rotary" | "guide" | "spindle" | "tool" | "part" | "work" | "line";

export interface Shape {
  geometry: three.BufferGeometry;
  material: Material;
}

const vector = (v: Vec3) => new three.Vector3(...v);

/** A box about `middle` with edges along `x`, across it towards `z`, and along `z`: their full lengths. */
export function box(material: Material, middle: Vec3, x: Vec3, z: Vec3, size: Vec3): Shape {
  const geometry = new three.BoxGeometry(...size);
  const y = cross(z, x);
  const matrix = new three.Matrix4().makeBasis(vector(x), vector(y), vector(z)).setPosition(vector(middle));
  return { geometry: geometry.applyMatrix4(matrix), material };
}

/** A round bar from one point to another. */
export function bar(material: Material, from: Vec3, to: Vec3, radius: number, end = radius): Shape {
  const length = Math.max(norm(minus(to, from)), 1e-6);
  const geometry = new three.CylinderGeometry(end, radius, length, 40);
  const direction = unit(minus(to, from));
  const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), vector(direction));
  geometry.applyQuaternion(turn).translate(...scaled(add(from, to), 0.5));
  return { geometry, material };
}

/** A square beam from one point to another; `side` is a direction across it. */
export function beam(material: Material, from: Vec3, to: Vec3, side: Vec3, width: number, depth: number): Shape {
  const direction = unit(minus(to, from));
  const x = isParallel(direction, side) ? unit(cross(direction, [direction[1], direction[2], direction[0]])) : side;
  const across = unit(cross(cross(direction, x), direction));
  return box(material, scaled(add(from, to), 0.5), across, direction, [width, depth, norm(minus(to, from))]);
}

/** A ball, for a pivot. */
export function ball(material: Material, middle: Vec3, radius: number): Shape {
  return { geometry: new three.SphereGeometry(radius, 24, 16).translate(...middle), material };
}
