// SPDX-License-Identifier: BSD-3-Clause
// For Node.js: `node figures.cjs report.html OUT` draws every picture and chart of the page as OUT/ID.svg.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { deflateSync } from "node:zlib";
import type { SceneHeader } from "../view/scene";
import type { Raster } from "../view/top_view";
import { echarts } from "./charts";
import type { ReportData } from "./data";
import { figuresOf } from "./figures_of";
import { mapPicture, pictureSvg, placePictures, sceneOf, type Picture, type WorldScene } from "./scenes";

const [input, out] = process.argv.slice(2);
const page = readFileSync(input, "latin1");

/** The text of the element with this id; empty if the page has none. */
function textOf(id: string): string {
  const begin = page.indexOf(`id='${id}'>`);
  return begin < 0 ? "" : page.slice(page.indexOf(">", begin) + 1, page.indexOf("</script>", begin));
}

const jsonOf = (id: string) => JSON.parse(Buffer.from(textOf(id), "latin1").toString("utf8"));

/** The check value of a part of a PNG file. */
function crc32(bytes: Uint8Array): number {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

function pngOf({ width, height, rgba }: Raster): string {
  const chunk = (type: string, bytes: Uint8Array) => {
    const body = Buffer.concat([Buffer.from(type), bytes]);
    const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(bytes.length);
    check.writeUInt32BE(crc32(body));
    return Buffer.concat([length, body, check]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 6, 0, 0, 0], 8); // 8 bits per channel, RGBA
  const rows = Buffer.alloc(height * (4 * width + 1)); // each begins with its filter: none
  for (let y = 0; y < height; ++y) rows.set(rgba.subarray(4 * width * y, 4 * width * (y + 1)), y * (4 * width + 1) + 1);
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  const png = Buffer.concat([signature, chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
  return `data:image/png;base64,${png.toString("base64")}`;
}

function scenesInPage(): WorldScene[] {
  const scenes: WorldScene[] = [];
  for (let i = 0; textOf(`scene-${i}`) !== ""; ++i) {
    const header: SceneHeader = jsonOf(`scene-${i}`);
    const source = async (block: number) => Uint8Array.from(Buffer.from(textOf(`block-${i}-${block}`), "base64")).buffer;
    scenes.push({ world: header.title, header, source });
  }
  return scenes;
}

async function draw() {
  mkdirSync(out, { recursive: true });
  const data: ReportData = jsonOf("data");
  for (const figure of figuresOf(data, data.runs)) {
    const chart = echarts.init(null, null, { renderer: "svg", ssr: true, width: figure.width, height: figure.height });
    chart.setOption(figure.option);
    writeFileSync(path.join(out, `${figure.id}.svg`), `${chart.renderToSVGString()}\n`);
    chart.dispose();
  }
  const write = (picture: Picture) => writeFileSync(path.join(out, `${picture.id}.svg`), `${pictureSvg(picture, pngOf)}\n`);
  const scenes = scenesInPage();
  for (const scene of scenes) (await placePictures(scene, { width: 420 })).forEach(write);
  const drawn = new Set<string>(); // of several flights and seeds, the first
  for (const run of data.runs) {
    const scene = sceneOf(scenes, run);
    if (!scene) continue;
    const picture = await mapPicture(scene, run, { width: 560 });
    if (!drawn.has(picture.id)) write(picture);
    drawn.add(picture.id);
  }
}

draw();
