// SPDX-License-Identifier: BSD-3-Clause
// Tables that sort by a click on a column's head and save as CSV.
import { button, element } from "../view/elements";
import { shownShare, type Cell, type Table } from "./data";
import { saveCsv } from "./save";

const ROWS_AT_FIRST = 100; // a longer table shows the rest on request

/** A cell that an action belongs to. */
export interface ShownCell extends Cell {
  open?: () => void;
}
export interface ShownTable extends Omit<Table, "rows"> {
  rows: ShownCell[][];
}

export const number = (value: number | null | undefined, bound?: number): Cell => ({
  text: shownShare(value, bound),
  value: value ?? undefined,
});
export const word = (text: string): Cell => ({ text });

function compare(a: Cell, b: Cell): number {
  if (a.value !== undefined && b.value !== undefined) return a.value - b.value;
  if (a.value !== undefined || b.value !== undefined) return a.value !== undefined ? -1 : 1; // figures first
  return (a.text ?? "").localeCompare(b.text ?? "");
}

function cellElement(cell: ShownCell, first: boolean): HTMLElement {
  const isText = cell.value === undefined;
  const content = cell.open ? button(cell.text ?? "", `open ${cell.text}`, cell.open) : element("span", {}, cell.text || "–");
  const made = element(first ? "th" : "td", { className: isText ? "text" : "" }, content);
  if (first) made.setAttribute("scope", "row");
  if (cell.bold) content.classList.add("bold");
  if (cell.underlined) content.classList.add("underlined");
  if (cell.live) made.append(element("span", {}, ` / ${cell.live} live`));
  if (cell.spread) made.append(element("span", { className: "range" }, cell.spread));
  if (cell.reference) made.append(element("span", { className: "reference" }, ` (${cell.reference})`));
  return made;
}

export function tableElement(table: ShownTable): HTMLElement {
  let rows = table.rows;
  let limit = ROWS_AT_FIRST;
  let sorted: { column: number; ascending: boolean } | null = null;
  const body = element("tbody");
  const more = button("", "show the rows that are left out", () => {
    limit = Infinity;
    fill();
  });
  const fill = () => {
    body.replaceChildren(...rows.slice(0, limit).map((row) => element("tr", {}, ...row.map((cell, i) => cellElement(cell, i === 0)))));
    more.hidden = rows.length <= limit;
    more.textContent = `Show all ${rows.length} rows`;
  };
  const heads = table.head.map((text, column) => {
    const isText = column === 0 || table.rows.every((row) => row[column]?.value === undefined);
    const head = element("th", { scope: "col", className: isText ? "text" : "" });
    head.append(button(text, `sort by ${text}`, () => sortBy(column)));
    return head;
  });
  const sortBy = (column: number) => {
    sorted = { column, ascending: sorted?.column === column ? !sorted.ascending : true };
    const sign = sorted.ascending ? 1 : -1;
    rows = [...table.rows].sort((a, b) => sign * compare(a[column] ?? word(""), b[column] ?? word("")));
    heads.forEach((head, i) => {
      if (i === column) head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
    fill();
  };
  fill();
  const csv = () => saveCsv(table.id, [table.head, ...table.rows.map((row) => row.map((cell) => cell.value ?? cell.text))]);
  const bar = element("div", { className: "save" }, button("CSV", `save ${table.title} as CSV`, csv));
  return element(
    "div",
    { className: "table", id: `table-${table.id}` },
    element("div", { className: "head" }, element("h3", {}, table.title), bar),
    element("div", { className: "scroll", tabIndex: 0 }, element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body)),
    more,
    element("p", { className: "note" }, table.note),
  );
}
