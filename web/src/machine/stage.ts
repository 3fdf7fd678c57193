/** The picture of the machine: camera, light, theme, and what is drawn about the deviation. */

import * as three from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { type Axis, type Chain, geometry, type Pose, type Vec3 } from "../evaluator/types";
import { Drag, type Grip } from "./drag";
import { Arms } from "./arms";
import { Figure, type Materials } from "./figure";
import { gltf } from "./gltf";
import { Guide } from "./guide";
import type { Surfaces } from "./look";
import { type FieldNode, Marks, type WorkPoint } from "./marks";
import { Overlay } from "./overlay";
import { hides, Pick } from "./pick";
import type { Material } from "./shapes";
import { scaled } from "./vectors";
import { roundLength } from "../units";

const LIGHT: Record<Material, number> = {
  bed: 0x9aa4ae,
  axis: 0xd9dfe4,
  rotary: 0x6f9fd0,
  guide: 0x39424b,
  spindle: 0xa8b0b8,
  tool: 0xd9a33c,
  part: 0xb9d7a8,
  work: 0xb9d7a8,
  line: 0x4a545e,
};
const DARK: Record<Material, number> = {
  bed: 0x59636d,
  axis: 0x8a95a0,
  rotary: 0x4f86bd,
  guide: 0x20262c,
  spindle: 0x9aa4ae,
  tool: 0xe0b04c,
  part: 0x7fa56f,
  work: 0x7fa56f,
  line: 0x161a1f,
};

/** Where a machine is looked at from; empty for where the tool is seen. */
export type View = "" | "front" | "right" | "top";

export class Stage {
  readonly marks = new Marks();
  private readonly guide = new Guide();
  private readonly arms = new Arms();
  private readonly overlay: Overlay;
  private ground: three.GridHelper | null = null;
  private readonly scene = new three.Scene();
  private readonly camera = new three.PerspectiveCamera(32, 1, 1, 1e6);
  /** Where `look` has put the camera. */
  private readonly placed = new three.Vector3();
  private readonly renderer: three.WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly materials = {} as Materials;
  private figure: Figure | null = null;
  /** Meshes in place of castings. */
  private surfaces: Surfaces = new Map();
  private shown = "";
  /** Geometry and tool of the figure. */
  private known = "";
  private pending = 0;
  pose: Pose = {};
  /** The pose as it was when the figure moved last: the other one may change in place. */
  private drawnPose = "";
  /** Name of the axis at hand. */
  private chosen = "";
  /** True while something is moved by hand: the picture is coarser then, and follows. */
  private isHeld = false;
  /** Width and height of the picture on paper, while it is printed. */
  private paper: [number, number] | null = null;
  /** Pixels of the picture to one of the screen while something is held. */
  private readonly coarse: number;

