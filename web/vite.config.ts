import { createHash } from "node:crypto";
import { readdirSync, readFileSync } from "node:fs";
import { defineConfig, type Plugin } from "vite";

/** Puts style and script into the page, with a policy that lets nothing else run. */
function onePage(mode: string): Plugin {
  return {
    name: "one-page",
    enforce: "post",
    generateBundle: {
      order: "post",
      handler(_, bundle) {
        const script = take(bundle, ".js");
        const style = take(bundle, ".css");
        const page = readFileSync("page.html", "utf8");
        const licences = notices([...this.getModuleIds()]);
        const source = fill(page, { style, script, licences, ...content(mode, script) });
        this.emitFile({ type: "asset", fileName: mode === "program" ? "workbench.html" : "index.html", source });
      },
    },
  };
}

type Bundle = Record<string, { type: string; fileName: string; code?: string; source?: string | Uint8Array }>;

function take(bundle: Bundle, ending: string): string {
  const file = Object.values(bundle).find((of) => of.fileName.endsWith(ending));
  if (!file) throw new Error(`the bundle has no ${ending}`);
  delete bundle[file.fileName];
  return (file.code ?? String(file.source)).trim();
}

/** Names, versions and licences of the packages in the script: their terms ask for it. */
function notices(modules: string[]): string {
  const folders = modules.map((id) => /^.*\/node_modules\/(?:@[^/]+\/)?[^/]+/.exec(id.replaceAll("\\", "/"))?.[0]);
  const texts = [...new Set(folders)].filter((folder) => folder !== undefined).map(notice);
  return [...new Set(texts)].sort().join("\n\n").replaceAll("--", "- -");
}

function notice(folder: string): string {
  const { name, version } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8")) as Record<string, string>;
  const licence = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
  if (!licence) throw new Error(`${name} has no licence`);
  return `${name} ${version}\n\n${readFileSync(`${folder}/${licence}`, "utf8").trim()}`;
}

/** What the program fills in; the page of the playground has fixed content. */
function content(mode: string, script: string): Record<string, string> {
  if (mode === "program")
    return { policy: "@POLICY@", nonce: "@NONCE@", appendices: "@APPENDICES@", start: "@START@", tail: "@TAIL@" };
  const start = '{"evaluator":"playground"}';
  return { policy: policy(script), nonce: "playground", appendices: "", start, tail: "" };
}

function policy(script: string): string {
  const hash = createHash("sha256").update(script).digest("base64");
  const scripts = `script-src 'sha256-${hash}' 'wasm-unsafe-eval'; worker-src blob:`;
  return `default-src 'none'; ${scripts}; style-src 'nonce-playground'; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'`;
}

function fill(page: string, parts: Record<string, string>): string {
  const script = parts["script"] ?? "";
  if (/<\/script|<!--|@(POLICY|NONCE|APPENDICES|START|TAIL)@/i.test(script))
    throw new Error("the script cannot stand in a page");
  return page.replace(/\{\{(\w+)\}\}/g, (_, name: string) => parts[name] ?? "");
}

export default defineConfig(({ mode }) => ({
  build: {
    outDir: mode === "program" ? "out/program" : "out/playground",
    target: "es2022",
    sourcemap: false,
    cssCodeSplit: false,
    modulePreload: false,
    reportCompressedSize: false,
    chunkSizeWarningLimit: 2048,
    rollupOptions: {
      input: "src/main.ts",
      output: {
        format: "iife" as const,
        entryFileNames: "workbench.js",
        assetFileNames: "workbench[extname]",
        inlineDynamicImports: true,
      },
    },
  },
  worker: { format: "iife" as const },
  plugins: [onePage(mode)],
}));
