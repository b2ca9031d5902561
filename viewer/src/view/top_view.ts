// SPDX-License-Identifier: BSD-3-Clause
// A place seen from above like an X-ray image: vertical surfaces are dark because many points fall into one pixel, and the
// color is their mean distance to the mesh.
import { OUTLIER, rampColor, rampOf, TRUTH } from "./colors";
import type { Points } from "./points";

const FULL_DISTANCE_M = 0.2;
const PATH_COLOR = "#f97316";
const MARGIN = 0.03; // share of the picture left empty on each side
const IGNORED = 0.001; // share of the points outside the box at either end
const PIXELS_PER_ROOT_OF_POINTS = 1.3; // more would leave gaps between the points of a wall

/** Seen from above: x0, y0 to x1, y1, m. */
export type Box = [number, number, number, number];

export interface TopView {
  title: string;
  points: Points;
  truth?: Float32Array; // positions
  estimate?: Float32Array;
  box?: Box; // what is shown; by default everything but a few stray points
  full_m?: number; // distance at the end of the color ramp
  width: number;
  maxHeight?: number;
}

export interface Raster {
  width: number;
  height: number;
  rgba: Uint8ClampedArray<ArrayBuffer>;
}

/** Contains 99.8 % of the points in each direction and the whole path. */
export function boxOf(points: Points, path?: Float32Array): Box {
  const ends = [0, 1].map((axis) => {
    const values = points.positions.filter((v, i) => i % 3 === axis && Number.isFinite(v)).sort();
    const cut = Math.floor(IGNORED * values.length);
    const along = path?.filter((_, i) => i % 3 === axis) ?? [];
    const all = values.length > 0 ? [values[cut], values[values.length - 1 - cut], ...along] : [...along];
    return all.length > 0 ? [Math.min(...all), Math.max(...all)] : [-0.5, 0.5];
  });
  return [ends[0][0], ends[1][0], ends[0][1], ends[1][1]];
}

function frameOf(view: TopView) {
  const [x0, y0, x1, y1] = view.box ?? boxOf(view.points, view.truth);
  const size = [x1 - x0, y1 - y0].map((s) => Math.max(s, 1) * (1 + 2 * MARGIN));
  const scale = Math.min(view.width / size[0], (view.maxHeight ?? 900) / size[1]);
  const height = Math.ceil(size[1] * scale);
  const x = (v: number) => (v - (x0 + x1) / 2) * scale + view.width / 2;
  const y = (v: number) => height / 2 - (v - (y0 + y1) / 2) * scale;
  return { scale, height, x, y };
}

export function rasterOf(view: TopView): Raster {
  const frame = frameOf(view);
  const { positions, distance } = view.points;
  const count = positions.length / 3;
  const shrink = Math.min(1, (PIXELS_PER_ROOT_OF_POINTS * Math.sqrt(count)) / view.width);
  const [width, height] = [view.width, frame.height].map((s) => Math.max(1, Math.round(s * shrink)));
  const counts = new Float32Array(width * height);
  const sums = new Float32Array(width * height);
  for (let i = 0; i < count; ++i) {
    const x = Math.floor(frame.x(positions[3 * i]) * shrink);
    const y = Math.floor(frame.y(positions[3 * i + 1]) * shrink);
    if (!(x >= 0 && x < width && y >= 0 && y < height)) continue;
    counts[y * width + x] += 1;
    const d = distance ? distance[i] : 0;
    sums[y * width + x] += Number.isNaN(d) ? 1 : Math.min(d, 1);
  }
  const filled = counts.filter((c) => c > 0).sort();
  const full = filled.length > 0 ? filled[Math.floor(0.97 * filled.length)] : 1; // the count of full opacity
  const rgba = new Uint8ClampedArray(4 * width * height).fill(255);
  const [ramp, end] = [rampOf("distance"), view.full_m ?? FULL_DISTANCE_M];
  counts.forEach((c, i) => {
    if (c === 0) return;
    const opacity = Math.min(1, 0.15 + (0.85 * Math.log1p(c)) / Math.log1p(full));
    const mean = sums[i] / c;
    const color = mean <= end ? rampColor(ramp, mean / end) : OUTLIER;
    color.forEach((channel, k) => (rgba[4 * i + k] = 255 + opacity * (channel - 255)));
  });
  return { width, height, rgba };
}

/** A self-contained SVG document; `picture` is the address of the raster as PNG. */
export function topViewSvg(view: TopView, picture: string): string {
  const { scale, height, x, y } = frameOf(view);
  const { width } = view;
  const path = (positions: Float32Array | undefined, style: string) => {
    if (!positions) return "";
    const points: string[] = [];
    let [px, py] = [Infinity, Infinity];
    for (let i = 0; i < positions.length; i += 3) {
      const [qx, qy] = [x(positions[i]), y(positions[i + 1])];
      if (Math.hypot(qx - px, qy - py) < 0.5) continue;
      points.push(`${qx.toFixed(1)},${qy.toFixed(1)}`);
      [px, py] = [qx, qy];
    }
    return `<polyline points="${points.join(" ")}" fill="none" ${style}/>`;
  };
  const length = niceLength((0.2 * width) / scale);
  const bar = `<path d="M12 ${height - 12}h${(length * scale).toFixed(1)}" stroke="#222" stroke-width="2"/>
<text x="12" y="${height - 17}" paint-order="stroke" stroke="#fff" stroke-width="3" font-size="11">${length} m</text>`;
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height + 22}" width="${width}" height="${height + 22}" \
font-family="system-ui,sans-serif" role="img" aria-label="${escaped(view.title)}"><rect width="100%" height="100%" fill="#fff"/>
<text x="6" y="15" font-size="12.5" font-weight="600" fill="#1c2430">${escaped(view.title)}</text><g transform="translate(0 22)">
<svg width="${width}" height="${height}"><image width="${width}" height="${height}" preserveAspectRatio="none" href="${picture}"/>
${path(view.truth, `stroke="${TRUTH}" stroke-width="3" stroke-opacity="0.5"`)}${path(view.estimate, `stroke="${PATH_COLOR}" stroke-width="1.4"`)}</svg>
${bar}</g></svg>`;
}

/** The largest of 1, 2, 5 times a power of ten that is at most `length`. */
function niceLength(length: number): number {
  const magnitude = 10 ** Math.floor(Math.log10(length));
  return magnitude * (length >= 5 * magnitude ? 5 : length >= 2 * magnitude ? 2 : 1);
}

export function escaped(text: string): string {
  return text.replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
}

/** In a browser: the raster as the address of a PNG. */
export function pngAddress({ width, height, rgba }: Raster): string {
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  canvas.getContext("2d")!.putImageData(new ImageData(rgba, width, height), 0, 0);
  return canvas.toDataURL("image/png");
}
