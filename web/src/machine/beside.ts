/** A second picture beside the machine: variant A, or the machine as a control corrects it. It moves and is looked at
 * together with the first, and its deviations are on the same scale. */

import { accepted, type Chain, type Pose } from "../evaluator/types";
import type { Session } from "../session";
import { move, place } from "../ui/address";
import { byId, make } from "../ui/dom";
import type { View } from "./deviation";
import type { Surfaces } from "./look";
import { Stage } from "./stage";

type Kind = "" | "a" | "control";

export class Beside {
  private readonly choice = make("select", { id: "beside-choice", "aria-label": "Picture beside the machine" });
  private readonly parent = byId("beside");
  private readonly label = make("p", { class: "caption", id: "beside-words" });
  private stage: Stage | null = null;
  private shown: View | null = null;
  private first: string | null = null;
  private chain: Chain | null = null;
  private tool = "";
  private known: { text: string; chain: Chain | null } | null = null;
  private surfaces: Surfaces = new Map();

  constructor(
    buttons: HTMLElement,
    private readonly main: Stage | null,
    private readonly session: Session,
    private readonly changed: () => void,
  ) {
    buttons.append(this.choice);
    this.parent.append(this.label);
    this.choice.addEventListener("change", () => {
      move({ beside: this.choice.value });
      void this.update();
    });
    this.list();
  }

  /** What stands beside the machine now. */
  get view(): View | null {
    return this.shown;
  }

  /** Variant A is another text, or only the control is another one. */
  take(first: string | null): void {
    this.first = first ?? this.first;
    this.list();
    void this.update();
  }

  follow(chain: Chain, tool: string, isHeld: boolean): void {
    [this.chain, this.tool] = [chain, tool];
    this.stage?.hold(isHeld);
    if (!isHeld) this.list();
    void this.update();
  }

  move(pose: Pose, rests: boolean): void {
    this.stage?.hold(!rests);
    if (this.shown) this.stage?.move(pose);
  }

  dress(surfaces: Surfaces): void {
    this.surfaces = surfaces;
    this.stage?.dress(surfaces);
  }

  theme(dark: boolean): void {
    this.stage?.theme(dark);
  }

  private list(): void {
    const chosen = place().beside;
    const all: [Kind, string, boolean][] = [
      ["", "Nothing beside", true],
      ["a", "Variant A beside", this.first !== null],
      ["control", "Corrected by the control beside", place().target !== ""],
    ];
    this.choice.replaceChildren(
      ...all.map(([value, words, may]) => make("option", { value, ...(may ? {} : { disabled: "" }) }, words)),
    );
    this.choice.value = all.some(([value, , may]) => value === chosen && may) ? chosen : "";
  }

  private async update(): Promise<void> {
    const kind = this.choice.value as Kind;
    if (kind === "" && this.parent.hidden) return;
    const text = kind === "a" ? (this.first ?? undefined) : undefined;
    const chain = text === undefined ? this.chain : await this.chainOf(text);
    const isOpen = kind !== "" && chain !== null && this.main !== null;
    const turns = this.parent.hidden === isOpen;
    this.parent.hidden = !isOpen;
    // The first picture is narrower now, or wide again.
    if (turns) this.main?.look(this.main.pose);
    this.shown = null;
    if (isOpen && chain && this.main) {
      const stage = this.opened(this.main);
      this.label.textContent = kind === "a" ? "Variant A" : `Corrected: ${place().target}`;
      stage.show(chain, this.tool, this.main.pose, this.main);
      this.shown = { stage, chain, ...(text === undefined ? { target: place().target } : { text }) };
    }
    this.changed();
  }

  /** The chain of a text; of the last one it is known. */
  private async chainOf(text: string): Promise<Chain | null> {
    if (this.known?.text !== text) {
      const [answer] = await this.session.ask(["show"], {}, text);
      this.known = { text, chain: accepted<Chain>(answer) };
    }
    return this.known.chain;
  }

  private opened(main: Stage): Stage {
    if (this.stage) return this.stage;
    this.stage = new Stage(this.parent, this.label.id, () => {});
    this.stage.theme(matchMedia("(prefers-color-scheme: dark)").matches);
    this.stage.dress(this.surfaces);
    main.together(this.stage);
    return this.stage;
  }
}
