"""Runs, conversions and exports that are asked to stop or killed: what they leave, and what --resume
and --force do with it. Journals that are refused, damaged, torn or in use.

resume_test.py PROGRAM
"""

import json
import os
import shutil
import signal
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import Scratch  # noqa: E402

INPUTS = "--env site.h5 --model model.ply --trajectory trajectory.txt"
JOURNAL, RESULT = "out/out.h5.journal", "out/out.h5"
FINISHED = "is the finished result of this query already"
UNFINISHED = b"CLWYJ"  # a journal with nothing in it yet
FEW = 2500  # bytes of a journal that has more than 20 cells


class Stopped(Scratch):
    """A folder with a folder for outputs alone."""

    def setUp(self):
        shutil.rmtree(self.place / "out", ignore_errors=True)
        (self.place / "out").mkdir()

    def files(self):
        return sorted(os.listdir(self.place / "out"))

    def size(self, name):
        try:
            return (self.place / name).stat().st_size
        except FileNotFoundError:
            return 0

    def wait_for(self, process, name, least):
        while self.size(name) < least:
            self.assertIsNone(process.poll(), f"it ended before {name} had {least} bytes")
            time.sleep(0.001)

    def stop(self, process, which, code, *said):
        process.send_signal(which)
        sent = time.monotonic()
        text = process.communicate()[0]
        self.assertEqual(process.returncode, code, text)
        self.assertLess(time.monotonic() - sent, 5)
        for part in said:
            self.assertIn(part, text)


