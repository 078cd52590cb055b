"""Kills `clearway run` and `clearway convert` at random moments and resumes them until they are
done: the file must be, byte for byte, that of a run that nobody disturbed. Now and then another
process starts on the same output: one of the two is refused.

kill_and_resume.py PROGRAM [--kills N] [--seed S] [--only PART-OF-A-CASE] [--while-writing]
                   [--device cuda] [--points N] [--poses N]

--kills: SIGKILLs of every case; SIGTERMs come on top. A process is killed when its journal has
grown to a random size, however busy the machine is. On a GPU, where runs are short, --points and
--poses make them long enough to be killed while they search. --while-writing: runs of which most
points are part of the result, killed while it is being written.
"""

import argparse
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time


# With all tables, and in several passes.
WRITTEN = {"all tables": ["--first-pose", "--clearance", "3", "--profile", "3"],
           "small memory": ["--first-pose", "--memory", "160M"]}
MOST_KILLED = 5  # in a row
MOST_SECONDS = 60  # that a process may take to stop


def run(command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def expect(condition, what):
    if not condition:
        sys.exit("kill_and_resume: " + what)


class Scene:
    def __init__(self, program, work, device, points, poses):
        self.program, self.work, self.device = program, work, device
        self.radius = "0.1"
        made = run([program, "scene", "hall", "--points", str(points), "--model-points", "10000",
                    "--poses", str(poses), "-o", str(work / "hall")])
        expect(made.returncode == 0, made.stdout)
        converted = run([program, "convert", str(work / "hall/environment.las"), "--cell-points",
                         "1000", "-o", str(work / "site.h5")])
        expect(converted.returncode == 0, converted.stdout)

    def run_command(self, options, output):
        return [self.program, "run", "--env", str(self.work / "site.h5"), "--model",
                str(self.work / "hall/model.ply"), "--trajectory",
                str(self.work / "hall/trajectory.txt"), "--radius", self.radius, "--device",
                self.device, "-o", str(output)] + options

    def convert_command(self, options, output):
        return [self.program, "convert", str(self.work / "hall/environment.las"), "--cell-points",
                "1000", "-o", str(output)] + options


def start(command):
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


class Tally:
    def __init__(self):
        self.kills = self.terms = self.inherited = self.refused = self.finished = 0


def stop(process, kill, tally):
    """Whether the signal ended it; otherwise it has exited with 0, or was refused."""
    process.send_signal(kill)
    sent = time.monotonic()
    text, _ = process.communicate()
    expect(time.monotonic() - sent < MOST_SECONDS, f"took more than {MOST_SECONDS} seconds to stop")
    tally.inherited += "resumes with" in text and "resumes with 0 " not in text
    if process.returncode == -signal.SIGKILL:
        tally.kills += 1
        return True
    if process.returncode == 5 and kill == signal.SIGTERM:
        expect("--resume" in text or "again" in text, text)
        tally.terms += 1
        return True
    if process.returncode == -signal.SIGTERM:  # before the program could listen
        return True
    return not succeeded(process, text, tally)


def succeeded(process, text, tally):
    """Whether the output is its; otherwise it was refused because another has it, or had."""
    if process.returncode == 0:
        return True
    another = process.returncode == 4 and "another process is writing it" in text
    expect(another or (process.returncode == 2 and "exists already" in text),
           f"exit code {process.returncode}: {text}")
    tally.refused += another
    return False


def beside(output, ending):
    return output.with_name(output.name + ending)


def size_of(path):
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def wait_to_grow(process, path, least):
    """Until the file has so many bytes, or the process has ended. Returns the most that it had."""
    most = size_of(path)
    while process.poll() is None and most < least:
        time.sleep(0.0002)
        most = max(most, size_of(path))
    return most


def undisturbed(command, output):
    """Runs a command to its end. Returns the most bytes that its journal had."""
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, text=True)
        most = wait_to_grow(process, beside(output, ".journal"), float("inf"))
        said.seek(0)
        expect(process.returncode == 0, said.read())
    return most


def attempt_writing(command, output, whole, draw, tally):
    """A process that is killed when it has written some part of the result's bytes."""
    process = start(command)
    wait_to_grow(process, beside(output, ".partial"), max(1, draw.random() * whole))
    stop(process, signal.SIGKILL, tally)


