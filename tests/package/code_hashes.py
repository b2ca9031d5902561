# SPDX-License-Identifier: BSD-3-Clause
"""The hashes of the code that decides results change with what matters to each part, and with nothing else.

usage: code_hashes.py CMAKE SOURCE_FOLDER
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def hashes(cmake, source, library):
    out = library.parent / "code_hashes.cpp"
    subprocess.run([cmake, f"-DSOURCES={library}", "-DCOMPILER=any", f"-DOUT={out}", "-P", source / "cmake/HashCode.cmake"],
                   check=True)
    return json.loads(re.search(r'R"\((.*)\)"', out.read_text(), re.DOTALL).group(1))


def commit(cmake, source, library):
    hashes(cmake, source, library)
    return re.search(r'kCommit = "(.*)"', (library.parent / "code_hashes.cpp").read_text())[1]


def check_commit(cmake, source, library):
    """The commit of a clone, whether the code differs from it, and none outside a clone."""
    assert commit(cmake, source, library) == "unknown"
    if not shutil.which("git"):
        return
    git = ["git", "-C", library.parent, "-c", "user.name=a", "-c", "user.email=a@b"]
    for command in (["init", "-q"], ["add", "lidarena"], ["commit", "-q", "-m", "a"]):
        subprocess.run([*git, *command], check=True)
    known = commit(cmake, source, library)
    assert re.fullmatch("[0-9a-f]{10}", known), known
    (library / "README.md").write_text("changed")
    assert commit(cmake, source, library) == f"{known} with changes"


def parts(code):
    return {"simulator": code["simulator"], "scorer": code["scorer"], **code["methods"]}


def check_scorer(source):
    """Of results/, the scorer's hash covers every header that the code behind it includes."""
    covered = set(re.findall(r"results/\w+", re.search(r"set\(scorer ([^)]*)\)", (source / "cmake/HashCode.cmake").read_text())[1]))
    library = source / "lidarena"
    files = [*library.glob("evaluation/**/*.?pp"), *library.glob("stages/score_run.?pp"), *library.glob("dataset/*.?pp"),
             *library.glob("map/*.?pp"), *(library / f"{name}{end}" for name in covered for end in (".hpp", ".cpp"))]
    included = {name for file in files if file.exists()
                for name in re.findall(r'#include "lidarena/(results/\w+)\.hpp"', file.read_text())}
    assert included <= covered, f"the scorer's hash does not cover {included - covered}"


def main(cmake, source):
    check_scorer(source)
    with tempfile.TemporaryDirectory() as folder:
        library = pathlib.Path(folder) / "lidarena"
        shutil.copytree(source / "lidarena", library)
        before = parts(hashes(cmake, source, library))
        methods = {p.name for p in (library / "odometry").iterdir() if p.is_dir()} | {"external"}
        assert set(before) == methods | {"simulator", "scorer"}, before
        assert len(set(before.values())) == len(before), "each part has code of its own"
        for file, text, changed in [("odometry/kiss_icp/kiss_icp.cpp", "int x = 1;", {"kiss_icp"}),
                                    ("odometry/kiss_icp/config.hpp", "int x = 1;", {"kiss_icp"}),
                                    ("odometry/kiss_icp/kiss_icp.cpp", "  // a comment", set()),
                                    ("odometry/run.cpp", "int x = 1;", methods),
                                    ("stages/recorder.cpp", "int x = 1;", methods),
                                    ("stages/score_run.cpp", "int x = 1;", {"scorer"}),
                                    ("evaluation/map/ghosting.cpp", "int x = 1;", {"scorer"}),
                                    ("evaluation/map/reproject.hpp", "int x = 1;", methods | {"scorer"}),
                                    ("sensor/lidar.cpp", "int x = 1;", {"simulator"}),
                                    ("results/figures.cpp", "int x = 1;", {"scorer"}),
                                    ("results/claims.cpp", "int x = 1;", set()),
                                    ("report/decision.cpp", "int x = 1;", set()),
                                    ("base/so3.cpp", "int x = 1;", set(before))]:
            path = library / file
            kept = path.read_text()
            path.write_text(f"{kept}{text}\n")
            now = parts(hashes(cmake, source, library))
            path.write_text(kept)
            found = {part for part in before if now[part] != before[part]}
            assert found == changed, f"{file}: {found}, expected {changed}"
        check_commit(cmake, source, library)


main(sys.argv[1], pathlib.Path(sys.argv[2]).resolve())
