# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a known room, their layout, and identical bytes for the same seed."""
import numpy as np
import pytest

import lidarena


def test_points_lie_on_the_walls_when_noise_is_off(room, flight, sensor):
    lidar = lidarena.Lidar(sensor, noise=False)
    scan, truth = lidar.measure(room, flight, 3, truth=True)
    assert len(scan) == len(truth) > 10_000
    assert scan.stamp == 3 * lidar.period
    assert room.closest_points(truth["position"])["distance"].max() < 1e-5
    # each point, placed by the pose at its own instant, is where its ray hit
    sensor_pose = np.eye(4)
    x, y, z, qx, qy, qz, qw = sensor.body_from_lidar
    assert (qx, qy, qz, abs(qw)) == (0, 0, 0, 1)
    sensor_pose[:3, 3] = x, y, z
    for i in range(0, len(scan), 997):
        pose = flight.at(scan.stamp + int(scan.points["dt_ns"][i])).pose @ sensor_pose
        placed = pose[:3, :3] @ scan.positions[i] + pose[:3, 3]
        np.testing.assert_allclose(placed, truth["position"][i], atol=2e-5)


def test_scans_are_views(room, flight, sensor):
    scan = lidarena.Lidar(sensor).measure(room, flight, 0)
    assert scan.points.dtype == lidarena.POINT
    assert scan.points.dtype.itemsize == 24
    assert np.shares_memory(scan.points, scan.positions)
    np.testing.assert_array_equal(scan.points["position"], scan.positions)
    copy = lidarena.Scan(scan.stamp, scan.points)
    np.testing.assert_array_equal(copy.points, scan.points)
    assert not np.shares_memory(copy.points, scan.points)


def test_the_same_seed_gives_the_same_bytes_on_any_threads(room, flight, sensor):
    def scan(seed, threads):
        return lidarena.Lidar(sensor, seed=seed).measure(room, flight, 1, threads=threads)
    assert scan(5, 1).points.tobytes() == scan(5, 2).points.tobytes()
    assert scan(5, 1).points.tobytes() != scan(6, 1).points.tobytes()


def test_events_come_in_order_with_the_imu_before_its_scan(room, flight, sensor):
    latest_imu, scans = -1, 0
    for sensor_id, data in lidarena.simulate(room, flight, [sensor], seconds=1.0):
        assert sensor_id == sensor.name
        if isinstance(data, lidarena.Scan):
            scans += 1
            assert latest_imu >= data.stamp + int(data.points["dt_ns"].max())
        else:
            assert data.stamp > latest_imu
            latest_imu = data.stamp
    assert scans == 10


def test_fields_of_a_sensor_come_from_its_own_list(sensor):
    own = lidarena.Sensor(**sensor.to_dict())
    assert own == sensor
    own.set("imu.rate_hz=100")
    own.max_range_m = 12.5
    assert own.imu["rate_hz"] == 100 and own.max_range_m == 12.5
    assert "max_range_m" in dir(own)
    assert ("max_range_m", "m") in [row[:2] for row in lidarena.Sensor.fields()]
    with pytest.raises(lidarena.InputError, match="did you mean 'max_range_m'"):
        own.max_rnge_m = 3
    with pytest.raises(lidarena.InputError, match="max_range_m"):
        own.max_range_m = -1.0
    with pytest.raises(AttributeError):
        own.no_such_field