def torment_writing(name, command, reference, output, kills, draw):
    """Kills at any moment of the writing and resumes until `kills` SIGKILLs were made."""
    done = run(command([], reference))
    expect(done.returncode == 0, done.stdout)
    whole = reference.stat().st_size
    tally = Tally()
    while tally.kills < kills:
        output.unlink(missing_ok=True)
        for _ in range(MOST_KILLED):
            attempt_writing(command(["--resume"], output), output, whole, draw, tally)
            expect(not output.exists() or output.read_bytes() == reference.read_bytes(),
                   f"{name}: the result differs")
            if output.exists():
                break
        last = run(command(["--resume"], output))
        expect(last.returncode == 0, last.stdout)
        expect(output.read_bytes() == reference.read_bytes(), f"{name}: the result differs")
        left = [p.name for p in output.parent.iterdir()]
        expect(left == [output.name], f"{name}: left behind: {left}")
        tally.finished += 1
    print(f"{name}, {whole} bytes: {tally.kills} SIGKILLs while writing, {tally.inherited} of the "
          f"runs went on from finished work, {tally.finished} results, all equal", flush=True)


def attempt(command, output, whole, draw, tally):
    """One process that is killed, or two of which one is, when the journal has grown by a part of
    what it lacks."""
    journal = beside(output, ".journal")
    size = size_of(journal)
    process = start(command)
    rival = start(command) if draw.random() < 0.25 else None
    wait_to_grow(process, journal, max(1, size + draw.random() * (whole - size)))
    kill = draw.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM])
    done = not stop(process, kill, tally)
    if rival is not None:
        text, _ = rival.communicate()
        done = succeeded(rival, text, tally) or done
    return done


def torment(name, command, reference, output, kills, draw):
    """Kills and resumes until `kills` SIGKILLs were made, and the output is done."""
    output.unlink(missing_ok=True)  # of the case before
    whole = undisturbed(command([], output), output)
    output.rename(reference)
    print(f"{name}: {whole} bytes of journal undisturbed", flush=True)
    tally = Tally()
    while tally.kills < kills:
        output.unlink(missing_ok=True)
        attempt(command(["--resume"], output), output, whole, draw, tally)
        killed = 1
        while not output.exists():  # killed between its name and its exit, it is complete
            if killed == MOST_KILLED:
                done = run(command(["--resume"], output))
                expect(done.returncode == 0, done.stdout)
                break
            attempt(command(["--resume"], output), output, whole, draw, tally)
            killed += 1
        last = run(command(["--resume"], output))  # removes the journal, where one is left
        expect(last.returncode in (0, 2), last.stdout)
        expect(output.read_bytes() == reference.read_bytes(), f"{name}: the result differs")
        left = [p.name for p in output.parent.iterdir()]
        expect(left == [output.name], f"{name}: left behind: {left}")
        tally.finished += 1
    print(f"{name}: {tally.kills} SIGKILLs, {tally.terms} SIGTERMs, {tally.inherited} of the runs "
          f"went on from finished work, {tally.refused} refused beside another, "
          f"{tally.finished} results, all equal", flush=True)
    return tally.inherited


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--while-writing", action="store_true")
    parser.add_argument("--device", choices=["cpu", "cuda"], default="cpu")
    parser.add_argument("--points", type=int, default=400000)
    parser.add_argument("--poses", type=int, default=800)
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    cases = {"sweep": ["--engine", "sweep", "--clearance", "0.3", "--first-pose"],
             "shard": ["--engine", "sweep", "--clearance", "0.3", "--profile", "0.3", "--shard",
                       "2/3"],
             "grid": ["--engine", "grid"],
             "error budget": ["--engine", "sweep", "--first-pose", "--error-scan", "0.01",
                              "--error-pose", "0.02"],
             "kdtree": ["--engine", "kdtree"]}
    if arguments.device == "cuda":
        del cases["kdtree"]
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        scene = Scene(arguments.program, work, arguments.device, arguments.points,
                      arguments.poses)
        output = work / "out" / "out.h5"
        output.parent.mkdir()
        if arguments.while_writing:
            scene.radius = "3"
            for name, options in WRITTEN.items():
                if arguments.only not in name:
                    continue
                torment_writing(name, lambda more, to: scene.run_command(options + more, to),
                                work / "reference.h5", output, arguments.kills, draw)
                (work / "reference.h5").unlink()
            return
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
