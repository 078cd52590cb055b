"""A Slurm of one node in a folder: munged, slurmctld and slurmd without systemd and without root's
configuration, on free ports. All of it ends with the `with` block, also after a failure."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel"]
SBIN = "/usr/sbin"

CONFIGURATION = """ClusterName=clearway
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/log/slurmctld
SlurmdLogFile={folder}/log/slurmd
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobRequeue=1
MinJobAge=600
MaxArraySize={max_array}
SchedulerParameters=defer,sched_interval=1,sched_min_interval=100000,batch_sched_delay=0,bf_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} Boards=1 SocketsPerBoard=1 CoresPerSocket={cpus} ThreadsPerCore=1 RealMemory=900 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def what_is_missing():
    """Programs that are not installed."""
    path = os.environ["PATH"] + ":" + SBIN
    return [name for name in PROGRAMS if shutil.which(name, path=path) is None]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class OneNodeSlurm:
    def __init__(self, folder, cpus=2, max_array=1001):
        self.folder = pathlib.Path(folder)
        self.cpus, self.max_array = cpus, max_array
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))
        self.environment["PATH"] += ":" + SBIN

    def __enter__(self):
        try:
            self._start()
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(self, *_):
        self._stop()

    def run(self, *command, check=True):
        done = subprocess.run([str(word) for word in command], env=self.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if check and done.returncode != 0:
            raise RuntimeError(f"{command}: exit code {done.returncode}: {done.stdout}")
        return done.stdout

    def _start(self):
        for name in ["state", "spool", "log", "munge"]:
            (self.folder / name).mkdir(parents=True)
        (self.folder / "munge").chmod(0o700)
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(64))
        key.chmod(0o400)
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout
        host = socket.gethostname().split(".")[0]
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=host, user=user.strip(), folder=self.folder, ports=free_ports(2), cpus=self.cpus,
            max_array=self.max_array))
        munge = self.folder / "munge"
        self.run("munged", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket",
                 f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed",
                 "--num-threads=2")
        self.run("slurmctld", "-c", "-f", self.folder / "slurm.conf")
        self.run("slurmd", "-f", self.folder / "slurm.conf")
        self._wait_until_idle(host)

    def _wait_until_idle(self, host):
        last = time.monotonic() + 30
        while "State=IDLE" not in self.run("scontrol", "show", "node", host, check=False):
            if time.monotonic() > last:
                raise RuntimeError("the node does not come up: " +
                                   (self.folder / "log/slurmctld").read_text()[-3000:])
            time.sleep(0.2)

    def _stop(self):
        """Only what was started here, by the numbers that it wrote itself."""
        self.run("scancel", "--user=" + str(os.getuid()), check=False)
        self.run("scontrol", "shutdown", check=False)
        files = [self.folder / name for name in ["slurmctld.pid", "slurmd.pid", "munge/pid"]]
        numbers = [int(file.read_text()) for file in files if file.exists()]
        self._wait_for_end(numbers[:-1], 5)
        for number in numbers:
            self._signal(number, signal.SIGTERM)
        self._wait_for_end(numbers, 5)
        for number in numbers:
            self._signal(number, signal.SIGKILL)

    @staticmethod
    def _signal(number, which):
        try:
            os.kill(number, which)
            return True
        except ProcessLookupError:
            return False

    def _wait_for_end(self, numbers, seconds):
        last = time.monotonic() + seconds
        while time.monotonic() < last and any(self._signal(number, 0) for number in numbers):
            time.sleep(0.1)
