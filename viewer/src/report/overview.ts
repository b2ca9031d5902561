// SPDX-License-Identifier: BSD-3-Clause
// The first screen: what was compared, the figures of all combinations, and the same place as the run with the lowest and
// that with the highest map error map it. decision.ts says which combination to use.
import { button, element } from "../view/elements";
import {
  cellOf,
  count,
  CPU,
  distinct,
  DRIFT,
  figureOf,
  grouped,
  keptOf,
  label,
  LIVE_DRIFT,
  MAP_RMSE,
  MEMORY,
  OUTLIERS,
  OWN_OUTLIERS,
  OWN_RMSE,
  shown,
  shownShare,
  spreadOf,
  type FigureInfo,
  type ReportData,
  type Run,
} from "./data";
import { moveByArrows } from "./keyboard";
import { drawn, saveCsv } from "./save";
import { commonBox, mapPicture, pictureSvg, sceneOf, type WorldScene } from "./scenes";
import type { Settings } from "./settings";

const SWITCH: [string, string][] = [
  [DRIFT, "drift"],
  [OWN_RMSE, "own map"],
  [MAP_RMSE, "sampled returns"],
  [OWN_OUTLIERS, "outliers, own map"],
  [OUTLIERS, "outliers, sampled returns"],
  [CPU, "CPU"],
  [MEMORY, "memory"],
];

export interface Page {
  data: ReportData;
  scenes: WorldScene[];
  settings: Settings;
  runs: Run[]; // those that pass the filters
  change: (some: Partial<Settings>) => void;
}

export function compared({ runs }: Page): string {
  const names = (values: string[]) => (values.length <= 4 ? ` (${values.join(", ")})` : "");
  const [sensors, methods, worlds] = [distinct(runs, (r) => r.sensor), distinct(runs, label), distinct(runs, (r) => r.world)];
  const flights = distinct(runs, (run) => `${run.world} ${run.flight}`).length;
  const seeds = distinct(runs, (run) => run.seed).length;
  return (
    `${count(sensors.length, "LiDAR")}${names(sensors)} with ${count(methods.length, "SLAM method")} in ` +
    `${count(worlds.length, "world")}${names(worlds)}, ${count(flights, "flight")}, ${count(seeds, "seed")}: ` +
    `${keptOf(runs).length} of ${count(runs.length, "run")} kept tracking.`
  );
}

// --- the matrix

/** Blue for the best to orange for the worst of the shown values, on a logarithmic scale. */
function heat(value: number, values: number[], info: FigureInfo): string {
  const scale = (v: number) => Math.log(Math.max(v, 1e-3));
  const [low, high] = [Math.min(...values), Math.max(...values)].map(scale);
  const s = high > low ? (scale(value) - low) / (high - low) : 0.5;
  const worse = info.more_is_better ? 1 - s : s;
  return worse < 0.5
    ? `rgb(43 108 176 / ${(0.55 * (1 - 2 * worse)).toFixed(3)})`
    : `rgb(232 135 30 / ${(0.65 * (2 * worse - 1)).toFixed(3)})`;
}

/** Of the runs of a cell, the one to open: one with a map in the page, near the median. */
function runToOpen(page: Page, runs: Run[]): Run {
  const figure = figureOf(page.data, page.settings.figure);
  const median = spreadOf(runs, figure)?.median ?? 0;
  const middle = Number.isFinite(median) ? median : 0;
  const far = (run: Run) => (sceneOf(page.scenes, run) ? 0 : 1e9) + Math.abs((figure.of(run) ?? 1e6) - middle);
  return [...runs].sort((a, b) => far(a) - far(b))[0];
}

/** "2 diverged, 1 lost, 3 ended at 4.6 to 9.1 s" */
function losses(runs: Run[]): string {
  const ended = runs.flatMap((run) => (run.lost && run.ended_at_s !== null ? [run.ended_at_s] : []));
  const state = (run: Run) => (run.status === "ok" ? "lost" : run.status);
  const bad = runs.filter((run) => run.lost && run.ended_at_s === null);
  const words = distinct(bad, state).map((name) => `${bad.filter((run) => state(run) === name).length} ${name}`);
  if (ended.length > 0) {
    const times = [...new Set([Math.min(...ended), Math.max(...ended)].map((time) => time.toFixed(1)))];
    words.push(`${ended.length} ended at ${times.join(" to ")} s`);
  }
  return words.join(", ");
}

/** " / 0.15 live" beside the final drift of a cell. */
function liveText({ data, settings }: Page, runs: Run[]): string {
  const live = settings.figure === DRIFT ? spreadOf(runs, figureOf(data, LIVE_DRIFT)) : null;
  return live && Number.isFinite(live.median) ? ` / ${shown(live.median)} live` : "";
}

interface MatrixCell {
  runs: Run[];
  spread: ReturnType<typeof spreadOf>;
}

