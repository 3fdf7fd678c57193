// Writes the machine files of configs/ with all they name into one JSON file for the playground.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";

const folder = new URL("../configs/", import.meta.url);
const names = readdirSync(folder, { recursive: true })
  .map(String)
  .filter((name) => /\.(yaml|csv)$/.test(name))
  .sort();
const files = Object.fromEntries(names.map((name) => [name, readFileSync(new URL(name, folder), "utf8")]));
writeFileSync(process.argv[2], JSON.stringify({ machines: names.filter((name) => name.endsWith(".yaml")), files }));
