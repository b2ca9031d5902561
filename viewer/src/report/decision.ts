// SPDX-License-Identifier: BSD-3-Clause
// Which LiDAR, which SLAM: for each world the Pareto front, in the order of the reader's weights; what is dominated, and by
// which; what lost track. lidarena/report/decision.hpp finds the front and what a test says of it.
import { element } from "../view/elements";
import { cellOf, count, distinct, DRIFT, label, type Candidate, type Cell } from "./data";
import type { Page } from "./overview";

const weightsOf = ({ data, settings }: Page) => data.decision.criteria.map(({ key, weight }) => settings.weights[key] ?? weight);

/**
 * The weighted mean of the logarithms of each value's ratio to the least one: only the order of the front, never shown. What is
 * not known counts as the largest one.
 */
function scores(candidates: Candidate[], weights: number[]): Map<Candidate, number> {
  const sums = new Map(candidates.map((candidate) => [candidate, 0]));
  weights.forEach((weight, k) => {
    const known = candidates.flatMap(({ values }) => (values[k] ? [values[k]!] : []));
    if (known.length === 0) return;
    const [least, largest] = [Math.min(...known), Math.max(...known)];
    for (const candidate of candidates) {
      const value = candidate.values[k] === 0 ? least : (candidate.values[k] ?? largest);
      sums.set(candidate, sums.get(candidate)! + weight * Math.log(value / least));
    }
  });
  return sums;
}

const name = (candidate: Candidate) => `${candidate.sensor} with ${label(candidate)}`;

function cellElement({ text, live, spread }: Cell): HTMLElement {
  return element("td", {}, (text || "–") + (live ? ` / ${live} live` : ""), spread ? element("span", { className: "range" }, spread) : "");
}

/** The columns of the table: the names, the criteria, and the own map among them. */
function columns({ data }: Page): string[] {
  const heads = data.decision.criteria.map(({ label: text, unit }) => (unit ? `${text}, ${unit}` : text));
  return ["", ...heads.slice(0, 2), "own map RMSE, cm", ...heads.slice(2)];
}

function row(candidate: Candidate): HTMLElement {
  return element(
    "tr",
    {},
    element("th", { scope: "row" }, name(candidate), element("span", { className: "range" }, candidate.verdict)),
    ...candidate.cells.slice(0, 2).map(cellElement),
    cellElement(candidate.own_map),
    ...candidate.cells.slice(2).map(cellElement),
  );
}

function list(title: string, lines: string[]): HTMLElement | string {
  if (lines.length === 0) return "";
  return element(
    "details",
    { className: "changes" },
    element("summary", {}, title),
    element("ul", {}, ...lines.map((line) => element("li", {}, line))),
  );
}

function ofWorld(page: Page, world: string): HTMLElement {
  const cells = new Set(page.runs.filter((run) => run.world === world).map(cellOf));
  const tried = page.data.decision.candidates.filter((candidate) => candidate.world === world && cells.has(cellOf(candidate)));
  const score = scores(
    tried.filter(({ on_front }) => on_front),
    weightsOf(page),
  );
  const front = [...score.keys()].sort((a, b) => score.get(a)! - score.get(b)!);
  const dominated = tried.filter((candidate) => !candidate.on_front && candidate.kept === candidate.runs);
  const lost = tried.filter((candidate) => candidate.kept < candidate.runs);
  const words =
    front.length === 0
      ? "no combination that keeps tracking in every run is in sight"
      : `${front.length} of ${count(tried.length, "combination")} on the Pareto front`;
  const head = element(
    "th",
    { scope: "rowgroup", colSpan: columns(page).length },
    element("b", {}, `${world}: `),
    words,
    list(
      `Dominated: ${dominated.length}`,
      dominated.map((candidate) => `${name(candidate)}, by ${candidate.dominated_by}`),
    ),
    list(
      `Lost track in some run: ${lost.length}`,
      lost.map((candidate) => `${name(candidate)}: ${candidate.verdict}`),
    ),
  );
  return element("tbody", { className: "verdict" }, element("tr", { className: "world" }, head), ...front.map(row));
}

/** One number for each criterion, kept in the address. */
function weightsForm(page: Page): HTMLElement {
  const weights = weightsOf(page);
  const fields = page.data.decision.criteria.map(({ key, label: text, weight }, k) => {
    const input = element("input", { type: "number", min: "0", max: "99", step: "0.5", value: String(weights[k]), name: `weight-${key}` });
    input.title = `weight of ${text}, ${weight} by default`;
    input.onchange = () => {
      page.change({ weights: { ...page.settings.weights, [key]: Math.max(0, Number(input.value) || 0) } });
    };
    return element("label", {}, text, input);
  });
  return element("form", { className: "filters weights", onsubmit: () => false }, "Weights: ", ...fields);
}

export function decision(page: Page): HTMLElement {
  const worlds = distinct(page.runs, (run) => run.world);
  const { criteria } = page.data.decision;
  const all =
    page.runs.length === page.data.runs.length ? "" : " The figures are those of all runs of the study; filters choose combinations.";
  return element(
    "div",
    { className: "answer", id: "decision" },
    element("h2", {}, "Which LiDAR, which SLAM"),
    weightsForm(page),
    element(
      "div",
      { className: "verdicts", tabIndex: 0 },
      element(
        "table",
        { className: "front" },
        element("thead", {}, element("tr", {}, ...columns(page).map((text) => element("th", { scope: "col" }, text)))),
        ...worlds.map((world) => ofWorld(page, world)),
      ),
    ),
    element(
      "details",
      { className: "note" },
      element(
        "summary",
        {},
        `Medians, their range, and the runs that kept tracking; a test of the drift: ${page.data.claims.words[DRIFT]}.`,
      ),
      `On the front is what keeps tracking in every run and is not dominated: no other is as good in all of ${criteria.map(({ label: text }) => text).join(", ")} ` +
        "and better in one, in the medians over flights and seeds; what a test says of them stands with what is dominated. Map: of sampled returns. " +
        `The weights order the front by the mean logarithm of the ratios to the best (default ${criteria.map(({ label: text, weight }) => `${text} ${weight}`).join(", ")}); that order is a taste, not a test. ` +
        "A price counts by the number in it. Real time: at most 5 % of the scans take more CPU time than their period on one core (in paced runs: more time by the clock)." +
        all,
    ),
  );
}
