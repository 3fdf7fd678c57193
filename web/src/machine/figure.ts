/** The machine as a tree of bodies: each axis is a group that moves within the one that carries it. */

import * as three from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { Axis, Chain, Pose, Vec3 } from "../evaluator/types";
import { castings } from "./castings";
import type { Line } from "./drag";
import { type Layout, layout, motion } from "./layout";
import type { Surface, Surfaces } from "./look";
import { hides } from "./pick";
import type { Material, Shape } from "./shapes";
import { along } from "./vectors";

export type Materials = Record<Material, three.Material>;

/** A machine that can be drawn, and moved by its axes. */
export class Figure {
  readonly root = new three.Group();
  /** The group in which the workpiece stands still, with its origin and directions. */
  readonly workpiece = new three.Group();
  readonly layout: Layout;
  private readonly bodies = new Map<string, three.Group>();
  /** The middle of the largest casting of each body, at the zero pose. */
  private readonly hearts = new Map<string, three.Vector3>();

  /** `surfaces` are drawn in place of castings. */
  constructor(chain: Chain, tool: string, materials: Materials, surfaces: Surfaces = new Map()) {
    const found = layout(chain, tool);
    if (!found) throw new Error("the machine has no tool");
    this.layout = found;
    const shapes = castings(found);
    this.bodies.set("bed", this.root);
    this.grow(found.tool);
    const inner = this.grow(found.workpiece);
    inner.add(this.workpiece);
    this.workpiece.position.set(...chain.workpiece_origin_mm);
    const [a, b, c] = chain.workpiece_rotation_deg.map((angle) => (angle * Math.PI) / 180) as Vec3;
    // Turned about X, then Y, then Z of the machine.
    this.workpiece.setRotationFromEuler(new three.Euler(a, b, c, "ZYX"));
    for (const [body, list] of shapes) this.fill(body, castingsOf(body, list, surfaces), materials);
    for (const [body, list] of surfaces) for (const of of list) this.dress(body, of, materials);
    for (const axis of chain.axes) if (axis.kind === "rotary") this.pivot(axis, materials);
  }

  /** Moves the axes to a pose, mm and deg; axes that it leaves out are at 0. */
  move(pose: Pose): void {
    for (const axis of this.layout.chain.axes) this.moveAxis(axis, pose[axis.name] ?? 0);
    this.root.updateMatrixWorld(true);
  }

  /** The corners of everything at the pose, and with the linear axes at their ends; the machine stays at the pose. */
  corners(pose: Pose): three.Vector3[] {
    const linear = this.layout.chain.axes.filter((axis) => axis.kind === "linear");
    const end = (k: 0 | 1) => Object.fromEntries(linear.map((axis) => [axis.name, axis.travel[k]]));
    return [{ ...pose, ...end(0) }, { ...pose, ...end(1) }, pose].flatMap((there) => {
      this.move(there);
      return this.boxes().flatMap(cornersOf);
    });
  }

  /** Boxes of what is drawn; of what has no finite one, none. */
  private boxes(): three.Box3[] {
    const list: three.Box3[] = [];
    this.root.traverse((object) => {
      if (object instanceof three.Mesh) list.push(new three.Box3().setFromObject(object));
    });
    return list.filter(({ min, max }) => [...min.toArray(), ...max.toArray()].every(Number.isFinite));
  }

  /** The line of an axis at the present pose, in the machine's coordinates. */
  line(axis: Axis): Line {
    const carrier = this.bodies.get(axis.name)?.parent ?? this.root;
    const origin = new three.Vector3(...axis.origin_mm).applyMatrix4(carrier.matrixWorld);
    const direction = new three.Vector3(...axis.direction).transformDirection(carrier.matrixWorld);
    return { origin: origin.toArray(), direction: direction.toArray() };
  }

  /** The middle of the body of an axis, in the machine's coordinates: of castings that of the largest, not in the air. */
  middle(axis: Axis): Vec3 {
    const [heart, body] = [this.hearts.get(axis.name), this.bodies.get(axis.name)];
    if (heart && body) return heart.clone().applyMatrix4(body.matrixWorld).toArray();
    const box = new three.Box3();
    for (const of of this.bodies.get(axis.name)?.children ?? []) {
      if (!(of instanceof three.Mesh)) continue;
      const geometry = of.geometry as three.BufferGeometry;
      if (!geometry.boundingBox) geometry.computeBoundingBox();
      if (geometry.boundingBox) box.union(geometry.boundingBox.clone().applyMatrix4(of.matrixWorld));
    }
    return box.isEmpty() ? this.line(axis).origin : (box.getCenter(new three.Vector3()).toArray() as Vec3);
  }

