/** The eight questions of a design review, a line each, as the panels answer them. */

import { button, make } from "../ui/dom";

/** What a panel answers, by the panel's name in the address. */
const QUESTIONS = {
  better: ["variants", "Which concept is better on my part?", "Keep a variant A, then change the machine."],
  by: ["variants", "By how much?", "Keep a variant A."],
  sure: ["variants", "Is that more than its uncertainty?", "Keep a variant A."],
  dominates: ["errors", "Which error dominates, and where?", "No error has a value or a bound."],
  fits: ["part", "Does the part fit?", "Name its tool poses."],
  tighten: ["tighten", "What must be tightened, at what cost?", "State a goal."],
  repair: ["control", "What can the control repair?", "Choose a control."],
  test: ["acceptance", "What will the acceptance test read?", "Being computed."],
} as const;

export type Asked = keyof typeof QUESTIONS;

/** Takes an answer; nothing takes it back. */
export type Tell = (of: Asked, ...answer: (Node | string)[]) => void;

export class Answers {
  private readonly cells = new Map<Asked, HTMLElement>();

  /** `open` shows a panel. */
  constructor(parent: HTMLElement, open: (panel: string) => void) {
    const rows = (Object.keys(QUESTIONS) as Asked[]).map((of) => {
      const [panel, words] = QUESTIONS[of];
      const cell = make("dd", { id: `answer-${of}` });
      this.cells.set(of, cell);
      this.tell(of);
      const head = button(words, () => open(panel), { class: "link" });
      return make("div", {}, make("dt", {}, head), cell);
    });
    parent.append(make("dl", { class: "answers", "aria-live": "polite" }, ...rows));
  }

  readonly tell: Tell = (of, ...answer) => {
    const cell = this.cells.get(of);
    const [, , none] = QUESTIONS[of];
    cell?.classList.toggle("none", !answer.length);
    cell?.replaceChildren(...(answer.length ? answer : [none]));
  };
}
