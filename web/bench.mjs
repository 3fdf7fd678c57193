// Times the engines beside the program on one thread, in turn: ABBE_PROGRAM=... ABBE_ENGINES=... node web/bench.mjs
// The program is asked over HTTP as the page of the workbench asks it; two workers share a request as in a page. The
// smallest of seven times counts.
import { build } from "esbuild";
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { setFlagsFromString } from "node:v8";
import { isMainThread, parentPort, Worker } from "node:worker_threads";

setFlagsFromString("--experimental-wasm-relaxed-simd");
const here = new URL("./", import.meta.url);
const { pathname: folder } = new URL("../configs/", here);
const bundled = async (name) => {
  const { pathname: outfile } = new URL(`out/${name}.mjs`, here);
  const { pathname: source } = new URL(`src/evaluator/${name}.ts`, here);
  if (isMainThread) await build({ entryPoints: [source], outfile, bundle: true, format: "esm" });
  return import(outfile);
};
const { Engine } = await bundled("engine");
const { isDivisible, together } = await bundled("division");
const examples = JSON.parse(readFileSync(new URL("out/examples.json", here), "utf8"));
const { ABBE_PROGRAM: program, ABBE_ENGINES: engines } = process.env;

const map = { map: { poses: { random: 2000 } } };
const sources = { sources: { poses: 2000 } };
const turn = ["show", map, { budget: {} }, sources, "words", "numbers"];
const OF_BOUNDS = "the same of bounds alone";
const bounded = examples.files["trunnion.yaml"].replace(/^errors:[^]*/m, "class: production\n");
const QUESTIONS = {
  "155,925 nodes, exact, with statistics": [{ map: { poses: "grid" } }],
  "155,925 nodes, order 1": [{ map: { poses: "grid", order: "1" } }],
  "2000 poses": [map],
  "2000 poses, each error alone": [sources],
  "all that a page asks first": turn,
  [OF_BOUNDS]: turn,
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

async function started(variant) {
  const engine = await Engine.of(await WebAssembly.compile(readFileSync(`${engines}/engine-${variant}.wasm`)));
  for (const [name, text] of Object.entries(examples.files)) engine.put(name, text);
  return engine;
}

async function wasm(variant) {
  const engine = await started(variant);
  return { end: () => {}, ask: async (body) => engine.ask(body) };
}

/** An engine in a worker, which runs this file, too. */
class Sharer {
  worker = new Worker(new URL(import.meta.url));

  ask = async (request, _, parts = []) => JSON.parse(await this.send({ ask: [JSON.stringify(request), parts] }, parts));
  part = (request, index, count) => this.send({ part: [JSON.stringify(request), index, count] });

  send(message, parts = []) {
    const answer = new Promise((resolve) => this.worker.once("message", resolve));
    const transfer = parts.map(({ buffer }) => buffer);
    this.worker.postMessage(message, transfer);
    return answer;
  }
}

async function serve() {
  const engine = await started("relaxed");
  parentPort.on("message", ({ ask, part }) => {
    const answer = ask ? engine.ask(...ask) : engine.part(...part);
    parentPort.postMessage(answer, part ? [answer.buffer] : []);
  });
}

function shared() {
  const both = [new Sharer(), new Sharer()];
  const ask = async (body) => {
    const request = JSON.parse(body);
    return JSON.stringify(await (isDivisible(request) ? together(request, both) : both[0].ask(request)));
  };
  return { ask, end: () => both.forEach(({ worker }) => worker.terminate()) };
}

async function timed(ask, body) {
  const start = performance.now();
  const answer = await ask(body);
  return [performance.now() - start, answer];
}

async function compare() {
  const subjects = { program: await native(), relaxed: await wasm("relaxed"), plain: await wasm("plain") };
  const two = { ...subjects, "two workers": shared() };
  for (const [words, questions] of Object.entries(QUESTIONS)) {
    const texts = words === OF_BOUNDS ? { "trunnion.yaml": bounded } : {};
    const body = JSON.stringify({ machine: "trunnion.yaml", texts, questions });
    const of = isDivisible(JSON.parse(body)) ? two : subjects;
    const best = {};
    // Of one engine letter by letter; what two have shared was put together again.
    const [letters, values] = [new Set(), new Set()];
    for (let k = 0; k < 7; k += 1)
      for (const [name, { ask }] of Object.entries(of)) {
        const [ms, answer] = await timed(ask, body);
        best[name] = Math.min(best[name] ?? Infinity, ms);
        if (name in subjects) letters.add(answer);
        values.add(JSON.stringify(JSON.parse(answer)));
      }
    if (letters.size !== 1 || values.size !== 1) throw new Error(`the answers differ: ${words}`);
    const ratios = Object.entries(best).map(
      ([name, ms]) => `${name} ${ms.toFixed(1)} ms (${(ms / best.program).toFixed(1)})`,
    );
    console.log(`${words}: ${ratios.join(", ")}`);
  }
  Object.values(two).forEach(({ end }) => end());
}

await (isMainThread ? compare() : serve());
