# SPDX-License-Identifier: BSD-3-Clause
"""Plots of results with matplotlib: trajectory, drift over time, map error, histogram.

    import lidarena, lidarena.plot
    axes = lidarena.plot.trajectory(result.trajectory, truth)
    axes.figure.savefig("trajectory.png")

Each function draws into `axes`, or into a new figure, and returns the axes. Lengths are in meters,
distances and errors in centimeters on the axes.
"""
import numpy as np

#: Distances beyond this are outliers, as in the scores, m.
LIMIT = 0.2


def _axes(axes, title, x, y):
    if axes is None:
        try:
            import matplotlib.pyplot as pyplot
        except ImportError as missing:
            raise ImportError("lidarena.plot needs matplotlib: apt install python3-matplotlib, or "
                              "pip install matplotlib") from missing
        axes = pyplot.subplots(layout="constrained")[1]
    axes.set(title=title, xlabel=x, ylabel=y)
    return axes


def trajectory(estimate, truth=None, axes=None):
    """The path of a Trajectory from above, over the true one.

    With `truth`, the estimate is moved so that its first pose is the true one at the same time.
    Throws ValueError if the truth does not cover that time.
    """
    axes = _axes(axes, "Path from above", "x, m", "y, m")
    positions = np.asarray(estimate.positions)
    if truth is not None:
        first = truth.at(int(estimate.stamps[0]))
        if first is None:
            raise ValueError("the truth has no pose at the time of the estimate's first one")
        moved = first @ np.linalg.inv(estimate.poses[0])
        positions = positions @ moved[:3, :3].T + moved[:3, 3]
        axes.plot(*np.asarray(truth.positions)[:, :2].T, color="0.6", linewidth=3, label="truth")
    axes.plot(*positions[:, :2].T, color="C0", label="estimate")
    axes.plot(*positions[0, :2], "o", color="C0", label="start")
    axes.set_aspect("equal")
    axes.legend()
    return axes


def drift(metrics, axes=None):
    """Error of the position over time, from the result of evaluate() or score_run().

    The estimate's first pose is the true one, so the curve begins at 0.
    """
    errors = metrics["live"]["errors_over_time"]["ate_first_pose"]
    axes = _axes(axes, "Drift", "time, s", "error of the position, cm")
    axes.plot(errors["t_s"], 100 * np.asarray(errors["translation_m"]))
    axes.set_ylim(bottom=0)
    return axes


def map_error(points, distances, axes=None, limit=LIMIT):
    """Points (N, 3) from above, colored by their distances (N) from the mesh, up to `limit`.

    `distances` are those of lidarena.map_error(). The worst points are drawn last.
    """
    points, distances = np.asarray(points), np.asarray(distances)
    if len(points) != len(distances):
        raise ValueError(f"{len(points)} points have {len(distances)} distances")
    axes = _axes(axes, "Distance of the map from the mesh", "x, m", "y, m")
    order = np.argsort(distances)
    drawn = axes.scatter(*points[order, :2].T, c=100 * distances[order], s=1, linewidths=0,
                         vmin=0, vmax=100 * limit, cmap="viridis", rasterized=True)
    axes.figure.colorbar(drawn, ax=axes, label="cm", extend="max")
    axes.set_aspect("equal")
    return axes


def histogram(distances, axes=None, limit=LIMIT, bins=50):
    """Share of the points by their distance from the mesh; those beyond `limit` are in the title."""
    distances = np.asarray(distances)
    distances = distances[np.isfinite(distances)]
    if not len(distances):
        raise ValueError("there are no distances")
    beyond = 100 * np.mean(distances > limit)
    axes = _axes(axes, f"Distance of the map from the mesh; {beyond:.2g} % beyond "
                 f"{100 * limit:g} cm", "distance, cm", "points, %")
    axes.hist(100 * distances, bins=bins, range=(0, 100 * limit),
              weights=np.full(len(distances), 100 / len(distances)))
    return axes
