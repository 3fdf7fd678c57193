/** Dragging bodies: the point that was taken comes under the pointer, within the travel. */

import assert from "node:assert/strict";
import { test } from "node:test";
import type { Axis, Chain, Vec3 } from "../src/evaluator/types";
import { dragged, type Line, meant, nearest, turned } from "../src/machine/drag";
import { Figure, type Materials } from "../src/machine/figure";
import { rim, way } from "../src/machine/guide";
import { add, along, cross, minus, norm, scaled, unit } from "../src/machine/vectors";
import * as three from "three";
import { random } from "./random";

/** Numbers from 0 to 1. */
function shares(seed: number): () => number {
  const next = random(seed);
  return () => next(1e6) / 1e6;
}

const axis = (change: Partial<Axis>): Axis => ({
  arm_mm: { at_zero: 0, longest: 0, share: null },
  geometry_stated: true,
  other_side: null,
  name: "X",
  kind: "linear",
  side: "tool",
  sense: "iso841",
  direction: [1, 0, 0],
  origin_mm: [0, 0, 0],
  travel: [-100, 200],
  continuous: false,
  unit: "mm",
  ...change,
});

/** A ray of sight through a point, from a place aside. */
function sight(through: Vec3, from: Vec3): Line {
  return { origin: from, direction: unit(minus(through, from)) };
}

test("the place on a line that a ray comes nearest to", () => {
  const next = shares(1);
  const any = (): Vec3 => [next() * 2 - 1, next() * 2 - 1, next() * 2 - 1];
  for (let i = 0; i < 200; i++) {
    const line = { origin: scaled(any(), 100), direction: unit(any()) };
    const away = next() * 50;
    const at = along(line.origin, line.direction, away);
    // A ray that passes beside the place, at right angles to both.
    const aside = unit(cross(line.direction, any()));
    const ray = {
      origin: along(at, aside, 30),
      direction: unit(add(scaled(cross(aside, line.direction), 1), scaled(line.direction, 0.3))),
    };
    assert.ok(Math.abs((nearest(line, ray) ?? NaN) - away) < 1e-9);
  }
  assert.equal(nearest({ origin: [0, 0, 0], direction: [1, 0, 0] }, { origin: [0, 1, 0], direction: [1, 0, 0] }), null);
});

test("a turn brings the point under the ray, seen along the axis and across it", () => {
  const line: Line = { origin: [10, 20, 0], direction: [0, 0, 1] };
  const point: Vec3 = [60, 20, 5];
  for (const angle of [-120, -30, 1, 45, 90, 170]) {
    const radians = (angle * Math.PI) / 180;
    const wanted: Vec3 = [10 + 50 * Math.cos(radians), 20 + 50 * Math.sin(radians), 5];
    const found = turned(line, point, sight(wanted, [200, -300, 400]));
    assert.ok(Math.abs((found ?? NaN) - angle) < 1e-6, `${found} ${angle}`);
  }
  // Seen from the side a turn follows the tangent: 10 mm at 50 mm.
  const found = turned(line, point, sight([60, 30, 5], [1000, 30, 5]));
  assert.ok(Math.abs((found ?? NaN) - 0.2 * (180 / Math.PI)) < 1e-9);
  assert.equal(turned(line, [10, 20, 7], sight([0, 0, 0], [1, 1, 1])), null, "a point of the line itself");
});

test("a drag ends at the travel, and turns without end go on", () => {
  const line: Line = { origin: [0, 0, 0], direction: [1, 0, 0] };
  const grip = { axis: axis({}), position: 20, line, point: [5, 0, 0] as Vec3 };
  const to = (x: number) => dragged(grip, sight([x, 0, 0], [x, 500, 80]), 20);
  assert.ok(Math.abs((to(45) ?? NaN) - 60) < 1e-9);
  assert.equal(to(900), 200);
  assert.equal(to(-900), -100);
  // A table runs the other way.
  const table = { ...grip, axis: axis({ side: "workpiece" }) };
  assert.ok(Math.abs((dragged(table, sight([45, 0, 0], [45, 500, 80]), 20) ?? NaN) + 20) < 1e-9);
  const turn = axis({ kind: "rotary", continuous: true, travel: [0, 360], direction: [0, 0, 1], unit: "deg" });
  const held = {
    axis: turn,
    position: 170,
    line: { origin: [0, 0, 0], direction: [0, 0, 1] } as Line,
    point: [50, 0, 0] as Vec3,
  };
  const at = (angle: number): Vec3 => [
    50 * Math.cos((angle * Math.PI) / 180),
    50 * Math.sin((angle * Math.PI) / 180),
    0,
  ];
  let last = 170;
  for (const angle of [60, 120, 179, 200, 250]) last = dragged(held, sight(at(angle), [0, -100, 300]), last) ?? NaN;
  assert.ok(Math.abs(last - 420) < 1e-6, `${last}`);
});