  /** The tip of the tool in use. */
  get tip(): Vec3 {
    const { toolInUse, tool } = this.layout;
    const body = this.bodies.get(tool[tool.length - 1]?.name ?? "bed") ?? this.root;
    return new three.Vector3(...toolInUse.tip_mm).applyMatrix4(body.matrixWorld).toArray();
  }

  /** A middle, and a place of the camera before it: from the right, or from the left where posts hide the tool. */
  viewpoint(corners: three.Vector3[]): { center: three.Vector3; place: three.Vector3 } {
    const { up, back, right } = this.layout;
    const { center, radius } = new three.Box3().setFromPoints(corners).getBoundingSphere(new three.Sphere());
    const before = (aside: number) => {
      const from = new three.Vector3(...up).multiplyScalar(0.62).addScaledVector(new three.Vector3(...back), -1.25);
      from.addScaledVector(new three.Vector3(...right), aside).normalize();
      return center.clone().addScaledVector(from, 3 * radius);
    };
    const [usual, other] = [before(0.95), before(-0.95)];
    return { center, place: this.sight(usual) < 0.5 && this.sight(other) > 0.5 ? other : usual };
  }

  /** The share of the body at the tool that nothing hides from there. */
  sight(from: three.Vector3): number {
    const body = this.bodies.get(this.layout.tool.at(-1)?.name ?? "") ?? this.root;
    const own = body.children.filter((object) => hides(object));
    const isSeen = (object: three.Object3D) => {
      const { center, radius } = new three.Box3().setFromObject(object).getBoundingSphere(new three.Sphere());
      const way = center.sub(from);
      const far = Math.max(0, way.length() - radius);
      const ray = new three.Raycaster(from, way.normalize(), 0, far);
      return !ray.intersectObject(this.root).some((hit) => hides(hit.object) && !own.includes(hit.object));
    };
    return own.length ? own.filter(isSeen).length / own.length : 1;
  }

  /** From the tip to the gauge point of the tool in use, in the workpiece frame. */
  get reach(): Vec3 {
    const { toolInUse, tool } = this.layout;
    const body = this.bodies.get(tool[tool.length - 1]?.name ?? "bed") ?? this.root;
    const there = this.workpiece.matrixWorld.clone().invert().multiply(body.matrixWorld);
    const [tip, gauge] = [toolInUse.tip_mm, toolInUse.gauge_mm].map((v) => new three.Vector3(...v).applyMatrix4(there));
    return gauge && tip ? (gauge.sub(tip).toArray() as Vec3) : [0, 0, 0];
  }

  /** The point that an axis moves: the tip of the tool, or the workpiece origin for an axis that carries the part. */
  moved(axis: Axis): Vec3 {
    if (axis.side === "tool") return this.tip;
    const body = this.workpiece.parent ?? this.root;
    return new three.Vector3(...this.layout.chain.workpiece_origin_mm).applyMatrix4(body.matrixWorld).toArray();
  }

  /** The axes that carry a mesh, the nearest first; none for the bed and for marks. */
  carriers(object: three.Object3D): Axis[] {
    const name = object.userData["body"] as string | undefined;
    const { tool, workpiece } = this.layout;
    const side = [tool, workpiece].find((axes) => axes.some((axis) => axis.name === name)) ?? [];
    return side.slice(0, side.findIndex((axis) => axis.name === name) + 1).reverse();
  }

  dispose(): void {
    this.root.traverse((object) => {
      if (object instanceof three.Mesh || object instanceof three.Line) object.geometry.dispose();
    });
  }

  /** A group for each axis of a side, one within the other, and returns the innermost. */
  private grow(axes: Axis[]): three.Group {
    let parent = this.root;
    for (const axis of axes) {
      const group = new three.Group();
      group.matrixAutoUpdate = false;
      parent.add(group);
      this.bodies.set(axis.name, group);
      parent = group;
    }
    return parent;
  }

