# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import lidarena


def room_mesh(size=(8.0, 6.0, 3.0)):
    """A box centered above the origin, floor at z = 0, with a pillar inside; seen from inside."""
    def box(low, high):
        corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1])
                            for z in (low[2], high[2])], float)
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    shell = box((-size[0] / 2, -size[1] / 2, 0.0), (size[0] / 2, size[1] / 2, size[2]))
    pillar = box((1.0, 1.0, 0.0), (1.5, 1.8, size[2]))
    vertices = np.vstack([shell[0], pillar[0]])
    return vertices, np.vstack([shell[1], pillar[1] + 8]).astype(np.uint32)


@pytest.fixture(scope="session")
def room():
    return lidarena.World(*room_mesh(), name="room")


@pytest.fixture(scope="session")
def flight():
    """2 s on a circular arc at 1.5 m height, facing along x."""
    stamps = np.arange(0, 2_000_000_001, 50_000_000)
    angles = 0.4 * stamps * 1e-9
    poses = np.tile(np.eye(4), (len(stamps), 1, 1))
    poses[:, 0, 3], poses[:, 1, 3], poses[:, 2, 3] = np.sin(angles), 1 - np.cos(angles) - 1.0, 1.5
    return lidarena.replay(lidarena.Trajectory(stamps, poses))


@pytest.fixture(scope="session")
def sensor():
    return lidarena.load_sensor("livox_mid360_range_noise")
