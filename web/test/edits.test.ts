/** Edits of the text: every number is found where it stands, and a change touches nothing else. */

import { yaml } from "@codemirror/lang-yaml";
import { EditorState } from "@codemirror/state";
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { axisAdded, axisRemoved } from "../src/editor/axes";
import { type Change, chainEdit, moved, words } from "../src/editor/chain";
import { nameOf } from "../src/editor/names";
import { numberAt, numbers, range, written } from "../src/editor/numbers";
import { random } from "./random";

const CONFIGS = "../configs";

const machines = readdirSync(CONFIGS, { recursive: true })
  .map(String)
  .filter((name) => name.endsWith(".yaml"))
  .sort();

function stateOf(doc: string): EditorState {
  return EditorState.create({ doc, extensions: [yaml()] });
}

test("50 random edits touch only their digits, and are found again", () => {
  const next = random(21);
  for (let k = 0; k < 50; k += 1) {
    const name = machines[next(machines.length)] ?? "";
    const state = stateOf(readFileSync(`${CONFIGS}/${name}`, "utf8"));
    const list = numbers(state);
    const number = list[next(list.length)];
    assert.ok(number, name);
    const { min, max, decimals } = range(number);
    const digits = written(min + ((max - min) * next(1000)) / 1000, decimals);
    const after = state.update({ changes: { from: number.from, to: number.to, insert: digits } }).state;
    const [before, now] = [state.doc.toString(), after.doc.toString()];
    assert.equal(now.slice(0, number.from), before.slice(0, number.from));
    assert.equal(now.slice(number.from + digits.length), before.slice(number.to));
    const again = numberAt(after, number.from);
    assert.deepEqual(
      [again?.value, again?.unit, again && nameOf(again)],
      [Number(digits), number.unit, nameOf(number)],
      name,
    );
    assert.equal(numbers(after).length, list.length, name);
  }
});

test("the errors of the trunnion are found by their keys", () => {
  const list = numbers(stateOf(readFileSync(`${CONFIGS}/trunnion.yaml`, "utf8")));
  const found = list
    .filter((number) => number.path[0] === "errors")
    .map((number) => `${nameOf(number)} ${number.value} ${number.unit}`);
  assert.equal(found.length, 11);
  assert.ok(found.includes("errors › EB0Z -22 urad"));
  assert.ok(list.some((number) => nameOf(number) === "axes › A › travel › 1" && number.value === -120));
});

test("an axis that crosses the bed changes its prime", () => {
  const list = words("w C' A' Y' b X Z (S) t");
  assert.equal(moved(list, 2, 5).join(" "), "w C' Y' b X A Z (S) t");
  assert.equal(moved(list, 5, 4).join(" "), "w C' A' Y' X' b Z (S) t");
  assert.equal(moved(list, 1, 99).join(" "), "w A' Y' b X Z C (S) t");
  assert.equal(moved(list, 4, 1), list);
  assert.equal(moved(list, 1, 1), list);
});

test("the chain is written where it stands, or below `extends`", () => {
  const write = (doc: string) => {
    const state = stateOf(doc);
    const edit = chainEdit(state, words("w b X t"));
    return edit && state.update({ changes: edit }).state.doc.toString();
  };
  assert.equal(write('abbe: 1\nchain: "w X\' b t" # why\naxes: {}\n'), 'abbe: 1\nchain: "w b X t" # why\naxes: {}\n');
  assert.equal(write("chain: w b Y t\n"), 'chain: "w b X t"\n');
  assert.equal(
    write("extends: ../a.yaml # base\nmachine: M\n"),
    'extends: ../a.yaml # base\nchain: "w b X t"\nmachine: M\n',
  );
  assert.equal(write("branches: { tool: [X] }\n"), null);
  assert.equal(write("machine: M\n"), null);
});

test("an axis joins next to the tool, and leaves with what the file says of it", () => {
  const doc = [
    "abbe: 1",
    'chain: "w C\' b X Z (S) t"',
    "axes:",
    "  # travels",
    "  X: { travel: [0, 500] }",
    "  Z: { travel: [-400, 0] } # quill",
    "  C:",
    "    travel: continuous",
    "    origin: [1, 2, 3]",
    "errors: { EX0C: 3 um, EXX: { table: x.csv }, EAX: 1 urad }",
    "tolerances:",
    "  EXC: 5 um",
    "  X-C: 10 urad",
    "measured:",
    "  - errors/x.csv",
    "  - errors/c.csv",
    "volume: { X: { step: 50 mm }, C: { step: 15 deg } }",
    "",
  ].join("\n");
  const after = (edits: Change[] | null) => edits && stateOf(doc).update({ changes: edits }).state.doc.toString();
  const list = words("w C' b X Z (S) t");
  assert.equal(
    after(axisAdded(stateOf(doc), list, "B")),
    doc.replace("Z (S)", "Z B (S)").replace("  X: { travel", "  B: { travel: [-90 deg, 90 deg] }\n  X: { travel"),
  );
  assert.equal(
    after(axisRemoved(stateOf(doc), list, "C")),
    doc
      .replace("w C' b", "w b")
      .replace("  C:\n    travel: continuous\n    origin: [1, 2, 3]\n", "")
      .replace("EX0C: 3 um, ", "")
      .replace("tolerances:\n  EXC: 5 um\n  X-C: 10 urad\n", "")
      .replace("  - errors/c.csv\n", "")
      .replace(", C: { step: 15 deg }", ""),
  );
  assert.equal(
    after(axisRemoved(stateOf(doc), list, "X")),
    doc
      .replace("b X Z", "b Z")
      .replace("  X: { travel: [0, 500] }\n", "")
      .replace(", EXX: { table: x.csv }, EAX: 1 urad", "")
      .replace("  X-C: 10 urad\n", "")
      .replace("  - errors/x.csv\n", "")
      .replace("X: { step: 50 mm }, ", ""),
  );
  assert.equal(axisRemoved(stateOf('extends: a.yaml\nchain: "w b X Z t"\n'), words("w b X Z t"), "X"), null);
  assert.equal(axisAdded(stateOf("branches: { tool: [X] }\n"), words("w b X t"), "Y"), null);
});
