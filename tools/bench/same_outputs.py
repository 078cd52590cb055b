#!/usr/bin/python3
"""Asks two builds of Clearway what the texts of tests/commands ask, and compares all that they write.

It prints a line for each output that differs, with the first difference, and a summary. An output is
what a command printed on standard output or on standard error, its exit code, or a file that it wrote
or changed. Exit code 1: an output differs.
The driver of the texts is that of the new build; it runs this script in the place of the program, which
runs the program and keeps its outputs. --data adds real files: each is converted, and described.
Files of HDF5 are compared by dump.py beside this script, which knows their layouts.
Needs h5py and numpy (Debian: python3-h5py).
Example: tools/bench/same_outputs.py before/clearway build/release/tools/clearway --data DATA
"""

import argparse
import difflib
import io
import os
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

if "CLEARWAY_RECORDED" not in os.environ:  # not needed in the place of the program, which is often run
    import dump
    import numpy

TEXTS = Path(__file__).resolve().parents[2] / "tests" / "commands"
# What depends on the clock: what stands for it, and why it may differ.
MAY_DIFFER = [(re.compile(pattern), word) for pattern, word, _ in (
    (rb"\b\d[\d,]*(\.\d+)? (ms|s|min|h)\b", b"TIME", "seconds that a step took"),
    (rb"\b(count|distribute|partition|confirm) \d+\.\d+", rb"\1 TIME", "seconds of a conversion"),
    (rb'"(\w*seconds)": ?\{[^{}]*\}', rb'"\1": TIME', "seconds of the steps of a command"),
    (rb'"(\w*seconds)": ?[\d.e+-]+', rb'"\1": TIME', "seconds that a task took"),
    (rb'"time": ?"[^"]*"', b'"time": TIME', "when a task of a campaign ended"),
    (rb'"date": ?"\d{4}-[^"]* UTC"', b'"date": TIME', "when a page was made that got no date"),
    (rb'"peak_host_bytes": ?\d+', b'"peak_host_bytes": BYTES', "memory at its greatest"),
    (rb'"bytes_moved": ?\{[^{}]*\}', b'"bytes_moved": BYTES', "as the system counts them"),
    (rb'"outputs_id": ?"\w+"', b'"outputs_id": HASH', "hash of commands that name the folder"),
    (rb'"modified": ?-?\d+', b'"modified": TIME', "time of an input file"),
    (rb"tests: [^\n]*", b"tests: COUNTS", "threads find points of a profile in any order"),
)]
# Also only where HDF5 files have another layout (--layout).
LAYOUT = [(re.compile(pattern), word) for pattern, word, _ in (
    (rb'("kind": "(result|store)",\s+"version": )\d+', rb"\1VERSION", "version of a file, in clearway info"),
    (rb'("result":\{"name":"[^"]*","hash":")\w+', rb"\1HASH", "hash of a result's facts, in a page"),
)]
# Outputs that depend on it: what a command prints, and these files. All others have to be equal.
TELLS_TIME = re.compile(r"(^|/)(stdout|stderr|log\.txt|plan\.json|run\.json|state\.json)$|\.html$")
PRINTED = ("stdout.txt", "stderr.txt")  # files of the driver


# --- in the place of the program -------------------------------------------------------------------


def files(folder):
    """Name, and what changes with its contents, of each file in the folder. Links are not followed."""
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            path = Path(place, name)
            if path.is_file() and not path.is_symlink() and str(path.relative_to(folder)) not in PRINTED:
                status = path.stat()
                found[str(path.relative_to(folder))] = status.st_mtime_ns, status.st_size, status.st_ino
    return found


def keep_outputs(program, records):
    """Runs the program with the words of this script, and keeps its outputs in a folder of their own."""
    here = Path.cwd()
    before = files(here)
    more = os.environ["CLEARWAY_MORE"].split() if sys.argv[1:2] == ["run"] else []
    done = subprocess.run([program, *sys.argv[1:], *more], capture_output=True)
    record = Path(records) / f"{len(os.listdir(records)):06}"
    record.mkdir()
    outputs = {"words": "\n".join(sys.argv[1:]).encode(), "folder": str(here).encode(),
               "exit code": str(done.returncode).encode(), "stdout": done.stdout, "stderr": done.stderr}
    after = files(here)
    for name in after:
        if before.get(name) != after[name]:
            outputs["wrote/" + name] = (here / name).read_bytes()
    for name in before.keys() - after.keys():
        outputs["wrote/" + name] = b"removed"
    for name, data in outputs.items():
        (record / name).parent.mkdir(parents=True, exist_ok=True)
        (record / name).write_bytes(data)
    sys.stdout.buffer.write(done.stdout)
    sys.stderr.buffer.write(done.stderr)
    return done.returncode


