/** Completion of keys from the schema of machine files, and of names of errors with what each is. */

import {
  autocompletion,
  type Completion,
  type CompletionContext,
  type CompletionResult,
} from "@codemirror/autocomplete";
import type { EditorState, Extension } from "@codemirror/state";
import { hoverTooltip } from "@codemirror/view";

/** As much of JSON Schema as machine files use. */
export interface Schema {
  $ref?: string;
  description?: string;
  properties?: Record<string, Schema>;
  patternProperties?: Record<string, Schema>;
  additionalProperties?: Schema | boolean;
  items?: Schema;
  anyOf?: Schema[];
  oneOf?: Schema[];
  allOf?: Schema[];
  definitions?: Record<string, Schema>;
}

/** What is known of files and of the machine. */
export interface Language {
  schema: Schema;
  /** Errors of the machine's axes, in words by name. */
  words: Record<string, string>;
}

/** Sections whose keys are names of errors. */
const OF_ERRORS = new Set(["errors", "tolerances"]);

/** Returns the keys under which an entry at a position stands, the outermost first. */
export function keysAbove(state: EditorState, position: number): string[] {
  const line = state.doc.lineAt(position);
  const keys = flowKeys(line.text.slice(0, position - line.from));
  let indent = /^\s*/.exec(line.text)?.[0].length ?? 0;
  const own = keys.length ? indent : -1;
  for (let i = line.number - 1; i >= 1 && (indent > 0 || own > 0); i -= 1) {
    const [, spaces, key] = /^(\s*)(?:- )?["']?([\w-]+)["']?\s*:/.exec(state.doc.line(i).text) ?? [];
    if (spaces === undefined || key === undefined || spaces.length >= indent) continue;
    keys.unshift(key);
    indent = spaces.length;
    if (indent === 0) break;
  }
  return keys;
}

/** Keys of braces that are open at the end of a text. */
function flowKeys(text: string): string[] {
  const open: string[] = [];
  for (const match of text.matchAll(/([\w-]+)\s*:\s*\{|\{|\}/g)) {
    if (match[0] === "}") open.pop();
    else open.push(match[1] ?? "");
  }
  return open.filter((key) => key !== "");
}

/** Returns the keys that may stand below others, with their descriptions. */
export function keysAt({ schema, words }: Language, above: string[]): Record<string, string> {
  if (OF_ERRORS.has(above.at(-1) ?? "")) return words;
  let at = alternatives(schema, schema);
  for (const key of above) at = at.flatMap((of) => below(of, key)).flatMap((of) => alternatives(schema, of));
  const entries = at.flatMap((of) => Object.entries(of.properties ?? {}));
  return Object.fromEntries(entries.map(([key, of]) => [key, of.description ?? ""]));
}

function below(of: Schema, key: string): Schema[] {
  const exact = of.properties?.[key];
  if (exact) return [exact];
  const patterns = Object.entries(of.patternProperties ?? {}).filter(([pattern]) => new RegExp(pattern).test(key));
  if (patterns.length) return patterns.map(([, schema]) => schema);
  return typeof of.additionalProperties === "object" ? [of.additionalProperties] : [];
}

/** A schema with references followed and alternatives side by side. */
function alternatives(root: Schema, of: Schema, depth = 0): Schema[] {
  if (depth > 8) return [];
  const name = of.$ref?.replace("#/definitions/", "");
  const target = name ? root.definitions?.[name] : undefined;
  const more = [...(target ? [target] : []), ...(of.anyOf ?? []), ...(of.oneOf ?? []), ...(of.allOf ?? [])];
  return [of, ...more.flatMap((next) => alternatives(root, next, depth + 1))];
}

function complete(language: Language | null, context: CompletionContext): CompletionResult | null {
  const word = context.matchBefore(/[\w-]*/);
  if (!language || !word || (word.from === word.to && !context.explicit)) return null;
  const line = context.state.doc.lineAt(context.pos);
  // A key begins a line or an entry of braces; everything else is a value.
  if (!/^\s*$|[{,]\s*$/.test(line.text.slice(0, word.from - line.from))) return null;
  const known = keysAt(language, keysAbove(context.state, word.from));
  const options = Object.entries(known).map(([label, info]): Completion => ({
    label,
    apply: `${label}: `,
    detail: short(info),
  }));
  return options.length ? { from: word.from, options, validFor: /^[\w-]*$/ } : null;
}

const short = (text: string) => (text.length > 70 ? `${text.slice(0, 69).trimEnd()}…` : text);

/** `explain` returns what a name is, for the pointer over it. */
export function completion(language: () => Language | null, explain: (name: string) => HTMLElement | null): Extension {
  return [
    autocompletion({ override: [(context) => complete(language(), context)], icons: false }),
    hoverTooltip((view, position) => {
      const word = view.state.wordAt(position);
      const dom = word && explain(view.state.sliceDoc(word.from, word.to));
      return dom ? { pos: word.from, end: word.to, create: () => ({ dom }) } : null;
    }),
  ];
}
