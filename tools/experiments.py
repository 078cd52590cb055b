#!/usr/bin/python3
"""Runs one of the paper's experiments, or of ours, and writes its figures as JSON for tools/charts.py.

Every case is a `clearway run` in a process of its own, or a command of clearway-bench where it sets an
engine as no run does. A file is gone on with by --resume; a case that it has is not measured again,
unless a smaller --limit stopped it.
Needs numpy and h5py (Debian: python3-h5py).
Example: tools/experiments.py build/release/tools table -o table.json --work /tmp/scenes
"""

import argparse
import atexit
import fcntl
import hashlib
import json
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter, namedtuple
from functools import cache
from itertools import product
from pathlib import Path

import h5py
import numpy as np

from bench import variants
from trials import verdicts
from trials.scans import Scene
from trials.seen_space import Ground, look
from trials.verdicts import ERRORS, SHAPES, monte_carlo

RADIUS = 0.1  # of all experiments that do not vary it, metres; it is the paper's
SCENES = ("mine", "hall", "plant", "tunnel")
# Environment points, model points and poses.
FULL = {"mine": (806_183_400, 100_000, 17_795), "hall": (55_872_714, 214_489, 17_234),
        "plant": (350_109_065, 434_700, 398_999), "tunnel": (18_919_000, 28_622, 19_392)}
SMALL = {"mine": (4_000_000, 10_000, 1_800), "hall": (1_110_000, 20_000, 1_700),
         "plant": (2_000_000, 40_000, 8_000), "tunnel": (500_000, 5_000, 1_900)}
# Seconds of a case after which it is not repeated.
ENOUGH = {"smoke": 3, "small": 3, "full": 30}
# Options that only clearway-bench search has.
SETTINGS = ("--field-voxel", "--grid-cell", "--precision")
MEMORY = r"--(device-)?memory( \d+ is enough)?\s*$"
NON_RIGID = "--allow-non-rigid accepts"

Files = namedtuple("Files", "environment store model trajectory")
Engine = namedtuple("Engine", "name options exact")


