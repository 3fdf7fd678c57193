/** Lever arms: from the line of each rotary axis to the tip of the tool, square to the line. */

import * as three from "three";
import type { Figure } from "./figure";
import { foot, minus, norm } from "./vectors";

export class Arms {
  readonly group = new three.Group();
  private readonly line = new three.LineBasicMaterial({ color: 0xc25f0c, depthTest: false, transparent: true });
  private readonly pivot = new three.MeshBasicMaterial({ color: 0xc25f0c, depthTest: false, transparent: true });

  constructor() {
    this.line.opacity = this.pivot.opacity = 0.6;
  }

  /** Draws those of a machine as it stands. */
  show(figure: Figure): void {
    for (const old of [...this.group.children] as (three.Mesh | three.Line)[]) {
      old.geometry.dispose();
      old.removeFromParent();
    }
    const { tip, layout } = figure;
    for (const axis of layout.chain.axes.filter(({ kind }) => kind === "rotary")) {
      const { origin, direction } = figure.line(axis);
      const centre = foot(tip, origin, direction);
      const ball = new three.Mesh(new three.SphereGeometry(0.08 * layout.size, 14, 10), this.pivot);
      ball.position.set(...centre);
      this.put(ball);
      if (norm(minus(tip, centre)) < 1e-6) continue;
      const ends = [centre, tip].map((point) => new three.Vector3(...point));
      this.put(new three.Line(new three.BufferGeometry().setFromPoints(ends), this.line));
    }
  }

  private put(object: three.Object3D): void {
    object.renderOrder = 8;
    this.group.add(object);
  }
}
