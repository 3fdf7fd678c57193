/** What lies under the pointer: a mark that no body hides says what it is, and a click goes there. */

import * as three from "three";
import { make } from "../ui/dom";

/** What a mesh of marks tells of each of its instances. */
export interface Told {
  words: (instance: number) => string;
  click?: (instance: number) => void;
}

export class Pick {
  private readonly note = make("div", { id: "readout", "aria-hidden": "true" });
  private readonly ray = new three.Raycaster();
  private pending = false;
  private pressed = "";

  constructor(
    parent: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly scene: three.Scene,
    private readonly camera: three.Camera,
  ) {
    this.note.hidden = true;
    parent.append(this.note);
    canvas.addEventListener("pointermove", (event) => this.hover(event));
    canvas.addEventListener("pointerleave", () => (this.note.hidden = true));
    // A drag turns the camera: only a press that stays is a click.
    canvas.addEventListener("pointerdown", (event) => (this.pressed = placeOf(event)));
    canvas.addEventListener("pointerup", (event) => placeOf(event) === this.pressed && this.click(event));
  }

  private hover(event: PointerEvent): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      const found = event.buttons ? null : this.under(event);
      this.note.hidden = !found;
      if (!found) return;
      this.note.textContent = found.told.words(found.instance);
      this.note.style.left = `${Math.min(event.offsetX + 14, this.canvas.clientWidth - 150)}px`;
      this.note.style.top = `${event.offsetY + 14}px`;
    });
  }

  private click(event: PointerEvent): void {
    const found = this.under(event);
    found?.told.click?.(found.instance);
  }

  /** The mark in front of everything at a place. */
  private under(event: PointerEvent): { told: Told; instance: number } | null {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const at = new three.Vector2((2 * event.offsetX) / width - 1, 1 - (2 * event.offsetY) / height);
    this.ray.setFromCamera(at, this.camera);
    const [first] = this.ray.intersectObject(this.scene).filter(({ object }) => hides(object));
    const told = first?.object.userData["told"] as Told | undefined;
    return told && first?.instanceId !== undefined ? { told, instance: first.instanceId } : null;
  }
}

const placeOf = (event: PointerEvent) => `${event.clientX} ${event.clientY}`;

/** True for a body that one cannot see through. */
export function hides(object: three.Object3D): boolean {
  if (!(object instanceof three.Mesh) || !object.visible) return false;
  return !(object.material as three.Material).transparent;
}
