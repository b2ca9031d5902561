# SPDX-License-Identifier: BSD-3-Clause
"""A Slurm cluster on this machine for tests: a controller and two nodes of two cores on the loopback.

Needs root and Debian's slurm-wlm and munge. It has its own keys, ports and folders, so that it does not touch an installed
Slurm; everything ends with the `with` block.
"""
import os
import pathlib
import signal
import socket
import subprocess
import time

NODES = ("n1", "n2")
CONF = """ClusterName=lidarena
SlurmctldHost=localhost
SlurmUser=root
SlurmdUser=root
SlurmctldPort={ports[0]}
AuthInfo=socket={here}/munge.socket
StateSaveLocation={here}/state
SlurmdSpoolDir={here}/spool-%n
SlurmctldPidFile={here}/slurmctld.pid
SlurmdPidFile={here}/slurmd-%n.pid
SlurmctldLogFile={here}/slurmctld.log
SlurmdLogFile={here}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobRequeue=1
ReturnToService=2
SlurmdTimeout=10
KillWait=5
MpiDefault=none
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SchedulerParameters=sched_interval=2,batch_sched_delay=0
NodeName=n[1-2] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[{ports[1]}-{ports[2]}] CPUs=2 RealMemory=1000
PartitionName=main Nodes=ALL Default=YES State=UP
"""


def three_free_ports():
    """Three consecutive ports that nobody uses."""
    for first in range(16800, 17800, 3):
        sockets = []
        try:
            for port in range(first, first + 3):
                sockets.append(socket.socket())
                sockets[-1].bind(("127.0.0.1", port))
            return list(range(first, first + 3))
        except OSError:
            continue
        finally:
            for one in sockets:
                one.close()
    raise RuntimeError("no free ports")


class SlurmCluster:
    def __init__(self, folder):
        self.here = pathlib.Path(folder).resolve()
        self.programs = {}

    def __enter__(self):
        for name in ("state", *(f"spool-{node}" for node in NODES)):
            (self.here / name).mkdir(parents=True)
        self.here.chmod(0o755)
        (self.here / "slurm.conf").write_text(CONF.format(here=self.here, ports=three_free_ports()))
        (self.here / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        os.environ["SLURM_CONF"] = str(self.here / "slurm.conf")
        key = self.here / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        try:
            self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.here}/munge.socket",
                       f"--pid-file={self.here}/munged.pid", f"--seed-file={self.here}/munged.seed",
                       f"--log-file={self.here}/munged.log")
            self.wait_until(lambda: (self.here / "munge.socket").exists(), "munged", 10)
            self.start("slurmctld", "-D")
            for node in NODES:
                self.start_node(node)
            self.wait_until(lambda: self.call("sinfo", "-h", "-o", "%T %D") == "idle 2", "both nodes", 30)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        subprocess.run(["scancel", "--quiet", "--state=PENDING"], check=False, timeout=20)
        subprocess.run(["scancel", "--quiet", "--state=RUNNING"], check=False, timeout=20)
        for program in reversed(list(self.programs.values())):
            program.terminate()
        for program in self.programs.values():
            try:
                program.wait(10)
            except subprocess.TimeoutExpired:
                program.kill()
                program.wait()

    def start(self, program, *arguments, name=None):
        log = open(self.here / f"{name or program}.out", "ab")
        self.programs[name or program] = subprocess.Popen([f"/usr/sbin/{program}", *arguments], stdout=log, stderr=log,
                                                          start_new_session=True)

    def start_node(self, node):
        self.start("slurmd", "-D", "-N", node, name=node)

    def lose_node(self, node):
        """Kills the node's daemon and all processes of its jobs, as when its power fails; returns how many."""
        victims = {self.programs[node].pid}
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (folder / "environ").read_bytes().split(b"\0")
                parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
                is_step = pathlib.Path(f"/proc/{parent}/cmdline").read_bytes().startswith(b"slurmstepd")
            except OSError:
                continue
            if {f"SLURMD_NODENAME={node}".encode(), f"SLURM_CONF={self.here}/slurm.conf".encode()} <= set(environment):
                victims |= {int(folder.name), parent} if is_step else {int(folder.name)}
        for victim in victims:
            try:
                os.kill(victim, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.programs[node].wait()
        return len(victims)

    @staticmethod
    def call(*command):
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, timeout=60).stdout.strip()

    @staticmethod
    def wait_until(condition, what, seconds):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise RuntimeError(f"{what}: not within {seconds} s")
            time.sleep(0.2)

    def jobs(self):
        """State and exit code of each job and array task, by its number or JOB_TASK."""
        found = {}
        for line in self.call("scontrol", "--oneliner", "show", "jobs").splitlines():
            fields = dict(field.split("=", 1) for field in line.split() if "=" in field)
            if "JobId" not in fields:
                continue
            name = fields["JobId"]
            if "ArrayTaskId" in fields:
                name = f"{fields['ArrayJobId']}_{fields['ArrayTaskId']}"
            found[name] = fields
        return found
