# SPDX-License-Identifier: BSD-3-Clause
"""Builds the module and the program with CMake and adds them and configs/ to the package.

The build folder is build/pip, or $LIDARENA_BUILD: `LIDARENA_BUILD=build/release pip install ...`
reuses what ./run or ./test has built.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

ROOT = pathlib.Path(__file__).parent.resolve()


class BinaryDistribution(Distribution):
    """A wheel for one platform and one Python version."""

    def has_ext_modules(self):
        return True


class BuildWithCMake(build_py):
    def run(self):
        super().run()
        build = ROOT / os.environ.get("LIDARENA_BUILD", "build/pip")
        configure = ["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                     f"-DPython_EXECUTABLE={sys.executable}"]
        if not (build / "CMakeCache.txt").exists():
            configure.append("-DLIDARENA_BUILD_TESTS=OFF")
        subprocess.run(configure, check=True)
        subprocess.run(["cmake", "--build", build, "--target", "lidarena_python", "lidarena"],
                       check=True)
        package = pathlib.Path(self.build_lib, "lidarena")
        for module in (build / "python" / "lidarena").glob("_core*.so"):
            self.copy_file(str(module), str(package / module.name))
        self.mkpath(str(package / "bin"))
        self.copy_file(str(build / "apps/lidarena/lidarena"), str(package / "bin/lidarena"))
        shutil.copytree(ROOT / "configs", package / "configs", dirs_exist_ok=True)


version = re.search(r"project\(lidarena VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())
setup(version=version[1], distclass=BinaryDistribution, cmdclass={"build_py": BuildWithCMake})
