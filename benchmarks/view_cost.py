#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the cost of `lidarena view` for a map of many points, in a headless Chromium with software rendering.
usage: view_cost.py LIDARENA [--million 20] [--png FILE] [--keep FOLDER]

Software rendering (SwiftShader) is the slowest case: any graphics card is faster. The browser is started
before the program, as is usual for a user. Needs NumPy and chromium. Fails if the page reports an error.
"""
import argparse
import base64
import contextlib
import json
import os
import pathlib
import select
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

import numpy as np

BUDGETS = {"picture_s": 3.0, "loaded_s": 15.0, "browser_MB": 2000.0}
LIMIT_S = 600.0
CHUNK = 1_000_000
CHROMIUM = [
    "chromium", "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--hide-scrollbars", "--window-size=1280,800",
    "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-default-apps",
    "--disable-sync", "--remote-debugging-pipe",
]  # fmt: skip

# Draws all loaded points in one picture, regardless of the time that takes.
DRAW_ALL = """(() => {
  const { view, panel } = window.lidarena;
  const loaded = view.clouds.reduce((sum, cloud) => sum + cloud.loaded, 0);
  panel.change({ budget: loaded });
  const gl = view.renderer.getContext();
  view.finish();
  const begin = performance.now();
  view.render();
  view.finish();
  const frame_s = (performance.now() - begin) / 1000;
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = new Uint32Array(width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(pixels.buffer));
  const covered = pixels.filter((pixel) => pixel !== pixels[0]).length / pixels.length;
  return { loaded, drawn: view.drawn, frame_s, covered };
})()"""


class Failure(Exception):
    pass


def write_map(file, points):
    """Writes hills of 200 x 200 m with 36 houses as a binary PCD; the same bytes each time."""
    header = (
        "VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
        f"WIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA binary\n"
    )
    with file.open("wb") as out:
        out.write(header.encode())
        for begin in range(0, points, CHUNK):
            out.write(some_points(np.random.default_rng([1, begin]), min(CHUNK, points - begin)).tobytes())


def some_points(random, count):
    """Rows of x, y, z, intensity: three fifths on the ground, the others on walls."""
    x, y = random.uniform(-100, 100, (2, count))
    walls = random.random(count) < 0.4
    house = random.integers(0, 6, (2, count)) * 32 - 80
    along, side = random.uniform(-6, 6, count), random.integers(0, 4, count)
    x = np.where(walls, house[0] + np.choose(side, [along, along, -6, 6]), x)
    y = np.where(walls, house[1] + np.choose(side, [-6, 6, along, along]), y)
    up = np.where(walls, random.uniform(0, 7, count), 0)
    z = 3 * np.sin(x / 23) * np.cos(y / 31) + up
    window = walls & (abs(along) % 3 > 1.8) & (up % 3.5 > 1.2) & (up % 3.5 < 2.8)
    intensity = np.where(window, 10, np.where(walls, 180, 60 + 30 * np.sin(x / 5) * np.sin(y / 7)))
    noise = random.normal(0, 0.01, (3, count))
    return np.column_stack([x + noise[0], y + noise[1], z + noise[2], intensity]).astype("<f4")


class Memory(threading.Thread):
    """Peak memory of all processes of a session; shared pages are divided by their users (PSS)."""

    def __init__(self, leader):
        super().__init__(daemon=True)
        self.leader, self.peak_MB, self.over = leader, 0.0, threading.Event()
        self.start()

    def run(self):
        while not self.over.wait(0.2):
            self.peak_MB = max(self.peak_MB, self.now_MB())

    def now_MB(self):
        return sum(self.pss_kB(pid) for pid in os.listdir("/proc") if pid.isdigit()) * 1024e-6

    def pss_kB(self, pid):
        try:
            if os.getsid(int(pid)) != self.leader:
                return 0
            rows = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
            return next(int(row.split()[1]) for row in rows if row.startswith("Pss:"))
        except (OSError, StopIteration):  # the process has ended
            return 0


@contextlib.contextmanager
def started(command, **options):
    """A process in its own session, terminated at the end of the block."""
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, start_new_session=True, **options)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()


class Page:
    """One page of a browser, controlled by the DevTools protocol over two pipes."""

    def __init__(self, commands, answers):
        self.commands, self.answers = commands, answers
        self.rest, self.calls, self.session, self.errors = b"", 0, None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        self.calls += 1
        message = {"id": self.calls, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + LIMIT_S
        while True:
            answer = self.next_message(deadline)
            if answer.get("id") != self.calls:
                self.note(answer)
            elif "error" in answer:
                raise Failure(f"{method}: {answer['error']['message']}")
            else:
                return answer["result"]

    def next_message(self, deadline):
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.answers], [], [], max(0, deadline - time.monotonic()))
            data = os.read(self.answers, 1 << 20) if ready else b""
            if not data:
                raise Failure("the browser has exited" if ready else "the browser does not respond")
            self.rest += data
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def note(self, event):
        """Stores error messages of the console."""
        told = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif event.get("method") == "Runtime.consoleAPICalled" and told["type"] == "error":
            self.errors.append(" ".join(str(arg.get("value", "")) for arg in told["args"]))
        elif event.get("method") == "Log.entryAdded" and told["entry"]["level"] == "error":
            self.errors.append(told["entry"]["text"])
        elif event.get("method") == "Inspector.targetCrashed":
            raise Failure("the page has crashed")

    def value(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in answer:
            raise Failure(answer["exceptionDetails"]["exception"]["description"])
        return answer["result"].get("value")


@contextlib.contextmanager
def browser(folder):
    """Starts a headless Chromium; yields its process and a blank page."""
    command_out, command_in = os.pipe()
    answer_out, answer_in = os.pipe()
    redirected = f'exec "$0" "$@" 3<&{command_out} 4>&{answer_in}'
    command = ["bash", "-c", redirected, *CHROMIUM, f"--user-data-dir={folder / 'profile'}"]
    with (folder / "chromium.log").open("w") as log:
        with started(command, pass_fds=(command_out, answer_in), stdout=log, stderr=log) as process:
            os.close(command_out)
            os.close(answer_in)
            yield process, Page(command_in, answer_out)


def address_of(server):
    """The address that the program prints when it accepts connections."""
    told = ""
    for line in server.stdout:
        told += line
        with contextlib.suppress(json.JSONDecodeError):
            return json.loads(told)["address"]
    raise Failure(f"lidarena view ended before printing its address: {told}")


def wait_until_ready(page):
    """Waits until everything is loaded; returns the page's time marks, taken by its own clock."""
    deadline = time.monotonic() + LIMIT_S
    while time.monotonic() < deadline:
        marks = page.value("({ ...document.documentElement?.dataset, origin: performance.timeOrigin })")
        if "failed" in marks:
            raise Failure(page.value("document.querySelector('.message').textContent"))
        if "ready" in marks:
            return marks
        time.sleep(0.2)
    raise Failure("the page does not become ready")


