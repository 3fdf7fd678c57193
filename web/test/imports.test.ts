/** The files of `src` import each other one way: no two of them reach each other, directly or through others. */

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";

const IMPORT = /(?:\bfrom|\bimport)\s*\(?\s*"(\.[^"]+)"/g;

/** The files of a folder and of those below it. */
function filesBelow(folder: string): string[] {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    return entry.isDirectory() ? filesBelow(path) : path.endsWith(".ts") ? [path] : [];
  });
}

/** The first circle that a walk along the imports meets. */
function circle(imports: Map<string, string[]>): string[] | undefined {
  const finished = new Set<string>();
  const walk = (file: string, path: string[]): string[] | undefined => {
    if (path.includes(file)) return [...path.slice(path.indexOf(file)), file];
    if (finished.has(file)) return undefined;
    for (const next of imports.get(file) ?? []) {
      const found = walk(next, [...path, file]);
      if (found) return found;
    }
    finished.add(file);
    return undefined;
  };
  for (const file of imports.keys()) {
    const found = walk(file, []);
    if (found) return found;
  }
  return undefined;
}

test("no circle of files", () => {
  const files = filesBelow("src");
  const imports = new Map(
    files.map((file) => {
      const names = [...readFileSync(file, "utf8").matchAll(IMPORT)].map((match) => match[1] ?? "");
      const paths = names.map((name) => `${join(dirname(file), name)}.ts`);
      return [file, paths.filter((path) => files.includes(path))] as const;
    }),
  );
  assert.ok([...imports.values()].flat().length > files.length, "imports are not recognised");
  assert.equal(circle(imports), undefined);
  assert.deepEqual(
    circle(
      new Map([
        ["a", ["b"]],
        ["b", ["c"]],
        ["c", ["b"]],
      ]),
    ),
    ["b", "c", "b"],
  );
});
