#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every shipped YAML is valid under its schema, schemas reject what the program rejects, and metrics
are valid under theirs.

usage: schemas.py PROGRAM CONFIGS; exits 77 (skipped) without PyYAML and jsonschema.
"""
import copy
import functools
import json
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as missing:
    print(f"skipped: {missing} (python3-yaml, python3-jsonschema)")
    sys.exit(77)

PROGRAM, CONFIGS = sys.argv[1], pathlib.Path(sys.argv[2])


@functools.lru_cache
def schema(kind):
    out = subprocess.run([PROGRAM, "schema", kind], check=True, capture_output=True, text=True)
    document = json.loads(out.stdout)
    jsonschema.Draft202012Validator.check_schema(document)
    return jsonschema.Draft202012Validator(document)


def kind_of(file):
    folder = file.parent.name
    if file.parent == CONFIGS:
        return "steps"
    if folder == "odometry":
        return "ct_icp" if file.stem.startswith("ct_icp") else "kiss_icp"
    return {"worlds": "world", "flights": "flight", "sensors": "sensor", "studies": "study",
            "beams": "beams", "recordings": "recording", "programs": "external"}[folder]


def check_rejected(kind, document, why):
    assert not schema(kind).is_valid(document), f"{kind}: {why} is not rejected"


checked = 0
for file in sorted(CONFIGS.rglob("*.yaml")):
    document = yaml.safe_load(file.read_text()) or {}
    for error in schema(kind_of(file)).iter_errors(document):
        sys.exit(f"{file}: {error.json_path}: {error.message}")
    wrong = copy.deepcopy(document)
    wrong["no_such_key"] = 1
    check_rejected(kind_of(file), wrong, "an unknown key")
    checked += 1
assert checked > 25, checked

check_rejected("sensor", {"max_range_m": "far"}, "text instead of a number")
check_rejected("sensor", {"mode": "rollin"}, "a word that is not allowed")
check_rejected("sensor", {"rate_hz": 0}, "a value out of range")
check_rejected("sensor", {"imu": {"rate_hz": -5}}, "a value out of range in a nested group")
check_rejected("study", {"seeds": [1, -2]}, "a list element out of range")
with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "truth.tum"
    file.write_text("".join(f"{0.1 * i:.3f} {math.cos(0.1 * i)} {math.sin(0.1 * i)} 0 0 0 0 1\n"
                            for i in range(100)))
    out = subprocess.run([PROGRAM, "evaluate", "--trajectory", file, "--truth", file, "--json"],
                         check=True, capture_output=True, text=True)
metrics = json.loads(out.stdout)
for error in schema("metrics").iter_errors(metrics):
    sys.exit(f"metrics: {error.json_path}: {error.message}")
assert metrics["final"]["rpe"]["1m"]["used"] > 5, metrics["final"]["rpe"]
metrics["final"]["rpe"]["1m"]["used"] = "all"
check_rejected("metrics", metrics, "text instead of a number")

check_rejected("flight", {"waypoints": [[1, 2]]}, "a point with two coordinates")

algorithms = json.loads(subprocess.run([PROGRAM, "list", "algorithms", "--json"], check=True,
                                       capture_output=True, text=True).stdout)
for algorithm in algorithms:
    assert schema(algorithm["name"]).schema["properties"], algorithm
print(f"{checked} files are valid under their schemas")
