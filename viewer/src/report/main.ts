// SPDX-License-Identifier: BSD-3-Clause
// Script of the report page: draws the charts and the 3D views into their elements of the page and
// marks the instant of a 3D view's time line in the charts.
import "../view/view.css";
import "./report.css";
import { Panel } from "../view/panel";
import { blocksInPage, type SceneHeader } from "../view/scene";
import { initialState } from "../view/state";
import { View } from "../view/view";
import { echarts } from "./charts";
import type { Figure, ReportData } from "./data";
import { figuresOf } from "./figures_of";

const marks = document.documentElement.dataset;  // read by tests only
type Chart = ReturnType<typeof echarts.init>;
const overTime: { chart: Chart; figure: Figure; world: string }[] = [];

function jsonOf<T>(id: string): T | null {
  const element = document.getElementById(id);
  return element ? (JSON.parse(element.textContent!) as T) : null;
}

function drawFigures(data: ReportData) {
  let drawn = 0;
  for (const figure of figuresOf(data)) {
    const world = data.worlds.find((w) => figure.id.endsWith(`-${w}`) || figure.id.endsWith(`-${w}-all-returns`));
    const home = document.getElementById(world ? `figures-${world}` : "figures");
    if (!home) continue;
    const place = document.createElement("figure");
    const canvas = document.createElement("div");
    const caption = document.createElement("figcaption");
    caption.textContent = figure.caption;
    place.id = figure.id;
    place.append(canvas, caption);
    home.append(place);
    const chart = echarts.init(canvas, null, { renderer: "svg", width: figure.width, height: figure.height });
    chart.setOption(figure.option);
    if (figure.overTime && world) overTime.push({ chart, figure, world });
    drawn += 1;
  }
  marks.figures = String(drawn);
}

/** Draws a line at `time` in every chart over time of a world. */
function markTime(world: string, time: number) {
  for (const entry of overTime) {
    if (entry.world !== world) continue;
    const series = entry.figure.option.series as { xAxisIndex: number }[];
    const seen = new Set<number>();
    entry.chart.setOption({
      series: series.map(({ xAxisIndex }) => {
        if (seen.has(xAxisIndex)) return {};
        seen.add(xAxisIndex);
        return { markLine: { symbol: "none", silent: true, animation: false, label: { show: false },
          lineStyle: { color: "#1c2430", type: "solid", width: 1 }, data: [{ xAxis: time }] } };
      }),
    });
  }
}

/** Adds a button that starts the 3D view of a world: starting all views at once would be slow. */
function prepareView(world: string) {
  const root = document.getElementById(`view-${world}`);
  const header = jsonOf<SceneHeader>(`scene-${world}`);
  if (!root || !header) return;
  const start = document.createElement("button");
  start.type = "button";
  start.className = "start";
  start.textContent = "Show the interactive 3D view instead of this picture";
  start.onclick = () => {
    start.remove();
    try {
      showView(world, root, header);
    } catch (error) {
      root.classList.remove("open", "live");  // shows the pictures again
      root.querySelector(".message")!.textContent = `The interactive view could not start: ${error}`;
    }
  };
  root.before(start);
  if (location.hash === `#view-${world}`) start.click();
}

function showView(world: string, root: HTMLElement, header: SceneHeader) {
  root.classList.add("open", "live");  // first, because the view reads the size of its element
  const view = new View(root.querySelector<HTMLElement>(".stage")!, header);
  const state = { ...initialState(header), split: header.clouds.length > 1 };
  const panel = new Panel(view, root, state, { inAddress: false, onTime: (time) => markTime(world, time) });
  view.load(blocksInPage(`block-${world}`), () => panel.showLayers()).then(() => {
    panel.change({ color: panel.state.color });
    marks.view = world;
  });
}

const data = jsonOf<ReportData>("data");
if (data) {
  drawFigures(data);
  for (const world of data.worlds) prepareView(world);
  marks.ready = "1";
}
