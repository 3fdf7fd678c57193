/** Marks in the workpiece frame: the deviation of the tool at the present pose, enlarged, and the field around it. */

import * as three from "three";
import type { Vec3 } from "../evaluator/types";
import { rounded } from "../review/number";
import type { Told } from "./pick";

/** A node of a field: nominal position in the workpiece frame, mm, and length of the deviation, um. */
export interface FieldNode {
  nominal: Vec3;
  deviation_um: Vec3;
  length_um: number;
}

/** From little to much: darker is worse on a light ground, lighter on a dark one; told apart without red and green. */
const SCALE_LIGHT = ["#f3e3a8", "#f0a95b", "#d9623b", "#9b2d4d", "#4a1247"];
const SCALE_DARK = ["#4a1247", "#9b2d4d", "#d9623b", "#f0a95b", "#f8edb8"];

/** A tool pose of a part: reached with its deviation, or stopped. */
export interface WorkPoint {
  tip: Vec3;
  um: number | null;
  /** Colour where it is stopped. */
  stopped: string;
  words: string;
  click?: () => void;
}

export class Marks {
  readonly group = new three.Group();
  private readonly arrow = new three.ArrowHelper(new three.Vector3(0, 0, 1), new three.Vector3(), 1, 0xc2185b);
  private readonly ghost = new three.Mesh(
    new three.SphereGeometry(1, 20, 14),
    new three.MeshBasicMaterial({ color: 0xc2185b, depthTest: false, transparent: true, opacity: 0.85 }),
  );
  private field: three.Object3D | null = null;
  private readonly work = new three.Group();
  private dark = false;

  constructor() {
    this.arrow.visible = this.ghost.visible = false;
    this.arrow.renderOrder = this.ghost.renderOrder = 10;
    for (const part of [this.arrow.line, this.arrow.cone]) {
      const material = part.material as three.Material;
      material.depthTest = false;
      material.transparent = true;
    }
    this.group.add(this.arrow, this.ghost, this.work);
  }

  theme(dark: boolean): void {
    this.dark = dark;
  }

  /** Colours of the scale as CSS, from little to much. */
  get colours(): string[] {
    return this.dark ? SCALE_DARK : SCALE_LIGHT;
  }

  /** Draws the deviation from the nominal tip to the actual one, `times` as large. */
  deviation(nominal: Vec3 | null, deviation_mm: Vec3, times: number, size: number): void {
    this.arrow.visible = this.ghost.visible = nominal !== null;
    if (!nominal) return;
    const by = new three.Vector3(...deviation_mm).multiplyScalar(times);
    const length = Math.max(by.length(), 1e-9);
    this.arrow.position.set(...nominal);
    this.arrow.setDirection(by.clone().normalize());
    this.arrow.setLength(length, Math.min(length * 0.4, 0.35 * size), Math.min(length * 0.25, 0.2 * size));
    this.ghost.position.set(...nominal).add(by);
    this.ghost.scale.setScalar(0.07 * size);
  }

  /** Draws a field as arrows, coloured on a scale that ends at `most`; nothing for an empty one. */
  show(nodes: FieldNode[], times: number, most: number, size: number): void {
    this.clear();
    if (!nodes.length) return;
    const shape = new three.ConeGeometry(0.16 * size, 1, 10).translate(0, 0.5, 0);
    const mesh = new three.InstancedMesh(shape, new three.MeshBasicMaterial(), nodes.length);
    nodes.forEach((node, i) => {
      mesh.setMatrixAt(i, this.placed(node, times));
      mesh.setColorAt(i, this.colour(node.length_um / (most || 1)));
    });
    mesh.userData["told"] = { words: (i) => nodeWords(nodes[i]) } satisfies Told;
    this.field = mesh;
    this.group.add(mesh);
  }

  /** Draws the path of a part: balls coloured by deviation, octahedra where an axis stops. */
  path(points: WorkPoint[], most: number, size: number): void {
    for (const old of [...this.work.children] as (three.Mesh | three.Line)[]) {
      old.geometry.dispose();
      old.removeFromParent();
    }
    if (!points.length) return;
    const places = points.map(({ tip }) => new three.Vector3(...tip));
    const line = new three.LineBasicMaterial({
      color: this.dark ? 0xdfe6ec : 0x2b3640,
      transparent: true,
      opacity: 0.6,
    });
    this.work.add(new three.Line(new three.BufferGeometry().setFromPoints(places), line));
    const reached = points.filter(({ um }) => um !== null);
    const stopped = points.filter(({ um }) => um === null);
    const colour = ({ um, stopped }: WorkPoint) =>
      um === null ? new three.Color(stopped) : this.colour(um / (most || 1));
    for (const [list, shape] of [
      [reached, new three.SphereGeometry(size, 14, 10)],
      [stopped, new three.OctahedronGeometry(1.4 * size)],
    ] as const) {
      const mesh = new three.InstancedMesh(shape, new three.MeshBasicMaterial(), list.length);
      list.forEach((point, i) => {
        mesh.setMatrixAt(i, new three.Matrix4().makeTranslation(...point.tip));
        mesh.setColorAt(i, colour(point));
      });
      const told: Told = { words: (i) => list[i]?.words ?? "", click: (i) => list[i]?.click?.() };
      mesh.userData["told"] = told;
      this.work.add(mesh);
    }
  }

  clear(): void {
    this.field?.removeFromParent();
    if (this.field instanceof three.InstancedMesh) this.field.geometry.dispose();
    this.field = null;
  }

  private placed(node: FieldNode, times: number): three.Matrix4 {
    const by = new three.Vector3(...node.deviation_um).multiplyScalar(1e-3 * times);
    const length = Math.max(by.length(), 1e-6);
    const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), by.clone().normalize());
    return new three.Matrix4().compose(new three.Vector3(...node.nominal), turn, new three.Vector3(1, length, 1));
  }

  private colour(share: number): three.Color {
    const list = this.colours;
    const at = Math.min(Math.max(share, 0), 1) * (list.length - 1);
    const low = Math.min(Math.floor(at), list.length - 2);
    return new three.Color(list[low]).lerp(new three.Color(list[low + 1]), at - low);
  }
}

/** Length of the deviation at a node, with its parts. */
function nodeWords(node: FieldNode | undefined): string {
  if (!node) return "";
  const parts = node.deviation_um.map((um, i) => `${"XYZ"[i]} ${rounded(um)}`).join(", ");
  return `${rounded(node.length_um)} µm (${parts})`;
}
