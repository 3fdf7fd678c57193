/** The engines against the program: the same JSON, character by character, for 50 random edits. */

import { yaml } from "@codemirror/lang-yaml";
import { EditorState } from "@codemirror/state";
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { test } from "node:test";
import { setFlagsFromString } from "node:v8";
import { gzipSync } from "node:zlib";
import { numbers, range, written } from "../src/editor/numbers";
import { isDivisible, kindOf, type Sharing, together } from "../src/evaluator/division";
import { Engine } from "../src/evaluator/engine";
import type { Question, Reply, Request } from "../src/evaluator/types";
import { type Variant, variants } from "../src/evaluator/variants";
import { random } from "./random";

// Browsers have it; of Node the versions below 22 ask for a flag, and later ones ignore it.
setFlagsFromString("--experimental-wasm-relaxed-simd");

const [program, engines] = [process.env["ABBE_PROGRAM"], process.env["ABBE_ENGINES"]];
const skip =
  program && engines ? false : "ABBE_PROGRAM and ABBE_ENGINES name the program and the folder of the engines";
const engineFile = (variant: Variant) => `${engines}/engine-${variant}.wasm`;
// Both are there where they were built for a release; a plain one is enough for a change.
const VARIANTS = (["plain", "relaxed"] as const).filter((variant) => existsSync(engineFile(variant)));
const isShipped = VARIANTS.length === 2;
const FASTEST: Variant = VARIANTS.at(-1) ?? "plain";

interface Examples {
  machines: string[];
  files: Record<string, string>;
}

const examples = (): Examples => JSON.parse(readFileSync("out/examples.json", "utf8")) as Examples;

async function started(variant: Variant): Promise<Engine> {
  const engine = await Engine.of(await WebAssembly.compile(readFileSync(engineFile(variant))));
  for (const [name, text] of Object.entries(examples().files)) engine.put(name, text);
  return engine;
}

/** What the program prints for a verb, of a file among the examples with another text. */
function printed(machine: string, text: string, verb: string[]): string {
  const folder = "out/files";
  rmSync(folder, { recursive: true, force: true });
  for (const [name, content] of Object.entries({ ...examples().files, [machine]: text })) {
    mkdirSync(`${folder}/${name}`.replace(/\/[^/]*$/, ""), { recursive: true });
    writeFileSync(`${folder}/${name}`, content);
  }
  const [name, ...options] = verb;
  try {
    return execFileSync(program ?? "", [name ?? "", machine, ...options, "--format", "json", "--quiet"], {
      cwd: folder,
      encoding: "utf8",
      stdio: "pipe",
    }).trim();
  } catch (failure) {
    return (failure as { stdout: string }).stdout.trim();
  }
}

const QUESTIONS: [Question, string[]][] = [
  [{ map: { poses: { random: 500 }, samples: 50 } }, ["map", "--random", "500", "--samples", "50"]],
  ["show", ["show"]],
  [{ budget: { poses: 50, samples: 50 } }, ["budget", "--poses", "50", "--samples", "50"]],
];

test("this Node runs relaxed SIMD", { skip }, () => assert.deepEqual(variants(), ["relaxed", "plain"]));

test("50 random edits: the engines answer as the program prints", { skip }, async () => {
  const all = await Promise.all(VARIANTS.map(started));
  const { machines, files } = examples();
  const next = random(50);
  let compared = 0;
  for (let k = 0; k < 50; k += 1) {
    const machine = machines[next(machines.length)] ?? "";
    const text = edited(files[machine] ?? "", next);
    const [question, verb] = QUESTIONS[k % QUESTIONS.length] ?? ["show", ["show"]];
    const request = JSON.stringify({ machine, texts: { [machine]: text }, questions: [question] });
    const [plain, ...others] = all.map((engine) => engine.ask(request));
    for (const other of others) assert.equal(other, plain, `${machine}: ${verb.join(" ")}`);
    const reply = JSON.parse(plain ?? "") as Reply;
    const expected = JSON.parse(printed(machine, text, verb)) as {
      refused?: boolean;
      warnings?: unknown;
      more_warnings?: unknown;
    };
    if (expected.refused) continue;
    // The program lists the warnings of reading the file there too.
    const [own, theirs] = [
      { ...(reply.answers[0] as object), warnings: 0, more_warnings: 0 },
      { ...expected, warnings: 0, more_warnings: 0 },
    ];
    assert.equal(JSON.stringify(own), JSON.stringify(theirs), `${machine}: ${verb.join(" ")}`);
    compared += 1;
  }
  assert.ok(compared >= 30, `${compared} were accepted`);
});

