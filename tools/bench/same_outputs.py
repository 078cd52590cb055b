#!/usr/bin/python3
"""Asks two builds of Clearway the same questions, and compares all that they write.

It prints a line for each output that differs, with the first difference, and a summary. An output
is a file that a command wrote or changed, what it printed on standard output or on standard error,
or its exit code; with --python also each name of the Python module with its kind, signature and
docstring. Exit code 1: an output differs, or a command did not end as the table expects.

The questions are in outputs/questions.py, the inputs that they need in outputs/inputs.py, and what
may differ in outputs/difference.py. h5py and numpy (Debian: python3-h5py) say which dataset of a
result differs.
Example: tools/bench/same_outputs.py before/clearway build/release/tools/clearway --data DATA
"""

import argparse
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from outputs import inputs, questions
from outputs.difference import Comparison, Naming, missing_tools

SECONDS = 300  # that a command may take, on a busy machine
TRIES = 6      # to stop a run between its beginning and its end


class Program:
    """One of the two builds, with the folder in which it answers."""

    def __init__(self, path, folder):
        self.path, self.folder = Path(path).absolute(), folder
        self.folder.mkdir(parents=True)
        self.environment = {**os.environ, "LC_ALL": "C.UTF-8", "TZ": "UTC",
                            "CUDA_VISIBLE_DEVICES": ""}
        said = self.run(["--version"])
        if said.returncode != 0:
            sys.exit(f"{path}: --version ends with {said.returncode}")
        self.version = said.stdout.decode().strip()
        self.naming = Naming(folder, dict.fromkeys([self.path, self.path.resolve()]), self.version)

    def start(self, words, folder=None, **streams):
        return subprocess.Popen([str(self.path), *words], cwd=folder or self.folder,
                                env=self.environment, **streams)

    def run(self, words, stdin=None, folder=None):
        """The finished command; a command that takes too long ends with -9."""
        with open(self.folder / stdin if stdin else os.devnull, "rb") as given:
            process = self.start(words, folder, stdin=given, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE)
            try:
                out, err = process.communicate(timeout=SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                out, err = process.communicate()
        return subprocess.CompletedProcess(words, process.returncode, out, err)

    def answer(self, question):
        """All outputs of a question, by their names."""
        before = self._files()
        done = self.run(question.words, question.stdin)
        after = self._files()
        outputs = {"exit code": str(done.returncode).encode(), "stdout": done.stdout,
                   "stderr": done.stderr}
        for name in sorted(after):
            if before.get(name) != after[name]:
                outputs[name] = (self.folder / name).read_bytes()
        for name in before.keys() - after.keys():
            outputs[name] = b"removed"
        return outputs

    def _files(self):
        """Name, and what changes with its contents, of each file in the folder. Links are not followed."""
        found, start = {}, len(str(self.folder)) + 1
        waiting = [str(self.folder)]
        while waiting:
            for entry in os.scandir(waiting.pop()):
                if entry.is_dir(follow_symlinks=False):
                    waiting.append(entry.path)
                elif not entry.is_symlink():
                    status = entry.stat()
                    found[entry.path[start:]] = status.st_mtime_ns, status.st_size, status.st_ino
        return found


class Question:
    """A line of the table."""

    def __init__(self, group, number, line):
        text, _, code = line.partition(" => ")
        self.code = {"": 0, "any": None}.get(code) if code in ("", "any") else int(code)
        words = [word.replace("@", f"{group.replace(' ', '_')}_{number}") for word in shlex.split(text)]
        self.stdin = words[words.index("<") + 1] if "<" in words else None
        self.words = words[:words.index("<")] if "<" in words else words
        self.group = group

    def __str__(self):
        return shlex.join(self.words)

    def makes(self):
        """The files and folders that questions after it may read."""
        made = [after for word, after in zip(self.words, self.words[1:]) if word == "-o"]
        return made + ([self.words[2]] if self.words[:2] == ["campaign", "run"] else [])

    def counts_vary(self):
        """Whether the order of the threads changes how much is tested, which is printed."""
        return "--profile" in self.words and "--threads 1" not in str(self)

    def reads(self, made):
        return any(word == made or word.startswith(made + "/") for word in [*self.words, self.stdin or ""])


def chosen_questions(data, pattern):
    """The questions that the pattern finds, and those whose outputs they need."""
    asked = [Question(group, number, line) for group, lines in questions.groups(data).items()
             for number, line in enumerate(lines)]
    wanted = []
    for question in reversed(asked):
        if question.group in questions.ALWAYS or not pattern or \
                re.search(pattern, f"{question.group}: {question}") or \
                any(later.reads(made) for later in wanted for made in question.makes()):
            wanted.append(question)
    return wanted[::-1]


class Tally:
    """Counts outputs and prints those that differ."""

    def __init__(self, comparison):
        self.comparison = comparison
        self.compared = self.different = self.questions = 0
        self.problems = []

    def compare(self, question, name, old, new, several_threads=False):
        self.compared += 1
        if old is None or new is None:
            where = "is new" if old is None else "is missing"
        else:
            where = self.comparison.difference(name, old, new, several_threads)
        if where:
            self.different += 1
            print(f"{name}: {where} [{question}]", flush=True)

    def compare_answers(self, question, old, new):
        """Empty texts are not counted."""
        self.questions += 1
        for name in dict.fromkeys([*old, *new]):
            if name in ("stdout", "stderr") and not old[name] and not new[name]:
                continue
            self.compare(question, name, old.get(name), new.get(name),
                         question.counts_vary())

    def problem(self, text):
        self.problems.append(text)
        print(text, flush=True)


def ask(question, old, new, tally, pool):
    """One question to both programs at the same time."""
    answers = list(pool.map(lambda program: program.answer(question), (old, new)))
    code = int(answers[0]["exit code"])
    if question.code is not None and code != question.code:
        tally.problem(f"{question}\n    ends with {code}, the table expects {question.code}: " +
                      answers[0]["stderr"].decode(errors="replace").strip()[-300:])
    tally.compare_answers(question, *answers)


# --- commands that one program begins and the other one ends ---------------------------------


def stop_midway(program, words, journal, kill):
    """Stops a command once its journal has grown; whether that was before its end."""
    process = program.start(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    sizes, end = set(), time.monotonic() + SECONDS
    while process.poll() is None and len(sizes) < 4 and time.monotonic() < end:
        try:
            sizes.add(journal.stat().st_size)
        except FileNotFoundError:
            pass
        time.sleep(0.0005)
    process.send_signal(kill)
    process.wait()
    return journal.exists()


def look_at_journal(begins, ends, journal, tally):
    """Both programs look at the same journal, and have to say the same."""
    for command in ("info", "verify"):
        said = [program.run([command, journal, "--json"], folder=begins.folder)
                for program in (begins, ends)]
        tally.compare(shlex.join(said[0].args), "stdout", *(one.stdout for one in said))


def resumed(case, name, begins, ends, kill, tally):
    """What `ends` makes of a command in which `begins` was stopped; None where it was too fast."""
    output = case.output.format(name=name)
    words, go_on = (shlex.split(text.format(name=name)) for text in (case.begin, case.go_on))
    for _ in range(TRIES):
        if case.prepare:
            begins.run(shlex.split(case.prepare.format(name=name)))
        if stop_midway(begins, words, begins.folder / f"{output}.journal", kill):
            break
        shutil.rmtree(begins.folder / name, ignore_errors=True)
        (begins.folder / output).unlink(missing_ok=True)
    else:
        tally.problem(f"{shlex.join(words)}\n    ended before it could be stopped")
        return None
    look_at_journal(begins, ends, f"{output}.journal", tally)
    done = ends.run(go_on, folder=begins.folder)
    log = (begins.folder / output).with_name("log.txt")
    said = done.stderr + (log.read_bytes() if log.exists() else b"")
    if not re.search(rb"resumes with [1-9]", said):
        tally.problem(f"{shlex.join(words)}\n    nothing of the interrupted run was used: "
                      + said.decode(errors="replace")[-300:])
    return (begins.folder / output).read_bytes() if (begins.folder / output).exists() else b""


def ask_interrupted(old, new, tally, pool, pattern):
    """Compares what was interrupted and resumed, each way, with what nobody interrupted."""
    for number, (title, case) in enumerate(questions.INTERRUPTED.items()):
        if pattern and not re.search(pattern, f"interrupted: {case.begin}"):
            continue
        for line in filter(None, (case.prepare, case.begin)):
            whole = Question("interrupted", number, line.format(name=f"whole_{number}"))
            ask(whole, old, new, tally, pool)
        kill = (signal.SIGKILL, signal.SIGINT)[number % 2]
        cut = case.output.format(name=f"cut_{number}")
        for begins, ends, way in ((old, new, "old, then new"), (new, old, "new, then old")):
            tally.questions += 1
            found = resumed(case, f"cut_{number}", begins, ends, kill, tally)
            expected = begins.folder / case.output.format(name=f"whole_{number}")
            if found is not None and expected.exists():
                tally.compare(f"interrupted: {title} ({way})", cut, expected.read_bytes(), found)


# --- the names of the Python module --------------------------------------------------------------


def python_names(folder):
    """Each name of the module `clearway` in the folder, and what a user sees of it."""
    script = Path(__file__).parent / "outputs/python_names.py"
    done = subprocess.run([sys.executable, script], env={**os.environ, "PYTHONPATH": str(folder)},
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{folder}: the module cannot be loaded: {done.stderr.strip()[-300:]}")
    return json.loads(done.stdout)


def compare_python(folders, tally):
    old, new = map(python_names, folders)
    tally.questions += 1
    for name in dict.fromkeys([*old, *new]):
        tally.compare("Python", name, *(names[name].encode() if name in names else None for names in (old, new)))


# --- the whole -----------------------------------------------------------------------------------


def ask_all(old, new, options, tally):
    derived = False
    with ThreadPoolExecutor(2) as pool:
        for question in chosen_questions(options.data, options.only):
            if question.group != "scenes" and not derived:
                for program in (old, new):
                    inputs.derive(program.folder)
                    if options.data:
                        (program.folder / "data").symlink_to(options.data)
                derived = True
            ask(question, old, new, tally, pool)
        ask_interrupted(old, new, tally, pool, options.only)


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path, metavar="OLD_CLEARWAY", help="the program whose outputs are right")
    parser.add_argument("new", type=Path, metavar="NEW_CLEARWAY", help="the program to check")
    parser.add_argument("--work", type=Path, metavar="DIR",
                        help="folder for the files, made if missing (default: a temporary one)")
    parser.add_argument("--data", type=Path, metavar="FOLDER",
                        help="real files to ask about too: its folders formats, malformed, trajectories and street")
    parser.add_argument("--only", metavar="PATTERN",
                        help="regular expression: only the questions of which `GROUP: COMMAND` matches")
    parser.add_argument("--python", type=Path, nargs=2, metavar=("OLD_FOLDER", "NEW_FOLDER"),
                        help="folders that hold the Python modules of both builds, whose names are compared too")
    parser.add_argument("--keep", action="store_true", help="leave the files in the folder")
    options = parser.parse_args()
    options.data = options.data and options.data.resolve()
    return options


def main():
    options = parsed()
    if options.work:
        options.work.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(prefix="same_outputs_", dir=options.work)).resolve()
    started = time.monotonic()
    try:
        # Names of one length, so that a text that is padded or cut to a width is the same.
        old, new = Program(options.old, work / "old"), Program(options.new, work / "new")
        if missing_tools():
            print(missing_tools())
        tally = Tally(Comparison(old.naming, new.naming))
        if options.python:
            compare_python(options.python, tally)
        ask_all(old, new, options, tally)
    finally:
        if options.keep:
            print(f"the files are in {work}")
        else:
            shutil.rmtree(work, ignore_errors=True)
    print(f"{tally.compared} outputs of {tally.questions} questions compared, {tally.different} differ"
          f" ({time.monotonic() - started:.0f} s)")
    if tally.problems:
        print(f"{len(tally.problems)} questions were not answered as the table expects")
    return 1 if tally.different or tally.problems else 0


if __name__ == "__main__":
    sys.exit(main())
