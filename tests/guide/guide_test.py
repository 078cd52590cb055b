#!/usr/bin/python3
"""Runs every command of README.md and docs/guide, and compares what the pages say that it prints.

    guide_test.py CLEARWAY                       all pages
    guide_test.py CLEARWAY --only PAGE...        these
    guide_test.py CLEARWAY --without PAGE...     all but these
    guide_test.py CLEARWAY --update              writes what is printed into the pages

Numbers that depend on the machine may differ: page.py has the list. A command, snippet or text
that is neither run nor named in pages.py, with the reason, is a fault, and so is a name in
pages.py that no page has.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import page
import pages
import stand_ins
from stand_ins import PROGRAM, Place

TIMEOUT_SECONDS = 300
RUN_HERE = ("clearway ", "awk ", "head ", "cut -d", "sed -i")
TABLES = ("NOT_RUN", "SNIPPETS_ELSEWHERE", "SAMPLES", "WRITTEN", "EXIT_CODES", "SMALLER")


class Guide:
    def __init__(self, scratch, update):
        self.scratch, self.update, self.made = Path(scratch), update, None
        self.faults, self.used, self.ran, self.compared = [], set(), 0, 0
        (self.scratch / "bin").mkdir()
        (self.scratch / "bin/clearway").symlink_to(PROGRAM)
        (self.scratch / "tools").symlink_to(page.ROOT / "tools")
        # Pages show what a machine without a GPU prints.
        self.environment = {**os.environ, **pages.OF_SCHEDULERS, "CUDA_VISIBLE_DEVICES": "", "LC_ALL": "C.UTF-8",
                            "PATH": f"{self.scratch / 'bin'}:{os.environ['PATH']}"}

    def say(self, where, text):
        self.faults.append(f"{where}: {text}")

    def named(self, table, name, text):
        """What a table of pages.py says of a text of this page; None where it says nothing."""
        for key, value in getattr(pages, table).items():
            if key[0] == name and text.startswith(key[1]):
                self.used.add((table, key))
                return value
        return None

    def all_used(self, names):
        for table in TABLES:
            for key in getattr(pages, table):
                if key[0] in names and (table, key) not in self.used:
                    self.say("tests/guide/pages.py", f"{table}: no page has {key}")

    def follow(self, name):
        path, blocks, written, changes = page.ROOT / name, [], {}, []
        for line in page.stray_commands(path):
            self.say(name, f"a command outside of a block: {line}")
        for block in page.blocks(path):
            file = None if block.language in page.SHELL else self.named("WRITTEN", name, block.text.lstrip())
            if file is not None:
                written[file] = block.text
            elif self.named("SAMPLES", name, block.text) is None:
                blocks.append(block)
        for block in blocks:
            where = f"{name}:{block.line}"
            if not self.is_ours(name, where, block):
                continue
            folder = self.folder_for(name, block, blocks)
            for file, text in written.items():
                (folder / file).write_text(text, encoding="utf-8")
            printed = self.run_block(name, where, block, folder)
            if printed is not None and block.output is not None:
                changes += self.compare(name, block.output, printed)
        if changes:
            lines = path.read_text(encoding="utf-8").splitlines()
            for start, count, new in reversed(changes):
                lines[start:start + count] = new
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            print(f"{name}: {len(changes)} outputs written anew")

    def is_ours(self, name, where, block):
        """Whether this test runs anything of a block. Tells of a snippet that no test runs."""
        if block.language in page.SHELL:
            run = [command for command in block.commands if self.named("NOT_RUN", name, command) is None]
            for command in run:
                if not command.startswith(RUN_HERE):
                    self.say(where, f"neither run nor named in pages.py: {command}")
            return any(command.startswith(RUN_HERE) for command in run)
        if self.named("SNIPPETS_ELSEWHERE", name, block.text.lstrip()) is not None:
            return False
        if block.language != "python":
            self.say(where, f"a block of {block.language} that no test runs")
        return block.language == "python"

    def folder_for(self, name, block, blocks):
        followed = name in pages.FOLLOWED_FROM_NOTHING | pages.FOLLOWED
        folder = self.scratch / ("demo" if followed else "blocks") / (
            Path(name).stem if followed else f"{Path(name).stem}-{block.line}")
        if name in pages.FOLLOWED_FROM_NOTHING:
            folder.mkdir(parents=True, exist_ok=True)
        elif not folder.exists():
            if self.made is None:
                self.made = Place(self.scratch / "made")
                stand_ins.make(self.made)
            commands = [command for one in (blocks if followed else [block]) for command in one.commands]
            stand_ins.lend(self.made.folder, folder, commands)
        return folder

    def run_block(self, name, where, block, folder):
        """What its commands print; None where one of them is not run or fails."""
        if block.language == "python":
            (folder / "snippet.py").write_text(block.text, encoding="utf-8")
        printed, complete = "", True
        for command in block.commands or [f"{sys.executable} snippet.py"]:
            if self.named("NOT_RUN", name, command) is not None or \
                    block.commands and not command.startswith(RUN_HERE):
                complete = False
                continue
            for (of, there), smaller in pages.SMALLER.items():
                if of == name and there in command:
                    self.used.add(("SMALLER", (of, there)))
                    command = command.replace(there, smaller)
            done = subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=folder, env=self.environment,
                                  stdin=subprocess.DEVNULL, text=True, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, check=False, timeout=TIMEOUT_SECONDS)
            self.ran += 1
            printed += done.stdout
            expected = self.named("EXIT_CODES", name, command) or 0
            if done.returncode != expected:
                self.say(where, f"ended with {done.returncode}, expected {expected}: {command}\n{done.stdout}")
                complete = False
        return printed if complete else None

    def compare(self, name, output, printed):
        """The change of the page that would show what was printed, if that is asked for."""
        shown, lines = output.text.splitlines(), printed.splitlines()
        self.compared += 1
        if page.same(shown, lines):
            return []
        if self.update:
            return [(output.line - 1, len(shown), page.refreshed(shown, lines))]
        self.say(f"{name}:{output.line}", f"the page shows\n{output.text}but this is printed:\n{printed}")
        return []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--without", nargs="+", default=[])
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    every = ["README.md", *sorted(str(path.relative_to(page.ROOT))
                                  for path in (page.ROOT / "docs" / "guide").glob("**/*.md"))]
    names = [name for name in options.only or every if name not in options.without]
    with tempfile.TemporaryDirectory(prefix="clearway-guide-") as scratch:
        guide = Guide(scratch, options.update)
        for name in names:
            guide.follow(name)
        guide.all_used(names)
    print(f"{len(names)} pages, {guide.ran} commands run, {guide.compared} outputs compared")
    for fault in guide.faults:
        print(fault)
    return 1 if guide.faults else 0


if __name__ == "__main__":
    sys.exit(main())
