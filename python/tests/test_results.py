# SPDX-License-Identifier: BSD-3-Clause
import builtins

import numpy as np
import pytest

import lidarena
import lidarena.plot


def straight(offset=0.0, slope=0.0):
    """21 poses in 2 s along x, 1 m/s; `slope` is the drift in y per m."""
    stamps = np.arange(0, 2_000_000_001, 100_000_000)
    poses = np.tile(np.eye(4), (len(stamps), 1, 1))
    poses[:, 0, 3] = stamps * 1e-9 + offset
    poses[:, 1, 3] = slope * stamps * 1e-9
    return lidarena.Trajectory(stamps, poses)


def test_rows_of_a_study_have_numbers_and_texts(tmp_path):
    (tmp_path / "results.csv").write_text(
        "run,world,seed,status,ate_se3_translation_cm,key\n1,house,2,ok,3.5,123\nb,house,3,failed,,4\n")
    first, second = lidarena.study_rows(tmp_path)
    assert first == {"run": "1", "world": "house", "seed": 2.0, "status": "ok",
                     "ate_se3_translation_cm": 3.5, "key": "123"}
    assert second["ate_se3_translation_cm"] is None
    with pytest.raises(lidarena.InputError, match="does not exist"):
        lidarena.study_rows(tmp_path / "none")


def test_without_matplotlib_a_plot_says_how_to_get_it(monkeypatch):
    real = builtins.__import__

    def none(name, *rest):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *rest)
    monkeypatch.setattr(builtins, "__import__", none)
    with pytest.raises(ImportError, match="python3-matplotlib"):
        lidarena.plot.histogram([0.1])


@pytest.fixture
def pyplot():
    matplotlib = pytest.importorskip("matplotlib", reason="needs python3-matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot
    yield matplotlib.pyplot
    matplotlib.pyplot.close("all")


def test_a_path_is_drawn_from_the_true_start(pyplot):
    axes = lidarena.plot.trajectory(straight(offset=5.0), straight())
    estimate = axes.lines[1].get_xydata()
    assert np.allclose(estimate[0], [0, 0]) and np.allclose(estimate[-1], [2, 0])
    late = lidarena.Trajectory(np.array([9_000_000_000]), np.eye(4)[None])
    with pytest.raises(ValueError, match="no pose at the time"):
        lidarena.plot.trajectory(late, straight())


def test_drift_is_that_of_the_estimate(pyplot):
    metrics = lidarena.evaluate(straight(slope=0.01), straight())
    line = lidarena.plot.drift(metrics).lines[0].get_xydata()
    assert np.allclose(line[:, 1], 100 * 0.01 * line[:, 0], atol=1e-6), "1 cm after 1 m"


def test_a_histogram_counts_points_in_percent(pyplot):
    axes = lidarena.plot.histogram([0.001, 0.001, 0.101, 0.5])
    heights = [patch.get_height() for patch in axes.patches]
    assert heights[0] == 50 and heights[25] == 25 and sum(heights) == 75
    assert "25 % beyond 20 cm" in axes.get_title()
    with pytest.raises(ValueError, match="no distances"):
        lidarena.plot.histogram([np.nan])


def test_a_map_is_colored_by_its_error(pyplot):
    points = np.array([[0, 0, 0], [1, 2, 0]], np.float32)
    drawn = lidarena.plot.map_error(points, [0.2, 0.1]).collections[0]
    assert np.allclose(drawn.get_array(), [10, 20]), "the worst is drawn last"
    assert np.allclose(drawn.get_offsets(), [[1, 2], [0, 0]])
    with pytest.raises(ValueError, match="2 points have 1 distances"):
        lidarena.plot.map_error(points, [0.1])
