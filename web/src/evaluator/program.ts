/** The local program `abbe workbench`, over HTTP on 127.0.0.1. */

import { Conflict, type Evaluator, type OpenFile, type Reply, type Request, type Store } from "./types";

/** Why a program does not answer that was started after the page was opened. */
const STRANGER = "the program was started anew and does not know this page: open the address that it printed";

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
    if (response.status === 403) throw new Error(STRANGER);
    const { failure, theirs } = (await response.json().catch(() => ({}))) as { failure?: string; theirs?: string };
    if (response.status === 409) throw new Conflict(failure ?? "", theirs ?? null);
    throw new Error(failure ?? `the program answers with status ${response.status}`);
  }
}
