// SPDX-License-Identifier: BSD-3-Clause
// The first screen: what was compared, which combination to use and what would change that, the figures of all
// combinations, and the same place as the best and the worst of them map it.
import { button, element } from "../view/elements";
import {
  cellOf,
  count,
  distinct,
  DRIFT,
  figureOf,
  grouped,
  label,
  LATENCY,
  MAP_RMSE,
  MEMORY,
  OUTLIERS,
  REAL_TIME,
  shown,
  spreadOf,
  type Candidate,
  type FigureInfo,
  type ReportData,
  type Run,
  type Sensor,
  type Spread,
} from "./data";
import { drawn, saveCsv } from "./save";
import { commonBox, mapPicture, pictureSvg, sceneOf, type WorldScene } from "./scenes";
import type { Settings } from "./settings";

const SWITCH: [string, string][] = [
  [DRIFT, "drift"],
  [MAP_RMSE, "map RMSE"],
  [OUTLIERS, "outliers"],
  [REAL_TIME, "CPU"],
  [MEMORY, "memory"],
];
const SIMILAR = 1.1; // ratio below which two map errors count as equal
const MAX_REASONS = 3;

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
  const good = runs.filter((run) => run.status === "ok").length;
  return (
    `${count(sensors.length, "LiDAR")}${names(sensors)} with ${count(methods.length, "SLAM method")} in ` +
    `${count(worlds.length, "world")}${names(worlds)}, ${count(flights, "flight")}, ${count(seeds, "seed")}: ` +
    `${good} of ${count(runs.length, "run")} succeeded.`
  );
}

// --- the answer

function factsOf(sensor: Sensor | undefined): string {
  const { weight_kg, power_max_w, price } = sensor?.facts ?? {};
  const words = [weight_kg ? `${weight_kg} kg` : "", power_max_w ? `up to ${power_max_w} W` : "", price ?? ""].filter((word) => word);
  return words.length > 0 ? ` (${words.join(", ")})` : "";
}

interface Tried {
  candidate: Candidate;
  runs: Run[];
  map: Spread | null;
}

const range = ({ min, max, n }: Spread) => (n > 1 ? ` (${shown(min)} – ${shown(max)} in ${n} runs)` : "");
const overlap = (a: Spread, b: Spread) => a.n > 1 && b.n > 1 && a.min <= b.max && b.min <= a.max;

class Answer {
  private tried: Tried[];
  constructor(
    private page: Page,
    private world: string,
  ) {
    const { data, runs } = page;
    const map = figureOf(data, MAP_RMSE).of;
    const cells = grouped(
      runs.filter((run) => run.world === world),
      cellOf,
    );
    this.tried = data.decision
      .filter((candidate) => candidate.world === world)
      .map((candidate) => ({ candidate, runs: cells.get(cellOf(candidate)) ?? [] }))
      .filter((tried) => tried.runs.length > 0)
      .map((tried) => ({ ...tried, map: spreadOf(tried.runs, map) }));
  }

  element(): HTMLElement {
    const best = this.tried[0];
    const head = (text: string) => element("p", { className: "verdict" }, element("b", {}, `${this.world}: `), text);
    if (!best) return head("no run passes the filters.");
    if (!this.tried.some(({ map }) => map)) return head("no run has a scored map.");
    if (!best.candidate.usable) {
      return head(
        `nothing that was tried keeps tracking in real time. Closest is ${this.name(best)} (${best.candidate.verdict}): ${this.figures(best)}.`,
      );
    }
    const use = head("use the ");
    use.append(
      element("b", {}, best.candidate.sensor),
      this.facts(best),
      " with ",
      element("b", {}, label(best.candidate)),
      `: ${this.figures(best)}.`,
    );
    return element("div", {}, use, element("ul", { className: "changes" }, ...this.changes(best).map((text) => element("li", {}, text))));
  }

  private name = ({ candidate }: Tried) => `${candidate.sensor} with ${label(candidate)}`;
  private facts = ({ candidate }: Tried) => factsOf(this.page.data.sensors.find(({ name }) => name === candidate.sensor));

  private period({ candidate, runs }: Tried): number | null {
    const latency = spreadOf(runs, figureOf(this.page.data, LATENCY).of);
    const lidar = this.page.data.sensors.find(({ name }) => name === candidate.sensor)?.lidar;
    return latency && lidar ? 0.1 * latency.median * lidar.rate_hz : null;
  }

