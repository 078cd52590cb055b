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

TIMEOUT_SECONDS = 300
RUN_HERE = ("clearway ", "awk ", "head ", "cut -d", "sed -i")


class Guide:
    def __init__(self, program, scratch, update):
        self.program, self.scratch, self.update = Path(program).resolve(), Path(scratch), update
        self.faults, self.used, self.ran, self.compared = [], set(), 0, 0
        links = self.scratch / "bin"
        links.mkdir()
        (links / "clearway").symlink_to(self.program)
        (self.scratch / "tools").symlink_to(page.ROOT / "tools")
        # Pages show what a machine without a GPU prints.
        self.environment = {**os.environ, "CUDA_VISIBLE_DEVICES": "", "LC_ALL": "C.UTF-8",
                            "PATH": f"{links}:{os.environ['PATH']}"}
        self.made = None

    def say(self, where, text):
        self.faults.append(f"{where}: {text}")

    def named(self, table, name, text):
        """What a table of pages.py says of a text of this page; None where it says nothing."""
        for key in table:
            if key[0] == name and text.startswith(key[1]):
                self.used.add((id(table), key))
                return table[key]
        return None

    def all_used(self, names):
        for title in ("NOT_RUN", "SNIPPETS_ELSEWHERE", "SAMPLES", "WRITTEN", "EXIT_CODES", "SMALLER"):
            table = getattr(pages, title)
            for key in table:
                if key[0] in names and (id(table), key) not in self.used:
                    self.say("tests/guide/pages.py", f"{title}: no page has {key}")

    def shell(self, command, folder):
        done = subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=folder,
                              env=self.environment, stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
                              timeout=TIMEOUT_SECONDS)
        return done.returncode, done.stdout

    def stand_ins(self):
        if self.made is None:
            self.made = self.scratch / "made"
            self.made.mkdir()

            def clearway(words):
                subprocess.run([self.program, *words], cwd=self.made, env=self.environment,
                               check=True, capture_output=True, text=True)
            stand_ins.make(self.made, clearway)
        return self.made

    def run_page(self, name):
        path = page.ROOT / name
        for line in page.stray_commands(path):
            self.say(name, f"a command outside of a block: {line}")
        blocks, written = [], {}
        for block in page.blocks(path):
            file = self.named(pages.WRITTEN, name, block.text.lstrip()) \
                if block.language not in page.SHELL else None
            if file is not None:
                written[file] = block.text
            elif self.named(pages.SAMPLES, name, block.text) is None:
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
                self.compare(path, block.output, printed)

    def is_ours(self, name, where, block):
        """Whether this test runs anything of a block. Tells of a snippet that no test runs."""
        if block.language in page.SHELL:
            run = [command for command in block.commands
                   if self.named(pages.NOT_RUN, name, command) is None]
            for command in run:
                if not command.startswith(RUN_HERE):
                    self.say(where, f"neither run nor named in pages.py: {command}")
            return any(command.startswith(RUN_HERE) for command in run)
        if self.named(pages.SNIPPETS_ELSEWHERE, name, block.text.lstrip()) is not None:
            return False
        if block.language != "python":
            self.say(where, f"a block of {block.language} that no test runs")
        return block.language == "python"

    def folder_for(self, name, block, blocks):
        if name in pages.FOLLOWED_FROM_NOTHING | pages.FOLLOWED:
            folder, of = self.scratch / "demo" / Path(name).stem, blocks
        else:
            folder, of = self.scratch / "blocks" / f"{Path(name).stem}-{block.line}", [block]
        if folder.exists():
            return folder
        if name in pages.FOLLOWED_FROM_NOTHING:
            folder.mkdir(parents=True)
        else:
            commands = [command for other in of for command in other.commands]
            stand_ins.lend(self.stand_ins(), folder, commands)
        return folder

    def run_block(self, name, where, block, folder):
        """What its commands print; None where one of them is not run or fails."""
        if block.language == "python":
            (folder / "snippet.py").write_text(block.text, encoding="utf-8")
        commands = block.commands or [f"{sys.executable} snippet.py"]
        printed, complete = "", True
        for command in commands:
            if self.named(pages.NOT_RUN, name, command) is not None:
                complete = False
                continue
            if block.commands and not command.startswith(RUN_HERE):
                complete = False
                continue
            for (of, there), smaller in pages.SMALLER.items():
                if of == name and there in command:
                    self.used.add((id(pages.SMALLER), (of, there)))
                    command = command.replace(there, smaller)
            expected = self.named(pages.EXIT_CODES, name, command) or 0
            code, text = self.shell(command, folder)
            self.ran += 1
            printed += text
            if code != expected:
                self.say(where, f"ended with {code}, expected {expected}: {command}\n{text}")
                complete = False
        return printed if complete else None

    def compare(self, path, output, printed):
        shown, lines = output.text.splitlines(), printed.splitlines()
        self.compared += 1
        if page.same(shown, lines):
            return
        if self.update:
            text = path.read_text(encoding="utf-8").splitlines()
            new = page.refreshed(shown, lines)
            self.changes.append((output.line - 1, len(shown), new))
            return
        self.say(f"{path.relative_to(page.ROOT)}:{output.line}",
                 "the page shows\n" + output.text + "but this is printed:\n" + printed)

    def follow(self, name):
        self.changes = []
        self.run_page(name)
        if not self.changes:
            return
        path = page.ROOT / name
        lines = path.read_text(encoding="utf-8").splitlines()
        for start, count, new in reversed(self.changes):
            lines[start:start + count] = new
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        print(f"{name}: {len(self.changes)} outputs written anew")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--without", nargs="+", default=[])
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    every = ["README.md", *sorted(str(path.relative_to(page.ROOT))
                                  for path in (page.ROOT / "docs" / "guide").glob("**/*.md"))]
    names = [name for name in options.only or every if name not in options.without]
    with tempfile.TemporaryDirectory(prefix="clearway-guide-") as scratch:
        guide = Guide(options.program, scratch, options.update)
        for name in names:
            guide.follow(name)
        guide.all_used(names)
    print(f"{len(names)} pages, {guide.ran} commands run, {guide.compared} outputs compared")
    for fault in guide.faults:
        print(fault)
    return 1 if guide.faults else 0


if __name__ == "__main__":
    sys.exit(main())
