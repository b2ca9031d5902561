# SPDX-License-Identifier: BSD-3-Clause
"""Studies on a real Slurm: two nodes on this machine. See slurm_cluster.py for what it needs.

usage: cluster_test.py PROGRAM CONFIGS [efficiency]

Each test runs the same study of 12 cells (six datasets with two cells) and disturbs it; then every file that does not tell
times must be that of a local run. `slow` is an external program that sleeps SLOW seconds before it writes its poses.
"""
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from slurm_cluster import SlurmCluster

TIMED = {"manifest.json", "resources.csv", "resources.json", "lidarena.log", "program.log", "request.json"}
FLIGHT = "kind: waypoints\nwaypoints: [[2, 2, 1.5], [10, 2, 1.2], [10, 7, 1.8], [2, 6.5, 1.5], [2, 2, 1.5]]\n"
CORNERS = [(x, y, z) for z in (0, 4) for y in (0, 8) for x in (0, 12)]
FACES = ["1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"]
ROOM = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"f {f}\n" for f in FACES)
STUDY = """title: Twelve cells
scenes: [{{world: {here}/room.obj, flight: {here}/flight.yaml, seconds: 1}}]
seeds: [1, 2, 3, 4, 5, 6]
sensors: [livox_mid360]
external: [{{name: slow, command: "sh {here}/slow.sh {{output}}"}}]
algorithms: [kiss_icp, slow]
"""
SLOW = "sleep $SLOW; for t in 0.0 0.5; do echo $t 0 0 0 0 0 0 1; done > $1/trajectory.tum\n"
CELLS = 12


def results_of(study):
    """Bytes of the files that do not tell times, by their path in the study."""
    found = {}
    for part in ("datasets", "runs", "worlds"):
        for file in (study / part).rglob("*"):
            if file.is_file() and file.name not in TIMED:
                found[str(file.relative_to(study))] = file.read_bytes()
    return found


class Studies:
    """Submits the study again and again, each time into another folder."""

    def __init__(self, program, configs, here, cluster):
        self.program, self.configs, self.here, self.cluster = program, configs, here, cluster
        self.requeued_at = {}  # by job and number of its restart
        os.environ["SLOW"] = "0"
        (here / "room.obj").write_text(ROOM)
        (here / "flight.yaml").write_text(FLIGHT)
        (here / "slow.sh").write_text(SLOW)
        (here / "study.yaml").write_text(STUDY.format(here=here))
        self.call("study", here / "study.yaml", "--out", here / "local", "--jobs", 2)
        self.local = results_of(here / "local")
        assert sum(name.endswith("metrics.json") for name in self.local) == CELLS, sorted(self.local)

    def call(self, verb, *arguments, code=0):
        command = [self.program, verb, *map(str, arguments), "--json", "--quiet", "--configs", self.configs]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        assert done.returncode == code, f"{' '.join(command)}: {done.returncode}\n{done.stderr}"
        return json.loads(done.stdout)

    def submit(self, name, *options, slow=0, tasks=2, cpus=1):
        os.environ["SLOW"] = str(slow)
        return self.call("study", self.here / "study.yaml", "--out", self.here / name, "--slurm", "--partition", "main",
                         "--array-limit", tasks, "--cpus", cpus, *options)["job"]

    def status(self, name):
        return self.call("status", self.here / name)

    def wait_until(self, name, condition, what, seconds=60):
        self.cluster.wait_until(lambda: condition(self.status(name)), f"{name}: {what}", seconds)

    def tasks(self, job):
        """Number, state, ... of the tasks of an array job, and of the job that writes its report."""
        jobs = self.cluster.jobs()
        tasks = [fields for fields in jobs.values() if fields.get("ArrayJobId") == job and "_" not in fields["JobId"]]
        report = [fields for fields in jobs.values() if "ArrayJobId" not in fields and int(fields["JobId"]) > int(job)]
        return tasks, min(report, key=lambda fields: int(fields["JobId"]))

    def start_requeued(self, job):
        """Slurm lets requeued tasks wait for two minutes. This starts them after a few seconds, which the node needs to
        end the earlier start of the task."""
        for task in self.tasks(job)[0]:
            start = (task["JobId"], task["Restarts"])
            if task["JobState"] != "PENDING" or task["Restarts"] == "0":
                continue
            if time.monotonic() - self.requeued_at.setdefault(start, time.monotonic()) > 6:
                # fails if the task has just started
                subprocess.run(["scontrol", "update", f"jobid={task['JobId']}", "starttime=now"], check=False,
                               stderr=subprocess.DEVNULL)

    def wait_for_end(self, job, seconds=120):
        def has_ended():
            self.start_requeued(job)
            return self.tasks(job)[1]["JobState"] in ("COMPLETED", "FAILED")
        self.cluster.wait_until(has_ended, f"job {job}", seconds)

    def check_whole(self, name, job):
        tasks, report = self.tasks(job)
        logs = "\n".join(log.read_text() for log in sorted((self.here / name / "logs").iterdir()))
        assert report["ExitCode"] == "0:0", f"{logs}\n{tasks}"
        assert {task["JobState"] for task in tasks} == {"COMPLETED"}, logs
        status = self.status(name)
        assert (status["done"], status["failed"], status["missing"], status["workers"]) == (CELLS, 0, 0, []), status
        study = self.here / name
        results = results_of(study)
        differing = sorted(file for file in results.keys() | self.local.keys()
                           if results.get(file) != self.local.get(file))
        assert not differing, f"not as in a local run: {differing}"
        assert (study / "report.html").exists()
        assert not list((study / "work").iterdir())


