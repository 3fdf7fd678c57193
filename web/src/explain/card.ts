/** What a name is, on hover and focus: its words after ISO 230-1, its letters and a sketch. */

import type { Chain } from "../evaluator/types";
import { make } from "../ui/dom";
import { axisOf, letters, parsed } from "./name";
import { sketch } from "./sketch";

export class Cards {
  private readonly card = make("div", { id: "card", role: "tooltip" });
  private chain: Chain | null = null;
  private words: Record<string, string> = {};

  constructor() {
    this.card.hidden = true;
    document.querySelector("main")?.append(this.card);
    for (const event of ["pointerover", "focusin"] as const)
      document.addEventListener(event, ({ target }) => this.over(target));
    for (const event of ["pointerout", "focusout"] as const) document.addEventListener(event, () => this.hide());
    document.addEventListener("keydown", ({ key }) => key === "Escape" && this.hide());
  }

  /** Takes the machine of which names are explained, with the words of its errors. */
  follow(chain: Chain, words: Record<string, string>): void {
    this.chain = chain;
    this.words = words;
  }

  /** The explanation of a name; `null` for a text that is none. */
  of(error: string): HTMLElement | null {
    const [name, words] = [parsed(error), this.words[error]];
    if (!this.chain || !name || !words) return null;
    return make(
      "div",
      { class: "explained" },
      sketch(name, axisOf(this.chain, name)),
      make("div", {}, make("strong", {}, error), make("p", {}, words), make("p", { class: "words" }, letters(name))),
    );
  }

  private over(target: EventTarget | null): void {
    const owner = target instanceof Element ? target.closest<HTMLElement>("[data-error]") : null;
    const explained = owner && this.of(owner.dataset["error"] ?? "");
    if (!owner || !explained) return;
    owner.setAttribute("aria-describedby", this.card.id);
    this.card.replaceChildren(explained);
    this.card.hidden = false;
    this.stand(owner.getBoundingClientRect());
  }

  private hide(): void {
    this.card.hidden = true;
  }

  /** Below its owner, or above where there is no room. */
  private stand(owner: DOMRect): void {
    const { width, height } = this.card.getBoundingClientRect();
    const below = owner.bottom + 6;
    const top = below + height > innerHeight ? owner.top - height - 6 : below;
    this.card.style.top = `${Math.max(4, top)}px`;
    this.card.style.left = `${Math.max(4, Math.min(owner.left, innerWidth - width - 8))}px`;
  }
}
