// SPDX-License-Identifier: BSD-3-Clause
// One opened run: its map and paths in 3D, its charts over time with the same time cursor, its figures, files and command.
import { button, element } from "../view/elements";
import { Panel } from "../view/panel";
import { initialState } from "../view/state";
import { View } from "../view/view";
import { ChartBox, type Chart } from "./chart_box";
import {
  cellOf,
  CPU,
  DRIFT,
  figureOf,
  label,
  LIVE_DRIFT,
  MAP_RMSE,
  MEMORY,
  OUTLIERS,
  OWN_OUTLIERS,
  OWN_RMSE,
  shown,
  shownShare,
  type Run,
} from "./data";
import type { Page } from "./overview";
import { runCharts } from "./run_charts";
import { headerOfRuns, mapPicture, pictureSvg, sceneOf } from "./scenes";
import { number, tableElement, word } from "./tables";

const FILES = [
  "metrics.json",
  "resources.json",
  "manifest.json",
  "trajectory.tum",
  "live.tum",
  "map.ply",
  "reprojected.ply",
  "resources.csv",
  "events.csv",
];

const MAIN_FIGURES = [DRIFT, LIVE_DRIFT, OWN_RMSE, MAP_RMSE, OWN_OUTLIERS, OUTLIERS, CPU, MEMORY];

export class RunView {
  readonly root = element("section", { id: "run", className: "run", tabIndex: -1 });
  private boxes: ChartBox[] = [];
  private panel: Panel | null = null;
  private stage = element("div", { className: "map" });
  private charts = element("div", { className: "charts" });
  private marks = document.documentElement.dataset; // read by tests only

  constructor(
    private page: Page,
    readonly run: Run,
  ) {
    this.root.append(this.head(), element("div", { className: "columns" }, this.stage, this.charts), this.about());
    this.show(null).catch((error) => this.stage.append(`The map could not be shown: ${error}`));
  }

  /** Draws the charts that have not come into sight yet, for paper. */
  drawAll() {
    for (const box of this.boxes) box.draw();
  }

  dispose() {
    this.panel?.view.dispose();
    for (const box of this.boxes) box.dispose();
  }

  private head(): HTMLElement {
    const { run, page } = this;
    const others = page.data.runs.filter((other) => cellOf(other) === cellOf(run));
    const choose = element(
      "select",
      { title: "another run of this sensor and method" },
      ...others.map((other) =>
        element("option", { value: other.name, selected: other === run }, `${other.world}, ${other.flight}, seed ${other.seed}`),
      ),
    );
    choose.onchange = () => page.change({ run: choose.value });
    const close = button("Close", "close this run (Escape)", () => page.change({ run: "" }));
    return element(
      "div",
      { className: "head" },
      element("h2", {}, `${run.sensor} with ${label(run)}`),
      choose,
      this.comparison(),
      button("‹", "previous run (Page up)", () => this.step(-1)),
      button("›", "next run (Page down)", () => this.step(1)),
      close,
      element(
        "p",
        { className: run.lost ? "status bad" : "status" },
        run.lost ? `✕ ${run.lost}` : "kept tracking",
        run.statuses
          ? `; scans: ${Object.entries(run.statuses)
              .map(([name, n]) => `${n} ${name}`)
              .join(", ")}`
          : "",
        run.coverage_percent === null ? "" : `; the estimate covers ${shown(run.coverage_percent)} % of the flight`,
      ),
      element("p", { className: "figures-of-run" }, this.mainFigures()),
    );
  }

  /** Opens the run `by` places further in the list of those that pass the filters, if there is one. */
  step(by: number) {
    const { runs, change } = this.page;
    const next = runs[runs.indexOf(this.run) + by];
    if (next) change({ run: next.name });
  }

  private mainFigures(): string {
    const known = MAIN_FIGURES.map((key) => figureOf(this.page.data, key)).filter(({ of }) => of(this.run) !== null);
    const { run } = this;
    const words = known.map(({ info, of }) => {
      const means = run.mean_map && info.key === OWN_RMSE ? " (of means of several returns)" : "";
      const sample = run.sampled?.[info.key];
      const scored = sample ? ` (${sample[0]} of ${sample[1]} points)` : "";
      return `${info.label} ${shownShare(of(run), run.zero_bounds?.[info.key])} ${info.unit}${means}${scored}`;
    });
    return words.join("; ");
  }

