#!/usr/bin/python3
"""Help in groups, values that begin with a minus, and the run that gives what a result lacks.

    options_test.py CLEARWAY
"""

import json
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = []
FIVE = ["--env", "--model", "--trajectory", "--radius", "--output"]


def clearway(words, folder="."):
    words = words.split() if isinstance(words, str) else words
    return subprocess.run([PROGRAM[0], *words], cwd=folder, capture_output=True, text=True,
                          check=False)


def groups(command):
    """{title: [long name]} of a help, in its order."""
    found, title = {}, None
    for line in clearway(f"{command} --help-all").stdout.splitlines():
        if match := re.match(r"([A-Z][a-z][\w ]*):$", line):
            title = match[1]
        elif match := re.match(r"  (?:-\w,)?(--[\w-]+)", line):
            found.setdefault(title, []).append(match[1])
        elif not line.startswith(" "):
            title = None
    return found


class Help(unittest.TestCase):
    def test_run_begins_with_the_five_that_matter(self):
        run = groups("run")
        self.assertEqual(next(iter(run.items())), ("Inputs and output", FIVE))
        self.assertEqual(list(run), ["Inputs and output", "The question",
                                     "How sure the answer is", "Ignored points", "The model",
                                     "The path", "Units and frames",
                                     "Speed and memory", "Files and resume",
                                     "Messages and exit code"])

    def test_no_long_list_is_left(self):
        for command in ("check", "run", "convert", "merge", "export", "conflicts", "compare", "report",
                        "model", "model box", "model outline", "trajectory info",
                        "trajectory follow", "trajectory resample", "trajectory alignment",
                        "trajectory line",
                        "campaign plan", "campaign run", "campaign report"):
            for title, names in groups(command).items():
                self.assertLessEqual(len(names), 10, f"{command}: {title}")

    def test_the_first_example_asks_for_first_poses(self):
        example = re.search(r"^Example: ((?:.*\\\n)*.*)", clearway("run --help").stdout, re.M)[1]
        self.assertIn(" --first-pose ", example)

    def test_what_a_first_use_needs_fits_a_terminal(self):
        commands = ["", *re.findall(r"^  (\w+) ", clearway("--help").stdout, re.M)]
        self.assertGreater(len(commands), 15)
        for command in commands:
            shown, all_of = (clearway(f"{command} {option}").stdout
                             for option in ("--help", "--help-all"))
            for line in (shown + all_of).splitlines():
                if not line.startswith("Usage: "):  # which names the program's path
                    self.assertLessEqual(len(line), 80, f"{command}: {line}")
            options = re.findall(r"^  (?:-\w,)?(--[\w-]+)", shown, re.M)
            self.assertLessEqual(len(options), 17, command)
            more = re.search(r"^(\d+) more options: --help-all$", shown, re.M)
            every = re.findall(r"^  (?:-\w,)?(--[\w-]+)", all_of, re.M)
            self.assertEqual(len(options) + int(more[1] if more else 0), len(every), command)
        check = clearway("check --help").stdout
        for option in ("--model ", "--trajectory ", "--radius ", "--floor "):
            self.assertIn(f"  {option}", check)


