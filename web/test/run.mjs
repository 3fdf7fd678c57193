// Bundles the tests, for Node runs no TypeScript, and runs them.
import { build } from "esbuild";
import { spawnSync } from "node:child_process";
import { readdirSync } from "node:fs";

const names = readdirSync("test").filter((name) => name.endsWith(".test.ts"));
const entryPoints = names.map((name) => `test/${name}`);
await build({
  entryPoints,
  outdir: "out/test",
  outExtension: { ".js": ".mjs" },
  bundle: true,
  platform: "node",
  format: "esm",
  logLevel: "warning",
});
const files = names.map((name) => `out/test/${name.replace(/ts$/, "mjs")}`);
process.exit(spawnSync(process.execPath, ["--test", ...files], { stdio: "inherit" }).status ?? 1);
