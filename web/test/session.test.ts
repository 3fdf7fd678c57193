/** While a slider is held: the map at once, each error alone as soon as it is there, and nothing of an earlier drag. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { kindOf } from "../src/evaluator/division";
import type { Reply, Request } from "../src/evaluator/types";
import { Session, type State } from "../src/session";

/** Answers every question with the text that it was asked of; those after each error alone wait until they are let go. */
class Machine {
  readonly asked: string[] = [];
  hold = false;
  private readonly held: (() => void)[] = [];

  async ask({ questions, texts }: Request): Promise<Reply> {
    const kinds = questions.map(kindOf);
    this.asked.push(kinds.join());
    if (this.hold && kinds.includes("sources")) await new Promise<void>((done) => this.held.push(done));
    const of = texts["m.yaml"] ?? "";
    const p95 = Number(of);
    const answers: Record<string, unknown> = {
      show: { chain: of },
      map: { position_um: { p95 } },
      sources: { at: {}, errors: [{ error: of }] },
    };
    return { diagnostics: [], answers: kinds.map((kind) => answers[kind] ?? { refused: true, diagnostics: [] }) };
  }

  release(): void {
    this.held.splice(0).forEach((done) => done());
  }
}

const rest = () => new Promise((done) => setTimeout(done, 5));

test("a held slider asks for the map alone, and shows each error alone when it comes", async () => {
  const machine = new Machine();
  const shown: State[] = [];
  const failures: string[] = [];
  const session = new Session(
    machine,
    (state) => shown.push(state),
    (failure) => failures.push(failure),
    () => {},
  );
  const last = () => {
    const { now, effort } = shown[shown.length - 1] ?? {};
    return [now?.map?.position_um.p95, now?.sources?.errors[0]?.error, effort?.draft];
  };
  session.open("m.yaml", "1");
  await rest();
  assert.deepEqual(machine.asked, ["show,map,budget,sources,words,numbers"]);
  assert.deepEqual(last(), [1, "1", false]);
  machine.hold = true;
  session.change("2", true, true);
  await rest();
  assert.deepEqual(machine.asked.slice(1).sort(), ["map", "sources"]);
  assert.deepEqual(last(), [2, "1", true]);
  machine.release();
  await rest();
  assert.deepEqual(last(), [2, "2", true]);
  // A number of the chain: it is asked for, too.
  session.change("3", true);
  await rest();
  assert.ok(machine.asked.includes("map,show"), machine.asked.join(" "));
  assert.equal(shown[shown.length - 1]?.now?.chain.chain, "3");
  // Let go before each error alone of "3" was there: what comes of it then is not shown.
  machine.hold = false;
  session.change("4", false);
  await rest();
  assert.deepEqual(last(), [4, "4", false]);
  machine.release();
  await rest();
  assert.deepEqual(last(), [4, "4", false]);
  assert.deepEqual(failures, []);
});