def sizes(scene, size):
    if size == "smoke":
        return 20_000, 500, 100
    if size == "small":
        return SMALL[scene]
    points, *others = FULL[scene]
    return (points // 10 if size == "tenth" else points, *others)


def judged(result, truth):
    """What a result decides wrongly, from exact distances that reach beyond the radius."""
    with h5py.File(result) as got, h5py.File(truth) as right:
        facts = json.loads(bytes(right["header"][:]))
        points, radius = facts["environment_points"], facts["radius"]
        found, expected = got["collisions/source"][:], right["collisions/source"][:]
        known, distances = right["clearance/source"][:], right["clearance/distance"][:]
    false_hits = np.setdiff1d(found[found < points], expected, assume_unique=True)
    misses = np.setdiff1d(expected, found, assume_unique=True)
    wrong = np.concatenate([false_hits, misses])
    at = np.minimum(np.searchsorted(known, wrong), len(known) - 1)
    off = np.abs(distances[at] - radius)[known[at] == wrong] if len(known) else np.empty(0)
    decades = [float(f"1e{i}") for i in range(-16, 1)]
    return {"false_hits": len(false_hits), "misses": len(misses),
            "share": len(wrong) / max(points, 1), "beyond": len(wrong) - len(off),
            "largest_distance": float(off.max(initial=0)),
            "histogram": np.bincount(np.searchsorted(decades, off, "right"), minlength=18).tolist()}


def compared(result, reference):
    with h5py.File(result) as one, h5py.File(reference) as other:
        here, there = one["collisions/source"][:], other["collisions/source"][:]
    common = len(np.intersect1d(here, there, assume_unique=True))
    return {"common": common, "only_here": len(here) - common,
            "only_in_reference": len(there) - common, "equal": np.array_equal(here, there)}


def near_boundary(truth):
    """How many points lie within 1, 2, 4 ... ulps of the radius."""
    with h5py.File(truth) as right:
        facts = json.loads(bytes(right["header"][:]))
        points, radius = facts["environment_points"], facts["radius"]
        off = np.sort(np.abs(right["clearance/distance"][:] - radius))
    within = np.searchsorted(off, np.spacing(radius) * 2.0 ** np.arange(41), "right")
    return {"environment_points": points, "within_ulps": within.tolist()}


def header(experiment, program, size, gpus):
    """What a record says of the machine and the program."""
    processors = re.findall(r"^model name\s*: (.*)", Path("/proc/cpuinfo").read_text(), re.M)
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    commit = subprocess.run(["git", "-C", Path(__file__).parent, "describe", "--always", "--dirty",
                             "--abbrev=12", "--exclude=*"], capture_output=True, text=True).stdout.strip()
    return {"experiment": experiment, "size": size,
            "machine": {"processor": processors[0].strip() if processors else platform.machine(),
                        "cores": len(os.sched_getaffinity(0)),
                        "memory_bytes": os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGESIZE"),
                        "gpus": gpus, "system": platform.freedesktop_os_release()["PRETTY_NAME"]},
            "clearway": {"version": version, "commit": commit or "unknown",
                         "program": hashlib.sha256(program.read_bytes()).hexdigest()[:12]}}


class Failed(Exception):
    """A run that failed; `finding` is what a record keeps of it."""

    def __init__(self, command, finding, log):
        super().__init__(f"{' '.join(map(str, command))}: {log.strip()}")
        self.finding, self.log = finding, log

    def counts(self, refusal):
        """Whether it is a finding: the limit was exceeded, or the log has the pattern."""
        return "limit" in self.finding or (refusal is not None and re.search(refusal, self.log))


def attempted(findings, refusal):
    """What a function finds, or how it failed where that is a finding."""
    try:
        return findings()
    except Failed as failed:
        if failed.counts(refusal):
            return {"failed": failed.finding}
        raise


class Bench:
    """Runs the programs, and keeps what they report."""

    def __init__(self, experiment, options):
        self.options, self.size, self.work = options, options.size, options.work
        self.cores = len(os.sched_getaffinity(0))
        gpus = subprocess.run(["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"],
                              capture_output=True, text=True).stdout.split("\n")[:-1] if (
                                  shutil.which("nvidia-smi")) else []
        if options.device == "cuda" and not gpus:
            sys.exit("no GPU; --device cpu measures without")
        self.cuda = bool(gpus) and options.device != "cpu"
        self.here = "cuda" if self.cuda else "cpu"
        self.wrong = []
        self.lock_work()
        record = header(experiment, options.programs / "clearway", self.size, gpus)
        record["parameters"] = {
            "device": self.here, "scenes": options.scenes, **{
                name: getattr(options, name) for name in ("repetitions", "memory", "device_memory", "limit")},
            **{name: str(getattr(options, name)) for name in ("gpus", "cold", "env") if getattr(options, name)}}
        self.open_record(record)

    def some(self, values):
        """All values, or of many the first, the middle and the last where the size is smoke."""
        if self.size != "smoke":
            return values
        return [values[i] for i in sorted({0, len(values) // 2, len(values) - 1})]

    def slow(self, values):
        """All values, or none where the size is smoke."""
        return values if self.size != "smoke" else []

    def lock_work(self):
        self.work.mkdir(parents=True, exist_ok=True)
        self.lock = open(self.work / "bench.lock", "w")  # open as long as the experiment
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            sys.exit(f"{self.work}: another experiment uses it; wait for it, or take another --work")

    def open_record(self, record):
        """Goes on with the file of the same experiment, or begins it."""
        self.record = {**record, "cases": []}
        path = self.options.output
        if path.exists() and not self.options.force:
            if not self.options.resume:
                sys.exit(f"{path}: exists; --resume goes on with it, --force replaces it")
            earlier = json.loads(path.read_text())
            scenes = record["parameters"]["scenes"] = list(dict.fromkeys(
                earlier["parameters"]["scenes"] + record["parameters"]["scenes"]))
            same = {**earlier, "cases": [],
                    "parameters": {**earlier["parameters"], "scenes": scenes, "limit": self.options.limit},
                    "clearway": {**earlier["clearway"], "commit": record["clearway"]["commit"]}}
            for name in self.record:
                if same.get(name) != self.record[name]:
                    sys.exit(f"{path}: differs in {name}: {same.get(name)} in the file, "
                             f"{self.record[name]} now; --force replaces it")
            self.record["cases"] = earlier["cases"]
        made_by = self.work / "made-by.txt"
        if made_by.exists() and made_by.read_text() != record["clearway"]["program"]:
            sys.exit(f"{self.work}: made by another program; take another --work, or remove the folder")
        made_by.write_text(record["clearway"]["program"])

    # Programs

    def execute(self, program, *words, limit=None, stdin=None):
        """Runs a program, and returns what it printed, seconds, seconds of processors and peak memory.
        Raises Failed."""
        command = [self.options.programs / program, *map(str, words)]
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
            start = time.monotonic()
            process = subprocess.Popen(command, stdin=stdin, stdout=out, stderr=err)
            try:
                late = False
                while not (ended := os.wait4(process.pid, os.WNOHANG))[0]:
                    time.sleep(0.002)
                    if not late and limit and time.monotonic() - start > limit:
                        late = True
                        process.terminate()
            except BaseException:
                process.send_signal(signal.SIGTERM)
                process.wait()
                raise
            wall = time.monotonic() - start
            process.returncode = os.waitstatus_to_exitcode(ended[1])
            for file in (out, err):
                file.seek(0)
            log = err.read()
            if late:
                raise Failed(command, {"after_seconds": wall, "limit": limit}, log)
            if process.returncode != 0:
                raise Failed(command, {"exit_code": process.returncode, "log": log}, log)
            self.disk_bytes = ended[2].ru_inblock * 512
            return out.read(), wall, ended[2].ru_utime + ended[2].ru_stime, ended[2].ru_maxrss * 1024

    def clearway(self, *words):
        return self.execute("clearway", *words)

    # Inputs and results, each made once and kept in the work folder

    def scene(self, name, size=None):
        size = size or self.size
        return self.with_store(self.made(name, f"{name}-{size}", sizes(name, size)), f"{name}-{size}")

    def with_store(self, files, label, *options):
        return files._replace(store=self.store(label, files.environment, *options))

    def made(self, name, label, counts):
        folder = self.work / label
        if not (folder / "trajectory.txt").exists():
            points, model_points, poses = counts
            self.clearway("scene", name, "-o", folder, "--points", points, "--model-points",
                          model_points, "--poses", poses, "--force")
        return Files(folder / "environment.las", None, folder / "model.ply", folder / "trajectory.txt")

    def scanned(self, name, points):
        """A scene with another number of points, whose store knows where its scanner stood."""
        whole, *others = sizes(name, self.size)
        label = f"{name}-{self.size}" + (f"-{points}" if points != whole else "")
        files = self.made(name, label, (points, *others))
        return self.with_store(files, label + "-origins", "--origins",
                               files.environment.with_name("origins.csv"))

    def store(self, label, environment, *options):
        path = self.work / f"{label}.h5"
        if not path.exists():
            self.clearway("convert", environment, "-o", path, "--memory", self.options.memory,
                          "--force", *options)
        return path

    def shifted(self, files, x, y):
        """The hall moved by whole metres, its environment and its poses."""
        label = f"hall-{self.size}-shifted-{x:.0f}-{y:.0f}"
        moved = files._replace(trajectory=self.work / f"{label}.txt", store=self.work / f"{label}.h5")
        if not moved.store.exists():
            variants.write_poses(moved.trajectory, variants.shifted(
                variants.read_poses(files.trajectory), (x, y, 0)))
            las = self.work / "shifted.las"
            variants.shift_environment(files.environment, las, (x, y, 0))
            self.store(label, las)
            las.unlink()
        return moved

    def changed_poses(self, files, change):
        """The files with poses that `change` makes of theirs."""
        path = self.work / "changed-poses.txt"
        variants.write_poses(path, change(variants.read_poses(files.trajectory)))
        return files._replace(trajectory=path)

    def answer(self, name, files, options):
        path = self.work / "answers" / f"{name}-{self.size}.h5"
        path.parent.mkdir(exist_ok=True)
        if not path.exists():
            self.execute(*self.command(files, path, options))
        return path

    def truth(self, name, files):
        """The exact result, with exact distances of all points farther than any method errs."""
        return self.answer(f"truth-{name}", files, [*self.engine_here("sweep").options, "--clearance", 0.3])

    # Engines

    @staticmethod
    def engine(name):
        kind, device = name.split()[0], name.split()[-1]
        exact = "float" not in name
        return Engine(name, ["--engine", kind, "--device", device,
                             *([] if exact else ["--precision", "float"])], exact)

    def engine_here(self, name):
        return self.engine(f"{name} {self.here}")

    def exact_engines(self):
        names = ["kdtree cpu", "sweep cpu"]
        if self.size != "full" or not self.cuda:
            names.append("grid cpu")
        return [self.engine(name) for name in names + ["grid cuda", "sweep cuda"] * self.cuda]

    # Cases

    def command(self, files, result, options):
        options = [str(word) for word in options]
        bench = any(word in SETTINGS for word in options)
        usual = {"--radius": RADIUS, "--memory": self.options.memory}
        if "cuda" in options:
            usual["--device-memory"] = self.options.device_memory
            if self.options.gpus:
                usual["--gpus"] = self.options.gpus
        more = [word for name, value in usual.items() if name not in options for word in (name, value)]
        return ["clearway-bench" if bench else "clearway", "search" if bench else "run", "--env",
                files.store, "--model", files.model, "--trajectory", files.trajectory, "-o", result,
                *([] if bench else ["--force", "--json"]), *more, *options]

    def find(self, key):
        """The case that the file has; None where it has yet to be measured, or a smaller limit has
        stopped it."""
        for case in self.record["cases"]:
            failed = case.get("failed") or case.get("findings", {}).get("failed") or {}
            limit = failed.get("limit", failed.get("after_seconds", self.options.limit))
            if case["key"] == key and limit >= self.options.limit:
                return case
        return None

    def add(self, case):
        cases = self.record["cases"]
        at = next((i for i, one in enumerate(cases) if one["key"] == case["key"]), len(cases))
        cases[at:at + 1] = [case]
        part = self.options.output.with_suffix(".part")
        part.write_text(json.dumps(self.record, indent=1) + "\n")
        part.replace(self.options.output)
        return case

    def measure(self, parameters, files, options, judge=None, once=False, refusal=None, exact=False,
                command=None):
        """Measures a case unless the file has it: `options` of a run, or words of another command.
        files: or a function that makes them. A run that exceeds the limit, or whose refusal is a
        finding, is kept as failed; exact: whether it may decide nothing wrongly."""
        key = "/".join(str(value) for value in parameters.values())
        case = self.find(key)
        if case is None:
            print(key, file=sys.stderr, flush=True)
            files = files() if callable(files) else files
            case = {"key": key, "parameters": parameters, "runs": []}
            result, seconds = self.work / "result.h5", 0
            words = command(files, result) if command else self.command(files, result, options)
            try:
                for _ in range(1 if once else self.options.repetitions):
                    if seconds > ENOUGH[self.size]:
                        break
                    if self.options.cold:
                        variants.drop_from_page_cache(files.store)
                    out, wall, cpu, peak = self.execute(*words, limit=self.options.limit)
                    seconds += wall
                    report = json.loads(out)
                    if not isinstance(report["seconds"], dict):  # of a section
                        report["seconds"] = {"total": report["seconds"], "search": report["search_seconds"],
                                             "engine": report["engine_seconds"]}
                    report["seconds"].setdefault("total", sum(report["seconds"].values()))  # of a check
                    case["runs"].append({**report, "wall_seconds": wall, "cpu_seconds": cpu,
                                         "peak_resident_bytes": peak, "disk_bytes": self.disk_bytes})
                if judge:
                    case["findings"] = judge(result)
            except Failed as failed:
                if not failed.counts(refusal):
                    raise
                print(f"warning: {key}: counted as failed: {failed}", file=sys.stderr)
                case["failed"] = failed.finding
            self.add(case)
        found = case.get("findings", {})
        if exact and (not found.get("equal", True) or found.get("false_hits") or found.get("misses")):
            self.wrong.append(key)
        return case

    def keep(self, parameters, findings):
        """Records a case whose findings come from a function, unless the file has it."""
        key = "/".join(str(value) for value in parameters.values())
        return self.find(key) or self.add({"key": key, "parameters": parameters, "findings": findings()})

    def scenes(self):
        """The name and the files of each scene that was chosen, or of the user's own query."""
        if self.options.env:
            yield self.options.env.stem, Files(None, self.options.env, self.options.model,
                                               self.options.trajectory)
        else:
            yield from ((name, self.scene(name)) for name in self.options.scenes)


def table(bench):
    """Colliding points and time of every engine on the four scenes (Table 1 and Fig. 3), or on the one
    that --env, --model and --trajectory name."""
    for scene, files in bench.scenes():
        reference = bench.answer(f"reference-{scene}", files, bench.engine("sweep cpu").options)
        for engine in [*bench.exact_engines(), bench.engine_here("grid float")]:
            bench.measure({"scene": scene, "engine": engine.name, "exact": engine.exact}, files,
                          engine.options, lambda result: compared(result, reference), exact=engine.exact)


def threads(bench):
    """Speed by the number of threads (Fig. 1)."""
    files = bench.scene("hall", "tenth" if bench.size == "small" else None)  # to keep all threads busy
    cores = bench.cores
    counts = sorted({1, cores, 2 * cores, *range(max(1, cores // 8), 2 * cores, max(1, cores // 8))})
    for name, count in product(("kdtree cpu", "sweep cpu"), bench.some(counts)):
        bench.measure({"scene": "hall", "engine": name, "threads": count}, files,
                      [*bench.engine(name).options, "--threads", count])


def grid(bench):
    """Time of each step by grid resolution and layout (Fig. 2)."""
    hall, options = bench.scene("hall"), bench.engine_here("grid").options
    chunk = 4096  # points of the regular layout; a cell has as many as it needs, the last one padded
    rows = [("grid cell", "chosen", (), ("--precision", "exact"))]
    rows += [("grid cell", value, (), ("--grid-cell", value))
             for value in bench.some(("0.04", "0.05", "0.07", "0.1", "0.14", "0.2", "0.28", "0.4"))]
    rows += [("adaptive layout", value, ("--cell-points", value), ())
             for value in bench.some(("1024", "4096", "16384", "65536", "262144"))]
    rows += [("regular layout", value, ("--layout", f"regular:{value}", "--cell-points", chunk), ())
             for value in bench.some(("0.7", "1", "1.5", "2", "3", "5", "8", "12", "20"))]
    for vary, value, layout, more in rows:
        label = f"hall-{bench.size}-{vary.split()[0]}-{value}"
        bench.measure({"vary": vary, "value": value, **({"chunk_points": chunk} if chunk in layout else {})},
                      lambda: bench.with_store(hall, label, *layout) if layout else hall,
                      [*options, *more], refusal=MEMORY)


def points(bench):
    """Time by the number of environment points, 111 samples at size full (Fig. 4)."""
    hall, whole = bench.scene("hall"), sizes("hall", bench.size)[0]
    samples = {"smoke": 3, "small": 37, "full": 111}[bench.size]  # 111 as in the paper
    step = 500_000 if bench.size == "full" else whole // samples
    made = []

    def sample(i):
        if made != [i]:
            las = bench.work / "sample.las"
            variants.sample_environment(hall.environment, las, step * i, 4 + i)
            (bench.work / "sample.h5").unlink(missing_ok=True)
            bench.store("sample", las)
            made[:] = [i]
        return hall._replace(store=bench.work / "sample.h5")

    for k, engine in product(range(samples), bench.exact_engines()):
        i = 1 + k * 40 % samples  # so that the first part covers the range
        bench.measure({"scene": "hall", "engine": engine.name, "points": step * i},
                      lambda: sample(i), engine.options, once=True)


def accuracy(bench):
    """Time and misclassified points, exact and approximate."""
    hall = bench.scene("hall")
    truth = bench.truth("hall", hall)
    fast, forward, single = (bench.engine_here(name) for name in ("sweep", "grid", "grid float"))

    def measure(method, engine, value, files=hall, more=(), exact=False):
        bench.measure({"method": method, "engine": engine.name, "value": value}, files,
                      [*engine.options, *more], lambda result: judged(result, truth), exact=exact,
                      refusal=None if engine.exact else MEMORY)

    for engine in bench.exact_engines():
        measure("exact", engine, "", exact=True)
    measure("float", single, "")
    for name, far in (("UTM", (450_000, 5_400_000)), ("10,000 km", (10_000_000, 10_000_000))):
        for engine in (bench.engine("kdtree cpu"), fast, forward, *bench.slow([single])):
            measure(("exact" if engine.exact else "float") + ", far origin", engine, name,
                    lambda: bench.shifted(hall, *far))
    thin = bench.work / "thinned-model.ply"
    for voxel in bench.some((0.005, 0.01, 0.02, 0.05)):
        def thinned():
            variants.write_thinned_model(hall.model, thin, voxel)
            return hall._replace(model=thin)
        measure("model thinned", fast, voxel, thinned)
    for n in (2, 5, 10):
        measure("every nth pose", fast, n,
                lambda: bench.changed_poses(hall, lambda poses: variants.every_nth(poses, n)))
    for scale in bench.some(("1e-6", "1e-5", "1e-4", "1e-3", "1e-2")):
        measure("environment quantised", fast, scale,
                lambda: bench.with_store(hall, f"hall-{bench.size}-scale-{scale}", "--scale", scale))


def stability(bench):
    """Where methods fail: origin, sparseness, radius, memory, poses."""
    hall = bench.scene("hall")
    truth = bench.truth("hall", hall)
    fast, forward, single = (bench.engine_here(name) for name in ("sweep", "grid", "grid float"))
    tree = bench.engine("kdtree cpu")

    def against_truth(result):
        return judged(result, truth)

    def measure(vary, value, engine, files=hall, more=(), judge=None, once=True, exact=False,
                refusal=MEMORY, **parameters):
        return bench.measure({"vary": vary, "value": value, "engine": engine.name, **parameters}, files,
                             [*engine.options, *more], judge, once, refusal, exact)

    bench.keep({"vary": "boundary"}, lambda: near_boundary(truth))
    boundary = Files(*(bench.work / f"boundary.{end}" for end in ("las", "h5", "ply", "txt")))
    steps = variants.write_boundary_scene(boundary, RADIUS)
    bench.store("boundary", boundary.environment)
    for engine in (tree, fast, forward, single):
        measure("ulps", RADIUS, engine, boundary, exact=engine.exact,
                judge=lambda result: variants.decided_at_boundary(result, steps))
    for far, engine in product(bench.some((0.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7)),
                               (tree, fast, forward, *bench.slow([single]))):
        measure("origin", far, engine, lambda: bench.shifted(hall, far, far) if far else hall,
                judge=against_truth, exact=engine.exact and far == 0)
    sparse(bench, fast, forward)
    for radius, engine in product(bench.some((0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)),
                                  (tree, fast, forward)):
        measure("radius", radius, engine, more=("--radius", radius))
    for option, name in [("--memory", "sweep cpu")] + bench.cuda * [
            ("--device-memory", "sweep cuda"), ("--device-memory", "grid cuda")]:
        engine = bench.engine(name)
        log = measure("least" + option, 1, engine, more=(option, 1)).get("failed", {}).get("log", "")
        least = re.search(option + r" (\d+) is enough", log)
        if not least:
            sys.exit(f"a refusal does not say the least {option}: {log}")
        for share in bench.some((0.99, 1.0, 1.05, 1.2, 1.5, 2.0, 4.0, 8.0)):
            memory = int(share * int(least[1]))
            measure(option, memory, engine, more=(option, memory), judge=against_truth, once=False,
                    exact=True)
    for vary, values, change, more in (
            ("noise of the poses", (0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1), variants.noisy, ()),
            ("stretch of the poses", (0.0, 1e-6, 1e-5, 9e-5, 1e-3, 1e-2, 0.1), variants.stretched,
             ("--allow-non-rigid",))):
        for value in bench.some(values):
            files = bench.changed_poses(hall, lambda poses: change(poses, value))
            if "failed" not in measure(vary, value, tree, files, more):
                reference = bench.answer(f"kdtree {vary} {value}", files, [*tree.options, *more])
                for engine in (fast, forward):
                    measure(vary, value, engine, files, more, lambda result: compared(result, reference),
                            exact=True)
            if more:
                measure("stretch without --allow-non-rigid", value, fast, files, refusal=NON_RIGID)


def sparse(bench, fast, forward):
    """The tunnel in a box that eight stray points stretch: conversion, and runs on the store."""
    tunnel, chunk = bench.scene("tunnel"), 256  # 4096 would make the stores 13 times as large
    for factor, (layout, side) in product(bench.some((1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)), (
            ("adaptive", None), ("regular, 50 cells along", 1335 / 50), ("regular, 2 m", 2.0))):
        side = side and (side if layout.endswith("2 m") else factor * side)
        parameters = {"vary": "sparseness", "value": factor, "layout": layout,
                      **({"chunk_points": chunk} if side else {})}
        store = bench.work / "sparse.h5"

        def converted():
            las = bench.work / "stretched.las"
            variants.stretch_environment(tunnel.environment, las, factor)
            _, wall, _, peak = bench.execute(
                "clearway", "convert", las, "-o", store, "--memory", bench.options.memory, "--force",
                *(["--layout", f"regular:{side}", "--cell-points", chunk] if side else []),
                limit=bench.options.limit)
            return {"convert_seconds": wall, "convert_peak_bytes": peak,
                    "store_bytes": store.stat().st_size}

        keys = ["/".join(map(str, [*parameters.values(), engine.name])) for engine in (fast, forward)]
        known = bench.find("/".join(map(str, parameters.values())))
        if known and ("failed" in known["findings"] or all(map(bench.find, keys))):
            continue
        found = attempted(converted, MEMORY)
        for engine in (fast, forward) if "failed" not in found else ():
            bench.measure({**parameters, "engine": engine.name}, tunnel._replace(store=store),
                          engine.options, once=True, refusal=MEMORY)
        bench.keep(parameters, lambda: found)


def share(bench):
    """What share of a scene a search touches, and what touching more than that would cost."""
    for scene, files in bench.scenes():
        @cache
        def found():
            return json.loads(bench.execute(
                "clearway-bench", "share", "--env", files.store, "--model", files.model, "--trajectory",
                files.trajectory, "--radius", RADIUS, "--repetitions", bench.options.repetitions)[0])

        for way in ("as it is", "all cells", "whole field", "poses one by one"):
            bench.keep({"scene": scene, "way": way}, lambda: found()[way])
        if bench.cuda:
            bench.measure({"scene": scene, "way": "GPU"}, files, bench.engine("sweep cuda").options)


def surfaces(bench):
    """A mesh as a surface and as points on it: time, and points missed (on the hall, unless --env,
    --model and --trajectory name others)."""
    sweep, smoke = bench.engine_here("sweep"), bench.size == "smoke"
    if bench.options.env:
        [(name, files)] = [("given", each) for _, each in bench.scenes()]
    else:
        name, files, body = "hall", bench.scene("hall"), bench.work / "body.off"
        if not body.exists():
            variants.write_body(files.model, body, 2_000 if smoke else 20_000)
        files = files._replace(model=body)
    surface = [*sweep.options, "--model-as", "surface"]
    truth = bench.answer(f"surface-{name}", files, [*surface, "--clearance", 0.3])

    def measure(method, value, options, exact=False):
        return bench.measure({"scene": name, "method": method, "engine": sweep.name, "value": value}, files,
                             options, lambda result: judged(result, truth), exact=exact)

    measure("surface", "", surface, exact=True)
    for parts in (4, 8, 12, 16) if smoke else (4, 8, 12, 16, 64):  # 12: ten points a triangle on the hall's body
        spacing = RADIUS / parts
        case = measure("sampled", f"r / {parts}",
                       [*sweep.options, "--model-as", "points", "--model-spacing", spacing])
        found = case.get("findings", {"false_hits": 0, "largest_distance": 0})
        # A sample lies on the surface, which is nowhere farther from a sample than the spacing; both are
        # rounded.
        if found["false_hits"] or found["largest_distance"] > spacing + 1e-9:
            bench.wrong.append(case["key"])


def seen(bench):
    """What it costs to know more than the set: time by question, and of seen space by beams, cubes, path
    and threads."""
    budget = ["--error-scan", 0.005, "--error-registration", 0.01, "--error-pose", 0.02]
    questions = {"set": [], "first poses": ["--first-pose"], "least distances": ["--clearance", 0.3],
                 "profile": ["--profile", 1], "error budget": budget, "seen, 0.2 m": ["--seen"],
                 "seen, 0.1 m": ["--seen", "--seen-cube", 0.1],
                 "seen, 0.2 m, and budget": [*budget, "--seen"]}
    parts, sweep = (64, 16, 4, 1), bench.engine_here("sweep")
    for scene in bench.options.scenes:
        whole = sizes(scene, bench.size)[0]
        files = bench.scanned(scene, whole)
        rows = [("question", name, files, more) for name, more in questions.items()]
        rows += [("beams", whole // part, lambda part=part: bench.scanned(scene, whole // part), ["--seen"])
                 for part in parts]
        rows += [("cube", side, files, ["--seen", "--seen-cube", side])
                 for side in ("0.8", "0.4", "0.2", "0.1", "0.05")[:None if bench.size == "full" else 4]]
        rows += [("path", 1 / part, lambda part=part: bench.changed_poses(
            files, lambda poses: poses[:-(-len(poses) // part)]), ["--seen"]) for part in parts]
        rows += [("threads", 2**i, files, ["--seen", "--threads", 2**i])
                 for i in range(bench.cores.bit_length())]
        for vary, value, of, more in rows:
            bench.measure({"scene": scene, "engine": sweep.name, "vary": vary, "value": value}, of,
                          [*sweep.options, *more], refusal=MEMORY)


def section(bench):
    """Time of a section by bins, cells, length of the load, threads and device, beside runs of many
    widths."""
    def find(options):
        return lambda files, result: [
            "clearway", "section", "find", "--env", files.store, "--trajectory", files.trajectory, "-o",
            result.with_name("section.h5"), "--memory", bench.options.memory, "--device-memory",
            bench.options.device_memory, "--force", "--json", *options]

    rear, front = -2.25, 2.25
    usual = f"--x-range={rear},{front}"
    rows = [("method", "section, 1 thread", [usual, "--threads", 1, "--device", "cpu"]),
            ("method", "section, all threads", [usual, "--device", "cpu"])]
    rows += [("method", "section, GPU", [usual, "--device", "cuda"])] * bench.cuda
    rows += [(vary, value, [usual, f"--{vary}", value, "--device", "cpu"]) for vary, values in (
        ("bin", (80.0, 20.0, 5.0, 1.25)), ("cell", (0.08, 0.04, 0.02, 0.01)),
        ("threads", [2**i for i in range(bench.cores.bit_length())])) for value in values]
    rows += [("length", length, [f"--x-range={-length / 2},{length / 2}", "--device", "cpu"])
             for length in (1.0, 4.5, 12.0, 25.0)]
    load = bench.work / "load.off"
    for scene, files in bench.scenes():
        for vary, value, options in rows:
            bench.measure({"scene": scene, "vary": vary, "value": value}, files, (), command=find(options),
                          refusal=MEMORY)
        for width in bench.some([1 + 0.3 * i for i in range(10)]):  # some of those that a user would have to try
            def loaded():
                variants.write_box(load, rear, front, width)
                return files._replace(model=load)
            bench.measure({"scene": scene, "vary": "width", "value": width, "widths": 200}, loaded,
                          ["--model-as", "solid", "--radius", 0.001, "--device", "cpu"], once=True)


def peer(bench, name, files, limit, *more):
    """What a program of tools/bench/peers/programs finds. Where all poses take longer than the limit,
    it searches every n-th."""
    out, *_ = bench.execute(f"peer_{name}", "--env", files.store, "--model", files.model, "--trajectory",
                            files.trajectory, "--radius", RADIUS, "--threads", bench.cores, "--limit", limit,
                            *more, limit=10 * bench.options.limit)  # with its preparation
    return json.loads(out)


def peers(bench):
    """Other libraries on the scenes, or on the one that --env, --model and --trajectory name; those whose
    program was not built, since the library was not found, are named."""
    rows = [(name, None) for name in ("nanoflann", "cgal", "pcl", "open3d")]
    rows += [("octomap", cell) for cell in (0.1, 0.05, 0.02, 0.01)]
    for (scene, files), (name, cell) in product(bench.scenes(), rows):
        if not (bench.options.programs / f"peer_{name}").exists():
            print(f"peer_{name}: not built", file=sys.stderr)
            continue
        bench.keep({"scene": scene, "peer": name, "threads": bench.cores, "radius": RADIUS,
                    **({"cell": cell} if cell else {})}, lambda: attempted(
                        lambda: peer(bench, name, files, bench.options.limit / 3,
                                     *(["--cell", cell] if cell else [])), ""))


def ablation(bench):
    """What each step brings on the way from a k-d tree over the scan to engine sweep: the question turned
    round, poses taken together, a model field, blocks of points; and a plain distance field."""
    if not (bench.options.programs / "peer_inverse").exists():
        print("peer_inverse: not built, as nanoflann was not found", file=sys.stderr)
        return
    for scene, files in bench.scenes():
        reference = bench.answer(f"reference-{scene}", files, bench.engine("sweep cpu").options)
        for engine in (bench.engine("kdtree cpu"), bench.engine("sweep cpu")):
            bench.measure({"scene": scene, "method": engine.name}, files, engine.options,
                          lambda result: compared(result, reference), exact=True)
        for method in ("poses", "tree", "field", "voxels"):
            # Searching every n-th pose does not take an n-th where poses are taken together.
            limit = bench.options.limit * (10 if method != "poses" else 1 / 3)
            found = bench.keep({"scene": scene, "method": method}, lambda: attempted(lambda: peer(
                bench, "inverse", files, limit, "--method", method, "--cell", 0.02), ""))["findings"]
            if method != "voxels" and found.get("false_hits", 0) + found.get("misses", 0):
                bench.wrong.append(f"{scene}/{method}")


def check(bench):
    """What `clearway check` takes as a whole, from the scan to the report, by the number of points."""
    most = {"smoke": 20_000, "small": 10_000_000, "full": 806_000_000}[bench.size]
    counts = [n for n in (20_000, 1_000_000, 3_000_000, 10_000_000, 30_000_000, 55_872_714, 200_000_000,
                          806_000_000) if n <= most and (n > 20_000 or bench.size == "smoke")]
    ways = {"1 core": ["--threads", 1, "--device", "cpu"],
            f"{bench.cores} cores": ["--threads", bench.cores, "--device", "cpu"]}
    if bench.cuda:
        ways["GPU"] = ["--device", "cuda"]
    for points, (way, how) in product(counts, ways.items()):
        def words(files, result):
            shutil.rmtree(bench.work / "site", ignore_errors=True)
            return ["clearway", "check", files.environment, "--model", files.model, "--trajectory",
                    files.trajectory, "--radius", RADIUS, "-o", bench.work / "site", "--memory",
                    bench.options.memory, "--json", *how]

        bench.measure({"scene": "hall", "points": points, "way": way}, lambda: bench.made(
            "hall", f"hall-{points}", (points, *FULL["hall"][1:])), (), command=words)


def memory_cgroup(limit):
    """The folder of a new memory cgroup with this many bytes, its page cache included; None where this user or
    this machine cannot make one."""
    for root, name in (("/sys/fs/cgroup", "memory.max"), ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")):
        folder = Path(root, "clearway-outofcore")
        try:
            folder.mkdir(exist_ok=True)
            if (folder / name).exists():
                atexit.register(folder.rmdir)
                (folder / name).write_text(str(limit))
                return folder
            folder.rmdir()
        except OSError:
            pass
    return None


def outofcore(bench):
    """Conversion and questions with a fixed --memory, by the points of a scan that is far larger: with its store
    in the page cache (warm), not there (cold), and in a memory cgroup of 1.5 times --memory (confined)."""
    memory = 2**30 if bench.size == "full" else 2**28  # a conversion refuses less than 224 MiB
    counts = {"smoke": (20_000, 40_000), "small": (10**5, 10**6, 4 * 10**6),
              "full": (10**6, 10**7, 10**8, 10**9, 12 * 10**8)}[bench.size]
    questions = {"set": ["--device", "cpu"], **({"set, GPU": ["--device", "cuda"]} if bench.cuda else {}),
                 "check": ["--device", "cpu", "--first-pose", "--clearance", 0.3, "--profile", 0.5]}
    _, model_points, poses = sizes("mine", bench.size)
    clearway, folder = bench.options.programs / "clearway", bench.work / f"outofcore-{bench.size}"
    files = Files(None, folder / "store.h5", folder / "model.ply", folder / "trajectory.txt")
    cgroup = memory_cgroup(memory * 3 // 2)
    if not cgroup:
        bench.keep({"state": "confined"}, lambda: {"skipped": "not possible here"})

    def converted():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        scene = map(str, (clearway, "scene", "mine", "-o", folder, "--points", points, "--model-points",
                          model_points, "--poses", poses, "--environment", "-"))
        with subprocess.Popen(scene, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as made:
            out, wall, cpu, peak = bench.execute(
                "clearway", "convert", "-", "-o", files.store, "--memory", memory, "--json", stdin=made.stdout,
                limit=3 * bench.options.limit)
        return {"memory_bytes": memory, "wall_seconds": wall, "cpu_seconds": cpu, "peak_resident_bytes": peak,
                "temporary_bytes": json.loads(out)["temporary_bytes"], "store_bytes": files.store.stat().st_size}

    def at_hand(state):
        if not files.store.exists():
            converted()
        if state != "warm":
            variants.drop_from_page_cache(files.store)
        return files

    def command(state, options, result):
        words = bench.command(files, folder / result.name, ["--memory", memory, *options])
        return ["/bin/sh", "-c", 'echo $$ > "$0/cgroup.procs" && exec "$@"', cgroup, clearway,
                *words[1:]] if state == "confined" else words

    for points in counts:
        shutil.rmtree(folder, ignore_errors=True)
        case = bench.keep({"points": points, "question": "conversion"}, lambda: attempted(converted, ""))
        states = ["cold", "warm", *["confined"] * bool(cgroup)] if "failed" not in case["findings"] else []
        for (question, options), state in product(questions.items(), states):
            bench.measure({"points": points, "question": question, "state": state}, lambda: at_hand(state), (),
                          once=True, refusal="", command=lambda _, result: command(state, options, result))
    shutil.rmtree(folder, ignore_errors=True)


def certainty(bench):
    """How often a verdict is sure and wrong, of places that stand at the margin: by Monte Carlo, and by
    asking Clearway about thousands of them; and how many cubes inside opaque things are called seen, by
    noise and side of the cubes."""
    import clearway  # PYTHONPATH=build/release/python
    trials, places, scenes, rays = {"smoke": (20_000, 1_000, 1, 20_000), "small": (1_000_000, 20_000, 4, 100_000),
                                    "full": (10_000_000, 100_000, 16, 400_000)}[bench.size]
    all_sigmas, margins, sides = (2, 3, 4) if bench.size != "smoke" else (2,), (0, 0.1), (0.1, 0.2, 0.4)
    for shape, (mix, errors), margin in product(SHAPES.values(), ERRORS.items(), margins):
        @cache
        def by_sigmas():
            return monte_carlo(shape, errors, margin, all_sigmas, trials, 1)

        for sigmas in all_sigmas:
            bench.keep({"vary": "place", "shape": shape.name, "errors": mix, "margin": margin,
                        "sigmas": sigmas}, lambda: by_sigmas()[sigmas])
    for seed, (shape, mix, margin, sigmas) in enumerate(product(SHAPES.values(), ERRORS, margins, all_sigmas)):
        def asked():
            errors = ERRORS[mix]
            drawn = verdicts.Places(shape, errors, margin, places, np.random.default_rng([2, seed]))
            formulas = errors.margins(shape, sigmas)
            expected = verdicts.wrong(drawn.distances(), margin, formulas)
            clear, conflict, told = verdicts.ask(clearway, drawn, errors, sigmas)
            return {"places": places, "clear": int(clear.sum()), "conflict": int(conflict.sum()),
                    "margins": told, "formulas": formulas,
                    "differ": int((clear != expected[0]).sum() + (conflict != expected[1]).sum())}

        case = bench.keep({"vary": "program", "shape": shape.name, "errors": mix, "margin": margin,
                           "sigmas": sigmas}, asked)
        found = case["findings"]
        if found["differ"] or any(abs(found["margins"][name] - value) > 1e-12
                                  for name, value in found["formulas"].items()):
            bench.wrong.append(case["key"])
    # The third and fourth normal noise are a sixteenth and a twelfth of 0.2 m.
    for kind, size in bench.some([("uniform", bound) for bound in (0.005, 0.02, 0.045)] + [
            ("normal", sigma) for sigma in (0.005, 0.0125, 0.2 / 12, 0.02, 0.05)]):
        @cache
        def sums():
            of_side = {side: Counter() for side in sides}
            for seed in range(scenes):
                random = np.random.default_rng([3, seed])
                with tempfile.TemporaryDirectory() as folder:
                    ground = Ground(bench.options.programs / "clearway", Path(folder),
                                    Scene(np.random.default_rng(seed)))
                    seen_of = look(ground, random, rays, lambda n: random.uniform(-size, size, n)
                                   if kind == "uniform" else random.normal(0, size, n), sides)
                for side, counts in seen_of.items():
                    of_side[side].update(counts)
            return of_side

        for side in sides:
            bench.keep({"vary": "noise", "noise": kind, "size": size, "side": side}, lambda: sums()[side])


# Whether an experiment takes --scenes, and a query of the user's.
EXPERIMENTS = {table: (True, True), threads: (False, False), grid: (False, False), points: (False, False),
               accuracy: (False, False), stability: (False, False),
               share: (True, False), surfaces: (False, True), seen: (True, False), section: (True, False),
               peers: (True, True), ablation: (True, True), check: (False, False),
               outofcore: (False, False), certainty: (False, False)}


def words_of(choices):
    def words(text):
        found = text.split(",")
        if not set(found) <= set(choices):
            raise argparse.ArgumentTypeError(f"expected some of {', '.join(choices)}")
        return found
    return words


def main():
    usage = "Experiments:\n" + "".join(f"  {experiment.__name__:10} {' '.join(experiment.__doc__.split())}\n"
                                       for experiment in EXPERIMENTS)
    parser = argparse.ArgumentParser(description=__doc__, epilog=usage,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    experiments = {experiment.__name__: experiment for experiment in EXPERIMENTS}
    parser.add_argument("programs", type=Path, help="folder of clearway and clearway-bench")
    parser.add_argument("experiment", choices=experiments, metavar="experiment", help="see below")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the figures, a JSON file")
    parser.add_argument("--work", type=Path, required=True,
                        help="folder for scenes, stores and results, which stay there; for one experiment "
                             "at a time and one build of clearway")
    parser.add_argument("--size", choices=("smoke", "small", "full"), default="small",
                        help="small: minutes on 2 cores; full: the paper's sizes, for a machine with a GPU; "
                             "smoke: seconds, to try the script out")
    parser.add_argument("--scenes", type=words_of(SCENES), help=f"of {', '.join(SCENES)}; default: all")
    for name in ("--env", "--model", "--trajectory"):
        parser.add_argument(name, type=Path, help="a query of your own, for table, surfaces, peers and ablation")
    parser.add_argument("--device", choices=("auto", "cpu", "cuda"), default="auto",
                        help="cpu measures no GPU; auto measures one where there is one")
    parser.add_argument("--repetitions", type=int, default=3,
                        help="runs of every case; points and most of stability run each case once")
    parser.add_argument("--limit", type=float, default=60,
                        help="seconds after which a run is stopped and counts as failed")
    parser.add_argument("--cold", action="store_true",
                        help="drop the store from the page cache before every run")
    parser.add_argument("--memory", default="4G", help="of every run and conversion")
    parser.add_argument("--device-memory", default="2G", help="of every run on a GPU")
    parser.add_argument("--gpus", help="of every run on a GPU, such as 0,1")
    parser.add_argument("--force", action="store_true", help="replace an existing file")
    parser.add_argument("--resume", action="store_true", help="go on with a file of the same experiment")
    options = parser.parse_args()
    experiment = experiments[options.experiment]
    of_any_scene, of_any_query = EXPERIMENTS[experiment]
    if options.scenes and not of_any_scene:
        parser.error(f"{options.experiment} has scenes of its own")
    given = [options.env, options.model, options.trajectory]
    if any(given) and not (of_any_query and all(given)):
        parser.error("--env, --model and --trajectory belong together, and to table, surfaces, peers "
                     "and ablation")
    options.scenes = options.scenes or list(SCENES)
    bench = Bench(options.experiment, options)
    try:
        experiment(bench)
    except Failed as failed:
        sys.exit(f"error: {failed}")
    if bench.wrong:
        print(f"error: what decides exactly is wrong: {', '.join(bench.wrong)}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
