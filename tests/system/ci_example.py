#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The shell parts of examples/ci: install, fly, compare, keep, comment.

usage: ci_example.py PROGRAM EXAMPLES CONFIGS
"""
import http.server
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading

PROGRAM, EXAMPLES, CONFIGS = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
STUDY = """title: A SLAM
scenes: [{world: house, flight: house_moving, seconds: 1.5}]
sensors: [livox_mid360]
seeds: [1]
algorithms: [{name: kiss_icp, as: mine, set: {%s}}]
keep_maps: false
score: [trajectory]
expect:
  - {finding: It drifts less than %s per m, figure: rpe_1m_at_poses_translation, below: %s}
"""


def run(folder, *words, code=0, env=None):
    done = subprocess.run([*map(str, words)], cwd=folder, env=env, capture_output=True, text=True, check=False)
    if done.returncode != code:
        sys.exit(f"{words}: exit code {done.returncode}, not {code}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def check_flights(folder, env):
    (folder / "good.yaml").write_text(STUDY % ("voxel_size_m: 0.6", "1 m", 100))
    (folder / "worse.yaml").write_text(STUDY % ("voxel_size_m: 1.0", "1 m", 100))
    (folder / "strict.yaml").write_text(STUDY % ("voxel_size_m: 0.6", "1 nm", 1e-7))
    fly = "bash", EXAMPLES / "ci/fly.sh"
    run(folder, *fly, "good.yaml", "first", env=env)
    text = (folder / "first/summary.md").read_text()
    assert text.startswith("<!-- lidarena -->\n### Lidarena: all limits are kept\n"), text
    assert "No earlier result" in text and "mine" in text, text
    run(folder, "bash", EXAMPLES / "ci/keep.sh", "first", "baseline", env=env)
    assert not list((folder / "baseline").rglob("*.ply"))

    run(folder, *fly, "good.yaml", "same", "baseline", env=env)
    assert "all limits are kept" in (folder / "same/summary.md").read_text()
    assert "RPE per meter" in (folder / "same/summary.md").read_text()
    run(folder, *fly, "worse.yaml", "worse", "baseline", code=1, env=env)
    text = (folder / "worse/summary.md").read_text()
    assert "### Lidarena: a limit is exceeded\n- beyond the limit drift=5%" in text, text
    run(folder, *fly, "worse.yaml", "allowed", "baseline", "drift=100000%", env=env)
    run(folder, *fly, "strict.yaml", "strict", code=1, env=env)
    assert "- falls short with indoor: It drifts less than 1 nm" in (folder / "strict/summary.md").read_text()
    run(folder, *fly, "none.yaml", "none", code=2, env=env)


class Comments(http.server.BaseHTTPRequestHandler):
    """A list of comments, as both GitHub and GitLab serve it."""

    stored, calls = [], []

    def answer(self, value):
        body = json.dumps(value).encode()
        self.send_response(200)
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        self.calls.append(("GET", self.path))
        self.answer(self.stored)

    def change(self):
        token = self.headers.get("Authorization", "") + self.headers.get("PRIVATE-TOKEN", "")
        assert "secret" in token, self.headers
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))["body"]
        self.calls.append((self.command, self.path, body))
        self.answer({})

    do_POST = do_PATCH = do_PUT = change

    def log_message(self, *_):
        pass


def check_comments(folder, env):
    server = http.server.HTTPServer(("127.0.0.1", 0), Comments)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{server.server_port}"
    script = sys.executable, EXAMPLES / "ci/comment.py", "first/summary.md"
    github = dict(env, GITHUB_API_URL=url, GITHUB_REPOSITORY="me/slam", PULL_REQUEST="7", GITHUB_TOKEN="secret")
    gitlab = dict(env, CI_API_V4_URL=url, CI_PROJECT_ID="3", CI_MERGE_REQUEST_IID="7", GITLAB_TOKEN="secret")
    text = (folder / "first/summary.md").read_text()
    run(folder, *script, env=github)
    assert Comments.calls[-1] == ("POST", "/repos/me/slam/issues/7/comments", text), Comments.calls
    Comments.stored[:] = [{"id": 1, "body": "thanks"}, {"id": 2, "body": "<!-- lidarena -->\nold"}]
    run(folder, *script, env=github)
    assert Comments.calls[-1] == ("PATCH", "/repos/me/slam/issues/comments/2", text), Comments.calls
    run(folder, *script, env=gitlab)
    assert Comments.calls[-1] == ("PUT", "/projects/3/merge_requests/7/notes/2", text), Comments.calls
    assert "neither PULL_REQUEST nor" in run(folder, *script, env=env, code=1)
    server.shutdown()


def check_install(folder, env):
    """With dummies of apt-get and python3, which note their arguments."""
    tools = folder / "tools"
    tools.mkdir()
    for name in ("apt-get", "sudo", "python3"):
        (tools / name).write_text('#!/bin/bash\necho "$(basename "$0") $*" >>"$NOTES"\n'
                                  'case "$0 $*" in\n*sudo*) "$@" ;;\n'
                                  '*venv*) mkdir -p "$3/bin"; ln -s "$0" "$3/bin/pip" ;;\nesac\n')
        (tools / name).chmod(0o755)
    env = dict(env, PATH=f"{tools}:{env['PATH']}", NOTES=f"{folder}/notes")
    (folder / "a.deb").touch()
    (folder / "a.whl").touch()
    script = "bash", EXAMPLES / "ci/install.sh"
    assert run(folder, *script, "a.deb", env=env).splitlines()[-1] == f"{folder}/bin"
    assert f"apt-get install -y -qq --no-install-recommends {folder}/a.deb" in (folder / "notes").read_text()
    assert run(folder, *script, "a.whl", "place", env=env).splitlines()[-1] == f"{folder}/place/bin"
    assert "pip install --quiet a.whl" in (folder / "notes").read_text()
    assert "does not exist" in run(folder, *script, "b.deb", env=env, code=2)
    (folder / "a.txt").touch()
    assert "neither a .deb nor a .whl" in run(folder, *script, "a.txt", env=env, code=2)


def check_templates():
    """The files for GitHub and GitLab name scripts and inputs that exist."""
    try:
        import yaml
    except ImportError:
        print("skipped: the form of the templates, since python3-yaml is not installed")
        return
    action = yaml.safe_load((EXAMPLES / "ci/action.yml").read_text())
    text = json.dumps(action)
    assert set(re.findall(r"inputs\.(\w+)", text)) == set(action["inputs"]), text
    workflow = yaml.safe_load((EXAMPLES / "ci/workflow.yml").read_text())
    given = workflow["jobs"]["fly"]["steps"][-1]["with"]
    assert {key for key, value in action["inputs"].items() if value.get("required")} <= set(given), given
    assert set(given) <= set(action["inputs"]), given
    text += json.dumps(yaml.safe_load((EXAMPLES / "ci/gitlab.yml").read_text()))
    named = set(re.findall(r"(?:PATH|lidarena)/(\w+\.(?:sh|py))", text))
    assert named == {file.name for file in (EXAMPLES / "ci").glob("*.[sp][hy]")}, named


with tempfile.TemporaryDirectory() as scratch:
    place = pathlib.Path(scratch).resolve()
    (place / "bin").mkdir()
    (place / "bin/lidarena").symlink_to(PROGRAM)
    (place / "configs").symlink_to(CONFIGS)
    plain = {key: value for key, value in os.environ.items() if not key.startswith(("CI", "GIT", "PULL"))}
    plain["PATH"] = f"{place}/bin:{plain['PATH']}"
    check_templates()
    check_flights(place, plain)
    check_comments(place, plain)
    check_install(place, plain)
