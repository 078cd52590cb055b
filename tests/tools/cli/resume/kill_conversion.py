"""Kills `clearway convert` at random moments, resumes it, and compares the store with that of a
conversion that nobody disturbed: it must be the same, byte for byte, and nothing may be left beside
it.

kill_conversion.py PROGRAM [--trials N] [--points N] [--seed S] [--only PART-OF-A-CASE]
                   [--scan FILE ...]

--trials: conversions of every case; each is killed one to four times, the later kills while it
resumes. --points: of the scans that are made. --scan: another case, for each file given.
"""

import argparse
import json
import pathlib
import random
import signal
import shutil
import subprocess
import sys
import tempfile
import time


def expect(condition, what):
    if not condition:
        sys.exit("kill_conversion: " + what)


def run(command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def write_text(path, points, seed):
    draw = random.Random(seed)
    with open(path, "w") as file:
        for _ in range(points):
            file.write(f"{draw.uniform(-50, 50):.3f} {draw.uniform(-20, 20):.3f} "
                       f"{draw.uniform(0, 8):.3f}\n")


def beside(output):
    return sorted(p.name for p in output.parent.iterdir())


class Case:
    def __init__(self, program, name, inputs, options):
        self.program, self.name = program, name
        self.words = [str(i) for i in inputs] + ["--threads", "2"] + options

    def command(self, output, more):
        return [self.program, "convert", *self.words, "-o", str(output), *more]


def kill_after(command, seconds):
    """Kills the command after that time; returns whether it had not ended before."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               text=True)
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
    _, said = process.communicate()
    expect(process.returncode in (0, -signal.SIGKILL), f"exit code {process.returncode}: {said}")
    return process.returncode != 0


def torment(case, work, trials, draw):
    reference, output = work / "reference.h5", work / "out" / "out.h5"
    output.parent.mkdir(exist_ok=True)
    begin = time.monotonic()
    done = run(case.command(reference, ["--force"]))
    usual = time.monotonic() - begin
    expect(done.returncode == 0, done.stderr)
    kills = taken_over = 0
    most_counted = most_batches = most_buckets = most_points = 0
    for trial in range(trials):
        left = usual
        for _ in range(1 + trial % 4):
            killed = kill_after(case.command(output, ["--resume"]), draw.random() * left)
            kills += killed
            if not killed:
                break
            left *= 0.8
        last = run(case.command(output, ["--resume", "--json"]))
        expect(last.returncode == 0, f"{case.name}: {last.stderr}")
        expect(output.read_bytes() == reference.read_bytes(), f"{case.name}: the store differs")
        expect(beside(output) == [output.name], f"{case.name}: left behind: {beside(output)}")
        report = json.loads(last.stdout)
        if not report["was_finished"]:
            taken_over += report["resumed_points"] > 0
            most_points = max(most_points, report["resumed_points"])
            most_counted = max(most_counted, report["recounted_batches"])
            most_batches = max(most_batches, report["repeated_batches"])
            most_buckets = max(most_buckets, report["repeated_buckets"])
        output.unlink()
    print(f"{case.name}: {usual:.2f} s undisturbed; {kills} kills, {trials} stores, all equal; "
          f"{taken_over} went on from distributed points, at most {most_points:,}; done twice at "
          f"most {most_counted} batches counted, {most_batches} distributed, {most_buckets} buckets "
          f"written", flush=True)
    reference.unlink()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--trials", type=int, default=3)
    parser.add_argument("--points", type=int, default=1200000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--scan", nargs="*", default=[])
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        made = run([arguments.program, "scene", "hall", "--points", str(arguments.points),
                    "--model-points", "1000", "--poses", "100", "-o", str(work / "hall")])
        expect(made.returncode == 0, made.stderr)
        las, path = work / "hall/environment.las", work / "hall/trajectory.txt"
        texts = [work / f"{i}.xyz" for i in range(3)]
        for i, text in enumerate(texts):
            write_text(text, arguments.points // 12, i)
        small = ["--cell-points", "2000"]
        cases = [Case(arguments.program, "LAS", [las], small),
                 Case(arguments.program, "several inputs", [texts[0], las, *texts[1:]], small),
                 Case(arguments.program, "text", texts[:1], []),
                 Case(arguments.program, "small memory", [las], small + ["--memory", "256M"]),
                 Case(arguments.program, "cubes", [las], small + ["--layout", "regular:8"]),
                 Case(arguments.program, "near a path", [las],
                      small + ["--near", str(path), "--within", "9"])]
        cases += [Case(arguments.program, pathlib.Path(scan).name, [scan], small)
                  for scan in arguments.scan]
        for case in cases:
            if arguments.only in case.name:
                torment(case, work, arguments.trials, draw)
        shutil.rmtree(work / "hall")


main()