class Runs(Stopped):
    """A hall that the grid engine searches for a second."""

    @classmethod
    def make(cls):
        cls.place.make_hall(500000, 10000, 1500, "--cell-points 500")
        cls.place.ask(f"run {INPUTS} --radius 0.1 --engine grid --device cpu -o whole.h5")

    def words(self, options="", radius="0.1", engine="grid"):
        return f"run {INPUTS} --device cpu --radius {radius} --engine {engine} -o {RESULT} {options}"

    def ask(self, options="", code=0, *said, **question):
        return self.place.ask(self.words(options, **question), code, *said)

    def start_and(self, which=signal.SIGKILL, options=""):
        """Starts a run, lets it finish a few cells and sends it a signal."""
        process = self.place.start(self.words(options))
        self.wait_for(process, JOURNAL, FEW)
        self.stop(process, which, -which if which == signal.SIGKILL else 5)

    def journal(self):
        return (self.place / JOURNAL).read_bytes()

    def put(self, name, data):
        (self.place / name).write_bytes(data)

    def check_result(self):
        self.assertEqual(self.files(), ["out.h5"])
        self.assertEqual(*self.place.bytes(RESULT, "whole.h5"))

    def test_a_run_that_is_asked_to_stop_says_how_to_resume_and_resumes(self):
        for which in (signal.SIGINT, signal.SIGTERM):
            self.setUp()
            process = self.place.start(self.words())
            self.wait_for(process, JOURNAL, FEW)
            self.stop(process, which, 5, "interrupted", "--resume")
            self.assertEqual(self.files(), ["out.h5.journal"])
            self.place.ask(f"verify {JOURNAL}", lacks=["torn"])
        resumed = self.ask("--resume --json", 0, "resumes with", "cells finished")
        self.assertGreaterEqual(json.loads(resumed.stdout)["resumed_cells"], 20)
        self.check_result()

    def test_a_second_signal_ends_a_run_at_once(self):
        process = self.place.start(self.words())
        self.wait_for(process, JOURNAL, FEW)
        for which in (signal.SIGSTOP, signal.SIGTERM, signal.SIGINT):  # both are pending when it continues
            process.send_signal(which)
        self.stop(process, signal.SIGCONT, 5, "before the work in flight was finished")
        self.ask("--resume")
        self.check_result()

    def test_an_unfinished_journal_is_neither_used_nor_dropped_unasked(self):
        self.start_and()
        found = self.journal()
        self.place.put("other.xyz", "1 2 3\n")
        self.place.put("other.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n")
        for options, question, *said in (
                ("", {}, "--resume continues it, --force starts again",
                 "an unfinished run with engine grid on cpu, radius 0.1"),
                ("--resume --force", {}, "--force"),
                ("--resume", {"radius": "0.2"}, "its radius is 0.1, expected 0.2"),
                ("--resume", {"engine": "kdtree"}, "its engine is grid, expected kdtree"),
                ("--resume --between-poses", {"engine": "sweep"}, "between_poses is no")):
            self.assertEqual(self.ask(options, 2, *said, **question).stdout, "")
        for given, other, said in (("model.ply", "other.xyz", "its model is "),
                                   ("trajectory.txt", "other.txt", "its trajectory is ")):
            self.place.ask(self.words("--resume").replace(given, other), 2, said)
        # A mistyped name does not drop it either.
        self.place.ask(self.words("--force").replace("model.ply", "modle.ply"), 4, "modle.ply")
        self.assertEqual(self.journal(), found)
        info = self.place.json(f"info {JOURNAL}")
        self.assertEqual([info["kind"], info["radius"], info["answered_cells"]["hits"]],
                         ["journal", "0.1", info["finished_cells"]])
        self.assertGreaterEqual(info["finished_cells"], 19)
        self.ask("--force", 0, "journal of an unfinished run removed")
        self.check_result()

    def test_a_run_resumes_with_other_threads_memory_and_devices(self):
        self.start_and(options="--threads 1")
        found = self.journal()
        self.ask("--resume --threads 3 --memory 1G", 0, "resumes with")
        self.check_result()
        (self.place / RESULT).unlink()
        self.put(JOURNAL, found)
        self.place.ask(self.words("--resume --device-memory 1G").replace("--device cpu", "--device auto"), 0,
                       "resumes with", "on the CPU")
        self.check_result()

    def test_resuming_without_a_journal_starts_afresh_and_says_so(self):
        self.ask("--resume", 0, "no journal to resume, starts from the beginning")
        self.put(JOURNAL, UNFINISHED)
        self.ask("--force", 0, "removed, starts from the beginning")
        (self.place / RESULT).unlink()
        self.put(JOURNAL, UNFINISHED)
        self.ask("", 0, "nothing in it yet")
        self.check_result()

    def test_a_resumed_run_leaves_a_result_alone_that_answers_its_query_and_no_other(self):
        first, again = (json.loads(done.stdout) for done in
                        (self.ask("--json"), self.ask("--resume --json", 0, FINISHED, engine="sweep")))
        for same in ("environment_points", "colliding_points", "cells_total"):
            self.assertEqual(again[same], first[same])
        self.assertEqual([again["engine"], again["cells_read"], again["seconds"].keys()],
                         [None, 0, first["seconds"].keys()])
        self.put(JOURNAL, UNFINISHED)
        self.ask("--resume", 0, FINISHED)
        other = ("exists already, and answers another question than this run: radius: 0.1 m in the file, 0.2 m here; "
                 "--force ")
        for options, radius, said in (
                ("--resume", "0.2", f"{other}instead of --resume overwrites it"),
                ("", "0.2", f"{other}overwrites it, or give another name"),
                ("--shard 1/2", "0.1", "part: the whole result in the file, part 1 of 2 here"),
                ("", "0.1", "exists already, and answers the same question; --resume repeats that answer")):
            self.ask(options, 2, said, radius=radius)
        self.check_result()
        damaged = bytearray((self.place / RESULT).read_bytes())
        damaged[len(damaged) // 2] ^= 1
        self.put(RESULT, damaged)
        self.ask("--resume", 2, "exists already, and is ")

    def test_an_existing_result_stays_until_a_run_replaces_it_and_only_where_asked_for(self):
        self.ask(radius="0.05")
        old = self.place.bytes(RESULT)
        self.start_and(options="--force")
        self.assertEqual(self.place.bytes(RESULT), old)
        self.ask("", 2, "an unfinished run with engine grid on cpu")
        self.ask("--resume")
        self.check_result()
        self.setUp()
        self.start_and()
        self.put(RESULT, b"of somebody else")
        self.ask("--resume", 2, "exists already, and is no complete result")
        self.assertEqual(self.place.bytes(RESULT), [b"of somebody else"])
        # As if killed after the result got its name and before its journal was removed.
        shutil.copy(self.place / "whole.h5", self.place / RESULT)
        self.ask("--resume", 0, FINISHED)
        self.check_result()

    def test_a_run_does_not_remove_the_journal_of_the_next_one(self):
        self.start_and()
        finishing = self.place.start(self.words("--resume"))
        self.wait_for(finishing, JOURNAL, self.size(JOURNAL) + 300)
        (self.place / JOURNAL).unlink()
        self.put(JOURNAL, b"CLWYJRNL of another run")
        finishing.communicate()
        self.assertEqual([finishing.returncode, self.journal()], [0, b"CLWYJRNL of another run"])

    def test_two_runs_of_one_output_are_one_too_many(self):
        first = self.place.start(self.words())
        self.wait_for(first, JOURNAL, 500)
        first.send_signal(signal.SIGSTOP)
        for options in ("", "--resume", "--force"):
            self.ask(options, 4, "another process is writing it")
        first.send_signal(signal.SIGCONT)
        first.communicate()
        self.assertEqual(first.returncode, 0)
        self.check_result()

    def test_what_is_no_journal_is_left_alone_and_a_refused_run_leaves_none(self):
        for options, code, said in (("--memory 1K", 4, "too little"), ("--between-poses", 2, "--engine sweep"),
                                    *((f"--journal-interval {seconds}", 2, "--journal-interval")
                                      for seconds in ("-1", "nan", "x", "4000"))):
            self.ask(options, code, said)
            self.assertEqual(self.files(), [])
        self.put(JOURNAL, b"a diary")
        for options in ("", "--resume", "--force"):
            self.ask(options, 2, "move it away")
        self.assertEqual(self.journal(), b"a diary")
        (self.place / JOURNAL).unlink()
        (self.place / JOURNAL).symlink_to("elsewhere")
        for options in ("", "--resume", "--force"):
            self.ask(options, 2, "move it away")
        self.assertFalse((self.place / "out/elsewhere").exists())

    def verified(self, data, code, *said):
        self.put(JOURNAL, data)
        return self.place.ask(f"verify {JOURNAL}", code, *said).stdout

    def test_verify_tells_a_torn_tail_which_resuming_cuts_off_from_damage(self):
        self.start_and(signal.SIGTERM, "--journal-interval 0")
        whole = self.journal()
        self.assertEqual(self.verified(whole, 0), f"{JOURNAL}: sound\n")
        self.verified(whole[:5], 0, "it ends before its first record")
        self.verified(b"", 0)
        self.verified(whole[:100] + bytes([whole[100] ^ 1]) + whole[101:], 1, "record 0 at byte 16 is damaged",
                      ": damaged\n")
        self.ask("--resume", 3, "record 0 at byte 16 is damaged")
        self.verified(whole[:-3], 0, " is torn, with ", "--resume cuts that off", ": sound\n")
        self.ask("--resume", 0, " is torn, with ", "resumes with")
        self.check_result()


class Others(Stopped):
    @classmethod
    def make(cls):
        cls.place.make_hall(500000, 100, 50)
        # Nearly every point is part of the result.
        cls.place.ask(f"run {INPUTS} --radius 30 -o large.h5")

    def test_a_conversion_that_is_asked_to_stop_leaves_what_it_has_finished_and_goes_on_with_it(self):
        command = f"convert environment.las --cell-points 500 -o {RESULT} --resume"
        process = self.place.start(command)
        self.wait_for(process, f"{RESULT}.partial", 1000)
        self.stop(process, signal.SIGTERM, 5, "interrupted", "the same command")
        self.assertTrue(self.files() and all(name.startswith("out.h5.") for name in self.files()), self.files())
        self.place.ask(f"run --force {INPUTS} --radius 0.1 -o {RESULT}", 2,
                       "is the journal of an unfinished conversion")
        for _ in range(2):
            self.place.ask(command)
            self.assertEqual(self.files(), ["out.h5"])

    def test_a_store_in_another_unit_makes_the_result_anew(self):
        self.place.put("cloud.xyz", "".join(f"{i * 0.01} 0 {i % 9}\n" for i in range(300)))
        results, run = [], f"run {INPUTS} --radius 0.1 --first-pose -o {RESULT} --resume".replace("site", "unit")
        for unit in ("m", "ift", "m"):
            self.place.ask(f"convert cloud.xyz --unit {unit} -o unit.h5 --force")
            self.place.ask(run)
            results += self.place.bytes(RESULT)
            self.place.ask(run, 0, FINISHED)
        self.assertEqual([results[0] == results[1], results[0] == results[2]], [False, True])

    def test_a_scene_that_is_asked_to_stop_leaves_nothing_behind(self):
        process = self.place.start("scene hall --points 3000000 -o out")
        while not self.files():
            self.assertIsNone(process.poll())
            time.sleep(0.001)
        self.stop(process, signal.SIGTERM, 5, "interrupted", "the same command")
        self.assertEqual(self.files(), [])

    def test_an_export_that_is_asked_to_stop_or_killed_leaves_nothing_that_looks_finished(self):
        for which, code, said, left in ((signal.SIGTERM, 5, ["interrupted", "starts it again"], []),
                                        (signal.SIGINT, 5, ["interrupted", "starts it again"], []),
                                        (signal.SIGKILL, -signal.SIGKILL, [], ["out.csv.partial"])):
            process = self.place.start("export large.h5 -o out/out.csv")
            self.wait_for(process, "out/out.csv.partial", 1000)
            self.stop(process, which, code, *said)
            self.assertEqual(self.files(), left)
        self.place.ask("export large.h5 -o out/out.csv")
        self.assertEqual(self.files(), ["out.csv"])

    def test_what_does_not_come_to_an_end_is_given_up_within_5_seconds(self):
        read, write = os.pipe()  # which is never written to
        self.addCleanup(os.close, write)
        process = self.place.start(f"convert - -o {RESULT}", stdin=read)
        while not self.files():
            self.assertIsNone(process.poll())
            time.sleep(0.002)
        time.sleep(0.1)  # until the handlers are installed
        self.stop(process, signal.SIGTERM, 5, "interrupted before")
        self.assertEqual(self.files(), ["out.h5.partial"])


if __name__ == "__main__":
    unittest.main()