class Site(unittest.TestCase):
    """A small hall with a result that was asked for nothing but the points."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="clearway-options-")
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = Path(cls.scratch.name)
        cls.do("scene hall --points 20000 --model-points 2000 --poses 200 -o .")
        cls.do("convert environment.las -o site.h5")
        cls.do("run --env site.h5 --model model.ply --trajectory trajectory.txt --radius 0.1 "
               "--ignore-box -1,-2.5,-3,-0.5,9,9 -o out.h5")

    @classmethod
    def do(cls, words, exit_code=0):
        done = clearway(words, cls.folder)
        if done.returncode != exit_code:
            raise AssertionError(f"{words}: exit code {done.returncode}\n{done.stderr}")
        return done

    def advised(self, words, exit_code=2):
        """The command that a refusal, or a note, prints."""
        text = self.do(words, exit_code).stderr
        command = re.search(r"^  (clearway run .*)$", text, re.M)
        self.assertIsNotNone(command, text)
        return shlex.split(command[1])[1:]

    def answered(self, words, path="trajectory.txt"):
        """Runs the printed command, with the files that it cannot know. Gives its result."""
        known = {"SITE.h5": "site.h5", "MODEL": "model.ply", "PATH": path,
                 "VEHICLE.json": "vehicle.json"}
        words = [known.get(word, word) for word in words]
        self.do([*words, "--force"])
        return words[words.index("-o") + 1]


class Minus(Site):
    def test_axes_as_documented(self):
        self.do("run --env site.h5 --model model.ply --trajectory trajectory.txt --radius 0.1 "
                "--first-pose -o first.h5 --force")
        shown = [self.do(f"conflicts first.h5 --min-points 1 --trajectory trajectory.txt {axis}").stdout
                 for axis in ("--forward -x", "--forward=-x", "--forward -X", "--forward +x")]
        self.assertEqual(shown[0], shown[1])
        self.assertEqual(shown[0], shown[2])
        self.assertNotEqual(shown[0], shown[3])
        self.do("report first.h5 --env site.h5 --model model.ply --trajectory trajectory.txt "
                "--forward -y --up -z -o page.html --force")

    def test_lengths_and_boxes(self):
        run = "run --env site.h5 --model model.ply --trajectory trajectory.txt --force -o m.h5 "
        for value in ("--floor -0.5", "--floor -.5", "--floor -50cm",
                      "--lever-arm -.1,-0.2,0", "--ignore-box -.1,-2,-3,1,2,3"):
            self.do(run + "--radius 0.1 " + value)
            name, given = value.split()
            self.do(run + f"--radius 0.1 {name}={given}")
        self.do("trajectory follow trajectory.txt --pivots -.5,-2 -o body.txt --force")
        self.do("trajectory follow trajectory.txt --at -.5 -o body.txt --force")
        refused = clearway(run + "--radius -0.1", self.folder)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--radius: -0.1: expected a finite number of metres above 0", refused.stderr)

    def test_options_stay_options(self):
        for words, message in (("info --json -q site.h5", "unknown option -q"),
                               ("conflicts out.h5 --force -x", "unknown option -x"),
                               ("run --radius -o out.h5", "--radius"),
                               ("run --radius --force", "--radius")):
            refused = clearway(words, self.folder)
            self.assertEqual(refused.returncode, 2, words)
            self.assertIn(message, refused.stderr)


class RunAgain(Site):
    def test_conflicts(self):
        words = self.advised("conflicts out.h5 --trajectory trajectory.txt")
        self.assertEqual(words[:3], ["run", "--env", "SITE.h5"])
        self.assertIn("--ignore-box", words)
        result = self.answered(words)
        self.assertEqual(result, "out-first-poses.h5")
        self.do(f"conflicts {result} --trajectory trajectory.txt")
        self.do(f"compare out.h5 {result}")

    def test_all_that_was_asked_is_repeated(self):
        """Every option of the question, as the help groups them."""
        self.do("scene hall --points 2000 --model-points 200 --poses 20 -o small")
        (self.folder / "origins.csv").write_text("first,x,y,z\n0,1,2,3\n")
        self.do("convert small/environment.las --origins origins.csv -o seen.h5")
        asked = {"--clearance": "0.3", "--profile": "0.4", "--floor": "-0.5", "--seen": "",
                 "--seen-cube": "0.25", "--seen-min": "9", "--error-scan": "0.005",
                 "--error-registration": "0.01", "--error-pose": "0.02", "--error-angle": "0.001",
                 "--error-model": "0.003", "--sigmas": "2", "--gap": "0.4",
                 "--ignore-box": "-1,-2.5,-3,-0.5,9,9", "--depth": ""}
        # Without an error budget there are other questions, and no class is in this store.
        others = {"--first-pose", "--between-poses", "--ignore-class"}
        text = self.do("run --help-all").stdout
        groups = text[text.index("\nThe question:"):text.index("\nThe model:")]
        self.assertEqual(set(re.findall(r"^  (--[a-z-]+)", groups, re.M)), asked.keys() | others)
        words = [w for item in asked.items() for w in item if w]
        inputs = "--model small/model.ply --trajectory small/trajectory.txt"
        self.do(["run", "--env", "seen.h5", *inputs.split(), "--radius", "0.1", *words, "-o", "all.h5"])
        again = self.advised(f"conflicts all.h5 {inputs}")
        for option, value in asked.items():
            self.assertIn(option, again)
            if value:
                self.assertEqual(again[again.index(option) + 1], value)
        again = [{"SITE.h5": "seen.h5"}.get(word, word) for word in again]
        self.do(again)
        told = [json.loads(self.do(["info", "--json", file]).stdout)["parameters"]
                for file in ("all.h5", again[again.index("-o") + 1])]
        self.assertEqual(told[0] | {"first_pose": True}, told[1])

    def test_how_the_inputs_were_read_is_repeated(self):
        run = "--trajectory trajectory.txt --model model.ply --model-vertices " \
              "--trajectory-format matrix --lever-arm -.1,0,0"
        self.do(f"run --env site.h5 --radius 0.1 {run} --clearance 0.2 -o read.h5 --force")
        words = self.advised(f"conflicts read.h5 {run}")
        self.assertEqual(words[words.index("--clearance") + 1], "0.2")
        result = self.answered(words)
        self.do(f"compare read.h5 {result}")
        self.do(f"conflicts {result} {run} -o all.bcf --force")
        run = run.replace("--model-vertices", "--model-vertices=false")
        self.assertNotIn("--model-vertices", self.advised(f"conflicts read.h5 {run}"))

    def test_report_exports_and_comparison(self):
        page = "--env site.h5 --model model.ply --trajectory trajectory.txt -o page.html --force"
        words = self.advised(f"report out.h5 {page}", exit_code=0)
        self.assertNotIn("MODEL", words)
        self.assertNotIn("SITE.h5", words)
        first = self.answered(words)
        self.assertNotIn("clearway run", self.do(f"report {first} {page}").stderr)
        for what in ("clearance", "profile"):
            result = self.answered(self.advised(f"export out.h5 --what {what} -o {what}.csv"))
            self.do(f"export {result} --what {what} -o {what}.csv --force")
        words = self.advised(f"compare {first} out.h5 --conflicts --trajectory trajectory.txt")
        self.assertEqual(words[words.index("--trajectory") + 1], "trajectory.txt")

    def test_names_with_blanks(self):
        (self.folder / "the out.h5").write_bytes((self.folder / "out.h5").read_bytes())
        words = self.advised(["conflicts", "the out.h5", "--trajectory", "trajectory.txt"])
        self.assertEqual(words[-1], "the out-first-poses.h5")
        self.assertEqual(self.answered(words), "the out-first-poses.h5")

    def test_mesh_vehicle_and_way(self):
        sides = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
        corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
        (self.folder / "tent.obj").write_text(
            "".join("v {} {} {}\n".format(*c) for c in corners) +
            "".join("f {} {} {}\n".format(*(i + 1 for i in s)) for s in sides))
        (self.folder / "vehicle.json").write_text(
            '{"bodies": [{"name": "a", "model": "tent.obj"}, '
            '{"name": "b", "model": "model.ply", "at": 0}]}')
        for of in ("--model tent.obj", "--model tent.obj --model-as solid",
                   "--model tent.obj --model-as points", "--vehicle vehicle.json",
                   "--model tent.obj --model-as points --between-poses"):
            self.do(f"run --env site.h5 {of} --trajectory trajectory.txt --radius 0.1 -o of.h5 "
                    "--force")
            file = " ".join(of.split()[:2])
            words = self.advised(f"conflicts of.h5 --trajectory trajectory.txt {file}")
            result = self.answered(words)
            self.do(f"compare of.h5 {result}")
            self.do(f"conflicts {result} --trajectory trajectory.txt {file}")


if __name__ == "__main__":
    PROGRAM.append(str(Path(sys.argv[1]).resolve()))
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
