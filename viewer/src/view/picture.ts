// SPDX-License-Identifier: BSD-3-Clause
// A scene from above, for browsers that cannot run the 3D view.
import { cloudOf, pathOf, pointsOnMesh, type Points } from "./points";
import type { BlockSource, SceneHeader } from "./scene";
import { pngAddress, rasterOf, topViewSvg } from "./top_view";

/** The clouds that are visible at first (or the mesh if there are none), the truth and one path, as SVG. */
export async function scenePicture(header: SceneHeader, source: BlockSource): Promise<string> {
  const shown = header.clouds.filter((cloud) => cloud.visible);
  let parts: Points[] = [];
  for (const cloud of shown) parts.push(await cloudOf(cloud, source));
  if (shown.length === 0) {
    parts = await Promise.all(header.meshes.map(async (mesh) => pointsOnMesh(mesh, await source(mesh.block), 200_000)));
  }
  const total = parts.reduce((sum, part) => sum + part.positions.length / 3, 0);
  const points: Points = { positions: new Float32Array(3 * total), distance: new Float32Array(total) };
  let at = 0;
  for (const { positions, distance } of parts) {
    points.positions.set(positions, 3 * at);
    if (distance) points.distance!.set(distance, at);
    at += positions.length / 3;
  }
  const positionsOf = async (role: "truth" | "estimate") => {
    const path = header.paths.find((candidate) => candidate.role === role);
    return path && (await pathOf(path, source)).positions;
  };
  const view = {
    title: `${header.title}, from above`,
    points,
    width: 760,
    truth: await positionsOf("truth"),
    estimate: await positionsOf("estimate"),
  };
  return topViewSvg(view, pngAddress(rasterOf(view)));
}
