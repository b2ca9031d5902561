#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks which module may include which; prints each violation and exits with 1 if there is any."""
import pathlib
import re
import sys

ALLOWED = {
    "base": set(),
    "world": {"base"},
    "scenes": {"world", "base"},
    "dataset": {"base"},
    "map": {"base"},
    "estimation": {"base"},
    "flight": {"world", "base"},
    "loop": {"estimation", "map", "base"},
    "sensor": {"world", "flight", "base"},
    "results": {"dataset", "base"},
    "evaluation": {"results", "world", "dataset", "estimation", "map", "base"},
    "odometry": {"loop", "estimation", "map", "base"},
    "stages": {"base", "world", "scenes", "flight", "sensor", "dataset", "map", "estimation", "loop",
               "odometry", "results", "evaluation"},
    "study": {"base", "world", "scenes", "flight", "sensor", "dataset", "map", "estimation", "loop",
              "odometry", "results", "evaluation", "stages"},
    "report": {"results", "base", "dataset", "world"},
}
# Third-party libraries that may be included only in .cpp files of these modules. World uses oneTBB
# to make Embree build its tree on one thread, so that the tree is always the same.
HIDDEN = {
    "embree": {"world"}, "assimp/": {"world"}, "sdf/": {"world"}, "yaml-cpp": {"base"},
    "tbb/": {"base", "world"}, "zstd.h": {"dataset"}, "lz4": {"dataset"},
    "libdeflate.h": {"dataset"},
    "lzf.h": {"dataset"}, "md5.h": {"dataset"},
    "ceres/": {"estimation"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


def violations(root: pathlib.Path):
    for file in sorted((root / "lidarena").rglob("*.[hc]pp")):
        parts = file.relative_to(root / "lidarena").parts
        module = parts[0]
        algorithm = parts[1] if module == "odometry" and len(parts) > 2 else None
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            place = f"{file.relative_to(root)}:{number}"
            name = match[1]
            if not name.startswith("lidarena/"):
                if name in ("iostream",) or name.startswith(("ros/", "rclcpp/", "pcl/", "opencv")):
                    yield f"{place}: the library must not include <{name}>"
                for prefix, homes in HIDDEN.items():
                    hidden = module in homes and file.suffix == ".cpp"
                    if name.startswith(prefix) and not hidden:
                        yield f"{place}: <{name}> is only for .cpp files of {' and '.join(homes)}"
                continue
            target = name.split("/")
            if module not in ALLOWED:
                yield f"{place}: '{module}' is not a known module, see ALLOWED"
            elif target[1] != module and target[1] not in ALLOWED[module]:
                yield f"{place}: {module} must not include {target[1]}"
            elif algorithm and target[1] == "odometry" and len(target) > 3 and target[2] != algorithm:
                yield f"{place}: an algorithm must not include another one"


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    found = list(violations(root))
    print("\n".join(found) if found else "no include rule is violated")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
