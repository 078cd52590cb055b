"""What a file of figures says of the machine and the program."""

import os
import platform
import subprocess
from pathlib import Path


def processor():
    """The name of this machine's processor."""
    names = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
             if line.startswith("model name")]
    return names[0] if names else platform.machine()


def header(experiment, program, size, gpus=()):
    version = subprocess.run([program, "--version"], capture_output=True, text=True,
                             check=True).stdout.strip()
    commit = subprocess.run(["git", "-C", Path(__file__).parent, "describe", "--always", "--dirty",
                             "--abbrev=12", "--exclude=*"], capture_output=True, text=True).stdout.strip()
    return {"experiment": experiment, "size": size,
            "machine": {"processor": processor(),
                        "cores": len(os.sched_getaffinity(0)),
                        "memory_bytes": os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGESIZE"),
                        "gpus": list(gpus), "system": platform.freedesktop_os_release()["PRETTY_NAME"]},
            "clearway": {"version": version, "commit": commit or "unknown"}, "parameters": {}}