  /** Chooses a second run to be shown beside this one. */
  private comparison(): HTMLElement {
    const { run, page } = this;
    const scene = sceneOf(page.scenes, run);
    const others = scene ? page.data.runs.filter((other) => other !== run && sceneOf(page.scenes, other) === scene) : [];
    const choose = element(
      "select",
      { title: "show another map of this world beside this one", hidden: others.length === 0 },
      element("option", { value: "" }, "compare with …"),
      ...others.map((other) =>
        element("option", { value: other.name }, `${other.sensor}, ${label(other)}, ${other.flight}, seed ${other.seed}`),
      ),
    );
    choose.onchange = () => this.show(others.find(({ name }) => name === choose.value) ?? null);
    return choose;
  }

  private async show(other: Run | null) {
    const { run, page } = this;
    const scene = sceneOf(page.scenes, run);
    this.panel?.view.dispose();
    this.panel = null;
    if (this.boxes.length === 0) this.drawCharts();
    if (!scene) {
      this.stage.replaceChildren(
        element("p", { className: "note" }, `The page holds no points of this run; lidarena view ${run.folder} shows them.`),
      );
      return;
    }
    const header = headerOfRuns(scene, other ? [run, other] : [run]);
    const place = element("div", { className: "stage" });
    const root = element("div", { className: `lidarena-view embedded live${header.time ? " timed" : ""}`, tabIndex: 0 }, place);
    this.stage.replaceChildren(root);
    try {
      const view = new View(place, header);
      const dark = matchMedia("(prefers-color-scheme: dark)").matches;
      const state = { ...initialState(header), split: other !== null, dark };
      const panel = new Panel(view, root, state, { ofPage: false, onTime: (time) => this.markTime(time) });
      this.panel = panel;
      await view.load(scene.source, () => panel.showLayers());
      panel.change({ color: panel.state.color });
      this.marks.view = run.name;
    } catch {
      root.remove();
      const picture = await mapPicture(scene, run, { width: 560 }); // without WebGL
      this.stage.innerHTML = pictureSvg(picture);
      this.marks.picture = run.name;
    }
  }

  private drawCharts() {
    const { run, page } = this;
    const sensor = page.data.sensors.find(({ name }) => name === run.sensor);
    this.boxes = runCharts(run, sensor, page.data.event_kinds).map((figure) => new ChartBox(figure, (chart) => this.followMouse(chart)));
    this.charts.replaceChildren(...this.boxes.map((box) => box.root));
    if (this.boxes.length === 0)
      this.charts.replaceChildren(element("p", { className: "note" }, "There are no curves of this run in the page."));
  }

  /** The instant under the mouse is that of the 3D view and of the other charts. */
  private followMouse(chart: Chart) {
    chart.getZr().on("mousemove", ({ offsetX, offsetY }: { offsetX: number; offsetY: number }) => {
      if (!chart.containPixel("grid", [offsetX, offsetY])) return;
      const [t] = chart.convertFromPixel("grid", [offsetX, offsetY]) as number[];
      if (this.panel) this.panel.change({ t });
      else this.markTime(t);
    });
  }

  private markTime(time: number) {
    for (const box of this.boxes) box.markTime(time);
  }

  private about(): HTMLElement {
    const { run, page } = this;
    const rows = page.data.figures.flatMap((figure, i) =>
      run.values[i] === null ? [] : [[word(figure.label), number(run.values[i]), word(figure.unit)]],
    );
    const copy = button("Copy", "copy the command", () => navigator.clipboard?.writeText(run.command));
    return element(
      "div",
      { className: "about" },
      element(
        "details",
        {},
        element("summary", {}, "All figures"),
        tableElement({ id: `figures-${run.name}`, title: run.name, note: "", head: ["figure", "value", "unit"], rows }),
      ),
      element("h3", {}, "The command that makes it again"),
      element("div", { className: "command" }, element("code", {}, run.command), copy),
      element("h3", {}, "Its files"),
      element("p", {}, ...FILES.flatMap((name) => [element("a", { href: `${run.folder}/${name}` }, name), " "])),
    );
  }
}
