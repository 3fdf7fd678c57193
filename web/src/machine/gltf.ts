/** The machine as it stands, as a binary glTF 2.0 file: metres, Y up, as the format has it. three.js has an exporter of
 * anything; this one takes bodies of one colour, and a twentieth of its size in the page. */

import * as three from "three";
import type { Vec3 } from "../evaluator/types";

const [ARRAY, INDEX, FLOAT, UINT, TRIANGLES] = [34962, 34963, 5126, 5125, 4];

class Binary {
  readonly views: object[] = [];
  readonly accessors: object[] = [];
  private readonly parts: ArrayBuffer[] = [];
  private length = 0;

  /** Adds numbers, and returns the index of their accessor. */
  put(list: Float32Array | Uint32Array, type: "VEC3" | "SCALAR", bounds: object = {}): number {
    const isIndex = list instanceof Uint32Array;
    const bytes = list.slice().buffer;
    const view = { buffer: 0, byteOffset: this.length, byteLength: bytes.byteLength };
    this.views.push({ ...view, target: isIndex ? INDEX : ARRAY });
    this.parts.push(bytes);
    this.length += bytes.byteLength;
    const count = list.length / (type === "VEC3" ? 3 : 1);
    const componentType = isIndex ? UINT : FLOAT;
    return this.accessors.push({ bufferView: this.views.length - 1, componentType, count, type, ...bounds }) - 1;
  }

  /** The file: a chunk of JSON, and one of numbers. */
  file(scene: object): Blob {
    const buffers = [{ byteLength: this.length }];
    const all = { asset: { version: "2.0" }, ...scene, buffers, bufferViews: this.views, accessors: this.accessors };
    const text = new TextEncoder().encode(JSON.stringify(all));
    const json = new Uint8Array(Math.ceil(text.length / 4) * 4).fill(0x20);
    json.set(text);
    const total = 12 + 8 + json.length + 8 + this.length;
    const head = new Uint32Array([0x46546c67, 2, total, json.length, 0x4e4f534a]);
    return new Blob([head, json, new Uint32Array([this.length, 0x004e4942]), ...this.parts], {
      type: "model/gltf-binary",
    });
  }
}

/** The bodies below `root`, which is in millimetres with `up` upwards; marks and lines are left out. */
export function gltf(root: three.Object3D, up: Vec3): Blob {
  const binary = new Binary();
  const materials: three.MeshStandardMaterial[] = [];
  const meshes: object[] = [];
  const nodes: object[] = [];
  root.updateMatrixWorld(true);
  root.traverse((of) => {
    const name = of.userData["body"] as string | undefined;
    if (!(of instanceof three.Mesh) || name === undefined) return;
    const geometry = of.geometry as three.BufferGeometry;
    const material = of.material as three.MeshStandardMaterial;
    const known = materials.indexOf(material);
    const colour = known < 0 ? materials.push(material) - 1 : known;
    const points = (at: "position" | "normal") => new Float32Array(geometry.getAttribute(at).array);
    geometry.computeBoundingBox();
    const { min, max } = geometry.boundingBox ?? new three.Box3();
    const attributes = {
      POSITION: binary.put(points("position"), "VEC3", { min: min.toArray(), max: max.toArray() }),
      NORMAL: binary.put(points("normal"), "VEC3"),
    };
    const indices = geometry.index ? { indices: binary.put(new Uint32Array(geometry.index.array), "SCALAR") } : {};
    meshes.push({ primitives: [{ attributes, ...indices, material: colour, mode: TRIANGLES }] });
    nodes.push({ name, mesh: meshes.length - 1, matrix: of.matrixWorld.toArray() });
  });
  const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(...up), new three.Vector3(0, 1, 0));
  const children = nodes.map((_, i) => i);
  nodes.push({ name: "machine", children, scale: [1e-3, 1e-3, 1e-3], rotation: turn.toArray() });
  const look = ({ color, opacity, metalness, roughness }: three.MeshStandardMaterial) => ({
    pbrMetallicRoughness: {
      baseColorFactor: [...color.toArray(), opacity],
      metallicFactor: metalness,
      roughnessFactor: roughness,
    },
    ...(opacity < 1 ? { alphaMode: "BLEND" } : {}),
  });
  const scenes = [{ nodes: [nodes.length - 1] }];
  return binary.file({ scene: 0, scenes, nodes, meshes, materials: materials.map(look) });
}
