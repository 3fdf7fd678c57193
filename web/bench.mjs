// Times the engines beside the program on one thread, in turn: ABBE_PROGRAM=... ABBE_ENGINES=... node web/bench.mjs
// The program is asked over HTTP as the page of the workbench asks it; the smallest of seven times counts.
import { build } from "esbuild";
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { setFlagsFromString } from "node:v8";

setFlagsFromString("--experimental-wasm-relaxed-simd");
const here = new URL("./", import.meta.url);
const { pathname: folder } = new URL("../configs/", here);
const { pathname: outfile } = new URL("out/engine.mjs", here);
const { pathname: source } = new URL("src/evaluator/engine.ts", here);
await build({ entryPoints: [source], outfile, bundle: true, format: "esm" });
const { Engine } = await import(outfile);
const examples = JSON.parse(readFileSync(new URL("out/examples.json", here), "utf8"));
const { ABBE_PROGRAM: program, ABBE_ENGINES: engines } = process.env;

const QUESTIONS = {
  "155,925 nodes, exact, with statistics": { map: { poses: "grid" } },
  "155,925 nodes, order 1": { map: { poses: "grid", order: "1" } },
  "2000 poses": { map: { poses: { random: 2000 } } },
  "2000 poses, each error alone": { sources: { poses: 2000 } },
};

async function native() {
  const arguments_ = ["workbench", "trunnion.yaml", "--jobs", "1"];
  const child = spawn(program, arguments_, { cwd: folder, stdio: ["ignore", "pipe", "ignore"] });
  const [line] = await createInterface(child.stdout)
    [Symbol.asyncIterator]()
    .next()
    .then(({ value }) => [value]);
  const address = line.split(" ")[0];
  const page = await (await fetch(address)).text();
  const { token } = JSON.parse(/id="start">(.*?)<\/script>/.exec(page)[1]);
  const headers = { "content-type": "application/json", "x-abbe-token": token };
  return {
    end: () => child.kill(),
    ask: async (body) => (await fetch(`${address}ask`, { method: "POST", headers, body })).text(),
  };
}

async function wasm(variant) {
  const engine = await Engine.of(await WebAssembly.compile(readFileSync(`${engines}/engine-${variant}.wasm`)));
  for (const [name, text] of Object.entries(examples.files)) engine.put(name, text);
  return { end: () => {}, ask: async (body) => engine.ask(body) };
}

async function timed(ask, body) {
  const start = performance.now();
  const answer = await ask(body);
  return [performance.now() - start, answer];
}

const subjects = { program: await native(), relaxed: await wasm("relaxed"), plain: await wasm("plain") };
for (const [words, question] of Object.entries(QUESTIONS)) {
  const body = JSON.stringify({ machine: "trunnion.yaml", questions: [question] });
  const best = {};
  const answers = new Set();
  for (let k = 0; k < 7; k += 1)
    for (const [name, { ask }] of Object.entries(subjects)) {
      const [ms, answer] = await timed(ask, body);
      best[name] = Math.min(best[name] ?? Infinity, ms);
      answers.add(answer);
    }
  if (answers.size !== 1) throw new Error(`the answers differ: ${words}`);
  const ratio = (name) => `${name} ${best[name].toFixed(1)} ms (${(best[name] / best.program).toFixed(1)})`;
  console.log(`${words}: program ${best.program.toFixed(1)} ms, ${ratio("relaxed")}, ${ratio("plain")}`);
}
Object.values(subjects).forEach(({ end }) => end());
