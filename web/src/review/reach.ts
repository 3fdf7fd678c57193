/** The share of the work in reach, with what stops the rest. Asked when the geometry is another one. */

import { Newest } from "../evaluator/newest";
import { accepted, type Reach } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import { make } from "../ui/dom";
import { positions } from "../units";

/** Reasons that are shown. */
const FEW = 2;

export class ReachLine {
  private asked = "";
  private readonly asking: Newest;

  constructor(
    private readonly parent: HTMLElement,
    private readonly session: Session,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.parent);
  }

  show(state: State, tool: string): void {
    this.parent.classList.toggle("stale", !isSettled(state));
    if (!isSettled(state)) return;
    const geometry = JSON.stringify([state.now.chain, tool, state.now.map?.over]);
    if (geometry === this.asked) return;
    this.asked = geometry;
    this.parent.replaceChildren(make("p", { class: "words" }, "Work in reach: being counted …"));
    void this.asking.do(() => this.ask());
  }

  private async ask(): Promise<void> {
    const [answer] = await this.session.askAtRest([{ reach: {} }]);
    // The text is refused.
    if (answer === undefined) return void (this.asked = "");
    const reach = accepted<Reach>(answer);
    this.parent.replaceChildren(...(reach ? shown(reach) : []));
  }
}

function shown(reach: Reach): HTMLElement[] {
  const percent = `${Number((100 * reach.share).toPrecision(3))} %`;
  const share = make("strong", { "data-at": "reach", "data-value": String(reach.share) }, percent);
  const isJob = reach.over.kind === "job";
  const of = isJob ? `the ${reach.tool_poses} tool poses of the job` : `${reach.tips} tips, ${directions(reach)}`;
  const words = make(
    "p",
    {},
    isJob ? "Job in reach " : "Work in reach ",
    share,
    make("span", { class: "words" }, ` of ${of}`),
  );
  if (!reach.reasons.length) return [words];
  const more = reach.reasons.length - FEW;
  const rest = `${reach.reasons.slice(0, FEW).map(positions).join("; ")}${more > 0 ? `; ${more} more` : ""}.`;
  const all = { class: "words", id: "out-of-reach", title: reach.reasons.join("\n") };
  return [words, make("p", all, "The rest: ", rest.replaceAll(/-(\d)/g, "−$1").replaceAll("tool poses", "poses"))];
}

function directions({ directions: { kind, count } }: Reach): string {
  if (kind === "one") return "one direction of the tool";
  return `${count} directions ${kind === "circle" ? "on a circle" : "each"}`;
}
