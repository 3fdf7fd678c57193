/** How two engines share a request: some of its questions each, or one large map in two parts. */

import type { Question, Reply, Request } from "./types";

/** What an engine does of a request. */
export interface Sharing {
  ask(request: Request, parts?: Uint8Array<ArrayBuffer>[]): Promise<Reply>;
  part(request: Request, index: number, count: number): Promise<Uint8Array<ArrayBuffer>>;
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
export function together(request: Request, first: Sharing, second: Sharing): Promise<Reply> {
  return hasLargeMap(request.questions) ? inParts(request, first, second) : apart(request, first, second);
}

async function inParts(request: Request, first: Sharing, second: Sharing): Promise<Reply> {
  const parts = await Promise.all([first, second].map((engine, index) => engine.part(request, index, 2)));
  return first.ask(request, parts);
}

async function apart(request: Request, first: Sharing, second: Sharing): Promise<Reply> {
  const { questions } = request;
  const [own, other] = await Promise.all([
    first.ask({ ...request, questions: questions.filter((of) => !isApart(of)) }),
    second.ask({ ...request, questions: questions.filter(isApart) }),
  ]);
  // A refused machine has no answers.
  if (own.answers.length === 0) return own;
  const [ours, theirs] = [own.answers.values(), other.answers.values()];
  return { ...own, answers: questions.map((of) => (isApart(of) ? theirs : ours).next().value) };
}