/** The cell that a test over the whole study calls better than every other one in sight; filters that hide runs of a cell hide it. */
function claimedBest({ data, settings }: Page, cells: MatrixCell[]): string | null {
  const all = grouped(data.runs, cellOf);
  const names = cells.map(({ runs }) => cellOf(runs[0]));
  if (names.length < 2 || cells.some(({ runs }) => runs.length !== all.get(cellOf(runs[0]))!.length)) return null;
  const better = data.claims.better[settings.figure] ?? [];
  const beats = (a: string, b: string) => better.some(([i, j]) => data.claims.cells[i] === a && data.claims.cells[j] === b);
  return names.find((name) => names.every((other) => other === name || beats(name, other))) ?? null;
}

function matrixCell(page: Page, { runs, spread }: MatrixCell, values: number[], best: string | null): HTMLElement {
  if (runs.length === 0) return element("td", { className: "none", title: "not tried" });
  const { info } = figureOf(page.data, page.settings.figure);
  const worlds = distinct(page.runs, (run) => run.world);
  const fits = (pattern: string, name: string) => !pattern || pattern === name;
  const published = page.data.reference.find(
    (reference) =>
      worlds.length === 1 &&
      reference.figure === info.key &&
      fits(reference.world, worlds[0]) &&
      fits(reference.sensor, runs[0].sensor) &&
      fits(reference.algorithm, runs[0].algorithm),
  );
  const open = button("", `open a run of ${runs[0].sensor} with ${label(runs[0])}`, () => page.change({ run: runToOpen(page, runs).name }));
  open.append(
    element("span", { className: "value" }, shownShare(spread?.median, spread?.bound) + liveText(page, runs)),
    element(
      "span",
      { className: "range" },
      spread && runs.length > 1 ? `${shown(spread.best)} – ${shown(spread.worst)}` : "",
      element("span", { className: "runs" }, `${keptOf(runs).length} of ${runs.length}`),
    ),
  );
  const bad = losses(runs);
  if (bad) open.append(element("span", { className: "bad" }, `✕ ${bad}`));
  if (published) open.append(element("span", { className: "reference" }, `published ${published.value}`));
  const cell = element("td", { className: (bad ? "failed" : "") + (cellOf(runs[0]) === best ? " best" : "") }, open);
  if (spread) {
    cell.dataset.median = shown(spread.median) === "lost" ? "lost" : String(spread.median);
    if (Number.isFinite(spread.median)) cell.style.backgroundColor = heat(spread.median, values, info);
  }
  cell.dataset.cell = cellOf(runs[0]);
  return cell;
}

/** What the reader must know of the figures in sight: the marks, which maps are means or samples; all but the first words on demand. */
function matrixNote({ data, runs, settings }: Page, best: string | null): HTMLElement {
  const { info } = figureOf(data, settings.figure);
  const means = settings.figure.startsWith("own_map")
    ? distinct(
        keptOf(runs).filter((run) => run.mean_map),
        (run) => run.algorithm,
      )
    : [];
  const sampled = runs.flatMap((run) => (run.sampled?.[info.key] ? [run.sampled[info.key]] : []));
  const rest = data.claims.words[settings.figure] ?? "not tested";
  const most = sampled.sort((a, b) => b[1] - a[1])[0];
  const summary =
    `${info.label}${info.unit ? `, ${info.unit}` : ""}: median, range, runs that kept tracking. Blue is the best median, orange the worst, hatched: ` +
    `runs are lost. ${best ? "Framed: better than every other one" : "None is framed"} (${rest}).`;
  const more =
    "The range is from the best run to the worst; a lost run is the worst of its cell. " +
    `${info.more_is_better ? "Large" : "Small"} is good. ` +
    (best
      ? "The frame is by a test of the paired runs of all worlds (log ratios, ranked within each world), at 5 % after Holm's correction for all figures. "
      : "No combination is shown by the test (at least 16 pairs of runs that share no world and seed, 5 %) to be better than every other one in sight. ") +
    (means.length > 0 ? `The points of the own maps of ${means.join(", ")} are means of several returns, which removes noise. ` : "") +
    (most ? `Of large maps a sample is scored (${most[0]} of ${most[1]} points). ` : "") +
    "A click opens a run; arrow keys move between the cells.";
  return element("details", { className: "note" }, element("summary", {}, summary), more);
}

