// SPDX-License-Identifier: BSD-3-Clause
// The page of `lidarena check`: findings, and the measurements behind them.
import { element, jsonOf } from "../view/elements";
import { ChartBox } from "./chart_box";
import type { CheckPage, Finding, Spectrum } from "./check_data";
import { count as counted, shown } from "./data";
import { base, legendOf, line, timeAxis, valueAxis, type Figure } from "./figure_parts";
import "../view/view.css";
import "./report.css";

const COLORS = { note: "#64748b", warning: "#b7791f", fault: "#c53030" };
const [BLUE, RED, GREEN] = ["#2b6cb0", "#d1453b", "#2f855a"];
const SIZE = { world: "", width: 1000, height: 250 };

const pairs = (x: number[], y: number[]) => x.map((value, i) => [value, y[i]]);

/** The stretches of findings, shaded. */
function shaded(findings: Finding[]) {
  const areas = findings
    .filter(({ from_s, to_s, severity }) => to_s > from_s && severity !== "note")
    .map(({ from_s, to_s, severity }) => [{ xAxis: from_s, itemStyle: { color: COLORS[severity], opacity: 0.15 } }, { xAxis: to_s }]);
  return { markArea: { silent: true, data: areas } };
}

type Curve = [name: string, color: string, data: number[][]];

function overTime(id: string, title: string, unit: string, caption: string, findings: Finding[], curves: Curve[]): Figure | null {
  const known = curves.filter(([, , data]) => data.length > 0);
  if (known.length === 0) return null;
  return {
    ...SIZE,
    id,
    title,
    caption,
    option: {
      ...base(title),
      legend: legendOf(known.map(([name]) => name)),
      tooltip: { trigger: "axis", confine: true },
      grid: { left: 60, right: 20, top: 50, bottom: 40 },
      xAxis: timeAxis(0),
      yAxis: valueAxis(0, unit, { nameGap: 40 }),
      series: known.map(([name, color, data], i) => line(name, color, data, i === 0 ? shaded(findings) : {})),
    },
  };
}

function spectrum(id: string, title: string, unit: string, of: Spectrum | null): Figure | null {
  if (!of) return null;
  return {
    ...SIZE,
    id,
    title,
    caption:
      "Power spectral density, summed over the axes (Welch's method). Lines are vibration; power that rises towards the right end, half the rate, may be vibration above it that shows at another frequency.",
    option: {
      ...base(title),
      tooltip: { trigger: "axis", confine: true },
      grid: { left: 70, right: 20, top: 40, bottom: 40 },
      xAxis: valueAxis(0, "Hz", { nameGap: 20, min: 0, max: "dataMax" }),
      yAxis: valueAxis(0, unit, { nameGap: 50, type: "log" }),
      series: [line("density", BLUE, pairs(of.frequency_hz, of.density))],
    },
  };
}

function figuresOf({ curves: c, findings, accel_spectrum, gyro_spectrum }: CheckPage): Figure[] {
  const shadedNote = "Shaded: the stretches of the findings.";
  return [
    overTime("rates", "Angular rate", "rad/s", `Size, as the gyroscope and as the registered sweeps show it. ${shadedNote}`, findings, [
      ["gyroscope", BLUE, pairs(c.imu_t_s, c.gyro_rad_s)],
      ["LiDAR", RED, pairs(c.pose_t_s, c.lidar_rate_rad_s)],
    ]),
    overTime("accel", "Specific force", "m/s²", `Size of the accelerometer's samples; 9.8 at rest. ${shadedNote}`, findings, [
      ["accelerometer", BLUE, pairs(c.imu_t_s, c.accel_m_s2)],
    ]),
    overTime("points", "Points of a sweep", "points", shadedNote, findings, [["points", GREEN, pairs(c.sweep_t_s, c.sweep_points)]]),
    overTime("gaps", "Time between sweeps", "s", shadedNote, findings, [["gap", GREEN, pairs(c.sweep_t_s, c.sweep_gap_s).slice(1)]]),
    spectrum("accel-spectrum", "Spectrum of the accelerometer", "(m/s²)²/Hz", accel_spectrum),
    spectrum("gyro-spectrum", "Spectrum of the gyroscope", "(rad/s)²/Hz", gyro_spectrum),
  ].filter((figure): figure is Figure => figure !== null);
}

function findingRow(finding: Finding): HTMLElement {
  const { severity, text, from_s, to_s, remedy, settings } = finding;
  const keys = Object.entries(settings).map(([program, key]) => element("div", {}, `${program}: `, element("code", {}, key)));
  const state = element("td", {}, severity);
  state.style.cssText = `color:${COLORS[severity]};font-weight:600`;
  const when = to_s > from_s ? `${from_s.toFixed(2)} to ${to_s.toFixed(2)} s` : "";
  return element("tr", {}, state, element("td", {}, text), element("td", {}, when), element("td", {}, remedy, ...keys));
}

function table(head: string[], rows: HTMLElement[]): HTMLElement {
  return element(
    "div",
    { className: "scroll" },
    element(
      "table",
      {},
      element("thead", {}, element("tr", {}, ...head.map((name) => element("th", {}, name)))),
      element("tbody", {}, ...rows),
    ),
  );
}

function draw() {
  const data = jsonOf<CheckPage>("data");
  const count = (of: Finding["severity"]) => data.findings.filter(({ severity }) => severity === of).length;
  const topics = data.topics.map((t) =>
    element(
      "tr",
      {},
      ...[t.topic, t.type, t.frame_id, String(t.messages), shown(t.rate_hz), t.is_read ? "yes" : ""].map((text) => element("td", {}, text)),
    ),
  );
  const sensors = `${data.lidar}${data.imu ? ` with the IMU ${data.imu}` : ", without an IMU"}, ${shown(data.seconds)} s`;
  document.body.prepend(
    element(
      "header",
      {},
      element("h1", {}, `Check of ${data.recording}`),
      element(
        "p",
        {},
        `${sensors}: ${["fault" as const, "warning" as const, "note" as const].map((of) => counted(count(of), of)).join(", ")}.`,
      ),
    ),
    element(
      "main",
      {},
      element("section", {}, element("h2", {}, "Findings"), table(["", "what", "when", "remedy"], data.findings.map(findingRow))),
      element("section", {}, element("h2", {}, "Over time"), ...figuresOf(data).map((figure) => new ChartBox(figure).root)),
      topics.length > 0
        ? element("section", {}, element("h2", {}, "Topics"), table(["topic", "type", "frame", "messages", "Hz", "read"], topics))
        : "",
    ),
  );
  document.documentElement.dataset.ready = "1";
}

draw();
