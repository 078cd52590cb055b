"""A Slurm of one node in a folder: munged, slurmctld and slurmd without systemd and without root's
configuration, on free ports. All of it ends with the `with` block, also after a failure."""

import os
import pwd
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

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
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 Boards=1 SocketsPerBoard=1 CoresPerSocket=2 ThreadsPerCore=1 RealMemory=900 State=UNKNOWN
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


def signalled(number, which):
    """Whether there was a process with this number to get the signal."""
    try:
        os.kill(number, which)
        return True
    except ProcessLookupError:
        return False


class OneNodeSlurm:
    def __init__(self, folder, max_array):
        self.folder, self.max_array = Path(folder), max_array
        self.environment = {**os.environ, "SLURM_CONF": f"{folder}/slurm.conf", "PATH": f"{os.environ['PATH']}:{SBIN}"}

    def __enter__(self):
        try:
            self._start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def run(self, *command, check=True):
        done = subprocess.run(list(map(str, command)), env=self.environment, text=True, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if check and done.returncode != 0:
            raise RuntimeError(f"{command}: exit code {done.returncode}: {done.stdout}")
        return done.stdout

    def _start(self):
        for name in ("state", "spool", "log", "munge"):
            (self.folder / name).mkdir(parents=True)
        munge = self.folder / "munge"
        munge.chmod(0o700)
        (munge / "key").write_bytes(os.urandom(64))
        (munge / "key").chmod(0o400)
        host = socket.gethostname().split(".")[0]
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=host, user=pwd.getpwuid(os.getuid()).pw_name, folder=self.folder, ports=free_ports(2),
            max_array=self.max_array))
        self.run("munged", "--force", "--num-threads=2", *(f"--{option}={munge}/{option.split('-')[0]}" for option in (
            "key-file", "socket", "pid-file", "log-file", "seed-file")))
        self.run("slurmctld", "-c", "-f", self.folder / "slurm.conf")
        self.run("slurmd", "-f", self.folder / "slurm.conf")
        last = time.monotonic() + 30
        while "State=IDLE" not in self.run("scontrol", "show", "node", host, check=False):
            if time.monotonic() > last:
                raise RuntimeError("the node does not come up: " + (self.folder / "log/slurmctld").read_text()[-3000:])
            time.sleep(0.2)

    def __exit__(self, *_):
        """Ends what was started here, by the numbers that it wrote itself."""
        self.run("scancel", f"--user={os.getuid()}", check=False)
        self.run("scontrol", "shutdown", check=False)
        files = [self.folder / name for name in ("slurmctld.pid", "slurmd.pid", "munge/pid")]
        numbers = [int(file.read_text()) for file in files if file.exists()]
        for waited, which in ((numbers[:-1], signal.SIGTERM), (numbers, signal.SIGKILL)):
            last = time.monotonic() + 5
            while time.monotonic() < last and any(signalled(number, 0) for number in waited):
                time.sleep(0.1)
            for number in numbers:
                signalled(number, which)