  private figures(tried: Tried): string {
    const { data } = this.page;
    const drift = spreadOf(tried.runs, figureOf(data, DRIFT).of);
    const memory = spreadOf(tried.runs, figureOf(data, MEMORY).of);
    const good = tried.runs.filter((run) => run.status === "ok").length;
    return [
      tried.map ? `map RMSE ${shown(tried.map.median)} cm${range(tried.map)}` : "",
      drift ? `drift ${shown(drift.median)} cm per m${range(drift)}` : "",
      this.period(tried) === null ? "" : `95 % of the scans within ${this.period(tried)!.toFixed(0)} % of their period`,
      memory ? `${shown(memory.median)} MB` : "",
      `tracking kept in ${good} of ${count(tried.runs.length, "run")}`,
    ]
      .filter((text) => text)
      .join("; ");
  }

  /** What would make another choice right. */
  private changes(best: Tried): string[] {
    const usable = this.tried.filter((tried) => tried.candidate.usable);
    const reasons: string[] = [];
    const times = (tried: Tried) => (best.map && tried.map && best.map.median > 0 ? tried.map.median / best.map.median : NaN);
    const error = (tried: Tried) => `${shown(times(tried))} times the map RMSE (${shown(tried.map?.median)} cm)`;
    const next = usable[1];
    if (next?.map && best.map && overlap(next.map, best.map)) {
      reasons.push(`${this.name(next)} lies within its spread over runs: more seeds would tell them apart.`);
    } else if (next) {
      const close = times(next) < SIMILAR ? "about the same map error, so that weight, price and computing time decide" : error(next);
      reasons.push(`Next is ${this.name(next)}: ${close}.`);
    }
    for (const sensor of distinct(this.tried, (tried) => tried.candidate.sensor).filter((name) => name !== best.candidate.sensor)) {
      const other = usable.find((tried) => tried.candidate.sensor === sensor);
      const any = this.tried.find((tried) => tried.candidate.sensor === sensor)!;
      if (other && other === next) continue;
      reasons.push(
        other
          ? `With the ${sensor}${this.facts(other)}: ${label(other.candidate)}, ${error(other)}.`
          : `With the ${sensor}${this.facts(any)} no method keeps tracking in real time.`,
      );
    }
    const slow = this.tried.find((tried) => tried.candidate.verdict.startsWith("too slow") && times(tried) < 1);
    if (slow)
      reasons.push(`On a machine ${shown(this.period(slow)! / 100)} times as fast, ${this.name(slow)} would be better: ${error(slow)}.`);
    return reasons.slice(0, MAX_REASONS);
  }
}

