#!/usr/bin/python3
"""Measures how many small mistakes in src the tests see.

A mutant is one line of src with one operator, bound or call changed. All are compiled into one
program, in which the environment variable CLEARWAY_MUTANT chooses one; without it the program is
as it was. Each mutant runs the tests that reach its line, quickest first, up to the first failure.

    tools/mutants.py draw FOLDER --seed 1 --count 300   # a copy of the tree with the mutants
    tools/mutants.py build FOLDER                       # compiles it; drops what does not compile
    tools/mutants.py reach FOLDER                       # runs every test once, for what it reaches
    tools/mutants.py run FOLDER                         # goes on where an earlier call ended
    tools/mutants.py report FOLDER

Results are added to FOLDER/results.jsonl. CLEARWAY_TEST_DATA says where real data is, as for ctest.
"""

import argparse
import collections
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

HEADER = """#pragma once
#ifndef __CUDACC__
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <cstdlib>
namespace clearway_mutants {
inline int chosen() {
  static const int number = [] {
    const char* text = std::getenv("CLEARWAY_MUTANT");
    return text == nullptr ? -1 : std::atoi(text);
  }();
  return number;
}
inline volatile char* reached() {
  static volatile char* const bytes = []() -> volatile char* {
    const char* path = std::getenv("CLEARWAY_MUTANTS_REACHED");
    if (path == nullptr) return nullptr;
    const int file = ::open(path, O_RDWR);
    if (file < 0) return nullptr;
    void* const map = ::mmap(nullptr, COUNT, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    return map == MAP_FAILED ? nullptr : static_cast<volatile char*>(map);
  }();
  return bytes;
}
inline bool is(int number) {
  if (volatile char* const bytes = reached()) bytes[number] = 1;
  return chosen() == number;
}
}  // namespace clearway_mutants
#endif
"""

# In an expression; clang-format puts spaces around operators and none into templates.
OPERATORS = [(" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "),
             (" != ", " == "), (" && ", " || "), (" || ", " && "), (" + ", " - "), (" - ", " + "),
             (" * ", " + "), ("std::min(", "std::max("), ("std::max(", "std::min("),
             (" true", " false"), (" false", " true"), (" 1 ", " 2 "), ("!", "")]
LEFT_OUT = re.compile(r"constexpr|static_assert|template|requires|noexcept|#|//|\[&?\]|\[this|\[=|"
                      r"CLEARWAY_HD|operator|typename|using |assert\(|\"")
CONDITION = re.compile(r"^(\s*(?:\} else )?(?:if|while) \()(.*)(\)(?: \{| return.*;| continue;| break;)?)$")
RETURN = re.compile(r"^(\s*return )([^{}]+)(;)$")
ASSIGNMENT = re.compile(r"^(\s*(?:const )?[\w:.\->\[\]]+(?: [\w\[\]]+)? [-+]?= )([^{}]+)(;)$")
CALL = re.compile(r"^(\s*)((?!return\b|throw\b|delete\b|else\b|std::)[a-z_][\w.\->\[\]:]*\(.*\);)$")


def is_balanced(text):
    depth = 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if depth < 0:
            return False
    return depth == 0


def mutants_of(line):
    """Each line that this one may become, with @ for the number of the mutant."""
    if LEFT_OUT.search(line):
        return
    for form in (CONDITION, RETURN, ASSIGNMENT):
        found = form.match(line)
        if not found or not is_balanced(found[2]) or (form is CONDITION and ";" in found[2]):
            continue
        before, text, after = found.groups()
        for operator, other in OPERATORS:
            at = (" " + text + " ").find(operator)
            if at < 0 or (operator == "!" and (" " + text)[at + 1] in "= "):
                continue
            changed = (" " + text + " ").replace(operator, other, 1).strip()
            cast = "static_cast<bool>" if form is CONDITION else ""
            yield f"{before}(clearway_mutants::is(@) ? {cast}({changed}) : {cast}({text})){after}"
        return
    found = CALL.match(line)
    if found and is_balanced(found[2]):
        yield f"{found[1]}if (!clearway_mutants::is(@)) {found[2]}"


def room_of(path):
    room = path.split("/")[1]
    return "engine" if room in ("core", "search", "cpu", "gpu", "stream") else room


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True,
                          check=True).stdout.strip()


