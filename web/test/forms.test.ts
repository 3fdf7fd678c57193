// Forms write values by their keys: every line that is not theirs stays as it is.
import { yaml } from "@codemirror/lang-yaml";
import { EditorState } from "@codemirror/state";
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { keysBelow, put, read, taken } from "../src/editor/put";

const stateOf = (doc: string) => EditorState.create({ doc, extensions: [yaml()] });

function changed(doc: string, keys: string[], text: string | null): string {
  const state = stateOf(doc);
  const changes = text === null ? taken(state, keys) : put(state, keys, text);
  return state.update({ changes }).state.doc.toString();
}

/** Lines of one that the other does not have. */
const other = (a: string, b: string) => a.split("\n").filter((line) => !b.split("\n").includes(line));

const FILE = `abbe: 1
axes:   # four
  X: { travel: [0, 1] } # ram
  # of the column
  Y:
    travel: [0, 2]  # mm
  Z: {}
  V: { travel:
         [0, 3] }
  W:
tolerances: { EXX: 1 um, EYX: 2 um }
up:
`;

test("a value is written in its place, or as the last entry of the innermost mapping", () => {
  // Keys, value, and the lines that are new; what was on a line that goes is in the new one.
  const cases: [string[], string, string[], number][] = [
    [["axes", "X", "travel"], "[0, 9]", ["  X: { travel: [0, 9] } # ram"], 0],
    [["axes", "X", "origin"], "[1, 2, 3]", ["  X: { travel: [0, 1], origin: [1, 2, 3] } # ram"], 0],
    [["axes", "Y", "origin"], "[1, 2, 3]", ["    origin: [1, 2, 3]"], 1],
    [["axes", "Z", "travel"], "[0, 3]", ["  Z: { travel: [0, 3] }"], 0],
    [["axes", "V", "travel"], "[0, 4]", ["         [0, 4] }"], 0],
    [["axes", "W", "travel"], "[0, 4]", ["    travel: [0, 4]"], 1],
    [["axes", "C", "travel"], "continuous", ["  C: { travel: continuous }"], 1],
    [["tolerances", "EYX"], "3 um", ["tolerances: { EXX: 1 um, EYX: 3 um }"], 0],
    [["tolerances", "EZX"], "3 um", ["tolerances: { EXX: 1 um, EYX: 2 um, EZX: 3 um }"], 0],
    [["up"], "+Z", ["up: +Z"], 0],
    [["job", "place", "origin"], "[0, 0, 5]", ["job:", "  place: { origin: [0, 0, 5] }"], 2],
  ];
  for (const [keys, text, lines, more] of cases) {
    const after = changed(FILE, keys, text);
    assert.deepEqual(other(after, FILE), lines, keys.join("."));
    assert.equal(after.split("\n").length - FILE.split("\n").length, more, after);
    assert.equal(other(FILE, after).length, more ? 0 : 1, after);
    assert.equal(read(stateOf(after), keys)?.text, text, after);
    assert.equal(changed(after, keys, text), after);
  }
});

test("a text stays one value", () => {
  const cases = [
    ["my part, second.csv", '"my part, second.csv"'],
    ["a: b", '"a: b"'],
    ["part #2.csv", '"part #2.csv"'],
    ["}", '"}"'],
    ['"as it is, here"', '"as it is, here"'],
    ["{ zero: [0, 0, 0] }", "{ zero: [0, 0, 0] }"],
    ["zero:1", "zero:1"],
    ["-3 um", "-3 um"],
  ] as const;
  for (const [text, written] of cases)
    for (const file of ["job: { limit: 5 um }\n", "job:\n  limit: 5 um\n", ""]) {
      const after = changed(file, ["job", "tool_poses"], text);
      assert.ok(after.includes(`tool_poses: ${written}`), after);
      assert.equal(keysBelow(stateOf(after), ["job"]).length, file ? 2 : 1, after);
      assert.equal(changed(after, ["job", "tool_poses"], null), file, after);
    }
});

test("an entry is taken away with nothing else, and an empty parent with it", () => {
  assert.deepEqual(other(changed(FILE, ["tolerances", "EXX"], null), FILE), ["tolerances: { EYX: 2 um }"]);
  assert.deepEqual(other(changed(FILE, ["tolerances", "EYX"], null), FILE), ["tolerances: { EXX: 1 um }"]);
  const without = changed(FILE, ["axes", "Y", "travel"], null);
  assert.deepEqual([other(without, FILE), other(FILE, without)], [[], ["  Y:", "    travel: [0, 2]  # mm"]]);
  assert.equal(changed(FILE, ["axes", "Q"], null), FILE);
  assert.deepEqual(keysBelow(stateOf(FILE), ["axes"]), ["X", "Y", "Z", "V", "W"]);
});

test("in every machine of configs a travel is changed in its line, and entries come and go", () => {
  const machines = readdirSync("../configs", { recursive: true })
    .map(String)
    .filter((name) => name.endsWith(".yaml"));
  let found = 0;
  for (const name of machines) {
    const doc = readFileSync(`../configs/${name}`, "utf8");
    const state = stateOf(doc);
    for (const axis of keysBelow(state, ["axes"])) {
      const keys = ["axes", axis, "travel"];
      const there = read(state, keys);
      if (there && !there.isLong) {
        found += 1;
        const after = changed(doc, keys, "[0, 12.5]");
        assert.ok(other(after, doc).length <= 1, `${name} ${axis}`);
        assert.equal(after.split("\n").length, doc.split("\n").length, name);
        assert.equal(changed(after, keys, there.text), doc);
      }
      comesAndGoes(doc, ["axes", axis, "controller"], `${name} ${axis}`);
    }
    comesAndGoes(doc, ["tolerances", "EQQ"], name);
    comesAndGoes(doc, ["job", "tool"], name);
  }
  assert.ok(found > 60, `${found}`);
});

/** An entry that is not there is written on one line, or with its section on two, and taken away again. */
function comesAndGoes(doc: string, keys: string[], of: string): void {
  if (read(stateOf(doc), keys)) return;
  const after = changed(doc, keys, "7");
  assert.equal(read(stateOf(after), keys)?.text, "7", `${of}: ${after}`);
  assert.ok(other(after, doc).length <= 2 && other(doc, after).length <= 1, of);
  const isWhole = keys.length === 2 || keysBelow(stateOf(doc), keys.slice(0, -1)).length > 0;
  if (isWhole) assert.equal(changed(after, keys, null), doc, of);
}
