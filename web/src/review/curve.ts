/** The deviation along one axis through the present pose: a chart that is read under the pointer, and along which a drag
 * moves the machine. */

import { Newest } from "../evaluator/newest";
import { accepted, type Axis, type Chain, type Evaluated, type Pose, type Rows, type Vec3 } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import { move, place } from "../ui/address";
import { button, make } from "../ui/dom";
import { download } from "../ui/download";
import { lineChart, MARGIN, type Sample, SIZE } from "./lines";
import { bare, named, quantity } from "../units";

/** Intervals of the curve. */
const STEPS = 80;

/** Machines that are drawn for what bounds lead to at each pose. */
const SAMPLES = 300;

export class AxisCurve {
  private readonly choice = make("select", { id: "curve-axis" });
  private readonly plot = make("div", { class: "plot", tabindex: "0", role: "slider", id: "curve" });
  private readonly cursor = make("div", { class: "cursor" });
  private readonly probe = make("div", { class: "cursor probe" });
  private readonly readout = make("p", { class: "words", id: "curve-readout" });
  private readonly asking: Newest;
  private chain: Chain | null = null;
  private bounded = false;
  private pose: Pose = {};
  private samples: Sample[] = [];
  /** The axis of the samples, and the poses of the others there. */
  private asked = "";

