/** What the panels write and say: tolerances into the text, completion of keys, judgements, tables. */

import { yaml } from "@codemirror/lang-yaml";
import { EditorState } from "@codemirror/state";
import assert from "node:assert/strict";
import { test } from "node:test";
import { keysAbove, keysAt } from "../src/editor/complete";
import { toleranceEdits } from "../src/editor/tolerances";
import type { Comparison } from "../src/evaluator/types";
import type { Chain } from "../src/evaluator/types";
import { letters, parsed, plainly } from "../src/explain/name";
import { inherited, override } from "../src/editor/override";
import { ticks } from "../src/review/lines";
import { judgement } from "../src/review/variants";
import { deciding, scopeOf, verdict } from "../src/review/verdict";
import type { Findings } from "../src/session";
import { csv } from "../src/ui/download";
import { compared, quantity } from "../src/ui/table";

const stateOf = (doc: string) => EditorState.create({ doc, extensions: [yaml()] });

function written(text: string, wishes: [string, number, string][]): string {
  const state = stateOf(text);
  const changes = toleranceEdits(
    state,
    wishes.map(([error, value, unit]) => ({ error, new: value, unit })),
  );
  return state.update({ changes }).state.doc.toString();
}

test("a new tolerance stands in place of the old one, never coarser", () => {
  const text = "tolerances:\n  EXX: 4 um  # of the scale\n  X-Y: 20urad\nerrors:\n  EC0A: { tolerance: 8 arcsec }\n";
  assert.equal(
    written(text, [
      ["EXX", 3.1479, "um"],
      ["EC0Y", 0.0123456, "urad"],
      ["EC0A", 11, "urad"],
    ]),
    "tolerances:\n  EXX: 3.14 um  # of the scale\n  X-Y: 0.0123 urad\nerrors:\n  EC0A: { tolerance: 11 urad }\n",
  );
});

test("a tolerance of a class or another file becomes an entry of this one", () => {
  const wish: [string, number, string][] = [
    ["EYX", 2, "um"],
    ["EBX", 5, "urad"],
  ];
  assert.equal(
    written("abbe: 1\nclass: premium", wish),
    "abbe: 1\nclass: premium\ntolerances:\n  EYX: 2 um\n  EBX: 5 urad\n",
  );
  assert.equal(
    written("tolerances:\n    EXX: 4 um\n", wish),
    "tolerances:\n    EYX: 2 um\n    EBX: 5 urad\n    EXX: 4 um\n",
  );
  assert.equal(written("tolerances: { EXX: 4 um }\n", wish), "tolerances: { EYX: 2 um, EBX: 5 urad, EXX: 4 um }\n");
});

const SCHEMA = {
  properties: { axes: { $ref: "#/definitions/Axes" }, errors: {}, class: { description: "A class." } },
  definitions: {
    Axes: { additionalProperties: { $ref: "#/definitions/Axis" } },
    Axis: { anyOf: [{ properties: { travel: { description: "Its ends." } } }, { properties: { origin: {} } }] },
  },
};

test("keys are completed by where they stand", () => {
  const language = { schema: SCHEMA, words: { EXX: "Positioning error of X." } };
  const at = (text: string) => {
    const position = text.indexOf("|");
    const state = stateOf(text.replace("|", ""));
    return Object.keys(keysAt(language, keysAbove(state, position)));
  };
  assert.deepEqual(at("abbe: 1\n|"), ["axes", "errors", "class"]);
  assert.deepEqual(at("axes:\n  X: { tr|"), ["travel", "origin"]);
  assert.deepEqual(at("axes:\n  X:\n    travel: [0, 1]\n    |"), ["travel", "origin"]);
  assert.deepEqual(at("errors:\n  # none\n  |"), ["EXX"]);
  assert.deepEqual(at("axes:\n  X: { travel: [0, 1] }\ntolerances: { E|"), ["EXX"]);
});

test("names are taken apart as ISO 230-1 builds them", () => {
  assert.deepEqual(parsed("EB0C"), { along: 1, isRotation: true, isLocation: true, axis: "C" });
  assert.deepEqual(parsed("EXX1"), { along: 0, isRotation: false, isLocation: false, axis: "X1" });
  assert.deepEqual([parsed("E0C"), parsed("<b>"), parsed("EDX")], [null, null, null]);
  const name = parsed("EYX");
  assert.equal(name && letters(name), "Y: shift along Y · X: in motion of X");
});

