// The path as it is played: places along the way, and the axes between rows.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec3, Work } from "../src/evaluator/types";
import { marks, poseAt, stopAt, stops } from "../src/review/player";

const row = (line: number, axes?: Record<string, number>) => ({ line, ...(axes ? { axes } : {}) });
const tip = (line: number, ...tip_mm: Vec3) => ({ line, tip_mm });

const WORK = {
  rows: { poses: [row(2, { X: 0, C: 0 }), row(3, { X: 30, C: 0 }), row(4), row(5, { X: 30, C: 90 })] },
  tips: [tip(2, 0, 0, 0), tip(3, 30, 40, 0), tip(4, 99, 0, 0), tip(5, 30, 40, 0)],
  played: [{ line: 3, across_um: 1, along_um: 2, has_normal: true, axes: { C: 2 } }],
  map: {
    path: {
      rewinds: [{ lines: [3, 5], turns_deg: { C: 90 } }],
      pole_crossings: [{ axis: "C", nearest_line: 3, nearest_deg: 0.2, deg_per_mm: null }],
      axes: [],
    },
  },
} as unknown as Work;

test("rows stand along the way of the tip; a turn in place takes its degrees, and rows out of reach are passed", () => {
  const list = stops(WORK);
  assert.deepEqual(
    list.map(({ row, at }) => [row.line, at]),
    [
      [2, 0],
      [3, 50],
      [5, 140],
    ],
  );
  assert.equal(list[1]?.played?.across_um, 1);
  assert.deepEqual(
    [-1, 0, 49.9, 50, 139, 140, 999].map((at) => stopAt(list, at)),
    [0, 0, 0, 1, 1, 2, 2],
  );
  assert.deepEqual(poseAt(list, 25), { X: 15, C: 0 });
  assert.deepEqual(poseAt(list, 95), { X: 30, C: 45 });
  assert.deepEqual(poseAt(list, 1e9), { X: 30, C: 90 });
});

test("rewinds and poles stand where they happen", () => {
  const found = marks(WORK, stops(WORK));
  assert.deepEqual(
    found.map(({ kind, at }) => [kind, at]),
    [
      ["pole", 50],
      ["rewind", 140],
    ],
  );
});
