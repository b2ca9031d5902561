// SPDX-License-Identifier: BSD-3-Clause
// The data of a page: a small JSON header and binary blocks, written by
// lidarena/report/scene_blocks.cpp. All coordinates are meters relative to `origin`, z up; times are
// seconds since `time_origin_s`.

export type Vec3 = [number, number, number];

/** One value per point, stored in 16 bits: 0 ... 65534 over [min, max], 65535 for no value. */
export interface FieldHeader {
  name: "distance" | "intensity" | "time";
  unit: string;
  min: number;
  max: number;
}

/** Neighboring points; positions have 16 bits per coordinate, over the box of the chunk. */
export interface ChunkHeader {
  count: number;
  min: Vec3;
  size: Vec3;
}

/**
 * The points of a chunk are in random order, so any prefix is a uniform sample. Block p contains
 * the p-th share of every chunk: the first block shows the whole cloud at a low density.
 */
export interface CloudHeader {
  name: string;
  points: number;
  left_out: number;
  fields: FieldHeader[];
  chunks: ChunkHeader[];
  blocks: number[];
  visible: boolean;
}

export interface MeshHeader {
  name: string;
  vertices: number;
  triangles: number;
  block: number;
}

/** Columns of float32: x y z, time, qx qy qz qw, and error (m) where the truth is known. */
export interface PathHeader {
  name: string;
  role: "truth" | "estimate";
  poses: number;
  has_error: boolean;
  block: number;
}

export interface SceneHeader {
  title: string;
  version: string;
  frame: string;
  origin: Vec3;
  bounds: [Vec3, Vec3];
  time: [number, number] | null;
  time_origin_s: number;
  window_s: number | null; // duration shown initially, from the beginning; null: all
  outlier_m: number;
  clouds: CloudHeader[];
  meshes: MeshHeader[];
  paths: PathHeader[];
  block_bytes: number[];
}

/** Number of points of a chunk of `count` that are in the blocks before block `part` of `parts`. */
export function sharePoints(count: number, part: number, parts: number): number {
  return Math.floor((count * part) / parts);
}

/** Loads the bytes of a block. */
export type BlockSource = (index: number) => Promise<ArrayBuffer>;

export function decodeBase64(text: string): ArrayBuffer {
  const bytes = atob(text);
  const out = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; ++i) out[i] = bytes.charCodeAt(i);
  return out.buffer;
}

/**
 * Reads blocks from inert elements of the page with the ids PREFIX-N. Waits for those that the browser has not parsed yet;
 * unless they are to be read again, empties an element after decoding to free the memory of its text.
 */
export function blocksInPage(prefix: string, again = false): BlockSource {
  return async (index) => {
    const id = `${prefix}-${index}`;
    let element = document.getElementById(id);
    while (!isWhole(element)) {
      if (document.readyState !== "loading" && !element) throw new Error(`the page has no element ${id}`);
      await new Promise((done) => setTimeout(done, 20));
      element = document.getElementById(id);
    }
    const bytes = decodeBase64(element!.textContent ?? "");
    if (!again) element!.textContent = "";
    return bytes;
  };
}

/** Whether an element is parsed completely: another one follows it, or the whole page is parsed. */
function isWhole(element: HTMLElement | null): boolean {
  return !!element && (!!element.nextElementSibling || document.readyState !== "loading");
}

/** Fetches blocks from the server of `lidarena view`. */
export function blocksFromServer(): BlockSource {
  return async (index) => {
    const answer = await fetch(`block/${index}`);
    if (!answer.ok) throw new Error(`block ${index}: ${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
  };
}
