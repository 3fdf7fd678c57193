/** The eight questions of a design review as a table: the answer with a mark, its figure, and why. */

import { button, make } from "../ui/dom";

/** The panel that answers, by its name in the address; the question; what is missing for an answer, and how to give it. */
const QUESTIONS = {
  better: [
    "variants",
    "Which concept is better on my part?",
    "One machine",
    "Open a second one, or keep this state and change it.",
  ],
  by: ["variants", "By how much?", "One machine", ""],
  sure: ["variants", "Is that more than its uncertainty?", "One machine", ""],
  dominates: ["errors", "Which error dominates, and where?", "None", "No error has a value or a bound."],
  fits: ["part", "Does the part fit?", "No part", "Name its tool poses."],
  tighten: ["tighten", "What must be tightened, at what cost?", "No goal", "State a limit or a goal."],
  repair: ["control", "What can the control repair?", "No control", "Choose one."],
  test: ["acceptance", "What will the acceptance test read?", "…", ""],
} as const;

/** The questions in their order, in words. */
export const ASKED = (Object.keys(QUESTIONS) as (keyof typeof QUESTIONS)[]).map((of) => ({
  of,
  words: QUESTIONS[of][1],
}));

export type Asked = keyof typeof QUESTIONS;

const MARKS = { yes: "✓", no: "✗", open: "?" };

/** An answer in one or two words. */
export interface Answer {
  words: Node | string;
  /** Good, bad, or not decided; none for what is neither. */
  mark?: keyof typeof MARKS;
  /** The figure, with its interval. */
  figure?: (Node | string)[];
  /** One sentence. */
  why?: (Node | string)[];
}

/** Takes an answer; without one the question is open. */
export type Tell = (of: Asked, answer?: Answer) => void;

export class Answers {
  private readonly cells = new Map<Asked, HTMLElement>();

  /** `open` shows a panel. */
  constructor(parent: HTMLElement, open: (panel: string) => void) {
    const rows = (Object.keys(QUESTIONS) as Asked[]).map((of) => {
      const [panel, words] = QUESTIONS[of];
      const cell = make("td", { id: `answer-${of}` });
      this.cells.set(of, cell);
      this.tell(of);
      const head = button(words, () => open(panel), { class: "link" });
      return make("tr", {}, make("th", { scope: "row" }, head), cell);
    });
    parent.append(make("table", { class: "answers", "aria-live": "polite" }, make("tbody", {}, ...rows)));
  }

  readonly tell: Tell = (of, answer) => {
    const cell = this.cells.get(of);
    const [, , none, how] = QUESTIONS[of];
    const { words, mark, figure = [], why = [] } = answer ?? { words: none, why: how ? [how] : [] };
    cell?.classList.toggle("none", !answer);
    cell?.replaceChildren(...said({ words, ...(mark ? { mark } : {}), figure, why }));
  };
}

/** An answer as it stands in a cell. */
export function said({ words, mark, figure = [], why = [] }: Answer): (Node | string)[] {
  const sign = mark ? [make("span", { class: `mark ${mark}`, "aria-hidden": "true" }, MARKS[mark]), " "] : [];
  const value = figure.length ? [" ", make("span", {}, ...figure)] : [];
  const reason = why.length ? [make("span", { class: "why" }, ...why)] : [];
  return [...sign, make("strong", {}, words), ...value, ...reason];
}
