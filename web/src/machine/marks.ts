/** Marks in the workpiece frame: the deviation of the tool at the present pose, enlarged, and the field around it. */

import * as three from "three";
import type { Vec3 } from "../evaluator/types";
import type { Told } from "./pick";
import { bare, quantity } from "../units";

/** A node of a field: nominal position in the workpiece frame, mm, and length of the deviation, um. What is only
 * bounded has no direction. */
export interface FieldNode {
  nominal: Vec3;
  deviation_um: Vec3 | null;
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
  private readonly tool = new three.Mesh(
    new three.CylinderGeometry(1, 0.8, 1, 20).translate(0, 0.5, 0),
    new three.MeshBasicMaterial({ color: 0xc2185b, transparent: true, opacity: 0.45 }),
  );
  private field: three.Object3D | null = null;
  private readonly work = new three.Group();
  private dark = false;

  constructor() {
    this.arrow.visible = this.ghost.visible = this.tool.visible = false;
    this.arrow.renderOrder = this.ghost.renderOrder = 10;
    for (const part of [this.arrow.line, this.arrow.cone]) {
      const material = part.material as three.Material;
      material.depthTest = false;
      material.transparent = true;
    }
    this.group.add(this.arrow, this.ghost, this.tool, this.work);
  }

  theme(dark: boolean): void {
    this.dark = dark;
  }

  /** Colours of the scale as CSS, from little to much, as the marks bear them: mixed in linear light. */
  get colours(): string[] {
    return Array.from({ length: 17 }, (_, i) => `#${this.colour(i / 16).getHexString()}`);
  }

  /** Draws the deviation from the nominal tip to the actual one, `times` as large. */
  deviation(here: FieldNode | null, times: number, size: number): void {
    const isSeen = here?.deviation_um != null && here.length_um > 0;
    this.arrow.visible = this.ghost.visible = isSeen;
    if (!here?.deviation_um || !isSeen) return void (this.tool.visible = false);
    const { nominal } = here;
    const by = new three.Vector3(...here.deviation_um).multiplyScalar(1e-3 * times);
    const length = Math.max(by.length(), 1e-9);
    this.arrow.position.set(...nominal);
    this.arrow.setDirection(by.clone().normalize());
    this.arrow.setLength(length, Math.min(length * 0.4, 0.35 * size), Math.min(length * 0.25, 0.2 * size));
    this.ghost.position.set(...nominal).add(by);
    this.ghost.scale.setScalar(0.07 * size);
  }

