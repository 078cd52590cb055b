"""Kills `clearway run` and `clearway convert` at random moments and resumes them until they are
done: the file must be, byte for byte, that of a run that nobody disturbed, and nothing may be left
beside it. Now and then another process starts on the same output: one of the two is refused.

kill_and_resume.py PROGRAM [--kills N] [--seed S] [--only PART-OF-A-CASE] [--device cuda]
                   [--points N] [--poses N] [--scan FILE ...]

--kills: SIGKILLs of every case; SIGTERMs come on top. A process is killed when the files of its
output have grown to a random size, however busy the machine is. On a GPU, where runs are short,
--points and --poses make them long enough to be killed while they search. --scan: conversions of
these files are cases too.
"""

import argparse
import random
import re
import signal
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import Place  # noqa: E402

RUNS = {"sweep": "--radius 0.1 --clearance 0.3 --first-pose",
        "shard": "--radius 0.1 --clearance 0.3 --profile 0.3 --shard 2/3",
        "error budget": "--radius 0.1 --first-pose --error-scan 0.01 --error-pose 0.02",
        "grid": "--radius 0.1 --engine grid",
        "kdtree": "--radius 0.1 --engine kdtree",
        # Most points are part of these results, so that they are killed while they are written.
        "all tables": "--radius 3 --first-pose --clearance 3 --profile 3",
        "small memory": "--radius 3 --first-pose --memory 160M"}
CONVERSIONS = {"convert": "environment.las", "convert several inputs": "0.xyz environment.las 1.xyz 2.xyz",
               "convert text": "0.xyz", "convert in small memory": "environment.las --memory 256M",
               "convert to cubes": "environment.las --layout regular:8",
               "convert near a path": "environment.las --near trajectory.txt --within 9"}
OUTPUT = "out/out.h5"
INHERITED = "resumes with (?!0 )|goes on with an unfinished conversion"
MOST_KILLED = 5  # in a row
MOST_SECONDS = 60  # that a process may take to stop


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


class Tally:
    def __init__(self):
        self.kills = self.terms = self.inherited = self.refused = self.results = 0


class Case:
    def __init__(self, place, name, words):
        self.place, self.name, self.words = place, name, f"{words} -o {OUTPUT}"
        self.output, self.tally = place / OUTPUT, Tally()

    def size(self):
        """Of the output and what lies beside it."""
        total = 0
        for file in self.output.parent.iterdir():
            try:
                total += file.stat().st_size
            except FileNotFoundError:  # it has got its name
                pass
        return total

    def wait_to_grow(self, process, least):
        """Until there are so many bytes, or the process has ended. Returns the most that there were."""
        most = self.size()
        while process.poll() is None and most < least:
            time.sleep(0.0005)
            most = max(most, self.size())
        return most

    def undisturbed(self):
        with tempfile.TemporaryFile("w+") as said:
            process = self.place.start(self.words, to=said)
            self.whole = self.wait_to_grow(process, float("inf"))
            said.seek(0)
            expect(process.returncode == 0, said.read())
        self.expected = self.output.read_bytes()

    def succeeded(self, process, text):
        """Whether the output is its; otherwise it was refused because another has it, or had."""
        if process.returncode == 0:
            return True
        another = process.returncode == 4 and "another process is writing it" in text
        expect(another or process.returncode == 2 and "exists already" in text,
               f"{self.name}: exit code {process.returncode}: {text}")
        self.tally.refused += another
        return False

    def stop(self, process, which):
        process.send_signal(which)
        sent = time.monotonic()
        text = process.communicate()[0]
        expect(time.monotonic() - sent < MOST_SECONDS, f"took more than {MOST_SECONDS} seconds to stop")
        self.tally.inherited += re.search(INHERITED, text) is not None
        self.tally.kills += process.returncode == -signal.SIGKILL
        if process.returncode == 5 and which == signal.SIGTERM:
            expect("--resume" in text or "again" in text, text)
            self.tally.terms += 1
        elif process.returncode != -which:  # which ends it before it can listen, too
            self.succeeded(process, text)

    def attempt(self, draw):
        """One process that is stopped, or two of which one is, when the files have grown by a part of
        what they lack."""
        size = self.size()
        process = self.place.start(f"{self.words} --resume")
        rival = self.place.start(f"{self.words} --resume") if draw.random() < 0.25 else None
        self.wait_to_grow(process, max(1, size + draw.random() * (self.whole - size)))
        self.stop(process, draw.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM]))
        if rival is not None:
            self.succeeded(rival, rival.communicate()[0])

    def torment(self, kills, draw):
        """Stops and resumes until `kills` SIGKILLs were made, and the output is done."""
        self.undisturbed()
        while self.tally.kills < kills:
            self.output.unlink()
            for _ in range(MOST_KILLED):
                self.attempt(draw)
                if self.output.exists():  # killed between its name and its exit, it is complete
                    break
            said = self.place.ask(f"{self.words} --resume").stderr
            self.tally.inherited += re.search(INHERITED, said) is not None
            expect(self.output.read_bytes() == self.expected, f"{self.name}: the result differs")
            left = [path.name for path in self.output.parent.iterdir()]
            expect(left == [self.output.name], f"{self.name}: left behind: {left}")
            self.tally.results += 1
        self.output.unlink()
        print(f"{self.name}: " + ", ".join(f"{count} {what}" for what, count in vars(self.tally).items()), flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--device", choices=["cpu", "cuda"], default="cpu")
    parser.add_argument("--points", type=int, default=400000)
    parser.add_argument("--poses", type=int, default=800)
    parser.add_argument("--scan", nargs="*", default=[])
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        place = Place(folder)
        (place / "out").mkdir()
        place.make_hall(arguments.points, 10000, arguments.poses, "--cell-points 1000")
        for i in range(3):
            place.put(f"{i}.xyz", "".join(
                f"{draw.uniform(-50, 50):.3f} {draw.uniform(-20, 20):.3f} {draw.uniform(0, 8):.3f}\n"
                for _ in range(arguments.points // 12)))
        run = f"run --env site.h5 --model model.ply --trajectory trajectory.txt --device {arguments.device}"
        cases = [Case(place, name, f"{run} {words}") for name, words in RUNS.items()
                 if arguments.device == "cpu" or name != "kdtree"]
        scans = {f"convert {Path(scan).name}": f"'{Path(scan).resolve()}'" for scan in arguments.scan}
        cases += [Case(place, name, f"convert {words} --threads 2 --cell-points 2000")
                  for name, words in {**CONVERSIONS, **scans}.items()]
        cases = [case for case in cases if arguments.only in case.name]
        for case in cases:
            case.torment(arguments.kills, draw)
        expect(sum(case.tally.inherited for case in cases) >= len(cases) * arguments.kills // 6,
               "too few were really resumed")


main()
