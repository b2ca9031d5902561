// SPDX-License-Identifier: BSD-3-Clause
// Script of the page of `lidarena view`: reads the scene from the page and shows it.
import "./view.css";
import { element } from "./elements";
import { Panel } from "./panel";
import { scenePicture } from "./picture";
import { blocksFromServer, blocksInPage, type SceneHeader } from "./scene";
import { initialState, readHash } from "./state";
import { View } from "./view";

const header = JSON.parse(document.getElementById("scene-0")!.textContent!) as SceneHeader;
const stage = element("div", { className: "stage" });
const progress = element("div", { className: "progress" });
const root = element("div", { id: "view", className: `lidarena-view page${header.time ? " timed" : ""}` }, stage, progress);
document.body.prepend(root);
const marks = document.documentElement.dataset; // read by tests only
const source = () => (document.documentElement.dataset.blocks === "server" ? blocksFromServer() : blocksInPage("block-0"));

function start() {
  const view = new View(stage, header);
  const panel = new Panel(view, root, readHash(initialState(header), location.hash), { ofPage: true });
  root.classList.add("live");
  Object.assign(window, { lidarena: { view, panel } });
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
  view
    .load(source(), (share) => {
      progress.style.width = `${100 * share}%`;
      panel.showLayers();
    })
    .then(() => {
      progress.hidden = true;
      panel.change({ color: panel.state.color }); // also for tracks that were loaded later
      view.render();
      view.onFrame();
      marks.loadedMs = drawnMs();
      marks.ready = "1";
    })
    .catch(showError);
}

async function showError(error: unknown) {
  const fallback = element(
    "div",
    { className: "fallback" },
    element("h1", {}, header.title),
    element("p", { className: "message" }, `The interactive view could not start: ${error instanceof Error ? error.message : error}`),
  );
  root.append(fallback);
  root.classList.remove("live");
  fallback.insertAdjacentHTML("beforeend", await scenePicture(header, source()));
  marks.failed = "1";
}

try {
  start();
} catch (error) {
  showError(error); // without WebGL the picture from above is shown
}