  /** Fails where the browser cannot draw in three dimensions. `words` is the id of what says in words what is drawn,
   * and `dragged` hears of bodies that are moved by hand. */
  constructor(
    private readonly parent: HTMLElement,
    words: string,
    dragged: (axis: Axis, position: number, rests: boolean) => void,
  ) {
    this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.coarse = isSoftware(this.renderer.getContext()) ? 0.5 : 1;
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-describedby", words);
    parent.append(canvas);
    new Drag(canvas, this.camera, { grips: (ray) => this.grips(ray), moved: dragged });
    this.scene.add(this.guide.group, this.arms.group);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => this.hold(true));
    this.controls.addEventListener("end", () => this.hold(false));
    canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.lights();
    for (const material of Object.keys(LIGHT) as Material[]) this.materials[material] = this.material(material);
    this.overlay = new Overlay(parent);
    new Pick(parent, canvas, this.scene, this.camera);
    new ResizeObserver(() => this.refit()).observe(parent);
    this.theme(false);
  }

  /** Shows a machine. The camera stays where it is while the chain keeps its shape, or is where that of another picture
   * is. */
  show(chain: Chain, tool: string, pose: Pose, as: Stage | null = null): void {
    const key = geometry(chain) + tool;
    if (key === this.known && !as) return this.stands(pose) ? undefined : this.move(pose);
    this.known = key;
    const figure = new Figure(chain, tool, this.materials, this.surfaces);
    this.figure?.dispose();
    this.figure?.root.removeFromParent();
    this.figure = figure;
    figure.workpiece.add(this.marks.group);
    this.scene.add(figure.root);
    // At the zero pose, whatever the pose: two pictures of one machine have one floor.
    this.floor(figure.corners({}));
    this.move(pose);
    const shape = chain.chain + chain.machine;
    if (as) {
      this.sun(figure.corners(pose));
      this.resize();
      this.lookAs(as);
      this.limit(as.controls.maxDistance / 5, as.controls.cursor);
    } else if (shape !== this.shown) this.look(pose);
    this.shown = shape;
    this.renderer.domElement.setAttribute("aria-label", `The machine ${chain.machine}, ${chain.chain}`);
    this.draw();
  }

  /** Draws bodies by these meshes from now on, and looks at the whole of them. */
  dress(surfaces: Surfaces): void {
    this.surfaces = surfaces;
    const { figure } = this;
    if (!figure) return;
    [this.known, this.shown] = ["", ""];
    this.show(figure.layout.chain, figure.layout.toolInUse.name, this.pose);
  }

  /** True if the picture shows this pose. */
  private stands(pose: Pose): boolean {
    return JSON.stringify(pose) === this.drawnPose;
  }

  move(pose: Pose): void {
    this.pose = pose;
    this.drawnPose = JSON.stringify(pose);
    this.figure?.move(pose);
    if (this.figure) this.arms.show(this.figure);
    this.point(this.chosen);
  }

  /** Shows the travel and the arm of an axis; of none for an empty name. */
  point(name: string): void {
    this.chosen = name;
    const figure = this.figure;
    const axis = figure?.layout.chain.axes.find((axis) => axis.name === name);
    if (!figure || !axis) this.guide.clear();
    else {
      const { size, table } = figure.layout;
      const [line, moved, position] = [figure.line(axis), figure.moved(axis), this.pose[name] ?? 0];
      this.guide.show({ axis, line, position, moved, tip: figure.tip, size, table });
    }
    this.draw();
  }

  /** The axes that carry the body in front of everything on a ray. */
  private grips(ray: three.Raycaster): Grip[] {
    const figure = this.figure;
    const bodies = ({ object }: three.Intersection) => hides(object) || (isShown(object) && object.userData["body"]);
    const [first] = ray.intersectObject(this.scene).filter(bodies);
    if (!first || !figure) return [];
    const point = first.point.toArray();
    const grip = (axis: Axis) => ({ axis, position: this.pose[axis.name] ?? 0, line: figure.line(axis), point });
    return figure.carriers(first.object).map(grip);
  }

  /** Shows the lengths of lever arms, and the distances of pivots. */
  measure(does: boolean): void {
    this.overlay.hasArms = does;
    this.draw();
  }

  /** Puts the camera before the whole machine: as a view has it, or where the tool is seen. */
  look(pose: Pose, view: View = ""): void {
    if (!this.figure) return;
    const corners = this.figure.corners(pose);
    if (!corners.length) return;
    const { center, place } = this.figure.viewpoint(corners);
    const { up, back, right } = this.figure.layout;
    this.resize();
    this.camera.up.set(...(view === "top" ? back : up));
    const from = { "": null, front: scaled(back, -1), right, top: up }[view];
    const far = place.distanceTo(center);
    this.camera.position.copy(from ? center.clone().addScaledVector(new three.Vector3(...from), far) : place);
    this.controls.target.copy(center);
    for (let i = 0; i < 4; i += 1) this.frame(corners);
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.updateProjectionMatrix();
    this.limit(distance, this.controls.target);
    this.controls.update();
    if (view === "") this.placed.copy(this.camera.position);
    this.sun(corners);
    this.draw();
  }

  /** A grid on the floor below the machine, with lines of a round length. */
  private floor(corners: three.Vector3[]): void {
    this.ground?.dispose();
    this.ground?.removeFromParent();
    const up = new three.Vector3(...(this.figure?.layout.up ?? [0, 0, 1]));
    const { center, radius } = new three.Box3().setFromPoints(corners).getBoundingSphere(new three.Sphere());
    const low = Math.min(...corners.map((corner) => corner.dot(up)));
    const step = roundLength(radius / 3).mm;
    const lines = 2 * Math.ceil((1.3 * radius) / step);
    const ground = new three.GridHelper(lines * step, lines, 0x7d8791, 0x7d8791);
    Object.assign(ground.material, { transparent: true, opacity: 0.25, depthWrite: false });
    ground.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), up);
    ground.position.copy(center).addScaledVector(up, low - center.dot(up));
    this.ground = ground;
    this.scene.add(ground);
  }

  /** No hand brings the camera so far, or so far aside, that nothing is left in the picture. */
  private limit(distance: number, middle: three.Vector3): void {
    const { controls } = this;
    [controls.minDistance, controls.maxDistance] = [distance / 20, distance * 5];
    controls.cursor.copy(middle);
    controls.maxTargetRadius = distance * this.tall;
  }

  /** Brings the camera so near that these points fill the picture, and to their middle. */
  private frame(corners: three.Vector3[]): void {
    const { camera, controls } = this;
    camera.lookAt(controls.target);
    camera.updateMatrixWorld(true);
    const seen = corners.map((corner) => corner.clone().applyMatrix4(camera.matrixWorldInverse));
    const { tall } = this;
    const distance = camera.position.distanceTo(controls.target);
    // Those beside the camera, or behind it, drive it back.
    const depth = (z: number) => Math.max(-z, 1e-3 * distance);
    const slopes = seen.map(({ x, y, z }) => [x / depth(z) / tall / camera.aspect, y / depth(z) / tall] as const);
    const span = (k: 0 | 1) => {
      const list = slopes.map((of) => of[k]);
      return [Math.min(...list), Math.max(...list)] as const;
    };
    const [[left, right], [low, high]] = [span(0), span(1)];
    const aside = new three.Vector3(((left + right) / 2) * tall * camera.aspect, ((low + high) / 2) * tall, 0);
    aside.multiplyScalar(distance).transformDirection(camera.matrixWorld);
    const by = distance * Math.hypot(((left + right) / 2) * tall * camera.aspect, ((low + high) / 2) * tall);
    const least = 1 - (0.9 * Math.min(...seen.map(({ z }) => -z))) / distance;
    const size = Math.max((right - left) / 2, (high - low) / 2, 0.94 * least) / 0.94;
    const back = camera.position.clone().sub(controls.target).multiplyScalar(size);
    controls.target.addScaledVector(aside, by);
    camera.position.copy(controls.target).add(back);
  }

  theme(dark: boolean): void {
    const colours = dark ? DARK : LIGHT;
    for (const material of Object.keys(colours) as Material[]) {
      const of = this.materials[material] as three.MeshStandardMaterial | three.LineBasicMaterial;
      of.color.setHex(colours[material]);
    }
    this.marks.theme(dark);
    this.draw();
  }

  draw(): void {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => this.render());
  }

  private render(): void {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    const { ratio } = this;
    // It empties the picture, which is drawn in the same frame.
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    this.renderer.render(this.scene, this.camera);
    const { render } = this.renderer.info;
    Object.assign(this.renderer.domElement.dataset, { calls: render.calls, triangles: render.triangles });
    const { x, y } = this.renderer.getSize(new three.Vector2());
    if (this.figure) this.overlay.draw(this.figure, this.camera, x, y, this.pixel);
  }

  /** Draws coarser while something is held, and once more when it is let go. */
  hold(isHeld: boolean): void {
    if (isHeld === this.isHeld) return;
    this.isHeld = isHeld;
    if (!isHeld) this.draw();
  }

  private get ratio(): number {
    const sharp = Math.min(window.devicePixelRatio || 1, 2);
    return this.isHeld ? Math.min(sharp, this.coarse) : sharp;
  }

  /** The deviation at the present pose, in the workpiece frame. */
  deviation(here: FieldNode | null, rotation_rad: Vec3 | null, times: number): void {
    const size = this.figure?.layout.size ?? 100;
    this.marks.deviation(here, times, size);
    this.marks.actual(here, rotation_rad, this.figure?.reach ?? [0, 0, 0], times);
    this.draw();
  }

  /** Looks from where another picture does, from now on; and that one from where this one does. */
  together(other: Stage): void {
    for (const [one, two] of [
      [this, other],
      [other, this],
    ] as const)
      one.controls.addEventListener("change", () => two.lookAs(one));
    other.lookAs(this);
  }

  private lookAs(other: Stage): void {
    if (this.camera.position.equals(other.camera.position) && this.controls.target.equals(other.controls.target))
      return;
    this.camera.position.copy(other.camera.position);
    this.camera.up.copy(other.camera.up);
    this.camera.near = other.camera.near;
    this.camera.far = other.camera.far;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(other.controls.target);
    this.camera.lookAt(this.controls.target);
    this.draw();
  }

  /** The poses of a part, coloured on a scale that ends at `most` um; a path is drawn from pose to pose. */
  path(points: WorkPoint[], most: number, isPath = false): void {
    const size = (this.figure?.layout.size ?? 100) / 14;
    const sizes: [number, number] = [Math.max(size, 3 * this.pixel), Math.max(1.4 * size, 6 * this.pixel)];
    this.marks.path(points, most, sizes, isPath);
    // The block stands for a part: where the part is known only its edges stay.
    this.materials.part.visible = !points.length;
    this.draw();
  }

  /** Length of a pixel in the middle of what is looked at, mm. */
  private get pixel(): number {
    const distance = this.camera.position.distanceTo(this.controls.target);
    return (2 * distance * this.tall) / Math.max(this.parent.clientHeight, 1);
  }

  /** Half of the height of the picture, over its distance. */
  private get tall(): number {
    return Math.tan((this.camera.fov * Math.PI) / 360);
  }

  /** A copy of the picture as it is, with the names of axes. */
  get picture(): HTMLCanvasElement {
    const { domElement: canvas } = this.renderer;
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const brush = copy.getContext("2d");
    brush?.drawImage(canvas, 0, 0);
    if (brush) this.overlay.print(brush, this.renderer.getPixelRatio());
    return copy;
  }

  /** The machine as it stands, as binary glTF. */
  get gltf(): Blob | null {
    return this.figure && gltf(this.figure.root, this.figure.layout.up);
  }

  /** Draws at once in a size of paper and in light colours, or as on the screen again. */
  print(paper: [number, number] | null, isDark: boolean): void {
    this.paper = paper;
    this.theme(isDark);
    this.refit();
    this.parent.querySelector(".paper")?.remove();
    if (!paper) return;
    // What WebGL draws is not always printed: a copy in two dimensions is.
    const copy = this.picture;
    copy.className = "paper";
    this.parent.append(copy);
  }

  /** Takes another size; the whole machine stays in a picture that nobody has turned. */
  private refit(): void {
    if (this.figure && this.camera.position.equals(this.placed)) this.look(this.pose);
    else this.resize();
    // Another size empties the picture: it is drawn before anybody sees it.
    this.render();
  }

  private resize(): void {
    const [width, height] = this.paper ?? [this.parent.clientWidth, this.parent.clientHeight];
    const { x, y } = this.renderer.getSize(new three.Vector2());
    if (!width || !height || (x === width && y === height)) return;
    this.renderer.setSize(width, height, !this.paper);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private readonly lamp = new three.DirectionalLight(0xffffff, 1.9);
  private readonly sky = new three.HemisphereLight(0xffffff, 0x9aa5b1, 2.1);

  private lights(): void {
    this.scene.add(this.sky, this.lamp, this.lamp.target);
  }

  private sun(corners: three.Vector3[]): void {
    const { center, radius } = new three.Box3().setFromPoints(corners).getBoundingSphere(new three.Sphere());
    const { up, back, right } = this.figure?.layout ?? { up: [0, 0, 1], back: [0, 1, 0], right: [1, 0, 0] };
    this.sky.position.set(...(up as Vec3));
    this.lamp.target.position.copy(center);
    this.lamp.position.copy(center);
    for (const [direction, k] of [
      [up, 2.0],
      [back, -2.0],
      [right, -0.5],
    ] as [Vec3, number][])
      this.lamp.position.addScaledVector(new three.Vector3(...direction), k * radius);
  }

  private material(material: Material): three.Material {
    if (material === "line") return new three.LineBasicMaterial({ transparent: true, opacity: 0.55 });
    const flat = {
      roughness: 0.65,
      metalness: 0.12,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    };
    if (material === "part" || material === "work")
      return new three.MeshStandardMaterial({ ...flat, transparent: true, opacity: 0.75 });
    return new three.MeshStandardMaterial(flat);
  }
}

/** True where no graphics card draws: time goes by the pixel then. */
function isSoftware(context: WebGLRenderingContext | WebGL2RenderingContext): boolean {
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name = String(context.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER));
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** The block that stands for a part is taken though one sees through it. */
const isShown = (object: three.Object3D) => object instanceof three.Mesh && (object.material as three.Material).visible;
