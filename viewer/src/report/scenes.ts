// SPDX-License-Identifier: BSD-3-Clause
// The points in the page: which runs have some, and pictures of them from above.
import { cloudOf, pathOf, pointsOnMesh } from "../view/points";
import type { BlockSource, SceneHeader } from "../view/scene";
import { boxOf, pngAddress, rasterOf, topViewSvg, type Box, type Raster, type TopView } from "../view/top_view";
import { label, type Run } from "./data";

export interface WorldScene {
  world: string;
  header: SceneHeader;
  source: BlockSource;
}

export function sceneOf(scenes: WorldScene[], run: Run): WorldScene | undefined {
  return scenes.find(({ world, header }) => world === run.world && header.clouds.some((cloud) => cloud.name === run.name));
}

/** What belongs to some runs of one world: their maps and paths, the truths of their flights, the mesh. */
export function headerOfRuns(scene: WorldScene, runs: Run[]): SceneHeader {
  const { header } = scene;
  const chosen = <T extends { name: string }>(items: T[]): T[] =>
    runs.flatMap((run) =>
      items
        .filter(({ name }) => name === run.name)
        .map((item) => ({ ...item, name: runs.length > 1 ? `${label(run)}, ${run.sensor}` : label(run), visible: run === runs[0] })),
    );
  const truths = header.paths.filter((path) => runs.some((run) => path.name === `truth of ${run.dataset}`));
  return {
    ...header,
    title: runs.map((run) => run.name).join(", "),
    clouds: chosen(header.clouds),
    paths: [...truths, ...chosen(header.paths)],
  };
}

export interface Picture {
  id: string;
  view: TopView;
}

/** A run's map with its paths. */
export async function mapPicture(scene: WorldScene, run: Run, look: Omit<TopView, "title" | "points">): Promise<Picture> {
  const header = headerOfRuns(scene, [run]);
  const positions = async (role: string) => {
    const path = header.paths.find((candidate) => candidate.role === role);
    return path && (await pathOf(path, scene.source)).positions;
  };
  const points = await cloudOf(header.clouds[0], scene.source);
  const title = `${run.sensor}, ${label(run)}`;
  const id = ["map", run.world, run.sensor, run.algorithm, run.preset].filter((part) => part !== "").join("-");
  return { id, view: { title, points, truth: await positions("truth"), estimate: await positions("estimate"), ...look } };
}

/** What several maps show, within the mesh: the map of a run that diverged extends far beyond it. */
export async function commonBox(scene: WorldScene, pictures: Picture[]): Promise<Box> {
  const boxes = pictures.map(({ view }) => boxOf(view.points, view.truth));
  const [mesh] = scene.header.meshes;
  const limit: Box = mesh ? boxOf(pointsOnMesh(mesh, await scene.source(mesh.block), 5000)) : [-Infinity, -Infinity, Infinity, Infinity];
  return [0, 1, 2, 3].map((i) => {
    const ends = boxes.map((box) => box[i]);
    return i < 2 ? Math.max(limit[i], Math.min(...ends)) : Math.min(limit[i], Math.max(...ends));
  }) as Box;
}

/** The world with its flights, and what each sensor sees in one scan. */
export async function placePictures(scene: WorldScene, look: Pick<TopView, "width" | "maxHeight">): Promise<Picture[]> {
  const { world, header, source } = scene;
  const pictures: Picture[] = [];
  const truth = header.paths.find((path) => path.role === "truth");
  if (header.meshes.length > 0) {
    const points = pointsOnMesh(header.meshes[0], await source(header.meshes[0].block), 150_000);
    const estimate = truth && (await pathOf(truth, source)).positions;
    pictures.push({ id: `world-${world}`, view: { title: `${world}, with the flight path`, points, estimate, ...look } });
  }
  const titles = { scan: "one scan, de-skewed", skewed: "the same, not de-skewed" };
  for (const cloud of header.clouds) {
    const [kind, sensor] = cloud.name.split(" ");
    const title = sensor && titles[kind as keyof typeof titles];
    if (!title) continue;
    pictures.push({
      id: `${kind}-${world}-${sensor}`,
      view: { title: `${sensor}: ${title}`, points: await cloudOf(cloud, source), ...look },
    });
  }
  return pictures;
}

export function pictureSvg({ view }: Picture, encode: (raster: Raster) => string = pngAddress): string {
  return topViewSvg(view, encode(rasterOf(view)));
}