  /** Draws the actual tool: from its tip along the nominal axis `reach`, mm, shifted and tilted `times` as much. */
  actual(here: FieldNode | null, rotation_rad: Vec3 | null, reach: Vec3, times: number): void {
    const length = Math.hypot(...reach);
    this.tool.visible = this.arrow.visible && rotation_rad !== null && length > 1e-6;
    if (!here?.deviation_um || !rotation_rad || !this.tool.visible) return;
    const turn = new three.Vector3(...rotation_rad).multiplyScalar(times);
    const angle = turn.length();
    const axis = new three.Vector3(...reach).divideScalar(length);
    this.tool.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), axis);
    if (angle > 0)
      this.tool.quaternion.premultiply(new three.Quaternion().setFromAxisAngle(turn.divideScalar(angle), angle));
    this.tool.position.set(...here.nominal).addScaledVector(new three.Vector3(...here.deviation_um), 1e-3 * times);
    const radius = Math.max(0.07 * length, 0.5);
    this.tool.scale.set(radius, length, radius);
  }

  /** Draws a field as arrows, or as balls where it has no direction, coloured on a scale that ends at `most`; nothing for an empty one. */
  show(nodes: FieldNode[], times: number, most: number, size: number): void {
    this.clear();
    if (!nodes.length) return;
    const shape = nodes[0]?.deviation_um
      ? new three.ConeGeometry(0.22 * size, 1, 12).translate(0, 0.5, 0)
      : new three.SphereGeometry(0.24 * size, 14, 10);
    const mesh = new three.InstancedMesh(shape, new three.MeshBasicMaterial(), nodes.length);
    nodes.forEach((node, i) => {
      mesh.setMatrixAt(i, this.placed(node, times));
      mesh.setColorAt(i, this.colour(node.length_um / (most || 1)));
    });
    mesh.userData["told"] = { words: (i) => nodeWords(nodes[i]) } satisfies Told;
    this.field = mesh;
    this.group.add(mesh);
  }

  /** Draws the poses of a part: balls of this radius coloured by deviation, octahedra where an axis stops. No line joins
   * single poses, which have no order. */
  path(points: WorkPoint[], most: number, [size, stop]: [number, number], isPath: boolean): void {
    for (const old of [...this.work.children] as (three.Mesh | three.Line)[]) {
      old.geometry.dispose();
      old.removeFromParent();
    }
    if (!points.length) return;
    const places = points.map(({ tip }) => new three.Vector3(...tip));
    if (isPath) this.outline(points, places, most, 0.35 * size);
    const reached = points.filter(({ um }) => um !== null);
    const stopped = points.filter(({ um }) => um === null);
    for (const [list, shape] of [
      [reached, new three.SphereGeometry(size, 14, 10)],
      [stopped, new three.OctahedronGeometry(stop)],
    ] as const) {
      // An empty one has a box without end, which the camera would follow.
      if (!list.length) continue;
      const mesh = new three.InstancedMesh(shape, new three.MeshBasicMaterial(), list.length);
      list.forEach((point, i) => {
        mesh.setMatrixAt(i, new three.Matrix4().makeTranslation(...point.tip));
        mesh.setColorAt(i, this.colourOf(point, most));
      });
      const told: Told = { words: (i) => list[i]?.words ?? "", click: (i) => list[i]?.click?.() };
      mesh.userData["told"] = told;
      this.work.add(mesh);
    }
  }

  private colourOf({ um, stopped }: WorkPoint, most: number): three.Color {
    return um === null ? new three.Color(stopped) : this.colour(um / (most || 1));
  }

  /** The outline of a part: rods from pose to pose in the mean of the colours of both. */
  private outline(points: WorkPoint[], places: three.Vector3[], most: number, radius: number): void {
    const shape = new three.CylinderGeometry(radius, radius, 1, 8).translate(0, 0.5, 0);
    // None between a pose that is reached and one that is not, which may be far away.
    const starts = points.flatMap(({ um }, i) => {
      const next = points[i + 1];
      return next && (um === null) === (next.um === null) ? [i] : [];
    });
    if (!starts.length) return;
    const mesh = new three.InstancedMesh(shape, new three.MeshBasicMaterial(), starts.length);
    starts.forEach((i, k) => {
      const [from, to] = [places[i], places[i + 1]] as [three.Vector3, three.Vector3];
      const way = to.clone().sub(from);
      const length = Math.max(way.length(), 1e-6);
      const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), way.divideScalar(length));
      mesh.setMatrixAt(k, new three.Matrix4().compose(from, turn, new three.Vector3(1, length, 1)));
      const [a, b] = [points[i], points[i + 1]] as [WorkPoint, WorkPoint];
      mesh.setColorAt(k, this.colourOf(a, most).lerp(this.colourOf(b, most), 0.5));
    });
    const ends = (k: number) => [points[starts[k] ?? 0], points[(starts[k] ?? 0) + 1]];
    const worse = (k: number) => ends(k).sort((a, b) => (b?.um ?? -1) - (a?.um ?? -1))[0];
    mesh.userData["told"] = { words: (i) => worse(i)?.words ?? "", click: (i) => worse(i)?.click?.() } satisfies Told;
    this.work.add(mesh);
  }

  clear(): void {
    this.field?.removeFromParent();
    if (this.field instanceof three.InstancedMesh) this.field.geometry.dispose();
    this.field = null;
  }

  private placed(node: FieldNode, times: number): three.Matrix4 {
    if (!node.deviation_um) return new three.Matrix4().makeTranslation(...node.nominal);
    const by = new three.Vector3(...node.deviation_um).multiplyScalar(1e-3 * times);
    const length = Math.max(by.length(), 1e-6);
    const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), by.clone().normalize());
    return new three.Matrix4().compose(new three.Vector3(...node.nominal), turn, new three.Vector3(1, length, 1));
  }

  private colour(share: number): three.Color {
    const list = this.dark ? SCALE_DARK : SCALE_LIGHT;
    const at = Math.min(Math.max(share, 0), 1) * (list.length - 1);
    const low = Math.min(Math.floor(at), list.length - 2);
    return new three.Color(list[low]).lerp(new three.Color(list[low + 1]), at - low);
  }
}

/** Length of the deviation at a node, with its parts. */
function nodeWords(node: FieldNode | undefined): string {
  if (!node) return "";
  if (!node.deviation_um) return `95 %: ${quantity(node.length_um)}`;
  const parts = node.deviation_um.map((um, i) => `${"XYZ"[i]} ${bare(um)}`).join(", ");
  return `${quantity(node.length_um)} (${parts})`;
}