  private moveAxis(axis: Axis, position: number): void {
    const group = this.bodies.get(axis.name);
    if (!group) return;
    const by = motion(axis) * position;
    const direction = new three.Vector3(...axis.direction);
    if (axis.kind === "linear") group.matrix.setPosition(direction.multiplyScalar(by));
    else {
      const origin = new three.Vector3(...axis.origin_mm);
      const turn = new three.Matrix4().makeRotationAxis(direction, (by * Math.PI) / 180);
      const back = origin.clone().applyMatrix4(turn);
      group.matrix.copy(turn).setPosition(origin.sub(back));
    }
  }

  /** One mesh for each material of a body, and the edges of its castings. */
  private fill(body: string, shapes: Shape[], materials: Materials): void {
    const group = this.bodies.get(body);
    const kinds = new Set(shapes.map((shape) => shape.material));
    const heart = largest(shapes);
    if (heart) this.hearts.set(body, heart);
    for (const material of kinds) {
      const parts = shapes.filter((shape) => shape.material === material).map((shape) => shape.geometry);
      const merged = mergeGeometries(parts);
      const mesh = new three.Mesh(merged, materials[material]);
      mesh.castShadow = mesh.receiveShadow = material !== "part";
      mesh.userData["body"] = body;
      group?.add(mesh, new three.LineSegments(new three.EdgesGeometry(merged, 40), materials.line));
      parts.forEach((part) => part.dispose());
    }
  }

  /** A surface of a file: that of the part stands in the workpiece frame. */
  private dress(name: string, { geometry, material }: Surface, materials: Materials): void {
    const { tool, workpiece, chain } = this.layout;
    const carrier = { tool: tool.at(-1)?.name, workpiece: workpiece.at(-1)?.name }[name] ?? name;
    const body = this.bodies.has(carrier) ? carrier : "bed";
    const axis = chain.axes.find((of) => of.name === name);
    const own = { bed: "bed", tool: "tool", workpiece: "work" } as const;
    const plain = own[name as keyof typeof own] ?? (axis?.kind === "rotary" ? "rotary" : "axis");
    const mesh = new three.Mesh(geometry, material ?? materials[plain]);
    mesh.userData["body"] = body;
    mesh.userData["look"] = name;
    (name === "workpiece" ? this.workpiece : (this.bodies.get(body) ?? this.root)).add(mesh);
  }

  /** The line about which a rotary axis turns. */
  private pivot(axis: Axis, materials: Materials): void {
    const reach = this.layout.table * 1.5 + this.layout.size;
    const ends = [-1, 1].map((way) => new three.Vector3(...along(axis.origin_mm, axis.direction, way * reach)));
    const line = new three.Line(new three.BufferGeometry().setFromPoints(ends), materials.guide);
    const dashed = new three.LineDashedMaterial({ color: 0xc25f0c, dashSize: reach / 18, gapSize: reach / 28 });
    line.material = dashed;
    line.computeLineDistances();
    this.bodies.get(axis.name)?.parent?.add(line);
  }
}

/** The castings of a body that no mesh stands for; the tool has one of its own, and the part has. */
function castingsOf(body: string, list: Shape[], surfaces: Surfaces): Shape[] {
  const stands: Partial<Record<Material, string>> = { tool: "tool", part: "workpiece" };
  return list.filter(({ material }) => !surfaces.has(stands[material] ?? body));
}

/** The middle of the largest of shapes, guides apart. */
function largest(shapes: Shape[]): three.Vector3 | undefined {
  const boxes = shapes
    .filter(({ material }) => material === "axis" || material === "rotary" || material === "spindle")
    .map(({ geometry }) => {
      geometry.computeBoundingBox();
      const { x, y, z } = geometry.boundingBox?.getSize(new three.Vector3()) ?? { x: 0, y: 0, z: 0 };
      return { middle: geometry.boundingBox?.getCenter(new three.Vector3()), size: x * y * z };
    });
  return boxes.sort((a, b) => b.size - a.size)[0]?.middle;
}

function cornersOf({ min, max }: three.Box3): three.Vector3[] {
  const both = [min, max];
  return both.flatMap(({ x }) => both.flatMap(({ y }) => both.map(({ z }) => new three.Vector3(x, y, z))));
}
