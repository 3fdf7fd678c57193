/** How deep two convex bodies lie in each other, from their triangles alone: the axes of separation of polytopes. */

import type { BufferGeometry } from "three";
import type { Vec3 } from "../src/evaluator/types";
import { cross, dot, minus, norm, unit } from "../src/machine/vectors";

/** A convex body: its corners, and the directions of its faces and edges. */
export interface Solid {
  corners: Vec3[];
  normals: Vec3[];
  edges: Vec3[];
  low: Vec3;
  high: Vec3;
}

export function solid(geometry: BufferGeometry): Solid {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  const at = flat.getAttribute("position");
  const corners = Array.from({ length: at.count }, (_, i): Vec3 => [at.getX(i), at.getY(i), at.getZ(i)]);
  const normals = new Map<string, Vec3>();
  const edges = new Map<string, Vec3>();
  const put = (into: Map<string, Vec3>, v: Vec3) => {
    if (norm(v) < 1e-9) return;
    const first = v.find((x) => Math.abs(x) > 1e-6 * norm(v)) ?? 1;
    const one = unit(first < 0 ? (v.map((x) => -x) as Vec3) : v);
    into.set(one.map((x) => x.toFixed(4)).join(), one);
  };
  for (let i = 0; i + 2 < corners.length; i += 3) {
    const [a, b, c] = [corners[i], corners[i + 1], corners[i + 2]] as [Vec3, Vec3, Vec3];
    put(normals, cross(minus(b, a), minus(c, a)));
    for (const [p, q] of [
      [a, b],
      [b, c],
      [c, a],
    ] as [Vec3, Vec3][])
      put(edges, minus(q, p));
  }
  const unique = new Map(corners.map((v) => [v.map((x) => x.toFixed(6)).join(), v]));
  const all = [...unique.values()];
  const end = (pick: (...list: number[]) => number) =>
    [0, 1, 2].map((k) => pick(...all.map((v) => v[k] as number))) as Vec3;
  return {
    corners: all,
    normals: [...normals.values()],
    edges: [...edges.values()],
    low: end(Math.min),
    high: end(Math.max),
  };
}

/** Least way by which one of two bodies has to be moved until they part; 0 where they do not overlap. */
export function depth(a: Solid, b: Solid): number {
  if ([0, 1, 2].some((k) => (a.low[k] ?? 0) >= (b.high[k] ?? 0) || (b.low[k] ?? 0) >= (a.high[k] ?? 0))) return 0;
  let least = Infinity;
  const part = (axis: Vec3) => {
    const [p, q] = [range(a.corners, axis), range(b.corners, axis)];
    least = Math.min(least, p[1] - q[0], q[1] - p[0]);
    return least <= 0;
  };
  for (const axis of [...a.normals, ...b.normals]) if (part(axis)) return 0;
  for (const e of a.edges)
    for (const f of b.edges) {
      const axis = cross(e, f);
      if (norm(axis) > 1e-6 && part(unit(axis))) return 0;
    }
  return least;
}

function range(corners: Vec3[], axis: Vec3): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const v of corners) {
    const x = dot(v, axis);
    low = Math.min(low, x);
    high = Math.max(high, x);
  }
  return [low, high];
}
