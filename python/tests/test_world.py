# SPDX-License-Identifier: BSD-3-Clause
"""Rays and nearest points against closed forms; views without copies."""
import gc
import threading
import time

import numpy as np
import pytest

import lidarena


def test_rays_meet_the_walls_at_their_distance(room):
    hits = room.cast([[0.0, 0.0, 1.0]], [[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, -2, 0]])
    np.testing.assert_allclose(hits["range"], [4.0, 4.0, 2.0, 3.0], atol=1e-5)
    np.testing.assert_allclose(hits["normal"][0], [-1, 0, 0], atol=1e-6)
    missed = room.cast([[0.0, 0.0, 1.0]], [[1, 0, 0]], max_range=3.0)
    assert np.isinf(missed["range"][0])


def test_nearest_points_lie_on_the_surface(room):
    rng = np.random.default_rng(1)
    points = rng.uniform([-3.9, -2.9, 0.1], [0.9, 0.9, 2.9], (500, 3))
    nearest = room.closest_points(points)
    walls = np.stack([points[:, 0] + 4, points[:, 1] + 3, points[:, 2], 3 - points[:, 2]], 1).min(1)
    pillar = np.linalg.norm(np.maximum([1.0, 1.0] - points[:, :2], 0), axis=1)
    np.testing.assert_allclose(nearest["distance"], np.minimum(walls, pillar), atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(nearest["point"] - points, axis=1),
                               nearest["distance"], atol=1e-12)


def test_the_mesh_is_viewed_not_copied_and_cannot_be_written(room):
    first, second = room.vertices, room.vertices
    assert np.shares_memory(first, second)
    assert not first.flags.owndata
    with pytest.raises(ValueError):
        first[0, 0] = 1.0


def test_a_view_keeps_its_owner_alive():
    world = lidarena.World([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    vertices = world.vertices
    del world
    gc.collect()
    np.testing.assert_array_equal(vertices, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])


def test_bad_meshes_are_refused_with_place():
    with pytest.raises(lidarena.InputError, match=r"vertices: is not of shape \(N, 3\)"):
        lidarena.World([[0, 0], [1, 1]], [[0, 1, 1]])
    with pytest.raises(ValueError, match="soup"):
        lidarena.World([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]], name="soup")
    with pytest.raises(lidarena.InputError, match="did you mean 'house'"):
        lidarena.load_world("huose")


def test_an_sdf_world_is_loaded_without_what_is_missing_if_allowed(tmp_path):
    file = tmp_path / "hall.sdf"
    file.write_text(
        "<?xml version='1.0'?><sdf version='1.6'><world name='w'><model name='m'><link name='l'>"
        "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual></link></model>"
        "<include><uri>model://no_chair</uri></include></world></sdf>")
    with pytest.raises(lidarena.InputError) as refused:
        lidarena.load_world(file)
    if "cannot read SDF" in str(refused.value):
        pytest.skip("this build cannot read SDF worlds")
    assert "model://no_chair" in str(refused.value)
    assert len(lidarena.load_world(file, allow_missing=True).triangles) == 12


def test_other_threads_go_on_during_a_long_call(room):
    """The GIL is released: another thread counts while rays are cast."""
    directions = np.random.default_rng(2).normal(size=(2_000_000, 3)).astype(np.float32)
    count, stop = [0], threading.Event()

    def counting():
        while not stop.is_set():
            count[0] += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=counting)
    thread.start()
    before = count[0]
    hits = room.cast([[0.0, 0.0, 1.0]], directions, threads=1)
    during = count[0] - before
    stop.set()
    thread.join()
    assert np.isfinite(hits["range"]).all()
    assert during > 20  # with the GIL held it would be 0 or 1
