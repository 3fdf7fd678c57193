/** While a slider is held: the map at once, each error alone as soon as it is there, and nothing of an earlier drag.
 * What a change makes stale is asked no longer. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { kindOf } from "../src/evaluator/division";
import { Newest } from "../src/evaluator/newest";
import type { Reply, Request } from "../src/evaluator/types";
import { Session, type State } from "../src/session";

/** Answers every question with the text that it was asked of; those after each error alone wait until they are let go. */
class Machine {
  readonly asked: string[] = [];
  hold = false;
  fails = false;
  /** Questions that nobody waits for any more. */
  readonly ended: string[] = [];
  private readonly held: (() => void)[] = [];

  async ask({ questions, texts }: Request, signal?: AbortSignal): Promise<Reply> {
    const kinds = questions.map(kindOf);
    const of = texts["m.yaml"] ?? "";
    this.asked.push(kinds.join());
    const isLong = kinds.includes("sources") || kinds.includes("reach");
    if (this.hold && isLong)
      await new Promise<void>((done, fail) => {
        this.held.push(done);
        signal?.addEventListener("abort", () => {
          this.ended.push(`${kinds.join()} of ${of}`);
          fail(signal.reason as Error);
        });
      });
    if (this.fails) throw new Error("nobody answers");
    const p95 = Number(of);
    const answers: Record<string, unknown> = {
      show: { chain: of },
      map: { position_um: { p95 } },
      reach: of,
      sources: { at: {}, errors: [{ error: of }] },
    };
    return { diagnostics: [], answers: kinds.map((kind) => answers[kind] ?? { refused: true, diagnostics: [] }) };
  }

  release(): void {
    this.held.splice(0).forEach((done) => done());
  }
}

const rest = () => new Promise((done) => setTimeout(done, 5));

function sessionOf(machine: Machine) {
  const shown: State[] = [];
  const failures: string[] = [];
  const session = new Session(
    machine,
    (state) => shown.push(state),
    (failure) => failures.push(failure),
    () => {},
  );
  return { session, shown, failures };
}

test("a held slider asks for the map alone, and shows each error alone when it comes", async () => {
  const machine = new Machine();
  const { session, shown, failures } = sessionOf(machine);
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

test("a question at rest ends with a change, and is asked again when the figures stand", async () => {
  const machine = new Machine();
  const { session, failures } = sessionOf(machine);
  session.open("m.yaml", "1");
  await rest();
  machine.hold = true;
  const reached: unknown[] = [];
  const asking = new Newest((failure) => failures.push(String(failure)));
  void asking.do(async () => void reached.push((await session.askAtRest([{ reach: {} }]))[0]));
  await rest();
  assert.deepEqual([machine.asked.at(-1), reached], ["reach", []]);
  session.change("2", true, true);
  await rest();
  assert.ok(machine.ended.includes("reach of 1"), machine.ended.join());
  session.change("3", true, true);
  await rest();
  assert.equal(machine.asked.filter((of) => of === "reach").length, 1);
  machine.hold = false;
  session.change("4", false);
  await rest();
  assert.deepEqual([reached, machine.asked.at(-1)], [["4"], "reach"]);
  assert.deepEqual(failures, []);
});

test("of what is wished after an ended question only the newest is done", async () => {
  const machine = new Machine();
  const { session, shown, failures } = sessionOf(machine);
  session.open("m.yaml", "1");
  await rest();
  machine.hold = true;
  const done: string[] = [];
  const asking = new Newest((failure) => failures.push(String(failure)));
  const wish = (name: string) =>
    asking.do(async () => void (await session.askAtRest([{ reach: {} }]), done.push(name)));
  void wish("first");
  await rest();
  session.change("2", false);
  await rest();
  void wish("second");
  // The figures of "2" are asked no longer either, and never shown.
  session.change("3", false);
  machine.hold = false;
  await rest();
  assert.deepEqual(machine.ended, ["reach of 1", "show,map,budget,sources,words,numbers of 2"]);
  assert.deepEqual(done, ["second"]);
  assert.deepEqual(
    shown.map(({ now }) => now?.chain.chain),
    ["1", "3"],
  );
  assert.deepEqual(failures, []);
});

test("a failure leaves the newest wish, and a question at rest is asked after it", async () => {
  const machine = new Machine();
  const { session, shown, failures } = sessionOf(machine);
  session.open("m.yaml", "1");
  await rest();
  machine.fails = true;
  machine.hold = true;
  const asking = new Newest((failure) => failures.push(String(failure)));
  session.change("2", true, true);
  session.change("3", true, true);
  void asking.do(async () => void (await session.askAtRest([{ reach: {} }])));
  machine.hold = false;
  await rest();
  assert.ok(failures.length > 0 && !machine.asked.includes("reach"), failures.join());
  machine.fails = false;
  machine.release();
  session.change("4", false);
  await rest();
  assert.deepEqual([shown.at(-1)?.now?.chain.chain, machine.asked.at(-1)], ["4", "reach"]);
});