test("the verdict on variants is that of the program", () => {
  const of = (verdict: string | null, by: object, uncertainty?: object) =>
    ({ machines: [{}, { uncertainty }], verdicts: [{ machine: 2, verdict, ...by }] }) as unknown as Comparison;
  const values = (um: number) => ({ by: { drawn: false, statistic: "p95", um } });
  const band = (p95: [number, number]) => ({ minus_first: { position_um: { p95 } } });
  assert.match(
    judgement(of("better", values(-2), band([-3, -1]))),
    /^Better than A, more than the uncertainty: −2\.00/,
  );
  assert.match(
    judgement(of("not_told_apart", values(2), band([-1, 5]))),
    /^Not told apart: 2\.00 µm \(−1\.00 to 5\.00/,
  );
  assert.match(judgement(of("worse", values(2))), /^Worse than A: .*state no uncertainty/);
  assert.equal(judgement(of("equal", values(0))), "Equal.");
  // A better 95 % value alone is no verdict.
  assert.equal(judgement(of(null, { reason: "of only one" })), "No verdict: of only one.");
  const drawn = { by: { drawn: true, statistic: "max", um: -5, low: -6, high: -4 } };
  assert.match(
    judgement(of("better", drawn)),
    /drawn machines differ.*−5\.00 µm \(−6\.00 to −4\.00 µm\) in the largest/,
  );
});

test("what a base gives becomes an entry, and what stands in the file does not", () => {
  const known = {
    EC0Y: { value: 21.000000000000004, unit: "urad", bound: false },
    EXX: { value: 4, unit: "um", bound: true },
    EB0Z: { value: -22, unit: "urad", bound: false },
  } as const;
  const text = "abbe: 1\nextends: base.yaml\nerrors:\n  EB0Z: 3 urad  # shimmed\n";
  const state = stateOf(text);
  const found = inherited(state, known);
  assert.deepEqual(
    found.map(({ error, section, text }) => [error, section, text]),
    [
      ["EC0Y", "errors", "21 urad"],
      ["EXX", "tolerances", "4 um"],
    ],
  );
  const [first, second] = found;
  assert.ok(first && second);
  const once = state.update({ changes: override(state, first) }).state;
  assert.equal(once.doc.toString(), text.replace("errors:\n", "errors:\n  EC0Y: 21 urad\n"));
  const twice = once.update({ changes: override(once, second) }).state;
  assert.ok(twice.doc.toString().endsWith("# shimmed\ntolerances:\n  EXX: 4 um\n"));
  assert.deepEqual(inherited(stateOf("abbe: 1\nerrors: { EB0Z: 3 urad }\n"), known), []);
});

test("ticks are round and within the ends", () => {
  assert.deepEqual(ticks(-400, 0, 5), [-400, -300, -200, -100, 0]);
  assert.deepEqual(ticks(0, 47.3, 5), [0, 10, 20, 30, 40]);
  assert.deepEqual(
    ticks(-1.2, 2.9, 4),
    [-0, 2].map((x) => x + 0),
  );
});

test("text from a file is no formula in a table", () => {
  assert.equal(csv([["a,b", -1.5, null, '=HYPERLINK("x")', "-face"]]), '"a,b",-1.5,,"\'=HYPERLINK(""x"")",\'-face\n');
});

test("columns are sorted by figures, words below numbers", () => {
  const cells = ["12.5 µm", "−3 µrad", "not reached", "1e-3", "EC0Y", "x 7"].map(quantity);
  assert.deepEqual(cells, [12.5, -3, "not reached", 1e-3, "EC0Y", "x 7"]);
  assert.deepEqual([...cells].sort(compared), ["EC0Y", "not reached", "x 7", -3, 1e-3, 12.5]);
});

test("an error is said as a designer says it", () => {
  const axis = (name: string, kind: string, direction: number[]) => ({ name, kind, direction });
  const axes = [axis("X", "linear", [1, 0, 0]), axis("B", "rotary", [0, 1, 0])];
  const chain = { axes } as unknown as Chain;
  const said = ["EBX", "EAX", "EYX", "EXX", "EC0X", "EAB", "EXB", "EYB", "EBB", "EA0B", "EX0B", "EA0S"];
  assert.deepEqual(
    said.map((name) => plainly(name, chain)),
    [
      "X tilts about Y",
      "X rolls",
      "X runs crooked in Y",
      "the scale of X is off",
      "X is out of square about Z",
      "the bearing of B tilts about X",
      "the bearing of B runs out in X",
      "the bearing of B moves along its axis",
      "B turns to wrong angles",
      "the axis of B leans about X",
      "the axis of B lies off in X",
      "the spindle leans about X",
    ],
  );
});

const OVER = { kind: "job", reference: "zero", path: false, poses: 8, reached: 8, tool: "" } as const;

test("the limit judges the headline beside it, and tool poses out of reach leave it open", () => {
  const position_um = { max: 20, p95: 15 };
  const on = (over: object, map: object) => {
    const found = { map: { over: { ...OVER, ...over }, position_um, ...map }, sources: { errors: [{}] }, budget: null };
    return deciding(found as unknown as Findings);
  };
  const own = { limit_um: 30, um: 20, interval_um: [18, 22], drawn: false, held: true };
  const held = on({}, { limit: own });
  assert.ok(held && held.value === 20);
  assert.equal(verdict(held, ""), "Passes by 10.0 µm");
  assert.equal(verdict(held, "21"), "Open: the limit lies within the band");
  assert.equal(verdict(held, "17"), "Fails by 3.00 µm");
  const missed = on({ reached: 7 }, { limit: { ...own, held: null } });
  assert.ok(missed);
  assert.equal(verdict(missed, ""), "Open: 1 of 8 tool poses are out of reach");
  assert.equal(verdict(missed, "40"), "Open: 1 of 8 tool poses are out of reach");
  const unknown = on({}, { limit: { ...own, held: null } });
  assert.ok(unknown && verdict(unknown, "").startsWith("Open: errors without value or bound"));
  const bare = on({}, {});
  assert.ok(bare && bare.band === null && verdict(bare, "") === "");
  assert.equal(scopeOf({ ...OVER, reached: 7 }), "over the job: 7 of 8 tool poses, zero");
});

test("over the volume the interval covers the choice of poses", () => {
  const map = { over: { ...OVER, kind: "volume" }, poses: 2000, position_um: { p95: 30 } };
  const of = (more: object) =>
    deciding({ map: { ...map, ...more }, sources: { errors: [{}] }, budget: null } as unknown as Findings)?.band;
  const p95_over_volume = { percent: 95, value: 30, low: 29, high: 32 };
  assert.deepEqual(of({ p95_over_volume }), [29, 32]);
  assert.deepEqual(of({ p95_over_volume, uncertainty: { position_um: { p95: [27, 34] } } }), [26, 36]);
  assert.equal(of({}), null);
});
