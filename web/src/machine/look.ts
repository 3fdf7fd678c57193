/** Meshes that the machine file names under `look`: asked for when they change, and handed to the pictures. The program
 * reads the files; what comes here are triangles with colours. */

import * as three from "three";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { accepted, type Chain, type Diagnostic, type Look } from "../evaluator/types";
import type { Session } from "../session";
import { byId, make } from "../ui/dom";
import type { Problems } from "../ui/problems";

/** A surface of a body: with the colour of its file, or that of the body's castings. */
export interface Surface {
  geometry: three.BufferGeometry;
  material: three.Material | null;
}

/** Surfaces by the body that they are drawn for. */
export type Surfaces = Map<string, Surface[]>;

/** Edges below this angle are smooth, rad. */
const CREASE = 0.6;

export class Looks {
  private known = "[]";
  private readonly words = make("span", { id: "look", class: "note" });

  constructor(
    private readonly session: Session,
    private readonly problems: Problems,
    private readonly dressed: (surfaces: Surfaces) => void,
  ) {
    byId("poses").append(this.words);
  }

  /** Asks for the meshes of a chain where they are others than those that are shown. */
  async follow({ look }: Chain): Promise<void> {
    const key = JSON.stringify(look);
    if (key === this.known) return;
    this.known = key;
    const [answer] = look.length ? await this.session.ask([{ look: this.session.settings.look }]) : [];
    // Asked for others meanwhile.
    if (key !== this.known) return;
    const found = accepted<Look>(answer);
    this.dressed(surfaces(found));
    this.words.textContent = found?.words ?? "";
    this.tell(found?.warnings ?? []);
  }

  /** A file that is drawn may be another one. */
  forget(): void {
    this.known = "";
  }

  private tell(warnings: Diagnostic[]): void {
    const words = warnings.filter(({ code }) => /^W085[34]$/.test(code));
    if (!words.length) return this.problems.clear("look");
    const text = words.map(({ message, help }) => `${message}${help ? `: ${help}` : ""}.`).join(" ");
    this.problems.say("look", `${text.charAt(0).toUpperCase()}${text.slice(1)}`);
  }
}

/** The surfaces of an answer. */
export function surfaces(found: Look | null): Surfaces {
  const all: Surfaces = new Map();
  for (const { body, color, positions, indices } of found?.bodies ?? []) {
    const indexed = new three.BufferGeometry();
    indexed.setAttribute("position", new three.BufferAttribute(new Float32Array(bytes(positions)), 3));
    indexed.setIndex(new three.BufferAttribute(new Uint32Array(bytes(indices)), 1));
    const geometry = toCreasedNormals(indexed, CREASE);
    const look = { roughness: 0.65, metalness: 0.12, side: three.DoubleSide };
    const material = color && new three.MeshStandardMaterial({ ...look, color: new three.Color(...color) });
    all.set(body, [...(all.get(body) ?? []), { geometry, material }]);
  }
  return all;
}

function bytes(base64: string): ArrayBuffer {
  return Uint8Array.from(atob(base64), (character) => character.charCodeAt(0)).buffer;
}