  constructor(
    private readonly parent: HTMLElement,
    private readonly session: Session,
    /** Moves one axis. */
    private readonly drag: (axis: Axis, position: number, rests: boolean) => void,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed);
    const words = "The deviation along one axis, the others as they are. Drag in the chart: the machine goes there.";
    this.choice.addEventListener("change", () => {
      move({ along: this.choice.value });
      this.update(true);
    });
    const files = [button("CSV", () => this.csv()), button("SVG", () => this.svg()), button("PNG", () => this.png())];
    parent.append(
      make("p", { class: "words" }, words),
      make("p", {}, make("label", { for: "curve-axis" }, "Along "), this.choice),
      this.plot,
      this.readout,
      make("p", { class: "files" }, ...files),
    );
    this.probe.hidden = true;
    this.listen();
  }

  show(state: State): void {
    this.parent.classList.toggle("stale", state.stale);
    if (!isSettled(state)) return;
    const { chain } = state.now;
    this.bounded = state.now.map?.from === "bounds";
    const names = chain.axes.map(({ name }) => name);
    if (names.join() !== this.chain?.axes.map(({ name }) => name).join()) {
      const chosen = place().along;
      this.choice.replaceChildren(...names.map((name) => make("option", {}, name)));
      this.choice.value = names.includes(chosen) ? chosen : (names[0] ?? "");
    }
    this.chain = chain;
    this.update(true);
  }

  moved(pose: Pose, rests: boolean): void {
    this.pose = { ...pose };
    this.mark();
    if (rests) this.update(false);
  }

  /** Asks where the curve is another one; nobody sees it in a panel that is closed. */
  update(anew: boolean): void {
    if (anew) this.asked = "";
    const { axis } = this;
    if (!axis || this.parent.hidden) return;
    const others = JSON.stringify({ ...this.pose, [axis.name]: 0, axis: axis.name });
    if (others === this.asked) return this.mark();
    this.asked = others;
    void this.asking.do(() => this.ask(axis));
  }

  private get axis(): Axis | undefined {
    return this.chain?.axes.find(({ name }) => name === this.choice.value);
  }

  private async ask(axis: Axis): Promise<void> {
    const { chain } = this;
    if (!chain) return;
    const [low, high] = axis.travel;
    const positions = Array.from({ length: STEPS + 1 }, (_, i) => low + ((high - low) * i) / STEPS);
    const pose = (at: number) => chain.axes.map(({ name }) => (name === axis.name ? at : (this.pose[name] ?? 0)));
    const poses = positions.map(pose);
    const question = this.bounded
      ? ({ rows: { poses: { listed: poses }, samples: SAMPLES } } as const)
      : ({ eval: { poses } } as const);
    const [answer] = await this.session.ask([question]);
    if (this.bounded) {
      const rows = accepted<Rows>(answer)?.rows.poses ?? [];
      this.samples = rows.map((row, i) => ({ at: positions[i] ?? 0, um: row.position_um?.p95 ?? 0, parts: null }));
    } else {
      const found = accepted<Evaluated>(answer)?.poses ?? [];
      this.samples = found.map(({ deviation }, i) => {
        const parts = deviation.map((mm) => mm * 1e3) as Vec3;
        return { at: positions[i] ?? 0, um: Math.hypot(...parts), parts };
      });
    }
    this.plotted(axis);
  }

  private get title(): string {
    return `${this.chain?.machine ?? ""}: ${this.bounded ? "95 % value" : "deviation"} along ${this.choice.value}`;
  }

  private plotted(axis: Axis): void {
    const svg = lineChart(this.title, `${axis.name} [${axis.unit}]`, this.samples, "currentColor");
    const drawn = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
    this.plot.replaceChildren(document.importNode(drawn, true), this.cursor, this.probe);
    this.plot.setAttribute("aria-label", this.title);
    this.plot.setAttribute("aria-valuemin", String(axis.travel[0]));
    this.plot.setAttribute("aria-valuemax", String(axis.travel[1]));
    this.mark();
  }

  /** The line at the present position. */
  private mark(): void {
    const { axis } = this;
    if (!axis || !this.samples.length) return;
    const position = this.pose[axis.name] ?? 0;
    this.plot.setAttribute("aria-valuenow", String(position));
    this.put(this.cursor, axis, position);
    if (this.probe.hidden) this.read(this.nearest(position));
  }

  private put(line: HTMLElement, { travel: [low, high] }: Axis, position: number): void {
    const share = (position - low) / (high - low || 1);
    line.hidden = share < 0 || share > 1;
    line.style.left = `${(100 * (MARGIN.left + share * (SIZE.width - MARGIN.left - MARGIN.right))) / SIZE.width}%`;
  }

  private nearest(position: number): Sample | undefined {
    return this.samples.reduce<Sample | undefined>(
      (best, of) => (best && Math.abs(best.at - position) <= Math.abs(of.at - position) ? best : of),
      undefined,
    );
  }

  private read(of: Sample | undefined): void {
    const { axis } = this;
    if (!of || !axis) return;
    const parts = of.parts ? ` (${of.parts.map((um, i) => `${"XYZ"[i]} ${bare(um)}`).join(", ")} ${named("um")})` : "";
    const at = `${axis.name} ${Number(of.at.toFixed(1))} ${axis.unit}`.replace("-", "−");
    const value = make("strong", { "data-at": "curve", "data-value": String(of.um), "data-axis-at": String(of.at) });
    value.textContent = quantity(of.um);
    this.readout.replaceChildren(`${at}: `, value, parts);
    this.plot.setAttribute("aria-valuetext", this.readout.textContent ?? "");
  }

  private listen(): void {
    const { plot } = this;
    const position = (event: PointerEvent, { travel: [low, high] }: Axis) => {
      const { left, width } = plot.getBoundingClientRect();
      const x = ((event.clientX - left) / width) * SIZE.width;
      const share = (x - MARGIN.left) / (SIZE.width - MARGIN.left - MARGIN.right);
      return low + (high - low) * Math.min(Math.max(share, 0), 1);
    };
    plot.addEventListener("pointermove", (event) => {
      const { axis } = this;
      if (!axis) return;
      const at = position(event, axis);
      this.probe.hidden = false;
      this.put(this.probe, axis, at);
      this.read(this.nearest(at));
      if (event.buttons & 1) this.drag(axis, at, false);
    });
    plot.addEventListener("pointerdown", (event) => {
      plot.setPointerCapture(event.pointerId);
      if (this.axis) this.drag(this.axis, position(event, this.axis), false);
    });
    plot.addEventListener("pointerup", (event) => this.axis && this.drag(this.axis, position(event, this.axis), true));
    plot.addEventListener("pointerleave", () => {
      this.probe.hidden = true;
      this.mark();
    });
    plot.addEventListener("keydown", (event) => this.key(event));
  }

  private key(event: KeyboardEvent): void {
    const { axis } = this;
    const by = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[event.key];
    if (!by || !axis) return;
    event.preventDefault();
    const [low, high] = axis.travel;
    const next = (this.pose[axis.name] ?? 0) + (by * (high - low)) / STEPS;
    this.drag(axis, Math.min(Math.max(next, low), high), true);
  }

  private csv(): void {
    const unit = this.axis?.unit ?? "";
    const head = [`${this.choice.value}_${unit}`, ...(this.bounded ? ["p95_um"] : ["um", "dx_um", "dy_um", "dz_um"])];
    download.csv("curve", [head, ...this.samples.map(({ at, um, parts }) => [at, um, ...(parts ?? [])])]);
  }

  private get file(): string {
    return lineChart(this.title, `${this.choice.value} [${this.axis?.unit ?? ""}]`, this.samples, "#1f2933");
  }

  private svg(): void {
    download.svg("curve", this.file);
  }

  private png(): void {
    void download.png("curve", this.file, SIZE.width, SIZE.height);
  }
}
