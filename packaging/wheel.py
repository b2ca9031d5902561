#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a wheel that is installed without a build: the program for any Python 3, the module for the Python
it was built with, and the libraries that both need. docs/install.md says where it runs.

usage: packaging/wheel.py --build build/release --out dist

Two runs on the same build and packages write the same bytes. Needs patchelf, a C compiler and dpkg.
"""
import argparse
import base64
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TAG = "py3-none-manylinux_2_36_x86_64"

# Libraries that a system of that tag has. All others are carried. The C++ library is not: a process has one,
# and that of the system suits other modules too.
SYSTEM = {"ld-linux-x86-64.so.2", "libc.so.6", "libdl.so.2", "libgcc_s.so.1", "libm.so.6", "libpthread.so.0",
          "librt.so.1", "libstdc++.so.6"}
# The newest versions of symbols that the tag permits.
NEWEST = {"GLIBC": (2, 36), "GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13), "GCC": (12, 0, 0)}

# Debian's Ceres refers to these, but Lidarena chooses Eigen's solvers: nothing of them is ever called. Some are
# under the GPL. One library with functions of the same names, each of which ends the program, takes their place.
LEFT_OUT = {"libblas", "libcholmod", "libcxsparse", "libf77blas", "liblapack", "libopenblas", "libspqr"}
STAND_IN = "liblidarena_left_out.so"

# Licences of the carried libraries by Debian package: of what is in the library, not of tests and packaging.
CARRIED = {
    "libacl1": "LGPL-2.1-or-later",
    "libassimp5": "BSD-3-Clause AND BSD-2-Clause AND BSL-1.0 AND MIT",
    "libbrotli1": "MIT",
    "libbz2-1.0": "bzip2-1.0.6",
    "libconsole-bridge1.0": "BSD-3-Clause",
    "libcpp-httplib0.11": "MIT",
    "libddsc0debian": "(EPL-2.0 OR BSD-3-Clause) AND Zlib",
    "libdeflate0": "MIT",
    "libdraco7": "Apache-2.0",
    "libembree3-3": "Apache-2.0",
    "libfmt9": "MIT",
    "libgflags2.2": "BSD-3-Clause",
    "libgoogle-glog0v6": "BSD-3-Clause",
    "libiceoryx-binding-c2": "Apache-2.0",
    "libiceoryx-hoofs2": "Apache-2.0",
    "libiceoryx-platform2": "Apache-2.0",
    "libiceoryx-posh2": "Apache-2.0",
    "libignition-math6-6": "Apache-2.0",
    "liblz4-1": "BSD-2-Clause",
    "liblzf1": "BSD-2-Clause",
    "liblzma5": "public domain",
    "libmd0": "BSD-3-Clause AND BSD-2-Clause AND ISC AND Beerware AND public domain",
    "libminizip1": "Zlib",
    "libsdformat12-12": "Apache-2.0 AND BSD-3-Clause AND BSL-1.0",
    "libsqlite3-0": "public domain",
    "libssl3": "Apache-2.0",
    "libtbb12": "Apache-2.0",
    "libtinyxml2-9": "Zlib",
    "libtinyxml2.6.2v5": "Zlib",
    "libunwind8": "MIT",
    "liburdfdom-model3.0": "BSD-3-Clause",
    "libyaml-cpp0.7": "MIT",
    "libzstd1": "(BSD-3-Clause OR GPL-2.0-only) AND MIT",
    "zlib1g": "Zlib",
}
# The same of what is compiled into the program and the module.
COMPILED_IN = {
    "libceres-dev": "BSD-3-Clause AND Apache-2.0",
    "libcli11-dev": "BSD-3-Clause",
    "libeigen3-dev": "MPL-2.0 AND BSD-3-Clause",
    "libxxhash-dev": "BSD-2-Clause",
    "nlohmann-json3-dev": "MIT",
    "pybind11-dev": "BSD-3-Clause",
    "robin-map-dev": "MIT",
}

# pip replaces the first line. The package itself is not imported: the program needs no module and no NumPy.
COMMAND = """\
#!python
# SPDX-License-Identifier: BSD-3-Clause
import importlib.util
import os
import sys

