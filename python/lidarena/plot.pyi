# SPDX-License-Identifier: BSD-3-Clause
# Types of lidarena.plot; axes are those of matplotlib.
from typing import Any, Mapping, Optional

import numpy.typing as npt

from . import Trajectory

LIMIT: float

def trajectory(estimate: Trajectory, truth: Optional[Trajectory] = ..., axes: Any = ...) -> Any: ...
def drift(metrics: Mapping[str, Any], axes: Any = ...) -> Any: ...
def map_error(points: npt.ArrayLike, distances: npt.ArrayLike, axes: Any = ..., limit: float = ...) -> Any: ...
def histogram(distances: npt.ArrayLike, axes: Any = ..., limit: float = ..., bins: int = ...) -> Any: ...
