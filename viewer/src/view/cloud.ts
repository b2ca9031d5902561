// SPDX-License-Identifier: BSD-3-Clause
// A cloud on the GPU: one buffer per chunk and column, reallocated when the loaded points double.
import * as THREE from "three";
import { sharePoints, type ChunkHeader, type CloudHeader, type FieldHeader } from "./scene";
import { pointMaterial, type PointStyle } from "./point_material";

interface Column {
  name: string;
  width: number;
  values: Uint16Array; // of the whole chunk; zero where not loaded yet
}

interface Chunk {
  header: ChunkHeader;
  columns: Column[];
  points: THREE.Points;
  box: THREE.Box3;
  loaded: number; // points on the GPU
}

export interface PickedPoint {
  cloud: Cloud;
  position: THREE.Vector3;
  values: { field: FieldHeader; value: number | null }[];
  pixels: number;
}

export class Cloud {
  readonly group = new THREE.Group();
  private chunks: Chunk[] = [];
  private material: THREE.ShaderMaterial;
  private partsLoaded = 0;

  constructor(
    readonly header: CloudHeader,
    style: PointStyle,
  ) {
    this.material = pointMaterial(header.fields, style);
    for (const chunk of header.chunks) this.addChunk(chunk);
  }

  get loaded(): number {
    return this.chunks.reduce((sum, chunk) => sum + chunk.loaded, 0);
  }

  private addChunk(header: ChunkHeader) {
    const column = (name: string, width: number): Column => ({ name, width, values: new Uint16Array(header.count * width) });
    const columns = [column("position", 3), ...this.header.fields.map((field) => column(`a_${field.name}`, 1))];
    const points = new THREE.Points(new THREE.BufferGeometry(), this.material);
    points.visible = false;
    points.frustumCulled = false; // plan() culls and also distributes the budget of points
    points.position.set(...header.min);
    points.scale.set(...(header.size.map((s) => Math.max(s, 1e-6)) as [number, number, number]));
    points.updateMatrixWorld();
    const min = new THREE.Vector3(...header.min);
    const box = new THREE.Box3(min, min.clone().add(new THREE.Vector3(...header.size)));
    this.chunks.push({ header, columns, points, box, loaded: 0 });
    this.group.add(points);
  }

  /**
   * Adds the next block: for each chunk its positions, then its fields one after the other. Returns
   * true when more points can be drawn: the GPU's buffers are updated at the first, second, fourth,
   * ... and the last block, so that the data uploaded is less than three times the cloud.
   */
  addBlock(bytes: ArrayBuffer): boolean {
    const parts = this.header.blocks.length;
    let offset = 0;
    for (const chunk of this.chunks) {
      const begin = sharePoints(chunk.header.count, this.partsLoaded, parts);
      const count = sharePoints(chunk.header.count, this.partsLoaded + 1, parts) - begin;
      for (const { width, values } of chunk.columns) {
        const part = new Uint16Array(bytes, offset, count * width);
        values.set(part, begin * width);
        offset += part.byteLength;
      }
    }
    if (offset !== bytes.byteLength) throw new Error(`${this.header.name}: a block has a wrong length`);
    this.partsLoaded += 1;
    const doubled = (this.partsLoaded & (this.partsLoaded - 1)) === 0;
    if (!doubled && this.partsLoaded < parts) return false;
    for (const chunk of this.chunks) this.toGpu(chunk, sharePoints(chunk.header.count, this.partsLoaded, parts));
    return true;
  }

  /** Uploads the first `count` points of a chunk to the GPU. */
  private toGpu(chunk: Chunk, count: number) {
    chunk.points.geometry.dispose();
    chunk.points.geometry = new THREE.BufferGeometry();
    for (const { name, width, values } of chunk.columns) {
      chunk.points.geometry.setAttribute(name, new THREE.BufferAttribute(values.subarray(0, count * width), width, true));
    }
    chunk.loaded = count;
  }

  /** Number of loaded points in the chunks that intersect `frustum`. */
  inSight(frustum: THREE.Frustum): number {
    let sum = 0;
    for (const chunk of this.chunks) {
      if (frustum.intersectsBox(chunk.box)) sum += chunk.loaded;
    }
    return sum;
  }

  /**
   * Sets what the next frame draws: `share` of the points of each chunk in `frustum`. Returns their
   * number.
   */
  plan(frustum: THREE.Frustum, share: number): number {
    let drawn = 0;
    for (const chunk of this.chunks) {
      const count = frustum.intersectsBox(chunk.box) ? Math.ceil(share * chunk.loaded) : 0;
      chunk.points.visible = count > 0;
      chunk.points.geometry.setDrawRange(0, count);
      drawn += count;
    }
    return drawn;
  }

  /** Position and fields of point `i` of a chunk. */
  private pointOf(chunk: Chunk, i: number) {
    const raw = chunk.columns[0].values;
    const position = new THREE.Vector3(raw[3 * i], raw[3 * i + 1], raw[3 * i + 2])
      .divideScalar(65535)
      .applyMatrix4(chunk.points.matrixWorld);
    const values = this.header.fields.map((field, k) => {
      const q = chunk.columns[1 + k].values[i];
      return { field, value: q === 65535 ? null : field.min + ((field.max - field.min) * q) / 65534 };
    });
    return { position, values };
  }

  /**
   * Of the drawn and accepted points within `radius` pixels of (x, y), the one closest to the
   * camera.
   */
  pick(
    toClip: THREE.Matrix4,
    width: number,
    height: number,
    x: number,
    y: number,
    radius: number,
    accepts: (picked: PickedPoint) => boolean,
  ): PickedPoint | null {
    let best: PickedPoint | null = null;
    let bestDepth = Infinity;
    const clip = new THREE.Vector4();
    for (const chunk of this.chunks) {
      if (!chunk.points.visible) continue;
      const raw = chunk.columns[0].values;
      const matrix = toClip.clone().multiply(chunk.points.matrixWorld);
      const drawn = chunk.points.geometry.drawRange.count;
      for (let i = 0; i < drawn; ++i) {
        clip.set(raw[3 * i] / 65535, raw[3 * i + 1] / 65535, raw[3 * i + 2] / 65535, 1);
        clip.applyMatrix4(matrix);
        if (clip.w <= 0) continue;
        const dx = (0.5 + (0.5 * clip.x) / clip.w) * width - x;
        const dy = (0.5 - (0.5 * clip.y) / clip.w) * height - y;
        if (Math.abs(dx) > radius || Math.abs(dy) > radius || clip.w >= bestDepth) continue;
        const picked = { cloud: this, ...this.pointOf(chunk, i), pixels: Math.hypot(dx, dy) };
        if (!accepts(picked)) continue;
        best = picked;
        bestDepth = clip.w;
      }
    }
    return best;
  }
}