program = os.path.join(importlib.util.find_spec("lidarena").submodule_search_locations[0], "bin", "lidarena")
os.execv(program, ["lidarena", *sys.argv[1:]])
"""


def fail(message):
    sys.exit(f"wheel: {message}")


def run(*command):
    """What a command prints."""
    command = [str(part) for part in command]
    if shutil.which(command[0]) is None:
        fail(f"the command {command[0]} is missing; install the Debian packages patchelf, binutils, gcc and dpkg")
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
    if done.returncode:
        fail(f"`{' '.join(command)}` failed: {(done.stderr or done.stdout).strip()}")
    return done.stdout


def needed(file):
    """The names of the libraries that a program or library is linked with."""
    return re.findall(r"\(NEEDED\).*\[(.+)\]", run("readelf", "-dW", file))


def is_left_out(name):
    return name.split(".so")[0] in LEFT_OUT


def find_libraries(objects):
    """Name and path of each library to carry, and the paths of those to leave out."""
    found = {}
    for file in objects:
        for name, path in re.findall(r"^\s*(\S+) => (.+?)(?: \(0x[0-9a-f]+\))?$", run("ldd", file), re.M):
            if path == "not found":
                fail(f"{file} needs {name}, which is not installed; install its Debian package")
            found[name] = pathlib.Path(path).resolve()
    carried, left_out, todo = {}, {}, list(objects)
    while todo:
        for name in needed(todo.pop()):
            if is_left_out(name):
                left_out[name] = found[name]
            elif name not in SYSTEM and name not in carried:
                carried[name] = found[name]
                todo.append(found[name])
    return dict(sorted(carried.items())), dict(sorted(left_out.items()))


def check_versions(file, label):
    for section in run("readelf", "-VW", file).split("\nVersion ")[1:]:
        if not section.startswith("needs"):
            continue
        for library, version in re.findall(r"Name: (GLIBC|GLIBCXX|CXXABI|GCC)_([0-9.]+)\s", section):
            if tuple(int(part) for part in version.split(".")) > NEWEST[library]:
                fail(f"{label} needs {library} {version}, newer than the tag {TAG} permits; "
                     "make the wheel on Debian 12")


def symbols(file, which):
    """Kinds of symbols by their names."""
    rows = re.findall(r"(\S) ([^\s@]+)\S*$", run("nm", "-D", which, file), re.M)
    return {name: kind for kind, name in rows}


def make_stand_in(objects, left_out, out):
    """A library with the functions of the libraries left out that the objects refer to."""
    offered = {}
    for path in left_out.values():
        offered.update(symbols(path, "--defined-only"))
    wanted = sorted({name for file in objects for name in symbols(file, "--undefined-only")} & set(offered))
    for name in wanted:
        if offered[name] not in "TWi":
            fail(f"{name} of a library that is left out is not a function; carry that library, see LEFT_OUT")
    source = out.with_suffix(".c")
    source.write_text(
        "#include <stdio.h>\n#include <stdlib.h>\n"
        "static void end(const char* name) {\n"
        '  fprintf(stderr, "lidarena: %s() was called, which the wheel leaves out; use a build from source\\n", name);\n'
        "  abort();\n}\n" + "".join(f'void {name}(void) {{ end("{name}"); }}\n' for name in wanted))
    run("cc", "-shared", "-fPIC", "-O1", "-s", "-Wl,--build-id=none", f"-Wl,-soname,{out.name}",
        "-o", out, source)


def package_of(path):
    """The Debian package of a library; its path may be recorded as in /lib or in /usr/lib."""
    for name in (str(path), str(path).removeprefix("/usr")):
        done = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.split(":")[0]
    return fail(f"{path} is in no Debian package, so its licence is unknown; install the library from Debian")


def licence_of(package, table):
    if package not in table:
        fail(f"the licence of the package {package} is unknown; read /usr/share/doc/{package}/copyright "
             "and add it to the table in packaging/wheel.py")
    return table[package]


def table_row(name, package, licence):
    version = run("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}\n", package).splitlines()[0]
    return f"{name:40} {package:24} {version:32} {licence}\n"


def licence_files(libraries):
    """The table of licences and the texts of all; libraries: file in the wheel and Debian package of each."""
    heading = f"{'':40} {'package of Debian':24} {'source package':32} licence\n"
    table = ("Lidarena's own code is under the BSD-3-Clause licence, see LICENSE and lidarena.txt.\n"
             "Libraries that the wheel carries. The text of each licence is in PACKAGE.txt; the source is the Debian\n"
             "source package of the stated version. A library may be replaced by a file of the same name.\n\n" + heading)
    packages = set()
    for name, package in libraries:
        table += table_row(name, package, licence_of(package, CARRIED))
        packages.add(package)
    table += "\nCompiled into the program and the module:\n\n" + heading
    for package, licence in COMPILED_IN.items():
        table += table_row("", package, licence)
        packages.add(package)
    table += (f"\n{STAND_IN} is part of Lidarena. It takes the place of SuiteSparse, LAPACK and BLAS, which Debian's\n"
              "Ceres refers to: the wheel carries none of them, since Lidarena uses Eigen's solvers.\n")
    texts = {"LIBRARIES.txt": table.encode(), "LICENSE": (ROOT / "LICENSE").read_bytes(),
             "lidarena.txt": (ROOT / "packaging/copyright").read_bytes()}
    for package in packages:
        file = pathlib.Path("/usr/share/doc", package, "copyright")
        if not file.exists():
            fail(f"{file} is missing; install the package {package} again, with its documentation")
        texts[f"{package}.txt"] = file.read_bytes()
    for text in list(texts.values()):
        for name in re.findall(rb"/usr/share/common-licenses/([A-Za-z]+(?:-[0-9]+(?:\.[0-9]+)*)?)", text):
            file = pathlib.Path("/usr/share/common-licenses", name.decode())
            if file.exists():
                texts[f"common-licenses/{file.name}"] = file.read_bytes()
    return texts


def binaries(program, module, folder):
    """Path in the wheel and content of the program, the module and their libraries; packages of the latter."""
    objects = [folder / "program", folder / module.name]
    shutil.copyfile(program, objects[0])
    shutil.copyfile(module, objects[1])
    for file in objects:
        file.chmod(0o755)
        run("strip", file)
    carried, left_out = find_libraries(objects)
    places = {objects[0]: ("lidarena/bin/lidarena", "$ORIGIN/../libs"),
              objects[1]: (f"lidarena/{module.name}", "$ORIGIN/libs")}
    renamed, packages = {}, []
    for name, path in carried.items():
        # A name of its own: another module in the process may use another version of the same library.
        stem, _, rest = name.partition(".so")
        renamed[name] = f"{stem}-{hashlib.sha256(path.read_bytes()).hexdigest()[:8]}.so{rest}"
        copy = folder / renamed[name]
        shutil.copyfile(path, copy)
        places[copy] = (f"lidarena/libs/{copy.name}", "$ORIGIN")
        packages.append((copy.name, package_of(path)))
    if left_out:
        stand_in = folder / STAND_IN
        make_stand_in(places, left_out, stand_in)
        places[stand_in] = (f"lidarena/libs/{stand_in.name}", "$ORIGIN")
    files = {}
    for file, (place, search) in places.items():
        check_versions(file, place)
        pairs = [(name, STAND_IN if is_left_out(name) else renamed.get(name)) for name in needed(file)]
        replace = [word for old, new in pairs if new for word in ("--replace-needed", old, new)]
        # one step a call: patchelf 0.14 mixes the names up if a call has several
        for change in (replace, ["--set-soname", file.name] if file.name in renamed.values() else [],
                       ["--set-rpath", search]):
            if change:
                run("patchelf", *change, file)
        files[place] = file.read_bytes()
    return files, packages


def write_wheel(files, out):
    """Writes the files, path in the wheel and content, and the list of their hashes."""
    record = next(name for name in files if name.endswith("/WHEEL")).replace("/WHEEL", "/RECORD")
    rows = []
    for name in sorted(files):
        digest = base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).rstrip(b"=").decode()
        rows.append(f"{name},sha256={digest},{len(files[name])}\n")
    unfinished = out.with_name(f".{out.name}.{os.getpid()}")
    try:
        with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in [*sorted(files.items()), (record, "".join([*rows, f"{record},,\n"]))]:
                entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.create_system = 3
                is_program = "/bin/" in name or "/scripts/" in name
                entry.external_attr = (0o100755 if is_program else 0o100644) << 16
                archive.writestr(entry, content)
        os.replace(unfinished, out)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        fail(f"{out} cannot be written ({error.strerror}); free space there or give another folder with --out")


def main():
    parser = argparse.ArgumentParser(description="Makes a wheel that is installed without a build.")
    parser.add_argument("--build", type=pathlib.Path, required=True, help="finished build, e.g. build/release")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("dist"), help="folder to write")
    options = parser.parse_args()
    if platform.machine() != "x86_64":
        fail(f"this machine is {platform.machine()}, but the wheel is for x86_64; make it on amd64")
    program = options.build / "apps/lidarena/lidarena"
    modules = sorted((options.build / "python/lidarena").glob("_core.cpython-*.so"))
    if not program.is_file() or len(modules) != 1:
        fail(f"{options.build} has no finished program or not exactly one Python module; "
             "build it first with pybind11-dev, python3-dev and python3-numpy installed")
    major, minor = re.match(r"_core\.cpython-(\d)(\d+)", modules[0].name).groups()
    project = (ROOT / "CMakeLists.txt").read_text()
    version, summary = re.search(r'project\(lidarena VERSION ([0-9.]+) DESCRIPTION "(.+?)"', project).groups()
    info = f"lidarena-{version}.dist-info"

    with tempfile.TemporaryDirectory() as folder:
        files, packages = binaries(program, modules[0], pathlib.Path(folder))
    for file in sorted([*(ROOT / "python/lidarena").glob("*.py*"), ROOT / "python/lidarena/py.typed"]):
        files[f"lidarena/{file.name}"] = file.read_bytes()
    for file in (ROOT / "configs").rglob("*"):
        if file.is_file() and "__pycache__" not in file.parts:
            files[f"lidarena/{file.relative_to(ROOT).as_posix()}"] = file.read_bytes()
    files[f"lidarena-{version}.data/scripts/lidarena"] = COMMAND.encode()
    licences = licence_files(packages)
    for name, text in licences.items():
        files[f"{info}/licenses/{name}"] = text
    # pybind11 of Debian 12 does not know NumPy 2; other Python versions have only the program, which needs none
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: lidarena\nVersion: {version}\nSummary: {summary}\n"
        "Author: The Lidarena authors\nRequires-Python: >=3.9\n"
        "License: BSD-3-Clause; carried libraries have their own licences, see licenses/LIBRARIES.txt\n"
        f'Requires-Dist: numpy<2; python_version == "{major}.{minor}"\n').encode()
    files[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: lidarena packaging/wheel.py\n"
                              f"Root-Is-Purelib: false\nTag: {TAG}\n").encode()
    options.out.mkdir(parents=True, exist_ok=True)
    wheel = options.out / f"lidarena-{version}-{TAG}.whl"
    write_wheel(files, wheel)
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB, unpacked {sum(map(len, files.values())) / 1e6:.1f} MB, "
          f"{len(packages)} libraries; the module is for Python {major}.{minor}")


if __name__ == "__main__":
    main()