function edited(text: string, next: (below: number) => number): string {
  const list = numbers(EditorState.create({ doc: text, extensions: [yaml()] })).filter(({ path }) =>
    ["errors", "tolerances", "tool", "tools"].includes(path[0] ?? ""),
  );
  const number = list[next(Math.max(list.length, 1))];
  if (!number) return text;
  const { min, max, decimals } = range(number);
  return (
    text.slice(0, number.from) +
    written(min + ((max - min) * (1 + next(1000))) / 1001, decimals) +
    text.slice(number.to)
  );
}

test("the engines are small, and answer 2000 poses while a slider moves", { skip }, async () => {
  for (const variant of VARIANTS) {
    const file = engineFile(variant);
    const size = gzipSync(readFileSync(file), { level: 9 }).length;
    console.log(`${variant}: ${statSync(file).size} bytes, ${size} by gzip`);
    assert.ok(!isShipped || size < 1_000_000, `${size} bytes by gzip`);
    const engine = await started(variant);
    const request = JSON.stringify({ machine: "trunnion.yaml", questions: [{ map: { poses: { random: 2000 } } }] });
    engine.ask(request);
    const start = performance.now();
    for (let k = 0; k < 10; k += 1) engine.ask(request);
    const each = (performance.now() - start) / 10;
    console.log(`${variant}: 2000 poses of the trunnion, with reading the file: ${each.toFixed(1)} ms`);
  }
});

/** An engine that shares, and what it did. */
class Sharer implements Sharing {
  readonly done: string[] = [];

  constructor(private readonly engine: Engine) {}

  async ask(request: Request, _?: AbortSignal, parts: Uint8Array[] = []): Promise<Reply> {
    this.done.push(request.questions.map(kindOf).join());
    return JSON.parse(this.engine.ask(JSON.stringify(request), parts)) as Reply;
  }

  async part(request: Request, index: number, count: number): Promise<Uint8Array<ArrayBuffer>> {
    const bytes = this.engine.part(JSON.stringify(request), index, count);
    this.done.push(`${bytes.length / 48} poses`);
    return bytes;
  }
}

test("two engines share a request and answer as one", { skip }, async () => {
  const turn: Question[] = [
    "show",
    { map: { poses: { random: 300 } } },
    { budget: {} },
    { sources: { poses: 40 } },
    "words",
  ];
  const shares: [Question[], string[], string[]][] = [
    [[{ map: { poses: { random: 50_001 }, worst: 3 } }], ["25000 poses", "map"], ["25001 poses"]],
    [[{ map: { poses: "grid", order: "1" } }], ["77962 poses", "map"], ["77963 poses"]],
    [turn, ["show,map,words"], ["budget,sources"]],
  ];
  for (const variant of VARIANTS) {
    const alone = await started(variant);
    for (const [questions, first, second] of shares) {
      const request = { machine: "trunnion.yaml", texts: {}, questions };
      const [one, other] = [new Sharer(await started(variant)), new Sharer(await started(variant))];
      assert.ok(isDivisible(request));
      const shared = await together(request, [one, other]);
      assert.deepEqual([one.done, other.done], [first, second]);
      assert.deepEqual(shared, JSON.parse(alone.ask(JSON.stringify(request))));
    }
  }
});

test("what two engines share may be refused or of bounds", { skip }, async () => {
  const [alone, one, other] = await Promise.all([1, 2, 3].map(() => started(FASTEST)));
  assert.ok(alone && one && other);
  const map: Question = { map: { poses: { random: 50_000 }, samples: 20 } };
  const budget: Question = { budget: { samples: 20 } };
  const bounded = "abbe: 1\nmachine: M\nchain: w b X t\naxes:\n  X: { travel: [0, 9], origin: [0, 0, 0] }\nerrors:\n";
  const texts = ["  EXX: { tolerance: 3 um }\n", "  EXX: 3 furlongs\n"].map((error) => bounded + error);
  for (const text of texts)
    for (const questions of [[map], [map, budget]]) {
      const request: Request = { machine: "m.yaml", texts: { "m.yaml": text }, questions };
      const shared = await together(request, [new Sharer(one), new Sharer(other)]);
      assert.deepEqual(shared, JSON.parse(alone.ask(JSON.stringify(request))));
    }
  const kept: Question[][] = [[], ["show"], [{ map: { poses: { random: 49_999 } } }], [{ budget: {} }], [map, "show"]];
  for (const questions of kept) assert.ok(!isDivisible({ machine: "m.yaml", texts: {}, questions }));
});

test("a question that the engine leaves out is refused in words", { skip }, async () => {
  const engine = await started("plain");
  const question = { map: { poses: { random: 10 }, target: "linuxcnc" } };
  const reply = JSON.parse(
    engine.ask(JSON.stringify({ machine: "trunnion.yaml", questions: [question, "schema"] })),
  ) as Reply;
  const [refused, schema] = reply.answers as [{ refused: boolean; diagnostics: { help: string }[] }, null];
  assert.ok(refused.refused && refused.diagnostics[0]?.help.includes("abbe workbench"));
  assert.equal(schema, null);
});