# --- what differs ----------------------------------------------------------------------------------


def neutral(name, data, words):
    """Without what names the program, its folder and version, or depends on the clock."""
    for word, stands_for in words:
        data = data.replace(word, stands_for)
    for pattern, word in MAY_DIFFER if TELLS_TIME.search(name) else ():
        data = pattern.sub(word, data)
    return data


def difference(name, old, new, words):
    """Where an output first differs; None where both say the same. words: of the two programs."""
    if old is None or new is None:
        return "is new" if old is None else "is missing"
    layouts = [b"header_hash" in data for data in (old, new)]
    old, new = (neutral(name, data, of) for data, of in zip((old, new), words))
    if old == new:
        return None
    read = PARTS.get(name.rpartition(".")[2])
    try:
        parts = [read(data) for data in (old, new)] if read else [{}, {}]
    except Exception as error:  # a damaged output is a difference like any other
        return f"{first_difference(old, new)} (not read: {error})"
    for part in dict.fromkeys([*parts[0], *parts[1]]):
        one, other = (neutral(name, of[part], own) if isinstance(of.get(part), bytes) else of.get(part)
                      for of, own in zip(parts, words))
        if type(one) is not type(other):
            return f"{part}: {one!r}, now {other!r}"
        if isinstance(one, bytes) and one != other:
            return f"{part}: {first_difference(one, other)}"
        if isinstance(one, numpy.ndarray) and (one.dtype, one.shape, one.tobytes()) != (
                other.dtype, other.shape, other.tobytes()):
            return f"{part}: {one.dtype} {one.shape}, now {other.dtype} {other.shape}: {first_value(one, other)}"
    # The members of a zip archive are compressed, and the version stands in them.
    if read is zipped or (read is hdf5 and layouts[0] != layouts[1]):
        return None
    return first_difference(old, new)


def first_difference(old, new):
    """The first line, or the first byte of binary data, that differs."""
    at = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
    if b"\0" in old:
        return f"byte {at} of {len(old)} and {len(new)}"
    start = max(old.rfind(b"\n", 0, at) + 1, at - 30)
    shown = [repr(data[start:at + 60].split(b"\n")[0].decode(errors="replace")) for data in (old, new)]
    return f"line {old.count(10, 0, at) + 1}: {shown[0]}, now {shown[1]}"


def first_value(old, new):
    """The first value that differs, by its bits, so that a NaN is equal to itself."""
    pairs = enumerate(zip(old.reshape(-1), new.reshape(-1)))
    return next((f"[{at}] is {a}, now {b}" for at, (a, b) in pairs if a.tobytes() != b.tobytes()), "")


def hdf5(data):
    """Facts, as texts, and columns."""
    facts, columns = dump.read(data)
    return {**{name: repr(fact).encode() for name, fact in facts.items()}, **columns}


def zipped(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {f"{info.filename} ({info.date_time})": archive.read(info) for info in archive.infolist()}


def sqlite(data):
    with sqlite3.connect(":memory:") as database:
        database.deserialize(data)
        tables = database.execute("select name from sqlite_master where type = 'table' order by name")
        return {table: "\n".join(map(repr, database.execute(f'select * from "{table}"'))).encode()  # noqa: S608
                for (table,) in tables.fetchall()}


PARTS = {"h5": hdf5, "gpkg": sqlite, "bcf": zipped, "bcfzip": zipped}


# --- the whole -------------------------------------------------------------------------------------


def ask_real_files(data):
    """What is asked of each file of a folder of real files, in a folder of its own."""
    for path in sorted(path for path in data.rglob("*") if path.is_file()):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / path.name).symlink_to(path)
            for words in (["info", path.name, "--json"], ["convert", path.name, "-o", "site.h5"],
                          ["info", "site.h5", "--json"]):
                subprocess.run([__file__, *words], cwd=folder, capture_output=True,
                               stdin=subprocess.DEVNULL)


