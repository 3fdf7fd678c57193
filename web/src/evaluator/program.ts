/** The local program `abbe workbench`, over HTTP on 127.0.0.1. */

import type { Evaluator, OpenFile, Reply, Request, Store } from "./types";

export class Program implements Evaluator, Store {
  readonly verb = "Save";
  readonly isReadOnly = false;

  constructor(private readonly token: string) {}

  ask(request: Request): Promise<Reply> {
    return this.post<Reply>("ask", request);
  }

  open(): Promise<OpenFile> {
    return this.post<OpenFile>("open", {});
  }

  follow(): Promise<{ text: string | null; changes: number }> {
    return this.post("follow", {});
  }

  async save(text: string, before: string): Promise<void> {
    await this.post("save", { text, before });
  }

  private async post<T>(path: string, body: unknown): Promise<T> {
    const headers = { "content-type": "application/json", "x-abbe-token": this.token };
    const response = await fetch(`/${path}`, { method: "POST", headers, body: JSON.stringify(body) }).catch(() => {
      throw new Error("the program does not answer: start `abbe workbench` again");
    });
    if (response.ok) return (await response.json()) as T;
    const failure = (await response.json().catch(() => ({}))) as { failure?: string };
    throw new Error(failure.failure ?? `the program answers with status ${response.status}`);
  }
}
