"""Disks that fail, calls that do less than asked, files that shrink, threads that cannot be started:
exit code 4, the file named, and nothing that looks finished.

faults_test.py PROGRAM FAULTY_CALLS
"""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import PROGRAM, Place, Scratch  # noqa: E402

FAULTY_CALLS = os.path.abspath(sys.argv.pop(1))
INPUTS = ["environment.las", "model.ply", "trajectory.txt", "site.h5", "made.h5", "scan.xyz"]
QUESTION = "--trajectory trajectory.txt --model model.ply"
SEARCH = f"run --env site.h5 {QUESTION} --radius 0.1 --threads 2 --force"
COMMANDS = {  # what makes an output
    "out.h5": "convert environment.las --force --cell-points 4096 --threads 2",
    "text.h5": "convert scan.xyz --force --threads 2",
    "sweep.h5": f"{SEARCH} --first-pose", "kdtree.h5": f"{SEARCH} --engine kdtree",
    "grid.h5": f"{SEARCH} --engine grid --device cpu",
    "thin.txt": "trajectory thin trajectory.txt --model model.ply --max-motion 0.01",
    "out.las": "export made.h5", "out.csv": "export made.h5"}


class Faults(Scratch):
    @classmethod
    def make(cls):
        cls.inputs = Place(cls.place / "inputs")
        cls.inputs.make_hall(12000, 200, 100)
        cls.inputs.ask(f"{SEARCH} --first-pose -o made.h5")
        cls.inputs.put("scan.xyz", "".join(f"{i % 50} {i} 1\n" for i in range(4000)))
        cls.files = Place(cls.place / "files")

    def restore(self):
        for name in INPUTS:
            shutil.copyfile(self.inputs / name, self.files / name)

    def setUp(self):
        shutil.rmtree(self.files.folder)
        self.files = Place(self.files.folder)
        self.restore()

    def faulty(self, words, kind, call, without=""):
        """Runs the program while calls on its files go wrong (faulty_calls.cpp). The exit code, what it
        says and prints, and whether a call went wrong. without: a file whose calls go right."""
        mark = self.place / "mark"
        mark.unlink(missing_ok=True)
        done = subprocess.run([PROGRAM, *words.split()], cwd=self.files.folder, capture_output=True, text=True,
                              check=False, env={
                                  **os.environ, "LD_PRELOAD": FAULTY_CALLS, "FAULT_KIND": kind,
                                  "FAULT_FOLDER": f"{self.files.folder}/", "FAULT_CALL": str(call),
                                  "FAULT_EXCEPT": str(self.files / without) if without else "", "FAULT_MARK": str(mark)})
        return done.returncode, done.stderr, done.stdout, mark.exists()

    def for_each_output(self):
        """Each output, the words of the command that makes it, and its bytes."""
        for name, words in COMMANDS.items():
            with self.subTest(name):
                (self.files / name).unlink(missing_ok=True)
                self.files.ask(f"{words} -o {name}")
                [expected] = self.files.bytes(name)
                (self.files / name).unlink()
                yield self.files / name, f"{words} -o {self.files / name}", expected

    def visible(self):
        """Files but journals and what lies beside them, with which stopped work goes on."""
        return {file for file in self.files.folder.iterdir() if not file.with_suffix(".journal").exists()}

    def test_every_call_that_fails_in_turn_ends_with_exit_code_4_and_without_an_output(self):
        for output, words, expected in self.for_each_output():
            before, went_wrong, call = self.visible(), True, 0
            while went_wrong:
                call += 1
                code, said, printed, went_wrong = self.faulty(words, "fail", call)
                if not went_wrong or code == 0 and words.startswith("export"):  # which reads again
                    self.assertEqual([code, output.read_bytes()], [0, expected], said)
                else:
                    self.assertEqual([code, printed], [4, ""], f"call {call}: {said}")
                    self.assertTrue(any(name in said for name in [*INPUTS, output.name, str(self.files.folder)]), said)
                # A failed fsync of the folder is reported although the output already has its name.
                output.unlink(missing_ok=True)
                self.assertEqual(self.visible(), before)
            self.assertGreater(call, 4)

    def test_short_and_interrupted_calls_change_nothing(self):
        for kind in ("short", "interrupt"):
            for output, words, expected in self.for_each_output():
                code, said, _, went_wrong = self.faulty(words, kind, 0)
                self.assertEqual([code, went_wrong, output.read_bytes()], [0, True, expected], said)

    def test_an_input_that_shrinks_while_it_is_read_is_noticed(self):
        for output, words, expected in self.for_each_output():
            went_wrong, call = True, 0
            while went_wrong:
                call += 1
                code, said, _, went_wrong = self.faulty(words, "shrink", call, output.name)
                self.assertEqual(output.exists(), code == 0, said)
                if code == 0:  # what was cut off was read before
                    self.assertEqual(output.read_bytes(), expected)
                    output.unlink()
                else:
                    self.assertIn(code, (3, 4))  # 3: HDF5 no longer finds its metadata
                    self.assertTrue(any(name in said for name in INPUTS), said)
                self.restore()
            self.assertGreater(call, 4)

    def test_a_command_that_gets_no_threads_says_so_or_does_without_them(self):
        self.files.put_path("long.txt", [(0.01 * i,) for i in range(40000)])
        self.files.put("vehicle.json", {"bodies": [{"name": "a", "model": "model.ply", "pivots": [0.1, -0.1]}]})
        commands = [f"{words.removesuffix(' --force')} --force -o {name}" for name, words in COMMANDS.items()]
        commands += [f"conflicts made.h5 {QUESTION} --force -o a.csv",
                     "stations made.h5 --trajectory trajectory.txt --force -o a.csv",
                     f"shift made.h5 --env site.h5 {QUESTION} --lateral -0.1,0.1 --force -o a.csv",
                     f"report made.h5 --env site.h5 {QUESTION} --force -o a.html",
                     "run --env site.h5 --trajectory trajectory.txt --vehicle vehicle.json --radius 0.1 --force -o b.h5",
                     "section find --env site.h5 --trajectory trajectory.txt --x-range=-1,1 --window=-2,2,0,3 --force "
                     "-o c.h5", "trajectory follow trajectory.txt --pivots 0.1,-0.1 --force -o out.txt",
                     "trajectory info long.txt", "verify made.h5", "compare made.h5 made.h5", "info made.h5",
                     "verify site.h5"]
        refused = 0
        for words in commands:
            # All threads fail, or the first one does. Where a later one fails, the check before has
            # passed, and oneTBB ends the process.
            for call in (0, 1):
                code, said, *_ = self.faulty(words, "thread", call)
                self.assertIn(code, (0, 4), f"{words}: {said}")
                refused += code == 4
                self.assertEqual(code == 4, "threads cannot be started" in said, f"{words}: {said}")
        self.assertGreater(refused, len(commands) / 2)


if __name__ == "__main__":
    unittest.main()