def study_of_twelve_cells(studies):
    job = studies.submit("whole")
    studies.wait_for_end(job)
    studies.check_whole("whole", job)
    hosts = [line for log in (studies.here / "whole/logs").glob("task-*.log")
             for line in log.read_text().splitlines() if " on n" in line]
    assert len({line.split(" on ")[1].split(",")[0] for line in hosts}) == 2, hosts


def node_lost_in_the_middle(studies):
    job = studies.submit("lost", slow=2, cpus=2)
    studies.wait_until("lost", lambda status: status["done"] >= 2 and len(status["workers"]) == 2, "two workers")
    assert studies.cluster.lose_node("n2") > 2, "no process of a task was on the node"
    before = studies.status("lost")
    assert before["missing"] > 0, before
    studies.cluster.wait_until(
        lambda: studies.cluster.call("sinfo", "-h", "-n", "n2", "-o", "%T").startswith("down"), "n2 is down", 60)
    studies.wait_for_end(job)
    studies.cluster.start_node("n2")
    studies.check_whole("lost", job)
    assert any(int(task["Restarts"]) > 0 for task in studies.tasks(job)[0]), "Slurm has requeued no task"


def task_requeued(studies):
    job = studies.submit("requeued", slow=2)
    studies.wait_until("requeued", lambda status: status["done"] >= 2, "two cells")
    at_work = studies.status("requeued")["workers"][0]["job"]
    task = next(task for task in studies.tasks(job)[0] if task["JobId"] == at_work)
    studies.cluster.call("scontrol", "requeue", f"{job}_{task['ArrayTaskId']}")
    studies.wait_for_end(job)
    studies.check_whole("requeued", job)
    assert sum(int(task["Restarts"]) for task in studies.tasks(job)[0]) == 1


def submit_walltime(studies):
    """One task, on one core of n1, that needs more than its minute: it is told 40 s before, ends its cell, and is
    requeued."""
    return studies.submit("walltime", "--time", 1, "--warning", 40, "--sbatch=--nodelist=n1", slow=8, tasks=1)


def check_walltime(studies, job):
    studies.wait_for_end(job, seconds=200)
    studies.check_whole("walltime", job)
    tasks = studies.tasks(job)[0]
    assert int(tasks[0]["Restarts"]) >= 1, tasks


def full_disk(studies):
    """The scratch disk of the nodes has no room: tasks fail and say why; once there is room, the rest is done."""
    disk = studies.here / "disk"
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", str(disk)], check=True)
    try:
        job = studies.submit("full", "--scratch", disk)
        studies.wait_for_end(job)
        tasks, report = studies.tasks(job)
        assert [task["JobState"] for task in tasks] == ["FAILED", "FAILED"], tasks
        assert report["ExitCode"] == "1:0", "the report has to say that runs are missing"
        log = (studies.here / "full/logs/task-1.log").read_text()
        assert "the disk is full" in log or "No space left on device" in log, log
        status = studies.status("full")
        assert (status["missing"], status["failed"], status["workers"]) == (CELLS, 0, []), status
        subprocess.run(["mount", "-o", "remount,size=300m", str(disk)], check=True)
        job = studies.cluster.call("sbatch", "--parsable", studies.here / "full/tasks.sh")
        studies.cluster.call("sbatch", f"--dependency=afterany:{job}", studies.here / "full/report.sh")
        studies.wait_for_end(job)
        studies.check_whole("full", job)
        assert not list(disk.iterdir()), "the scratch folder is not empty"
    finally:
        subprocess.run(["umount", "--lazy", str(disk)], check=False)


def efficiency(studies):
    """How much of the time of one and of two nodes is work: runs that mostly sleep do not compete for cores."""
    for nodes in (1, 2):
        name = f"nodes{nodes}"
        job = studies.submit(name, tasks=nodes, slow=15)
        studies.wait_for_end(job, seconds=500)
        tasks = studies.tasks(job)[0]
        begin, end = (datetime.datetime.fromisoformat(choose(task[key] for task in tasks))
                      for choose, key in ((min, "StartTime"), (max, "EndTime")))
        took = (end - begin).total_seconds()
        requests = [json.loads(file.read_text()) for part in ("datasets", "runs")
                    for file in (studies.here / name / part).glob("*/request.json")]
        work = sum(request["result"]["seconds"] for request in requests)
        print(f"{nodes} nodes: {took:.0f} s, {work:.0f} s of work, efficiency {100 * work / nodes / took:.1f} %", flush=True)


def main():
    program, configs = (str(pathlib.Path(argument).resolve()) for argument in sys.argv[1:3])
    begin = time.monotonic()

    def told(what):
        print(f"-- cluster: {what} ({time.monotonic() - begin:.0f}s)", flush=True)

    with tempfile.TemporaryDirectory(prefix="lidarena-cluster-") as folder:
        here = pathlib.Path(folder)
        with SlurmCluster(here / "slurm") as cluster:
            told("Slurm runs with two nodes")
            studies = Studies(program, configs, here, cluster)
            told("the local run")
            if sys.argv[3:] == ["efficiency"]:
                return efficiency(studies)
            walltime = submit_walltime(studies)  # mostly waits, beside the others
            for test in (study_of_twelve_cells, task_requeued, full_disk):
                test(studies)
                told(test.__name__.replace("_", " "))
            check_walltime(studies, walltime)
            told("walltime")
            node_lost_in_the_middle(studies)
            told("node lost in the middle")


if __name__ == "__main__":
    main()
