# SPDX-License-Identifier: BSD-3-Clause
"""C++ odometries and one in Python on the same events; files written and read back; scores."""
import os
import pathlib
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import lidarena


class TruthOdometry(lidarena.Odometry):
    """Returns the true poses, which must come out unchanged."""

    def __init__(self, flight):
        super().__init__()
        self.flight, self.scans, self.samples = flight, [], 0

    def register_imu(self, sample):
        self.samples += 1

    def track(self, scan):
        self.scans.append(scan)
        return lidarena.ScanResult(scan.stamp, self.flight.at(scan.stamp).pose,
                                   counters={"points": len(scan)})

    def map(self):
        return np.array([[4.0, 0.0, 1.0]], np.float32)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory, room, flight, sensor):
    """The flight's first second as a dataset folder with truth."""
    folder = tmp_path_factory.mktemp("data") / "room"
    rig = lidarena.make_rig([sensor])
    with lidarena.DatasetWriter(folder, rig) as writer:
        for t in range(0, 1_000_000_001, 10_000_000):
            writer.write_truth(t, flight.at(t).pose)
        for sensor_id, data in lidarena.simulate(room, flight, [sensor], seconds=1.0):
            writer.write(sensor_id, data)
    room.save(folder / "world.ply")
    return folder


def test_a_dataset_reads_back_as_it_was_written(recorded, room, flight, sensor):
    dataset = lidarena.open_dataset(recorded)
    assert dataset.rig == lidarena.make_rig([sensor])
    fresh = lidarena.simulate(room, flight, [sensor], seconds=1.0)
    count = 0
    for (id_a, a), (id_b, b) in zip(dataset, fresh):
        assert id_a == id_b and a.stamp == b.stamp
        if isinstance(a, lidarena.Scan):
            assert a.points.tobytes() == b.points.tobytes()
        count += 1
    assert count > 200
    np.testing.assert_allclose(lidarena.load_truth(recorded).positions[50],
                               flight.at(500_000_000).pose[:3, 3], atol=1e-8)


def test_an_unfinished_dataset_does_not_look_whole(tmp_path, sensor):
    with pytest.raises(RuntimeError, match="broke off"):
        with lidarena.DatasetWriter(tmp_path / "broken", lidarena.make_rig([sensor])):
            raise RuntimeError("broke off")
    with pytest.raises(lidarena.InputError):
        lidarena.open_dataset(tmp_path / "broken")


def test_a_python_odometry_is_run_and_scored(recorded, room, flight):
    odometry = TruthOdometry(flight)
    result = lidarena.run(odometry, lidarena.open_dataset(recorded))
    assert result.summary["scans"] == len(odometry.scans) == 10
    assert odometry.samples > 150
    assert result.summary["statuses"] == {"tracked": 10}
    np.testing.assert_allclose(result.trajectory.positions,
                               flight.sample(result.trajectory.stamps).positions, atol=1e-12)
    metrics = lidarena.evaluate(result.trajectory, lidarena.load_truth(recorded),
                                map=odometry.map(), world=room)
    assert metrics["status"] == "ok"
    assert odometry.scans[0].points.size > 1000  # still alive after the run


def test_what_python_raises_comes_out_of_the_run(recorded):
    class Failing(lidarena.Odometry):
        def track(self, scan):
            raise KeyError("my own fault")

    with pytest.raises(KeyError, match="my own fault"):
        lidarena.run(Failing(), lidarena.open_dataset(recorded))
    with pytest.raises(lidarena.InputError, match="is not a rigid transform"):
        lidarena.ScanResult(0, np.ones((4, 4)))
    with pytest.raises(lidarena.InputError, match="use one of: tracked"):
        lidarena.ScanResult(0, np.eye(4), status="fine")


def test_our_odometry_follows_the_flight(recorded, flight):
    dataset = lidarena.open_dataset(recorded)
    odometry = lidarena.make_odometry(dataset.rig, "kiss_icp", overrides=["max_range_m=50"])
    assert odometry.config["max_range_m"] == 50
    result = lidarena.run(odometry, dataset)
    truth = flight.sample(result.trajectory.stamps)
    moved = result.trajectory.positions[-1] - result.trajectory.positions[0]
    # The flight begins at 0.4 m/s, which no odometry can know in its first scan of 0.1 s: 4 cm.
    # The rest is the range noise of 2 cm over thousands of points.
    np.testing.assert_allclose(moved, truth.positions[-1] - truth.positions[0], atol=0.06)
    assert len(result.map) > 1000