test("the guide ends where the travel does", () => {
  const line: Line = { origin: [0, 0, 0], direction: [1, 0, 0] };
  assert.deepEqual(way(axis({}), line, [7, 1, 2], 20), [
    [-113, 1, 2],
    [187, 1, 2],
  ]);
  const turn = axis({ kind: "rotary", direction: [0, 0, 1], travel: [-90, 90], unit: "deg" });
  const arc = way(turn, { origin: [0, 0, 0], direction: [0, 0, 1] }, [10, 0, 3], 0);
  assert.ok(
    norm(minus(arc[0] as Vec3, [0, -10, 3])) < 1e-9 && norm(minus(arc[arc.length - 1] as Vec3, [0, 10, 3])) < 1e-9,
  );
});

test("the axis is meant that moves as the hand does", () => {
  const held = (of: Axis, line: Line) => ({ axis: of, position: 0, line, point: [40, 0, 30] as Vec3 });
  const x = held(axis({}), { origin: [0, 0, 0], direction: [1, 0, 0] });
  const z = held(axis({ name: "Z" }), { origin: [0, 0, 0], direction: [0, 0, 1] });
  const b = held(axis({ name: "B", kind: "rotary" }), { origin: [40, 0, 0], direction: [0, 1, 0] });
  // Seen from the front: X to the right, Z up.
  const front = ([px, , pz]: Vec3): [number, number] => [px, -pz];
  const name = (by: [number, number], ...list: (typeof x)[]) => meant(list, front, by)?.axis.name;
  assert.equal(name([10, 1], z, x), "X");
  assert.equal(name([1, -10], x, z), "Z");
  // B moves the point to the right too: the nearer one of the two.
  assert.equal(name([10, 0], b, z, x), "B");
  assert.equal(name([10, 0], x, z, b), "X");
  assert.equal(name([10, 0], z), undefined, "across all of its motion");
});

test("the mark on the edge of a table turns with it, and its ends stay", () => {
  const line: Line = { origin: [10, 5, 0], direction: [0, 0, 1] };
  const table = axis({ kind: "rotary", side: "workpiece", direction: [0, 0, 1], travel: [-90, 90], unit: "deg" });
  const mark = rim(table, line, 50, 30);
  // The table of ISO 841 turns the other way than its word.
  const angle = (-30 * Math.PI) / 180;
  assert.ok(norm(minus(mark, [10 + 50 * Math.cos(angle), 5 + 50 * Math.sin(angle), 0])) < 1e-9);
  const ends = (position: number) => way(table, line, rim(table, line, 50, position), position);
  const [now, later] = [ends(30), ends(-70)];
  for (const k of [0, now.length - 1]) assert.ok(norm(minus(now[k] as Vec3, later[k] as Vec3)) < 1e-9);
});

/** A tilting table that carries a table, and a head that turns. */
const CHAIN = {
  machine: "M",
  chain: "w C' A' b X Z B t",
  axes: [
    axis({
      name: "C",
      kind: "rotary",
      side: "workpiece",
      direction: [0, 0, 1],
      origin_mm: [10, 5, -80],
      continuous: true,
      travel: [0, 360],
      unit: "deg",
    }),
    axis({
      name: "A",
      kind: "rotary",
      side: "workpiece",
      direction: [1, 0, 0],
      origin_mm: [0, 5, -60],
      travel: [-90, 90],
      unit: "deg",
    }),
    axis({ name: "X" }),
    axis({ name: "Z", direction: [0, 0, 1], travel: [0, 300] }),
    axis({ name: "B", kind: "rotary", direction: [0, 1, 0], origin_mm: [0, 0, 200], travel: [-100, 100], unit: "deg" }),
  ],
  tools: [{ name: "t", gauge_mm: [0, 0, 120], tip_mm: [0, 0, 0], direction: [0, 0, 1] }],
  workpiece_origin_mm: [0, 0, -40],
  workpiece_rotation_deg: [0, 0, 0],
} as Chain;

test("in the picture the point that was taken follows the pointer, at any pose", () => {
  const any = new three.MeshBasicMaterial();
  const materials = new Proxy({}, { get: () => any }) as Materials;
  const figure = new Figure(CHAIN, "t", materials);
  const next = shares(7);
  for (let i = 0; i < 60; i++) {
    const pose = Object.fromEntries(CHAIN.axes.map((of) => [of.name, 60 * next() - 30]));
    figure.move(pose);
    for (const of of CHAIN.axes) {
      const line = figure.line(of);
      const point = figure.moved(of);
      const target = (pose[of.name] ?? 0) + 20 * next() - 10;
      // Where the point is at the target, by the picture itself.
      figure.move({ ...pose, [of.name]: target });
      const there = figure.moved(of);
      figure.move(pose);
      // From above and aside of the motion: the ray is not along it.
      const aside = of.kind === "rotary" ? line.direction : unit(cross(line.direction, [0.3, 0.5, 0.8]));
      const ray = sight(there, along(there, aside, 700));
      const found = dragged({ axis: of, position: pose[of.name] ?? 0, line, point }, ray, pose[of.name] ?? 0);
      if (of.travel[0] <= target && target <= of.travel[1])
        assert.ok(Math.abs((found ?? NaN) - target) < 1e-6, `${of.name}: ${found}, wanted ${target}`);
    }
  }
});
