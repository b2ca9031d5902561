// SPDX-License-Identifier: BSD-3-Clause
// Downloads of what the page shows.
import { button } from "../view/elements";

export function save(name: string, content: Blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

export function csvOf(rows: (string | number | null | undefined)[][]): string {
  const cell = (value: string | number | null | undefined) => {
    const text = value === null || value === undefined ? "" : String(value);
    return /[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  };
  return rows.map((row) => row.map(cell).join(",") + "\n").join("");
}

export function saveCsv(id: string, rows: (string | number | null | undefined)[][]) {
  save(`${id}.csv`, new Blob([csvOf(rows)], { type: "text/csv" }));
}

/** Draws an SVG document with twice its size. */
async function savePng(id: string, svg: string) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: 2 * image.width, height: 2 * image.height });
  canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => blob && save(`${id}.png`, blob));
}

/** Buttons that save a drawing, and its data if there are any. */
export function saveButtons(id: string, svg: () => string, rows?: () => (string | number | null)[][]): HTMLElement {
  const bar = document.createElement("div");
  bar.className = "save";
  bar.append(
    button("SVG", `save ${id} as SVG`, () => save(`${id}.svg`, new Blob([svg()], { type: "image/svg+xml" }))),
    button("PNG", `save ${id} as PNG`, () => savePng(id, svg())),
  );
  if (rows) bar.append(button("CSV", `save the data of ${id}`, () => saveCsv(id, rows())));
  return bar;
}

/** A drawing with its buttons; `content` is shown in place of the drawing alone. */
export function drawn(id: string, svg: string, content?: HTMLElement): HTMLElement {
  const figure = document.createElement("figure");
  figure.id = id;
  if (content) figure.append(content);
  (content ?? figure).innerHTML = svg;
  figure.append(saveButtons(id, () => svg));
  return figure;
}
