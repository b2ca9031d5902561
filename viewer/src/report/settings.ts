// SPDX-License-Identifier: BSD-3-Clause
// What the reader has chosen, kept in the address after "#", so that a view can be sent.
import { distinct, DRIFT, type ReportData, type Run } from "./data";

/** The filters: their labels and the value of a run. */
export const FILTERS = {
  world: (run: Run) => run.world,
  flight: (run: Run) => run.flight,
  sensor: (run: Run) => run.sensor,
  method: (run: Run) => run.algorithm,
  preset: (run: Run) => run.preset || "none",
  seed: (run: Run) => String(run.seed),
};
export type FilterName = keyof typeof FILTERS;
const NAMES = Object.keys(FILTERS) as FilterName[];

export interface Settings {
  filters: Partial<Record<FilterName, string>>; // a name that is missing: all
  figure: string; // key, of the matrix
  run: string; // name of the opened run, or ""
  front: string; // world of which the first screen shows maps; "": the first
  weights: Record<string, number>; // of the criteria of the decision; one that is missing: the default
}

export function readSettings(hash: string, data: ReportData): Settings {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const filters: Settings["filters"] = {};
  for (const name of NAMES) {
    const value = given.get(name);
    if (value !== null && data.runs.some((run) => FILTERS[name](run) === value)) filters[name] = value;
  }
  const figure = data.figures.find(({ key }) => key === given.get("figure"))?.key ?? DRIFT;
  const weights: Settings["weights"] = {};
  for (const { key } of data.decision.criteria) {
    const value = Number(given.get(`weight-${key}`) ?? NaN);
    if (value >= 0) weights[key] = value;
  }
  const front = data.runs.find((run) => run.world === given.get("front"))?.world ?? "";
  return { filters, figure, weights, front, run: data.runs.find((run) => run.name === given.get("run"))?.name ?? "" };
}

export function writeSettings({ filters, figure, run, front, weights }: Settings): string {
  const out = new URLSearchParams(filters as Record<string, string>);
  if (figure !== DRIFT) out.set("figure", figure);
  if (front) out.set("front", front);
  if (run) out.set("run", run);
  for (const [key, weight] of Object.entries(weights)) out.set(`weight-${key}`, String(weight));
  return out.toString();
}

export function passes(run: Run, { filters }: Settings): boolean {
  return NAMES.every((name) => filters[name] === undefined || FILTERS[name](run) === filters[name]);
}

/** The filters that can tell runs apart, with their values. */
export function choices(data: ReportData): [FilterName, string[]][] {
  const all = NAMES.map((name) => [name, distinct(data.runs, FILTERS[name])] as [FilterName, string[]]);
  return all.filter(([, values]) => values.length > 1);
}