def put(folder, mutant, text):
    """Writes the line of a mutant into the tree, and returns what it was."""
    path = folder / "tree" / mutant["file"]
    lines = path.read_text().split("\n")
    was, lines[mutant["line"]] = lines[mutant["line"]], text
    path.write_text("\n".join(lines))
    return was


def draw(folder, options):
    tree, names = folder / "tree", git("ls-files").split("\n")
    for name in names:
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, tree / name)
    places = []
    for name in sorted(names):
        if name.startswith("src/") and name.endswith((".cpp", ".hpp")) and "/gpu/" not in name:
            for number, line in enumerate((tree / name).read_text().split("\n")):
                changed = list(mutants_of(line))
                if changed:
                    places.append((name, number, changed))
    draw_from = random.Random(options.seed)
    chosen = draw_from.sample(places, options.count)
    mutants = [{"file": name, "line": number, "was": None, "text": draw_from.choice(changed)}
               for name, number, changed in sorted(chosen)]
    for number, mutant in enumerate(mutants):
        mutant["text"] = mutant["text"].replace("@", str(number))
        mutant["was"] = put(folder, mutant, mutant["text"])
    (folder / "mutants.hpp").write_text(HEADER.replace("COUNT", str(len(mutants))))
    save(folder, {"commit": git("rev-parse", "HEAD"), "seed": options.seed, "places": len(places),
                  "dropped": [], "mutants": mutants})
    print(f"{len(mutants)} of {len(places)} places")


def load(folder):
    return json.loads((folder / "mutants.json").read_text())


def save(folder, drawn):
    (folder / "mutants.json").write_text(json.dumps(drawn, indent=1))


def drop_what_fails(folder, drawn, log):
    """Restores the lines that the compiler names, or else all of the files that it names. Returns
    whether there were any."""
    dropped = set(drawn["dropped"])
    named = {(Path(os.path.normpath(name)).name, int(line))
             for name, line in re.findall(r"([\w./-]+\.[ch]pp):(\d+)(?::\d+)?: (?:error|note|required)", log)}
    left = [(number, mutant) for number, mutant in enumerate(drawn["mutants"]) if number not in dropped]
    found = [number for number, mutant in left
             if (Path(mutant["file"]).name, mutant["line"] + 1) in named]
    if not found:
        files = {name for name, _ in named}
        found = [number for number, mutant in left if Path(mutant["file"]).name in files]
    for number in found:
        mutant = drawn["mutants"][number]
        put(folder, mutant, mutant["was"])
        print(f"does not compile: {mutant['file']}:{mutant['line'] + 1}: {mutant['text'].strip()}")
    drawn["dropped"] += found
    save(folder, drawn)
    return bool(found)


def build(folder, options):
    drawn = load(folder)
    subprocess.run(["cmake", "-S", folder / "tree", "-B", folder / "build", "-G", "Ninja",
                    "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
                    f"-DCMAKE_CXX_FLAGS=-include {folder / 'mutants.hpp'}", "-DCLEARWAY_CUDA=OFF",
                    "-DCLEARWAY_UNITY=ON", "-DCLEARWAY_TESTS=ON", "-DCLEARWAY_BENCHMARKS=ON",
                    "-DCLEARWAY_WERROR=OFF", *options.cmake], check=True, stdout=subprocess.DEVNULL)
    while True:
        done = subprocess.run(["ninja", "-C", folder / "build", "-k", "0", f"-j{options.jobs}"],
                              capture_output=True, text=True, check=False)
        if done.returncode == 0:
            print(f"built; {len(drawn['dropped'])} of {len(drawn['mutants'])} left out")
            return
        if not drop_what_fails(folder, drawn, done.stdout + done.stderr):
            sys.exit(done.stdout[-5000:])


class Test:
    def __init__(self, of):
        self.name, self.command = of["name"], of.get("command", [])
        properties = {one["name"]: one["value"] for one in of["properties"]}
        self.folder = properties["WORKING_DIRECTORY"]
        self.skips = properties.get("SKIP_RETURN_CODE")
        self.environment = dict(one.split("=", 1) for one in properties.get("ENVIRONMENT", []))

    def passes(self, seconds, **environment):
        """Whether the test passes; one that takes longer fails."""
        process = subprocess.Popen(self.command, cwd=self.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   start_new_session=True,
                                   env={**os.environ, **self.environment, **environment})
        try:
            return process.wait(seconds) in (0, self.skips)
        except subprocess.TimeoutExpired:
            return False
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()


