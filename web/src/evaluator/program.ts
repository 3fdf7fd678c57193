/** The local program `abbe workbench`, over HTTP on 127.0.0.1. */

import { move } from "../ui/address";
import { Conflict, type Evaluator, type OpenFile, type Reply, type Request, type Store } from "./types";

/** Why a program does not answer that was started after the page was opened. */
const STRANGER =
  "the program does not know this page: open the whole address that it printed when it started, here or in another tab";

/** Where the tab keeps the token. */
const KEY = "abbe-token";

/** The token of the address that the program prints, which leaves the address bar; a reload finds it in the tab. */
function token(before?: string): string {
  const printed = new URLSearchParams(location.hash.slice(1)).get("token");
  if (printed !== null) {
    sessionStorage.setItem(KEY, printed);
    if (before === undefined) move({});
    else history.replaceState(null, "", before);
  }
  return sessionStorage.getItem(KEY) ?? "";
}

export class Program implements Evaluator, Store {
  readonly verb = "Save";
  readonly isReadOnly = false;

  private token = token();

  constructor() {
    // The address of a program that was started anew, put into the tab of the one before.
    window.addEventListener("hashchange", ({ oldURL }) => (this.token = token(oldURL)));
  }

  ask(request: Request, signal?: AbortSignal): Promise<Reply> {
    return this.post<Reply>("ask", request, signal);
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

  /** The program ends a computation whose reader has left. */
  private async post<T>(path: string, body: unknown, signal?: AbortSignal): Promise<T> {
    const headers = { "content-type": "application/json", "x-abbe-token": this.token };
    const question = { method: "POST", headers, body: JSON.stringify(body), signal: signal ?? null };
    const response = await fetch(`/${path}`, question).catch(() => {
      signal?.throwIfAborted();
      throw new Error("the program does not answer: start `abbe workbench` again");
    });
    if (response.ok) return (await response.json()) as T;
    if (response.status === 403) throw new Error(STRANGER);
    const { failure, theirs } = (await response.json().catch(() => ({}))) as { failure?: string; theirs?: string };
    if (response.status === 409) throw new Conflict(failure ?? "", theirs ?? null);
    throw new Error(failure ?? `the program answers with status ${response.status}`);
  }
}
