"""Flips every byte of a small store and of small journals, one at a time, and lets `clearway run`
answer with them: never another answer with exit code 0.

flip_every_byte.py PROGRAM [--every N] [--jobs J]

--every N: only every Nth byte. A store's bytes are tried with the engines in turn.
"""

import argparse
import collections
import concurrent.futures
import pathlib
import resource
import subprocess
import sys
import tempfile
import threading

ENGINES = ["sweep", "grid", "kdtree"]
JOURNAL_BYTES = 1500


def expect(condition, what):
    if not condition:
        sys.exit("flip_every_byte: " + what)


def flipped(data, at):
    return data[:at] + bytes([data[at] ^ (1 << at % 8)]) + data[at + 1:]


class Site:
    def __init__(self, program, work):
        self.program, self.work = program, work
        self.run(["scene", "hall", "--points", "700", "--model-points", "60", "--poses", "40",
                  "-o", str(work)])
        self.run(["convert", str(work / "environment.las"), "--cell-points", "64", "-o",
                  str(work / "site.h5")])
        self.store = (work / "site.h5").read_bytes()
        self.expected = {}
        for engine in ENGINES:
            self.run(self.search(self.work / "site.h5", engine, self.work / "expected.h5"))
            self.expected[engine] = (self.work / "expected.h5").read_bytes()
            (self.work / "expected.h5").unlink()

    def run(self, arguments):
        done = subprocess.run([self.program] + arguments, stderr=subprocess.PIPE, text=True)
        expect(done.returncode == 0, done.stderr)

    def search(self, store, engine, output):
        return ["run", "--env", str(store), "--model", str(self.work / "model.ply"),
                "--trajectory", str(self.work / "trajectory.txt"), "--radius", "0.8",
                "--device", "cpu", "--threads", "1", "--engine", engine, "-o",
                str(output)]

    def journal(self, engine, options):
        """What a run leaves that may not write more than so many bytes to a file."""
        output = self.work / "cut.h5"
        subprocess.run([self.program] + self.search(self.work / "site.h5", engine, output) +
                       options, stderr=subprocess.DEVNULL, preexec_fn=lambda: resource.setrlimit(
                           resource.RLIMIT_FSIZE, (JOURNAL_BYTES, JOURNAL_BYTES)))
        journal = pathlib.Path(str(output) + ".journal")
        data = journal.read_bytes()
        journal.unlink()
        return data


class Trial:
    """A folder of one thread, in which damaged files are tried."""

    def __init__(self, site, counts):
        self.site, self.counts = site, counts
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=site.work))
        self.output = self.folder / "out.h5"
        self.journal = self.folder / "out.h5.journal"

    def call(self, arguments):
        return subprocess.run([self.site.program] + arguments, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", timeout=60)

    def judge(self, what, damaged, engine, search, refusals):
        verified = self.call(["verify", str(damaged)])
        expect(verified.returncode in (0, 1), f"{what}: verify: {verified.stdout}")
        done = self.call(search)
        if done.returncode == 0:
            expect(self.output.read_bytes() == self.site.expected[engine],
                   f"{what}: another answer with exit code 0")
            self.output.unlink()
        else:
            expect(done.returncode in refusals, f"{what}: {done.returncode}: {done.stdout}")
            expect(damaged.name in done.stdout, f"{what}: not named: {done.stdout}")
            expect(not self.output.exists(), f"{what}: refused, but there is an output")
            expect(verified.returncode == 1, f"{what}: refused, but sound to verify")
        self.counts[("detected by verify" if verified.returncode else "sound to verify",
                     "refused" if done.returncode else "same answer")] += 1

    def try_store(self, at):
        engine = ENGINES[at % len(ENGINES)]
        damaged = self.folder / "bad.h5"
        damaged.write_bytes(flipped(self.site.store, at))
        self.judge(f"store, byte {at}, {engine}", damaged, engine,
                   self.site.search(damaged, engine, self.output), [3])
        self.journal.unlink(missing_ok=True)  # of what came before the damage

    def try_journal(self, data, engine, at):
        self.journal.write_bytes(flipped(data, at))
        search = self.site.search(self.site.work / "site.h5", engine, self.output) + ["--resume"]
        # 2: it is no journal any more
        self.judge(f"journal, byte {at}, {engine}", self.journal, engine, search, [2, 3])
        self.journal.unlink(missing_ok=True)


def for_all(site, count, every, jobs, attempt):
    counts = collections.Counter()
    local = threading.local()

    def one(at):
        if not hasattr(local, "trial"):
            local.trial = Trial(site, counts)
        attempt(local.trial, at)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for done in pool.map(one, range(0, count, every)):
            pass
    return ", ".join(f"{' and '.join(kind)}: {n}" for kind, n in sorted(counts.items()))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        site = Site(arguments.program, pathlib.Path(folder))
        for engine in ENGINES:
            for options in [["--journal-interval", "0"], []]:
                data = site.journal(engine, options)
                expect(len(data) > JOURNAL_BYTES / 2, f"{engine}: a journal of {len(data)} bytes")
                found = for_all(site, len(data), arguments.every, arguments.jobs,
                                lambda trial, at: trial.try_journal(data, engine, at))
                print(f"journal of {engine} {' '.join(options)}, {len(data)} bytes: {found}",
                      flush=True)
        found = for_all(site, len(site.store), arguments.every, arguments.jobs, Trial.try_store)
        print(f"store, {len(site.store)} bytes: {found}", flush=True)


main()