def measure(lidarena, cloud, points, folder, png):
    with browser(folder) as (chromium, page):
        time.sleep(3)  # until the browser is idle
        browser_memory = Memory(chromium.pid)
        empty_MB = browser_memory.now_MB()
        begin = time.time()
        view = [lidarena, "view", "--json", str(cloud), "--points", str(points / 1e6)]
        with started(view, stdout=subprocess.PIPE, text=True) as server:
            program_memory = Memory(server.pid)
            address = address_of(server)
            urllib.request.urlopen(address).read()
            answers_s = time.time() - begin
            page.call("Page.navigate", url=address)
            marks = wait_until_ready(page)
            time.sleep(1)  # until the memory peak has been sampled
            loaded_MB = browser_memory.peak_MB
            drawn = page.value(DRAW_ALL)
            if png:
                shot = page.call("Page.captureScreenshot", format="png")["data"]
                png.write_bytes(base64.b64decode(shot))
            browser_memory.over.set()
            program_memory.over.set()
    if page.errors:
        raise Failure("errors in the console:\n" + "\n".join(page.errors))
    if drawn["drawn"] != points or not drawn["covered"] > 0:
        raise Failure(f"not all points are drawn: {drawn}")
    opened_s = marks["origin"] / 1000 - begin
    return {
        "answers_s": answers_s,
        "opened_s": opened_s,
        "picture_s": float(marks["firstPictureMs"]) / 1000,
        "loaded_s": float(marks["loadedMs"]) / 1000,
        "frame_s": drawn["frame_s"],
        "shown": int(marks["drawn"]),
        "covered": drawn["covered"],
        "empty_MB": empty_MB,
        "loaded_MB": loaded_MB,
        "browser_MB": browser_memory.peak_MB,
        "program_MB": program_memory.peak_MB,
    }


def report(points, file_MB, cost):
    def line(what, value, unit, budget=None):
        verdict = ""
        if budget is not None:
            verdict = f"   budget {budget:g} {unit}: " + ("kept" if value <= budget else "MISSED")
        print(f"  {what:58}{value:8.{2 if unit == 's' else 0}f} {unit}{verdict}")

    opened = cost["opened_s"]
    print(f"{points:,} points in a file of {file_MB:.0f} MB; software rendering on {os.cpu_count()} cores")
    line("program responds, after its start", cost["answers_s"], "s")
    line("first picture, after the page is opened", cost["picture_s"], "s", BUDGETS["picture_s"])
    line("first picture, after the program's start", opened + cost["picture_s"], "s")
    line(f"all loaded and {cost['shown']:,} drawn, after the page is opened", cost["loaded_s"], "s")
    line("the same, after the program's start", opened + cost["loaded_s"], "s", BUDGETS["loaded_s"])
    line("one picture of all points", cost["frame_s"], "s")
    line("peak memory of the browser, all its processes", cost["browser_MB"], "MB", BUDGETS["browser_MB"])
    line("  before the picture of all points", cost["loaded_MB"], "MB")
    line("  with an empty page", cost["empty_MB"], "MB")
    line("peak memory of the program", cost["program_MB"], "MB")
    print(f"  {100 * cost['covered']:.0f} % of the picture is covered; no errors in the console")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lidarena", help="path of the program lidarena")
    parser.add_argument("--million", type=float, default=20, help="number of points, in millions")
    parser.add_argument("--png", type=pathlib.Path, help="file in which to save the picture of all points")
    parser.add_argument("--keep", type=pathlib.Path, help="folder in which to keep the map and the browser's log")
    given = parser.parse_args()
    if not shutil.which(CHROMIUM[0]):
        sys.exit("view_cost: chromium was not found; install it")
    points = round(given.million * 1e6)
    with contextlib.ExitStack() as stack:
        folder = given.keep or pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        folder.mkdir(parents=True, exist_ok=True)
        cloud = folder / "map.pcd"
        write_map(cloud, points)
        try:
            cost = measure(shutil.which(given.lidarena), cloud, points, folder, given.png)
        except Failure as failure:
            sys.exit(f"view_cost: {failure}")
        report(points, cloud.stat().st_size / 1e6, cost)


if __name__ == "__main__":
    main()
