// SPDX-License-Identifier: BSD-3-Clause
// What a page is given: a small header in JSON and blocks of bytes, written by
// lidarena/report/scene_blocks.cpp. All coordinates are meters relative to `origin`, z up; times are
// seconds since `time_origin_s`.

export type Vec3 = [number, number, number];

/** One value a point, stored as 16 bits: 0 ... 65534 over [min, max], 65535 where there is none. */
export interface FieldHeader {
  name: "distance" | "intensity" | "time";
  unit: string;
  min: number;
  max: number;
}

/** Points that lie together; positions are 16 bits a coordinate inside the box. */
export interface ChunkHeader {
  count: number;
  min: Vec3;
  size: Vec3;
}

/**
 * The points of a chunk are in random order, so any prefix of it is a fair sample. Block p holds the
 * p-th share of every chunk: after the first block the whole cloud can be seen, thinly.
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
  window_s: number | null;  // shown at first: so long from the beginning; null: all
  outlier_m: number;
  clouds: CloudHeader[];
  meshes: MeshHeader[];
  paths: PathHeader[];
  block_bytes: number[];
}

/** Where the bytes of a block come from. */
export type BlockSource = (index: number) => Promise<ArrayBuffer>;

export function decodeBase64(text: string): ArrayBuffer {
  const bytes = atob(text);
  const out = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; ++i) out[i] = bytes.charCodeAt(i);
  return out.buffer;
}

/**
 * Blocks that stand in the page as inert elements of id PREFIX-N. Those that the parser has not come
 * to yet are waited for; an element is emptied once it is decoded, so that its text is freed.
 */
export function blocksInPage(prefix: string): BlockSource {
  return async (index) => {
    const id = `${prefix}-${index}`;
    let element = document.getElementById(id);
    while (!isWhole(element)) {
      if (document.readyState !== "loading" && !element) throw new Error(`the page lacks ${id}`);
      await new Promise((done) => setTimeout(done, 20));
      element = document.getElementById(id);
    }
    const bytes = decodeBase64(element!.textContent ?? "");
    element!.textContent = "";
    return bytes;
  };
}

/** While the page is being parsed, an element is whole once another follows it. */
function isWhole(element: HTMLElement | null): boolean {
  return !!element && (!!element.nextElementSibling || document.readyState !== "loading");
}

/** Blocks that the small server of `lidarena view` hands out. */
export function blocksFromServer(): BlockSource {
  return async (index) => {
    const answer = await fetch(`block/${index}`);
    if (!answer.ok) throw new Error(`block ${index}: ${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
  };
}
