/** Castings: at the zero pose no body of any machine of `configs/` lies in another one. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync } from "node:fs";
import { test } from "node:test";
import * as three from "three";
import type { Chain, Vec3 } from "../src/evaluator/types";
import { castings } from "../src/machine/castings";
import { Figure, type Materials } from "../src/machine/figure";
import { layout } from "../src/machine/layout";
import { Marks, type WorkPoint } from "../src/machine/marks";
import { ball, bar, box } from "../src/machine/shapes";
import { depth, solid } from "./overlap";

const program = process.env["ABBE_PROGRAM"];
const skip = program ? false : "ABBE_PROGRAM names the program";

/** Share of the width of a casting: rounding of coordinates in single precision. */
const ROUNDING = 1e-5;

function machines(): string[] {
  const files = readdirSync("../configs", { recursive: true, encoding: "utf8" });
  return files.filter((file) => file.endsWith(".yaml")).sort();
}

function chainOf(machine: string): Chain {
  const options = ["show", `../configs/${machine}`, "--format", "json", "--quiet"];
  return JSON.parse(execFileSync(program ?? "", options, { encoding: "utf8", stdio: "pipe" })) as Chain;
}

/** Pairs of bodies that lie in each other, in widths of a casting. A longer tool than the first one is left out: at the
 * zero pose of the file it may reach into the table, where the machine would collide. */
function overlaps(chain: Chain, tool: string): string[] {
  const of = layout(chain, tool);
  assert.ok(of);
  const isFirst = tool === chain.tools[0]?.name;
  const bodies = [...castings(of)].map(([name, shapes]) => ({
    name,
    solids: shapes.filter((s) => isFirst || s.material !== "tool").map((s) => solid(s.geometry)),
  }));
  return bodies.flatMap((a, i) =>
    bodies.slice(0, i).flatMap((b) => {
      const most = Math.max(...a.solids.flatMap((p) => b.solids.map((q) => depth(p, q)))) / of.size;
      return most > ROUNDING ? [`${a.name} in ${b.name} by ${most.toFixed(3)}`] : [];
    }),
  );
}

test("how deep bodies lie in each other, against closed forms", () => {
  const cube = (x: number) => solid(box("axis", [x, 0, 0], [1, 0, 0], [0, 0, 1], [2, 2, 2]).geometry);
  assert.ok(Math.abs(depth(cube(0), cube(1.7)) - 0.3) < 1e-6);
  assert.equal(depth(cube(0), cube(2)), 0);
  const edge = Math.SQRT1_2;
  const turned = (x: number) => solid(box("axis", [x, 0, 0], [edge, edge, 0], [0, 0, 1], [2, 2, 2]).geometry);
  assert.ok(Math.abs(depth(cube(0), turned(2.2)) - (1 + Math.SQRT2 - 2.2)) < 1e-6);
  const crossed = (from: Vec3, to: Vec3) => solid(bar("axis", from, to, 1).geometry);
  // A cylinder is drawn with 40 sides: its corners lie on the circle.
  const by = depth(crossed([0, 0, -5], [0, 0, 5]), crossed([1.5, -5, 0], [1.5, 5, 0]));
  assert.ok(by <= 0.5 + 1e-6 && by > 0.5 - 0.01, `${by}`);
  const [a, b] = [ball("axis", [0, 0, 0], 1), ball("axis", [1.2, 1.6, 0], 1)].map((of) => solid(of.geometry));
  assert.ok(a && b && depth(a, b) < 1e-6);
});

const materials = new Proxy({}, { get: () => new three.MeshBasicMaterial() }) as Materials;

test("no bodies lie in each other at the zero pose, with any tool of any machine", { skip }, () => {
  const all = machines();
  assert.ok(all.length > 20, `${all.length} machines`);
  for (const machine of all) {
    const chain = chainOf(machine);
    for (const { name } of chain.tools) assert.deepEqual(overlaps(chain, name), [], `${machine} ${name}`);
  }
});

test("the camera stands where it sees the tool: on the left where posts are on the right", { skip }, () => {
  const sides = ["hh-ca-gantry.yaml", "trunnion.yaml"].map((machine) => {
    const figure = new Figure(chainOf(machine), "", materials);
    const { center, place } = figure.viewpoint(figure.corners({}));
    assert.equal(figure.sight(place), 1, machine);
    const width = 0.3 * place.distanceTo(center);
    const wall = new three.Mesh(new three.BoxGeometry(width, width, width), new three.MeshBasicMaterial());
    wall.position.copy(place).lerp(new three.Vector3(...figure.tip), 0.5);
    figure.root.add(wall);
    wall.updateMatrixWorld();
    assert.equal(figure.sight(place), 0, `${machine}: behind a wall`);
    return Math.sign(place.sub(center).dot(new three.Vector3(...figure.layout.right)));
  });
  assert.deepEqual(sides, [-1, 1]);
});

test("each axis has a body that shows", { skip }, () => {
  for (const machine of machines()) {
    const chain = chainOf(machine);
    const of = layout(chain, "");
    const shapes = of && castings(of);
    for (const { name } of chain.axes) {
      const size = new three.Box3();
      for (const { geometry } of shapes?.get(name) ?? []) {
        geometry.computeBoundingBox();
        if (geometry.boundingBox) size.union(geometry.boundingBox);
      }
      assert.ok(size.getSize(new three.Vector3()).length() > 0.1 * (of?.size ?? Infinity), `${machine}: ${name}`);
    }
  }
});

/** The camera goes before these corners: one that is not finite leaves the picture empty. */
test("all corners of every machine are finite, with any part on it", { skip }, () => {
  const point = (um: number | null): WorkPoint => ({ tip: [10, 20, 30], um, stopped: "#666666", words: "" });
  const parts = [[], [point(1)], [point(1), point(2)], [point(null), point(null)], [point(1), point(null)]];
  for (const machine of machines()) {
    const figure = new Figure(chainOf(machine), "", materials);
    const marks = new Marks();
    figure.workpiece.add(marks.group);
    for (const part of parts) {
      marks.path(part, 2, [1, 2], true);
      const corners = figure.corners({});
      assert.ok(corners.length > 8, machine);
      assert.ok(
        corners.every((corner) => corner.toArray().every(Number.isFinite)),
        `${machine} with ${part.length} tool poses`,
      );
    }
  }
});

test("every machine stands upright by any vertical that its file states", { skip: !program && "no program" }, () => {
  const ways: Vec3[] = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
  ];
  for (const machine of machines()) {
    const chain = chainOf(machine);
    for (const up of ways) {
      const of = layout({ ...chain, up }, "");
      assert.ok(of, machine);
      assert.deepEqual(of.up, up);
      const across = of.right.reduce((sum, x, i) => sum + x * (up[i] ?? 0), 0);
      assert.ok(Math.abs(across) < 1e-9 && Math.abs(Math.hypot(...of.right) - 1) < 1e-9, `${machine} ${up.join()}`);
      for (const [body, shapes] of castings(of))
        for (const { geometry } of shapes) {
          const points = geometry.getAttribute("position").array;
          assert.ok([...points].every(Number.isFinite), `${machine} ${up.join()}: ${body}`);
        }
    }
  }
});
