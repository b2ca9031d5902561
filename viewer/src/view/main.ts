// SPDX-License-Identifier: BSD-3-Clause
// Script of the page of `lidarena view`: reads the scene from the page and shows it.
import "./view.css";
import { Panel } from "./panel";
import { blocksFromServer, blocksInPage, type SceneHeader } from "./scene";
import { initialState, readHash } from "./state";
import { View } from "./view";

const root = document.getElementById("view")!;
const marks = document.documentElement.dataset;  // read by tests only

function start() {
  const header = JSON.parse(document.getElementById("scene")!.textContent!) as SceneHeader;
  const stage = root.querySelector<HTMLElement>(".stage")!;
  const view = new View(stage, header);
  const panel = new Panel(view, root, readHash(initialState(header), location.hash), { inAddress: true });
  root.classList.add("live");
  Object.assign(window, { lidarena: { view, panel } });
  const progress = root.querySelector<HTMLElement>(".progress")!;
  const source = document.documentElement.dataset.blocks === "server" ? blocksFromServer() : blocksInPage("block");
  const drawnMs = () => {
    view.finish();
    return String(Math.round(performance.now()));
  };
  const showFrame = view.onFrame;
  view.onFrame = () => {
    showFrame();
    if (view.drawn > 0 || view.clouds.length === 0) marks.firstPictureMs ??= drawnMs();
    marks.drawn = String(view.drawn);
  };
  view.load(source, (share) => {
    progress.style.width = `${100 * share}%`;
    panel.showLayers();
  }).then(() => {
    progress.hidden = true;
    panel.change({ color: panel.state.color });  // also for tracks that were loaded later
    view.render();
    view.onFrame();
    marks.loadedMs = drawnMs();
    marks.ready = "1";
  }).catch(showError);
}

function showError(error: unknown) {
  root.querySelector(".message")!.textContent = `The interactive view could not start: ${error instanceof Error ? error.message : error}`;
  marks.failed = "1";
}

try {
  start();
} catch (error) {
  showError(error);  // without WebGL the picture in the page remains visible
}