export function matrix(page: Page): HTMLElement {
  const { data, runs, settings } = page;
  const figure = figureOf(data, settings.figure);
  const { info } = figure;
  const sensors = distinct(runs, (run) => run.sensor);
  const methods = distinct(runs, label);
  const byCell = grouped(runs, cellOf);
  const cells = sensors.map((sensor) =>
    methods.map((method): MatrixCell => {
      const inCell = byCell.get(`${sensor}|${method}`) ?? [];
      return { runs: inCell, spread: spreadOf(inCell, figure) };
    }),
  );
  const tried = cells.flat().filter((cell) => cell.runs.length > 0);
  const values = tried.flatMap(({ spread }) => (spread && Number.isFinite(spread.median) ? [spread.median] : []));
  const best = claimedBest(page, tried);
  const table = element(
    "table",
    {},
    element("thead", {}, element("tr", {}, element("td"), ...methods.map((method) => element("th", { scope: "col" }, method)))),
    element(
      "tbody",
      {},
      ...sensors.map((sensor, i) =>
        element("tr", {}, element("th", { scope: "row" }, sensor), ...cells[i].map((cell) => matrixCell(page, cell, values, best))),
      ),
    ),
  );
  moveByArrows(table);
  const csv = () =>
    saveCsv(`matrix-${info.key}`, [
      ["sensor", "method", `median, ${info.unit}`, "best", "worst", "kept", "runs"],
      ...tried.map(({ runs: same, spread }) => [
        same[0].sensor,
        label(same[0]),
        ...[spread?.median, spread?.best, spread?.worst].map((value) => (value && !Number.isFinite(value) ? "lost" : value)),
        keptOf(same).length,
        same.length,
      ]),
    ]);
  return element(
    "div",
    { className: "matrix", id: "matrix" },
    figureSwitch(page, csv),
    element("div", { className: "scroll" }, table),
    matrixNote(page, best),
  );
}

function figureSwitch({ data, settings, change }: Page, csv: () => void): HTMLElement {
  const others = data.figures.filter(({ key }) => !SWITCH.some(([known]) => known === key));
  const more = element(
    "select",
    { title: "another figure" },
    element("option", { value: "" }, "more …"),
    ...others.map(({ key, label: text }) => element("option", { value: key, selected: key === settings.figure }, text)),
  );
  more.onchange = () => more.value && change({ figure: more.value });
  const buttons = SWITCH.map(([key, text]) => {
    const made = button(text, `show ${text}`, () => change({ figure: key }));
    made.setAttribute("aria-pressed", String(settings.figure === key));
    made.dataset.figure = key;
    return made;
  });
  return element(
    "div",
    { className: "switch" },
    ...buttons,
    more,
    element("div", { className: "save" }, button("CSV", "save as CSV", csv)),
  );
}

// --- the picture

/** The heading of the picture, with a choice of the world where several have maps. */
function pictureHead(page: Page, world: string, worlds: string[]): HTMLElement {
  const choose = element(
    "select",
    { name: "front" },
    ...worlds.map((value) => element("option", { value, selected: value === world }, value)),
  );
  choose.onchange = () => page.change({ front: choose.value });
  return element("h2", {}, "The same place, ", worlds.length > 1 ? choose : world, ": lowest and highest map RMSE");
}

/** The maps with the lowest and the highest RMSE of the chosen world, else of the first that has two; lost runs have the highest. */
export async function bestAndWorst(page: Page): Promise<HTMLElement | null> {
  const map = figureOf(page.data, MAP_RMSE).of;
  const mapped = grouped(
    page.runs.filter((run) => map(run) !== null && sceneOf(page.scenes, run)),
    (run) => run.world,
  );
  const worlds = [...mapped.keys()].filter((world) => mapped.get(world)!.length > 1);
  const world = worlds.includes(page.settings.front) ? page.settings.front : worlds[0];
  if (world !== undefined) {
    const known = mapped.get(world)!;
    const rank = (run: Run) => map(run)! + (run.lost ? 1e9 : 0);
    const sorted = known.sort((a, b) => rank(a) - rank(b));
    const scene = sceneOf(page.scenes, sorted[0])!;
    const [best, worst] = [sorted[0], sorted[sorted.length - 1]];
    const full_m = Math.min(0.2, Math.ceil(2 * map(worst)!) / 100);
    const pictures = await Promise.all([best, worst].map((run) => mapPicture(scene, run, { width: 380, maxHeight: 300, full_m })));
    const box = await commonBox(scene, pictures);
    const figures = [best, worst].map((run, i) => {
      const title = `${["lowest", "highest"][i]}: ${run.sensor}, ${label(run)}: ${shown(map(run))} cm`;
      const svg = pictureSvg({ ...pictures[i], view: { ...pictures[i].view, title, box } });
      const open = button("", `open ${run.name}`, () => page.change({ run: run.name }));
      return drawn(pictures[i].id, svg, open);
    });
    return element(
      "div",
      { className: "seen" },
      pictureHead(page, world, worlds),
      element("div", { className: "pair" }, ...figures),
      colorKey(full_m),
    );
  }
  return null;
}

export function colorKey(full_m = 0.2): HTMLElement {
  return element(
    "p",
    { className: "note" },
    "From above, colored by the mean distance to the mesh: 0 ",
    element("span", { className: "ramp" }),
    ` ${Math.round(100 * full_m)} cm, beyond `,
    element("span", { className: "ramp beyond" }),
    ". Gray: true path, orange: estimated.",
  );
}
