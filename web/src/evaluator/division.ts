/** How two engines share a request: some of its questions each, or one large map in two parts. */

import type { Question, Reply, Request } from "./types";

/** What an engine does of a request. */
export interface Sharing {
  ask(request: Request, signal?: AbortSignal, parts?: Uint8Array<ArrayBuffer>[]): Promise<Reply>;
  part(request: Request, index: number, count: number, signal?: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
}

/** They take as long as the map and all else: the sources where errors are measured, the budget where they are not. */
const APART = ["budget", "sources"];

/** A smaller map is there before its parts are handed over. */
const LARGE = 50_000;

export const kindOf = (of: Question): string => (typeof of === "string" ? of : (Object.keys(of)[0] ?? ""));

const isApart = (of: Question): boolean => APART.includes(kindOf(of));

function hasLargeMap([question, ...more]: Question[]): boolean {
  if (typeof question !== "object" || !("map" in question) || more.length > 0) return false;
  const { poses } = question.map;
  return poses === "grid" || poses.random >= LARGE;
}

export function isDivisible({ questions }: Request): boolean {
  const apart = questions.filter(isApart).length;
  return (apart > 0 && apart < questions.length) || hasLargeMap(questions);
}

/** Answers a request that is divisible, to the bit as one engine does. */
export function together(request: Request, engines: [Sharing, Sharing], signal?: AbortSignal): Promise<Reply> {
  return (hasLargeMap(request.questions) ? inParts : apart)(request, engines, signal);
}

async function inParts(request: Request, engines: [Sharing, Sharing], signal?: AbortSignal): Promise<Reply> {
  const parts = await Promise.all(engines.map((engine, index) => engine.part(request, index, 2, signal)));
  return engines[0].ask(request, signal, parts);
}

async function apart(request: Request, [first, second]: [Sharing, Sharing], signal?: AbortSignal): Promise<Reply> {
  const { questions } = request;
  const [own, other] = await Promise.all([
    first.ask({ ...request, questions: questions.filter((of) => !isApart(of)) }, signal),
    second.ask({ ...request, questions: questions.filter(isApart) }, signal),
  ]);
  // A refused machine has no answers.
  if (own.answers.length === 0) return own;
  const [ours, theirs] = [own.answers.values(), other.answers.values()];
  return { ...own, answers: questions.map((of) => (isApart(of) ? theirs : ours).next().value) };
}
