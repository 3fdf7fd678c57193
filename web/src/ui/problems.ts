/** What is wrong, above everything until it is settled, and whether picture and figures are of before. */

import { button, byId, make } from "./dom";

/** What a problem concerns: one of each stands at a time. */
export type About =
  "chain" | "file" | "figures" | "look" | "picture" | "program" | "questions" | "save" | "start" | "tool";

interface Problem {
  words: string;
  /** Whether what is shown is of before it. */
  isOld: boolean;
  choices: HTMLElement[];
}

export class Problems {
  private readonly all = new Map<About, Problem>();

  /** Says it; `choices` are buttons. */
  say(about: About, words: string, ...choices: HTMLElement[]): void {
    this.put(about, { words, isOld: false, choices });
  }

  /** Says it of what leaves picture and figures as they were before. */
  outdates(about: About, words: string): void {
    this.put(about, { words, isOld: true, choices: [] });
  }

  clear(...about: About[]): void {
    if (about.filter((of) => this.all.delete(of)).length) this.show();
  }

  private put(about: About, problem: Problem): void {
    const before = this.all.get(about);
    // Said again it would be read out again.
    if (before?.words === problem.words && !before.choices.length && !problem.choices.length) return;
    this.all.set(about, problem);
    this.show();
  }

  private show(): void {
    const list = [...this.all].map(([about, of]) => this.line(about, of));
    byId("problem").hidden = !list.length;
    byId("problem").replaceChildren(...list);
    const isOld = [...this.all.values()].some((of) => of.isOld);
    document.body.toggleAttribute("data-stale", isOld);
    byId("old").hidden = !isOld;
  }

  /** What is not settled by itself can be put away. */
  private line(about: About, { words, isOld, choices }: Problem): HTMLElement {
    const close = () => button("×", () => this.clear(about), { "aria-label": "Close", class: "link" });
    const more = isOld || choices.length ? choices : [close()];
    return make("span", { class: "line" }, words, ...more);
  }
}
