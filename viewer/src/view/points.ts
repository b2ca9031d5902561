// SPDX-License-Identifier: BSD-3-Clause
// Blocks of a scene as coordinates, for pictures that are drawn without a GPU.
import { sharePoints, type BlockSource, type CloudHeader, type MeshHeader, type PathHeader } from "./scene";

/** Meters relative to the scene's origin: x, y, z of each point; its distance to the mesh, NaN for none. */
export interface Points {
  positions: Float32Array;
  distance: Float32Array | null;
}

export function unpackCloud(cloud: CloudHeader, blocks: ArrayBuffer[]): Points {
  const total = cloud.chunks.reduce((sum, chunk) => sum + chunk.count, 0);
  const positions = new Float32Array(3 * total);
  const distance = cloud.fields.some((field) => field.name === "distance") ? new Float32Array(total) : null;
  let out = 0;
  blocks.forEach((bytes, part) => {
    const stored = new Uint16Array(bytes);
    let at = 0;
    for (const { count, min, size } of cloud.chunks) {
      const n = sharePoints(count, part + 1, blocks.length) - sharePoints(count, part, blocks.length);
      for (let i = 0; i < 3 * n; ++i) positions[3 * out + i] = min[i % 3] + (size[i % 3] * stored[at + i]) / 65535;
      at += 3 * n;
      for (const field of cloud.fields) {
        if (field.name === "distance") {
          for (let i = 0; i < n; ++i) {
            const value = stored[at + i];
            distance![out + i] = value === 65535 ? NaN : field.min + ((field.max - field.min) * value) / 65534;
          }
        }
        at += n;
      }
      out += n;
    }
  });
  return { positions, distance };
}

/** `count` points on the surface, evenly distributed by area; the same ones in each call. */
export function pointsOnMesh(mesh: MeshHeader, bytes: ArrayBuffer, count: number): Points {
  const vertices = new Float32Array(bytes, 0, 3 * mesh.vertices);
  const corners = new Uint32Array(bytes, 12 * mesh.vertices, 3 * mesh.triangles);
  const edges = (t: number) => {
    const [a, b, c] = [0, 1, 2].map((k) => vertices.subarray(3 * corners[3 * t + k], 3 * corners[3 * t + k] + 3));
    const [u, v] = [b, c].map((corner) => [0, 1, 2].map((axis) => corner[axis] - a[axis]));
    const cross = [0, 1, 2].map((i) => u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
    return { a, u, v, area: 0.5 * Math.hypot(...cross) };
  };
  let area = 0;
  for (let t = 0; t < mesh.triangles; ++t) area += edges(t).area;
  const step = area / count;
  const positions: number[] = [];
  let [reached, next] = [0, 0.5 * step];
  // Within triangles by the sequence of M. Roberts (2018), "The unreasonable effectiveness of quasirandom sequences",
  // folded into the triangle.
  const plastic = 1.324717957244746;
  for (let t = 0; t < mesh.triangles; ++t) {
    const triangle = edges(t);
    reached += triangle.area;
    for (; next < reached && positions.length < 3 * count; next += step) {
      const k = positions.length / 3 + 1;
      let [s, r] = [(k / plastic) % 1, (k / plastic ** 2) % 1];
      if (s + r > 1) [s, r] = [1 - s, 1 - r];
      for (let axis = 0; axis < 3; ++axis) positions.push(triangle.a[axis] + s * triangle.u[axis] + r * triangle.v[axis]);
    }
  }
  return { positions: Float32Array.from(positions), distance: null };
}

export async function cloudOf(cloud: CloudHeader, source: BlockSource): Promise<Points> {
  return unpackCloud(cloud, await Promise.all(cloud.blocks.map(source)));
}

/** Columns of a path. */
export interface Path {
  positions: Float32Array;
  t_s: Float32Array;
  quaternions: Float32Array;
}

export async function pathOf(path: PathHeader, source: BlockSource): Promise<Path> {
  const bytes = await source(path.block);
  const column = (begin: number, width: number) => new Float32Array(bytes, 4 * path.poses * begin, path.poses * width);
  return { positions: column(0, 3), t_s: column(3, 1), quaternions: column(4, 4) };
}