export function answer(page: Page): HTMLElement {
  const worlds = distinct(page.runs, (run) => run.world);
  const single = distinct(page.runs, (run) => `${run.world}|${cellOf(run)}`).length === page.runs.length;
  return element(
    "div",
    { className: "answer" },
    element("h2", {}, "Which LiDAR, which SLAM"),
    element(
      "div",
      { className: "verdicts" },
      ...worlds.map((world) => new Answer(page, world).element()),
      element(
        "p",
        { className: "note" },
        "Usable is what keeps tracking in every run (less than half of the map beyond 20 cm) and processes 95 % of the scans " +
          "within their period, over all flights and seeds; of that, the lowest map RMSE." +
          (single ? " One run each: how much these figures vary over seeds is not known." : ""),
      ),
    ),
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
  const { of } = figureOf(page.data, page.settings.figure);
  const middle = spreadOf(runs, of)?.median ?? 0;
  const far = (run: Run) => (sceneOf(page.scenes, run) ? 0 : 1e9) + Math.abs((of(run) ?? 1e6) - middle);
  return [...runs].sort((a, b) => far(a) - far(b))[0];
}

function failures(runs: Run[]): string {
  const bad = runs.filter((run) => run.status !== "ok");
  return distinct(bad, (run) => run.status)
    .map((status) => `${bad.filter((run) => run.status === status).length} ${status}`)
    .join(", ");
}

export function matrix(page: Page): HTMLElement {
  const { data, runs, settings } = page;
  const { info, of } = figureOf(data, settings.figure);
  const worlds = distinct(runs, (run) => run.world);
  const sensors = distinct(runs, (run) => run.sensor);
  const methods = distinct(runs, label);
  const byCell = grouped(runs, cellOf);
  const cells = sensors.map((sensor) =>
    methods.map((method) => {
      const inCell = byCell.get(`${sensor}|${method}`) ?? [];
      return { inCell, spread: spreadOf(inCell, of) };
    }),
  );
  const values = cells.flat().flatMap(({ spread }) => spread?.median ?? []);
  const best = info.more_is_better ? Math.max(...values) : Math.min(...values);
  const cellElement = ({ inCell, spread }: (typeof cells)[0][0]) => {
    if (inCell.length === 0) return element("td", { className: "none", title: "not tried" });
    const published =
      worlds.length === 1 &&
      data.reference.find(
        (reference) =>
          reference.figure === info.key &&
          [
            [reference.world, worlds[0]],
            [reference.sensor, inCell[0].sensor],
            [reference.algorithm, inCell[0].algorithm],
          ].every(([a, b]) => !a || a === b),
      );
    const bad = failures(inCell);
    const good = inCell.length - inCell.filter((run) => run.status !== "ok").length;
    const open = button("", `open a run of ${inCell[0].sensor} with ${label(inCell[0])}`, () =>
      page.change({ run: runToOpen(page, inCell).name }),
    );
    open.append(
      element("span", { className: "value" }, spread ? shown(spread.median) : bad ? "✕" : "–"),
      element(
        "span",
        { className: "range" },
        spread && spread.n > 1 ? `${shown(spread.min)} – ${shown(spread.max)}` : "",
        element("span", { className: "runs" }, `${good} of ${inCell.length}`),
      ),
    );
    if (bad) open.append(element("span", { className: "bad" }, `✕ ${bad}`));
    if (published) open.append(element("span", { className: "reference" }, `published ${published.value}`));
    const cell = element("td", { className: (bad ? "failed" : "") + (spread?.median === best ? " best" : "") }, open);
    if (spread) {
      cell.dataset.median = String(spread.median);
      cell.style.backgroundColor = heat(spread.median, values, info);
    }
    cell.dataset.cell = cellOf(inCell[0]);
    return cell;
  };
  const table = element(
    "table",
    {},
    element("thead", {}, element("tr", {}, element("td"), ...methods.map((method) => element("th", { scope: "col" }, method)))),
    element(
      "tbody",
      {},
      ...sensors.map((sensor, i) =>
        element("tr", {}, element("th", { scope: "row" }, sensor), ...cells[i].map((cell) => cellElement(cell))),
      ),
    ),
  );
  const csv = () =>
    saveCsv(`matrix-${info.key}`, [
      ["sensor", "method", `median, ${info.unit}`, "min", "max", "succeeded", "runs"],
      ...cells
        .flat()
        .filter(({ inCell }) => inCell.length > 0)
        .map(({ inCell, spread }) => [
          inCell[0].sensor,
          label(inCell[0]),
          spread?.median,
          spread?.min,
          spread?.max,
          inCell.filter((run) => run.status === "ok").length,
          inCell.length,
        ]),
    ]);
  return element(
    "div",
    { className: "matrix", id: "matrix" },
    figureSwitch(page, csv),
    element("div", { className: "scroll" }, table),
    element(
      "p",
      { className: "note" },
      `${info.label}${info.unit ? `, ${info.unit}` : ""}: median, range, and how many runs succeeded; ` +
        `${info.more_is_better ? "large" : "small"} is good: blue is the best, orange the worst, framed the very best; hatched: runs failed. A click opens a run.`,
    ),
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

/** The maps with the lowest and the highest RMSE of the first world that has two. */
export async function bestAndWorst(page: Page): Promise<HTMLElement | null> {
  const map = figureOf(page.data, MAP_RMSE).of;
  for (const world of distinct(page.runs, (run) => run.world)) {
    const known = page.runs.filter((run) => run.world === world && map(run) !== null && sceneOf(page.scenes, run));
    if (known.length < 2) continue;
    const sorted = [...known].sort((a, b) => map(a)! - map(b)!);
    const scene = sceneOf(page.scenes, sorted[0])!;
    const [best, worst] = [sorted[0], sorted[sorted.length - 1]];
    const full_m = Math.min(0.2, Math.ceil(2 * map(worst)!) / 100);
    const pictures = await Promise.all([best, worst].map((run) => mapPicture(scene, run, { width: 380, maxHeight: 300, full_m })));
    const box = await commonBox(scene, pictures);
    const figures = [best, worst].map((run, i) => {
      const title = `${["best", "worst"][i]}: ${run.sensor}, ${label(run)}: ${shown(map(run))} cm`;
      const svg = pictureSvg({ ...pictures[i], view: { ...pictures[i].view, title, box } });
      const open = button("", `open ${run.name}`, () => page.change({ run: run.name }));
      return drawn(pictures[i].id, svg, open);
    });
    return element(
      "div",
      { className: "seen" },
      element("h2", {}, `The same place, ${world}, as the best and the worst map it`),
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
