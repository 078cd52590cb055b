"""Kills `clearway run` and `clearway convert` at random moments and resumes them until they are
done: the file must be, byte for byte, that of a run that nobody disturbed.

kill_and_resume.py PROGRAM [--kills N] [--seed S] [--only PART-OF-A-CASE]
"""

import argparse
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time


def run(command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def expect(condition, what):
    if not condition:
        sys.exit("kill_and_resume: " + what)


class Scene:
    def __init__(self, program, work):
        self.program, self.work = program, work
        made = run([program, "scene", "hall", "--points", "1000000", "--model-points", "10000",
                    "--poses", "2000", "-o", str(work / "hall")])
        expect(made.returncode == 0, made.stdout)
        converted = run([program, "convert", str(work / "hall/environment.las"), "--cell-points",
                         "1000", "-o", str(work / "site.h5")])
        expect(converted.returncode == 0, converted.stdout)

    def run_command(self, options, output):
        return [self.program, "run", "--env", str(self.work / "site.h5"), "--model",
                str(self.work / "hall/model.ply"), "--trajectory",
                str(self.work / "hall/trajectory.txt"), "--radius", "0.1", "--device", "cpu",
                "-o", str(output)] + options

    def convert_command(self, options, output):
        return [self.program, "convert", str(self.work / "hall/environment.las"), "--cell-points",
                "1000", "-o", str(output)] + options


def killed(command, delay, kill):
    """Whether it was killed; otherwise it has exited with 0, or with 5 where the signal asks."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    time.sleep(delay)
    process.send_signal(kill)
    sent = time.monotonic()
    text, _ = process.communicate()
    expect(time.monotonic() - sent < 5, "took more than 5 seconds to stop")
    if process.returncode == -signal.SIGKILL:
        return True, text
    if process.returncode == 5 and kill == signal.SIGTERM:
        expect("--resume" in text or "again" in text, text)
        return True, text
    if process.returncode == -signal.SIGTERM:  # before the program could listen
        return True, text
    expect(process.returncode == 0, f"exit code {process.returncode}: {text}")
    return False, text


def torment(name, command, reference, output, kills, draw):
    """Kills and resumes until `kills` kills were made, and the output is done."""
    begin = time.monotonic()
    done = run(command([], reference))
    usual = time.monotonic() - begin
    expect(done.returncode == 0, done.stdout)
    made = finished = inherited = 0
    while made < kills:
        output.unlink(missing_ok=True)
        while True:
            kill = draw.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM])
            delay = draw.random() * 1.3 * usual
            was_killed, text = killed(command(["--resume"], output), delay, kill)
            made += was_killed
            inherited += "resumes with" in text and "resumes with 0 " not in text
            if not was_killed:
                break
            if output.exists():  # killed between its name and its exit: complete
                break
        last = run(command(["--resume"], output))  # removes the journal, where one is left
        expect(last.returncode in (0, 2), last.stdout)
        expect(output.read_bytes() == reference.read_bytes(), f"{name}: the result differs")
        left = [p.name for p in output.parent.iterdir()]
        expect(left == [output.name], f"{name}: left behind: {left}")
        finished += 1
    print(f"{name}: {made} kills, {inherited} of the runs went on from finished work, "
          f"{finished} results, all equal")
    return inherited


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    cases = {"sweep": ["--engine", "sweep", "--clearance", "0.3", "--first-pose"],
             "grid": ["--engine", "grid", "--first-pose"],
             "kdtree": ["--engine", "kdtree"],
             "kdtree first pose": ["--engine", "kdtree", "--first-pose", "--between-poses"]}
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        scene = Scene(arguments.program, work)
        output = work / "out" / "out.h5"
        output.parent.mkdir()
        for name, options in cases.items():
            if arguments.only not in name:
                continue
            inherited = torment(name, lambda more, to: scene.run_command(options + more, to),
                                work / "reference.h5", output, arguments.kills, draw)
            (work / "reference.h5").unlink()
            expect(inherited >= arguments.kills / 6, f"{name}: too few runs were really resumed")
        if arguments.only in "convert":
            torment("convert", scene.convert_command, work / "reference.h5", output,
                    arguments.kills, draw)


main()
