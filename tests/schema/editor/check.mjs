// The schema in the language server that editors use: completion, hover and messages as a user sees them.
//
// node check.mjs SCHEMA.json MACHINE.yaml...    the machines must be without a message
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const schema = pathToFileURL(resolve(process.argv[2])).href;
const settings = { yaml: { validate: true, hover: true, completion: true, schemas: { [schema]: "*" } } };

const server = spawn("node", [join(here, "node_modules/yaml-language-server/bin/yaml-language-server"), "--stdio"]);
const answers = new Map();
const published = new Map();
let buffer = Buffer.alloc(0);
let last = 0;

function send(message) {
  const text = JSON.stringify({ jsonrpc: "2.0", ...message });
  server.stdin.write(`Content-Length: ${Buffer.byteLength(text)}\r\n\r\n${text}`);
}

function ask(method, params) {
  const id = ++last;
  send({ id, method, params });
  return new Promise((done) => answers.set(id, done));
}

function receive(message) {
  if (message.method === undefined) {
    answers.get(message.id)?.(message.result);
  } else if (message.method === "textDocument/publishDiagnostics") {
    published.get(message.params.uri)?.(message.params.diagnostics);
  } else if (message.method === "workspace/configuration") {
    send({ id: message.id, result: message.params.items.map((item) => settings[item.section] ?? null) });
  } else if (message.id !== undefined) {
    send({ id: message.id, result: null });
  }
}

server.stdout.on("data", (data) => {
  buffer = Buffer.concat([buffer, data]);
  for (;;) {
    const end = buffer.indexOf("\r\n\r\n");
    if (end < 0) return;
    const length = Number(/Content-Length: (\d+)/.exec(buffer.subarray(0, end))[1]);
    if (buffer.length < end + 4 + length) return;
    const message = JSON.parse(buffer.subarray(end + 4, end + 4 + length));
    buffer = buffer.subarray(end + 4 + length);
    receive(message);
  }
});

// Opens a text, with the cursor at `|#|`; `messages` are the server's about it.
let opened = 0;
async function open(written) {
  const before = written.split("|#|")[0].split("\n");
  const uri = `file:///machine-${opened++}.yaml`;
  const messages = new Promise((done) => published.set(uri, done));
  const text = written.replace("|#|", "");
  send({ method: "textDocument/didOpen", params: { textDocument: { uri, languageId: "yaml", version: 1, text } } });
  const position = { line: before.length - 1, character: before.at(-1).length };
  return { at: { textDocument: { uri }, position }, messages: await messages };
}

async function completed(written) {
  const found = await ask("textDocument/completion", (await open(written)).at);
  return new Map((found.items ?? found).map((item) => [item.label, item]));
}

async function hovered(written) {
  return (await ask("textDocument/hover", (await open(written)).at)).contents.value;
}

async function messages(written) {
  return (await open(written)).messages.map((message) => message.message);
}

const capabilities = {
  textDocument: {
    completion: { completionItem: { snippetSupport: true, documentationFormat: ["markdown"] } },
    hover: { contentFormat: ["markdown"] },
  },
  workspace: { configuration: true },
};
await ask("initialize", { processId: process.pid, rootUri: null, capabilities });
send({ method: "initialized", params: {} });
send({ method: "workspace/didChangeConfiguration", params: { settings } });

const head = 'abbe: 1\nmachine: M\nchain: "w b X t"\n';
const axes = "axes:\n  X: { travel: [0 mm, 1 mm] }\n";

const top = await completed("abbe: 1\nmachine: M\n|#|\n");
for (const key of ["chain", "axes", "tool", "workpiece", "errors", "measured", "volume"]) {
  assert(top.has(key), `${key} is not offered`);
  assert(top.get(key).documentation, `${key} is not explained`);
}
const letters = await completed(`${head}axes:\n  |#|\n`);
for (const letter of ["X", "Y", "Z", "A", "B", "C"]) assert(letters.has(letter), `axis ${letter} is not offered`);
const keys = await completed(`${head}axes:\n  X:\n    |#|\n`);
for (const key of ["travel", "origin", "on_tool"]) assert(keys.has(key), `${key} of an axis is not offered`);
const errors = await completed(`${head}${axes}errors:\n  |#|\n`);
for (const name of ["EXX", "EYX", "ECC", "EC0Y", "EX0C", "EA0S"]) assert(errors.has(name), `${name} is not offered`);
const tool = await completed(`${head}${axes}tool:\n  |#|\n`);
for (const items of [top, letters, keys, errors, tool]) {
  for (const item of items.values()) assert(!/null/.test(item.insertText ?? ""), `${item.label} is offered with null`);
}

assert.match(await hovered(`${head}${axes}errors:\n  E|#|XX: 2 um\n`), /Positioning error of X/);
assert.match(await hovered(`${head}${axes}errors:\n  E|#|C0Y: 2 urad\n`), /squareness to X/);
assert.match(await hovered(`${head}${axes}errors:\n  E|#|BX: 2 urad\n`), /pitch/);

assert.deepEqual(await messages(`abbe: 1\nmachine: M\n${axes}`), ['Missing property "chain".']);
const lengths = await messages(`${head}${axes}errors:\n  EXX: 2 urad\n`);
assert.match(lengths.join(), /nm, um, mm/);
const angles = await messages(`${head}${axes}errors:\n  EC0Y: 2 um\n`);
assert.match(angles.join(), /urad, mrad, rad, arcsec/);
assert.match((await messages(`${head}axes:\n  X: { travl: [0 mm, 1 mm] }\n`)).join(), /travl is not allowed/);
for (const machine of process.argv.slice(3)) {
  assert.deepEqual(await messages(readFileSync(machine, "utf8")), [], machine);
}

server.kill();
console.log(`completion, hover and messages as expected; ${process.argv.length - 3} machines without a message`);
process.exit(0);
