#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The wheel of packaging/wheel.py is complete, relocatable, reproducible and free of GPL libraries, and runs.

usage: wheel.py BUILD_FOLDER; lists each carried library with its licence; exits 77 (skipped) without patchelf.
"""
import base64
import csv
import hashlib
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "packaging"))
import wheel  # noqa: E402

EMPTY = {"PATH": "/usr/bin:/bin", "LD_LIBRARY_PATH": "", "LC_ALL": "C"}


def run(*command, ok=True, cwd="/", **environment):
    """What a command prints, with nothing of this process's environment."""
    done = subprocess.run([str(part) for part in command], env={**EMPTY, **environment}, cwd=cwd,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert (done.returncode == 0) == ok, f"{command}: {done.returncode}\n{done.stdout}"
    return done.stdout


def make(build, out):
    print(run(sys.executable, "-B", ROOT / "packaging/wheel.py", "--build", build, "--out", out), end="")
    made, = pathlib.Path(out).iterdir()
    return made


def check_record(root):
    """RECORD lists every file, each with the hash and size of its content."""
    record, = root.glob("*.dist-info/RECORD")
    listed = {}
    with open(record, newline="", encoding="utf-8") as lines:
        for name, digest, size in csv.reader(lines):
            listed[name] = digest, size
    files = {file.relative_to(root).as_posix(): file for file in root.rglob("*") if file.is_file()}
    assert set(listed) == set(files), set(listed) ^ set(files)
    for name, file in files.items():
        content = file.read_bytes()
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
        expected = ("", "") if file == record else (f"sha256={digest}", str(len(content)))
        assert listed[name] == expected, name


def check_links(root):
    """Every library is the system's or in the wheel, and is found from where the file lies."""
    objects = [file for file in (root / "lidarena").rglob("*")
               if file.is_file() and file.open("rb").read(4) == b"\x7fELF"]
    assert len(objects) > 20, objects
    needed = set()
    for file in objects:
        dynamic = run("readelf", "-dW", file)
        path, = re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", dynamic)
        assert path in ("$ORIGIN", "$ORIGIN/libs", "$ORIGIN/../libs"), f"{file} searches {path}"
        folder = pathlib.Path(path.replace("$ORIGIN", str(file.parent)))
        for name in re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic):
            assert name in wheel.SYSTEM or (folder / name).is_file(), f"{file} needs {name}, which is not there"
            needed.add(name)
        if file.parent.name == "libs":
            assert f"[{file.name}]" in re.search(r"\(SONAME\).*", dynamic)[0], file
        for line in run("ldd", file).splitlines():
            name, _, place = line.strip().partition(" => ")
            assert not place or name in wheel.SYSTEM or place.startswith(str(root)), f"{file}: {line}"
    unused = {file.name for file in (root / "lidarena/libs").iterdir()} - needed
    assert not unused, unused


def check_licences(root):
    """The table names every carried library; no licence is the GPL alone; all texts are there."""
    folder, = root.glob("*.dist-info/licenses")
    table = (folder / "LIBRARIES.txt").read_text()
    rows = {}
    for line in table.splitlines():
        if line.startswith("lib") and not line.startswith(wheel.STAND_IN):
            name, package = line.split()[:2]
            rows[name] = package, wheel.CARRIED[package]
            assert line.endswith(f" {wheel.CARRIED[package]}"), line
    carried = {file.name for file in (root / "lidarena/libs").iterdir()} - {wheel.STAND_IN}
    assert set(rows) == carried, set(rows) ^ carried
    for name, (package, licence) in sorted(rows.items()):
        print(f"  {name:36} {package:24} {licence}")
        assert (folder / f"{package}.txt").stat().st_size > 100, package
    for package, licence in {**wheel.CARRIED, **wheel.COMPILED_IN}.items():
        for term in licence.split(" AND "):
            choices = term.strip("()").split(" OR ")
            assert any(not choice.startswith("GPL") for choice in choices), f"{package}: {licence}"
    assert (folder / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()


def check_use(root, work, built):
    """Program, command and module work without any setting, and the module names the Python it is for."""
    program = root / "lidarena/bin/lidarena"
    assert f"from the Python package in {root}, commit" in run(program, "--version")
    script, = root.glob("*.data/scripts/lidarena")
    assert run(sys.executable, script, "--version", PYTHONPATH=str(root)) == run(program, "--version")
    data = work / "data"
    run(program, "simulate", "--world", "house", "--flight", "house", "--sensor", "livox_mid360", "--seconds", "8",
        "--out", data)
    # loops are easily accepted, so the solver runs whose other libraries are left out; both programs agree exactly
    easily = ["loop.min_time_gap_s=1", "loop.min_path_length_m=1", "keyframe_translation_m=0.2", "loop.min_overlap=0.1",
              "loop.max_fitness_m2=1"]
    sets = [word for setting in easily for word in ("--set", f"loops.{setting}")]
    for each, out in ((program, work / "wheel"), (built, work / "built")):
        run(each, "run", "kiss_icp+loop", data, "--maps", "off", "--out", out, *sets)
    corrected = (work / "wheel/trajectory.tum").read_bytes()
    assert corrected == (work / "built/trajectory.tum").read_bytes(), "the wheel's program estimates another path"
    assert ",loop," in (work / "wheel/events.csv").read_text(), "no loop was closed, so the solver did not run"
    module = ("import lidarena; world = lidarena.load_world('house'); flight = lidarena.make_flight('house', world); "
              "print(lidarena.__version__, len(flight.sample([0, 10**9]).stamps))")
    assert run(sys.executable, "-B", "-c", module, PYTHONPATH=str(root)).split()[1] == "2"
    own, = (root / "lidarena").glob("_core*.so")
    own.rename(own.with_name("_core.cpython-34-x86_64-linux-gnu.so"))
    message = run(sys.executable, "-B", "-c", "import lidarena", ok=False, PYTHONPATH=str(root)).splitlines()[-1]
    assert message.startswith("ImportError: lidarena: the module is for Python 3.4 and this is"), message


def check_unknown_library(work):
    """A library whose licence the table does not have is refused by its package's name."""
    out = run(sys.executable, "-B", "-c", f"import sys; sys.path.insert(0, {str(ROOT / 'packaging')!r}); import wheel; "
              "wheel.licence_of('libnew1', wheel.CARRIED)", ok=False)
    assert "the licence of the package libnew1 is unknown" in out and "Traceback" not in out, out
    out = run(sys.executable, "-B", ROOT / "packaging/wheel.py", "--build", work, "--out", work / "none", ok=False)
    assert "has no finished program" in out and not (work / "none").exists(), out


def main(build):
    if not shutil.which("patchelf"):
        print("skipped: patchelf is not installed (patchelf)")
        sys.exit(77)
    glibc = platform.libc_ver()[1]
    if tuple(map(int, glibc.split("."))) > wheel.NEWEST["GLIBC"]:
        print(f"skipped: the C library is {glibc}, newer than a wheel may ask for; it is made on Debian 12")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        made = make(build, work / "one")
        assert made.name.endswith("-py3-none-manylinux_2_36_x86_64.whl"), made
        assert made.read_bytes() == make(build, work / "two").read_bytes(), "two wheels of one build differ"
        root = work / "root"
        with zipfile.ZipFile(made) as archive:
            archive.extractall(root)
            for entry in archive.infolist():
                (root / entry.filename).chmod(entry.external_attr >> 16)
        check_record(root)
        check_links(root)
        check_licences(root)
        check_use(root, work, build / "apps/lidarena/lidarena")
        check_unknown_library(work)


main(pathlib.Path(sys.argv[1]).resolve())