def test_events_may_come_from_any_iterable(recorded, flight):
    events = list(lidarena.open_dataset(recorded))
    by_list = lidarena.run(TruthOdometry(flight), events)
    assert by_list.summary["scans"] == 10
    with pytest.raises(lidarena.InputError, match="neither a Scan nor an ImuSample"):
        lidarena.run(TruthOdometry(flight), [("livox_mid360", 5)])


def test_trajectories_are_views_and_survive_files(tmp_path, flight):
    path = flight.sample(np.arange(0, 2_000_000_000, 100_000_000))
    assert path.poses.shape == (20, 4, 4) and not path.poses.flags.owndata
    assert np.shares_memory(path.poses, path.positions)
    np.testing.assert_array_equal(path.poses[:, :3, 3], path.positions)
    np.testing.assert_array_equal(path.poses[:, 3], np.tile([0, 0, 0, 1], (20, 1)))
    path.write(tmp_path / "path.tum")
    again = lidarena.read_trajectory(tmp_path / "path.tum")
    np.testing.assert_array_equal(again.stamps, path.stamps)
    np.testing.assert_allclose(again.positions, path.positions, atol=1e-8)
    between = path.at(50_000_000)
    np.testing.assert_allclose(between[:3, 3], path.positions[:2].mean(axis=0), atol=1e-12)
    assert path.at(-1) is None
    with pytest.raises(lidarena.InputError, match="not later than that of the pose before"):
        lidarena.Trajectory([5, 4], np.tile(np.eye(4), (2, 1, 1)))


def test_a_written_pose_becomes_its_matrix():
    half = np.sqrt(0.5)
    turned = lidarena.matrix([1, 2, 3, 0, 0, half, half])  # a quarter turn about z
    np.testing.assert_allclose(turned, [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]],
                               atol=1e-15)
    q = np.array([0.1, -0.2, 0.3, 0.9])
    rotation = lidarena.matrix([0, 0, 0, *q])[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(rotation @ q[:3], q[:3], atol=1e-15)  # the axis is unchanged


def test_map_errors_are_distances_to_the_mesh(room, tmp_path):
    points = np.array([[4.1, 0, 1], [-4.0, 0, 1], [0, 0, 3.3], [np.nan, 0, 0]], np.float32)
    figures, distances = lidarena.map_error(points, room)
    np.testing.assert_allclose(distances[:3], [0.1, 0.0, 0.3], atol=1e-6)
    assert np.isnan(distances[3])
    lidarena.write_cloud(tmp_path / "map.ply", points)
    np.testing.assert_array_equal(lidarena.read_cloud(tmp_path / "map.ply"), points)
    assert figures["points"] == 3 and figures["invalid_points"] == 1


def test_a_python_odometry_stands_in_a_study(tmp_path, room, flight):
    """Together with a C++ odometry, with the command `lidarena study`."""
    program = os.environ.get("LIDARENA_PROGRAM")
    if not program:
        pytest.skip("LIDARENA_PROGRAM is not set")
    room.save(tmp_path / "room.ply")
    flight.sample(np.arange(0, 1_000_000_001, 10_000_000)).write(tmp_path / "path.tum")
    (tmp_path / "mine.py").write_text(textwrap.dedent("""
        import numpy as np
        import lidarena
        import lidarena.external

        class Still(lidarena.Odometry):
            def track(self, scan):
                return lidarena.ScanResult(scan.stamp, np.eye(4))

        lidarena.external.main(lambda rig: Still())
        """))
    (tmp_path / "study.yaml").write_text(textwrap.dedent(f"""
        title: Mine and theirs
        scenes: [{{world: {tmp_path}/room.ply, flight: {tmp_path}/path.tum}}]
        sensors: [livox_mid360]
        external:
          - {{name: mine, command: "{sys.executable} {tmp_path}/mine.py {{input}} {{output}}", pose_of: body}}
        algorithms: [kiss_icp, mine]
        """))
    configs = lidarena.configs.root
    done = subprocess.run([program, "study", str(tmp_path / "study.yaml"), "--out",
                           str(tmp_path / "out"), "--configs", str(configs), "--quiet"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    run = next(pathlib.Path(tmp_path / "out" / "runs").glob("*mine*"))
    estimate = lidarena.read_trajectory(run / "trajectory.tum")
    assert np.ptp(estimate.positions, axis=0).max() == 0.0