def answers(program, more, options, work):
    """Asks a program everything, its runs with `more` options, and returns its records by what was asked:
    {title: folders}."""
    records = {}
    asked = [(path.stem, [options.driver, path]) for path in sorted(TEXTS.glob("*.test"))]
    if options.data:
        asked += [(folder.name, None) for folder in sorted(options.data.iterdir()) if folder.is_dir()]
    for title, command in asked:
        if options.only and not re.search(options.only, title):
            continue
        folder = work / title
        folder.mkdir(parents=True)
        os.environ.update(CLEARWAY_PROGRAM=__file__, CLEARWAY_RECORDED=str(program.resolve()),
                          CLEARWAY_RECORDS=str(folder), CLEARWAY_MORE=more, LC_ALL="C.UTF-8", TZ="UTC")
        if not options.more:
            os.environ["CUDA_VISIBLE_DEVICES"] = ""
        if command:
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                print(f"{program}: does not answer {title}.test as it expects", flush=True)
        else:
            ask_real_files(options.data / title)
        records[title] = sorted(folder.iterdir())
    return records


def same_questions(old, new):
    """The pairs of records with the same words, in their order, and the words of the others: a text
    leaves a test where an answer is not as it expects."""
    words = [[(record / "words").read_text().replace((record / "folder").read_text(), ".").replace("\n", " ")
              for record in records] for records in (old, new)]
    pairs, others = [], []
    for what, i, i_end, j, j_end in difflib.SequenceMatcher(None, *words, autojunk=False).get_opcodes():
        if what == "equal":
            pairs += zip(old[i:i_end], new[j:j_end])
        else:
            others += words[0][i:i_end] + words[1][j:j_end]
    return pairs, others


def outputs_of(record):
    return {str(path.relative_to(record)): path.read_bytes() for path in record.rglob("*") if path.is_file()}


def compare(old, new, versions, results_alone):
    """Counts outputs of two records, and prints those that differ."""
    found = [outputs_of(record) for record in (old, new)]
    words = [[(one.pop("folder"), b"FOLDER"), (version, b"VERSION")] for one, version in zip(found, versions)]
    asked = found[0]["words"].decode().replace("\n", " ")
    different = 0
    for name in sorted({*found[0], *found[1]}):
        if results_alone and not name.endswith(".h5"):
            continue
        where = difference(name, *(one.get(name) for one in found), words)
        if where:
            different += 1
            print(f"{name}: {where} [{asked}]", flush=True)
    return len(found[0]), different


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path, metavar="OLD_CLEARWAY", help="the program whose outputs are right")
    parser.add_argument("new", type=Path, metavar="NEW_CLEARWAY", help="the program to check")
    parser.add_argument("--driver", type=Path, help="commands_tests (default: that of the build of NEW_CLEARWAY)")
    parser.add_argument("--data", type=Path, metavar="FOLDER", help="folders of real files to ask about too")
    parser.add_argument("--more", default="", metavar="OPTIONS",
                        help="options of each run of NEW_CLEARWAY, as '--device cuda'; results alone are compared")
    parser.add_argument("--layout", action="store_true",
                        help="the programs write HDF5 files of different layouts: versions may differ")
    parser.add_argument("--only", metavar="PATTERN", help="regular expression of texts and folders to ask of")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="an empty folder for all outputs, which stay")
    options = parser.parse_args()
    MAY_DIFFER.extend(LAYOUT if options.layout else ())
    options.driver = options.driver or options.new.resolve().parents[1] / "tests" / "tools" / "commands_tests"
    work = options.keep or Path(tempfile.mkdtemp(prefix="same_outputs_"))
    try:
        old = answers(options.old, "", options, work / "old")
        new = answers(options.new, options.more, options, work / "new")
        versions = [subprocess.run([program, "--version"], capture_output=True, check=True).stdout.strip()
                    for program in (options.old.resolve(), options.new.resolve())]
        compared = different = asked = 0
        for title, records in old.items():
            pairs, others = same_questions(records, new[title])
            if others:
                different += len(others)
                print(f"{title}: only one program was asked: " + "; ".join(others))
            for pair in pairs:
                outputs, differ = compare(*pair, versions, options.more)
                compared, different, asked = compared + outputs, different + differ, asked + 1
    finally:
        if not options.keep:
            shutil.rmtree(work)
    print(f"{compared} outputs of {asked} commands compared, {different} differ")
    return 1 if different else 0


if __name__ == "__main__":
    if "CLEARWAY_RECORDED" in os.environ:
        sys.exit(keep_outputs(os.environ["CLEARWAY_RECORDED"], os.environ["CLEARWAY_RECORDS"]))
    sys.exit(main())
