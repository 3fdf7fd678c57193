/** The library in a worker, with the examples that lie beside the page. */

import { Hosted } from "./hosted";
import type { Evaluator, OpenFile, Reply, Request, Store } from "./types";
import { variants } from "./variants";
import { save as download } from "../ui/download";

/** Examples beside the page: names of machine files, and all files by name. */
interface Examples {
  machines: string[];
  files: Record<string, string>;
}

export class Playground implements Evaluator, Store {
  readonly verb = "Download";
  readonly isReadOnly = false;

  private constructor(
    private readonly engine: Hosted,
    private readonly examples: Examples,
    public chosen: string,
  ) {}

  /** Loads engine and examples; `chosen` is the name of one of them, or empty. */
  static async load(chosen: string): Promise<Playground> {
    const [module, examples] = await Promise.all([
      WebAssembly.compileStreaming(fetch(`engine-${variants()[0]}.wasm`)),
      fetch("examples.json").then((response) => response.json() as Promise<Examples>),
    ]);
    const known = examples.machines.includes(chosen) ? chosen : "trunnion.yaml";
    return new Playground(new Hosted(module, examples.files), examples, known);
  }

  get choices(): string[] {
    return this.examples.machines;
  }

  ask(request: Request, signal?: AbortSignal): Promise<Reply> {
    return this.engine.ask(request, signal);
  }

  open(): Promise<OpenFile> {
    return Promise.resolve({ machine: this.chosen, text: this.examples.files[this.chosen] ?? "" });
  }

  save(text: string): Promise<void> {
    download(this.chosen.split("/").pop() ?? "machine.yaml", new Blob([text], { type: "application/yaml" }));
    return Promise.resolve();
  }
}