def tests_of(folder):
    listed = subprocess.run(["ctest", "--test-dir", folder / "build", "--show-only=json-v1"],
                            capture_output=True, text=True, check=True)
    return [test for test in map(Test, json.loads(listed.stdout)["tests"]) if test.command]


def reach(folder, options):
    count = len(load(folder)["mutants"])
    bytes_of = folder / "reached"
    bytes_of.mkdir(exist_ok=True)

    def look(numbered):
        number, test = numbered
        path = bytes_of / str(number)
        path.write_bytes(bytes(count))
        begin = time.monotonic()
        passes = test.passes(1800, CLEARWAY_MUTANTS_REACHED=str(path))
        seconds = time.monotonic() - begin
        reached = [i for i, byte in enumerate(path.read_bytes()) if byte]
        return {"name": test.name, "passes": passes, "seconds": seconds, "reached": reached}

    with ThreadPoolExecutor(options.jobs) as pool:
        found = list(pool.map(look, enumerate(tests_of(folder))))
    (folder / "reach.json").write_text(json.dumps(found, indent=1))
    for one in found:
        if not one["passes"]:
            print(f"fails without a mutant, and is left out: {one['name']}")


def run(folder, options):
    drawn, tests = load(folder), {test.name: test for test in tests_of(folder)}
    looked = [one for one in json.loads((folder / "reach.json").read_text()) if one["passes"]]
    results = folder / "results.jsonl"
    known = {json.loads(line)["mutant"] for line in results.read_text().splitlines()} \
        if results.exists() else set()
    left = [number for number in range(len(drawn["mutants"]))
            if number not in known and number not in drawn["dropped"]]
    random.Random(drawn["seed"]).shuffle(left)
    end = time.monotonic() + options.minutes * 60

    def judge(number):
        if time.monotonic() > end:
            return
        seen_by, tried, begin = None, 0, time.monotonic()
        for one in sorted((one for one in looked if number in one["reached"]),
                          key=lambda one: one["seconds"]):
            tried += 1
            if not tests[one["name"]].passes(20 + 10 * one["seconds"], CLEARWAY_MUTANT=str(number)):
                seen_by = one["name"]
                break
        line = {"mutant": number, "seen_by": seen_by, "tests": tried,
                "seconds": round(time.monotonic() - begin, 1)}
        with results.open("a") as out:
            out.write(json.dumps(line) + "\n")

    with ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(judge, left))
    report(folder, options)


def report(folder, _options):
    drawn = load(folder)
    results = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    rooms = collections.defaultdict(lambda: [0, 0, 0])
    for result in results:
        mutant = drawn["mutants"][result["mutant"]]
        counts = rooms[room_of(mutant["file"])]
        counts[0] += 1
        counts[1] += result["seen_by"] is not None
        counts[2] += result["tests"] == 0
    print(f"seed {drawn['seed']}, commit {drawn['commit'][:8]}")
    print("room  mutants  seen  reached by no test")
    for room, (all_of, seen, unreached) in sorted(rooms.items()):
        print(f"{room}  {all_of}  {seen}  {unreached}")
    for result in results:
        mutant = drawn["mutants"][result["mutant"]]
        if result["seen_by"] is None:
            print(f"{mutant['file']}:{mutant['line'] + 1}: {mutant['was'].strip()}\n    -> "
                  f"{mutant['text'].strip()} ({result['tests']} tests)")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for function in (draw, build, reach, run, report):
        command = commands.add_parser(function.__name__)
        command.add_argument("folder", type=Path)
        command.add_argument("--jobs", type=int, default=os.cpu_count())
        command.add_argument("--cmake", nargs="*", default=[], help="further options of cmake")
        command.add_argument("--seed", type=int, default=1)
        command.add_argument("--count", type=int, default=300)
        command.add_argument("--minutes", type=float, default=60, help="how long to go on at most")
        command.set_defaults(function=function)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    options.function(options.folder.resolve(), options)


if __name__ == "__main__":
    main()
