#!/usr/bin/python3
"""Checks what a machine can judge in the documents and in the help of the programs.

It fails, with file and line, on
- a relative link or anchor in any Markdown file that leads nowhere,
- a path of the sources, such as `src/core/sweep`, in any Markdown file that is no folder and no file,
  with or without its ending,
- a command or option in README.md or docs/guide that the program does not have,
- an option of a program that docs/guide does not describe,
- a file, type, function or constant in a code span that no source has,
- a command of a program that docs/guide/command-line.md does not have in its first table,
- a text of the Python module that lists names of an enumeration, but not all of them,
- a code of the table of messages that no source gives, and a message that does not get its code
  from that table,
- a term that docs/design/glossary.md defines twice, and a word that its section "Words that are
  not used" replaces, where README.md, docs/guide or a help text has it.

Options: one on a line with a command belongs to it, and is checked where that is one of the
programs; one alone in a code span or a message may be of any of them. A heading that is a command
(`## clearway run`) promises all options of that command below it.

Example: tools/check_prose.py build/release/tools/clearway
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

from prose import codes, markdown, names, terms
from prose.program import OPTION, Program

OUTPUT_LANGUAGES = {"text", "json", "csv", "console"}
PREFIXES = {"$", "time", "nice", "sudo"}
SOURCE_PATH = re.compile(r"(?:src|include|tools|tests|examples|cmake|docs)/[\w./-]*\w")
COMMAND_LINE = "docs/guide/command-line.md"
ENDINGS = ("", ".hpp", ".cpp", ".cu", ".py", ".sh")


class Checker:
    def __init__(self, root, programs):
        self.root, self.programs = root.resolve(), {p.name: p for p in programs}
        self.problems = []
        self.files = self._files()
        self.blocks = {path: markdown.parse(path.read_text(encoding="utf-8"))
                       for path in sorted(self.files) if path.suffix == ".md"}
        self.described = {"": set()}  # in docs/guide, below each heading that is a command; "": all

    def _files(self):
        """All files that git does not ignore; where git knows none of them, all."""
        command = ["git", "-C", str(self.root), "ls-files", "--cached", "--others",
                   "--exclude-standard", "-z"]
        listed = subprocess.run(command, capture_output=True, text=True, check=False)
        if listed.returncode == 0 and listed.stdout:
            paths = (self.root / name for name in listed.stdout.split("\0") if name)
        else:
            paths = self.root.rglob("*")
        return {path for path in paths if path.is_file()}

    def run(self):
        glossary = terms.Glossary(self.root)
        self.problems.extend(glossary.problems())
        sources = names.Names(self.root, self.files)
        self.problems.extend(sources.incomplete())
        for path, blocks in self.blocks.items():
            name = str(path.relative_to(self.root))
            self._check_links(path, name, blocks)
            if name != "CHANGELOG.md":  # which names files of earlier versions too
                self._check_source_paths(name, blocks)
                self.problems.extend(sources.unknown(name, blocks))
            if name == "README.md" or name.startswith("docs/guide/"):
                for block in blocks:
                    if block.kind != "code":
                        self.problems.extend(glossary.not_used(name, block.line, block.text))
                self._check_options(name, blocks)
        for program in self.programs.values():
            for where, text in program.prose:
                self.problems.extend(glossary.not_used(where, 0, text))
            self._check_described(program)
            self._check_table(program)
        self.problems.extend(codes.problems(self.root, self.files))

    def _check_links(self, path, name, blocks):
        for block in blocks:
            for target in markdown.link_targets(block):
                if not re.match(r"([a-z][a-z0-9+.-]*:|//)", target):
                    self._check_target(path, f"{name}:{block.line}", unquote(target))

    def _check_source_paths(self, name, blocks):
        for block in blocks:
            if block.kind == "code":
                continue
            for span in markdown.CODE_SPAN.finditer(block.text):
                if (SOURCE_PATH.fullmatch(span[2]) and "NAME" not in span[2]
                        and not self._is_source(span[2])):
                    self.problems.append(f"{name}:{block.line}: {span[2]}: no such file or folder")

    def _is_source(self, path):
        return (self.root / path).is_dir() or any(
            self.root / (path + ending) in self.files for ending in ENDINGS)

    def _check_target(self, path, where, target):
        file, _, anchor = target.partition("#")
        base = self.root if file.startswith("/") else path.parent
        found = (base / file.lstrip("/")).resolve() if file else path
        if found not in self.files and not any(found in known.parents for known in self.files):
            self.problems.append(f"{where}: broken link: {target}: no such file")
        elif anchor and found in self.blocks:
            if anchor not in markdown.anchors(self.blocks[found]):
                self.problems.append(f"{where}: broken link: {target}: no such heading")

    def _check_options(self, name, blocks):
        heading = ""
        for block in blocks:
            if block.kind == "heading":
                heading = block.text.replace("`", "")
            if block.kind == "code":
                is_text = block.language in OUTPUT_LANGUAGES
                lines = block.text.replace("\\\n", "  ").splitlines()
                for offset, line in enumerate(lines):
                    self._check_code(f"{name}:{block.line + offset}", heading, line, is_text)
                continue
            for span in markdown.CODE_SPAN.finditer(block.text):
                line = block.line + block.text.count("\n", 0, span.start())
                self._check_code(f"{name}:{line}", heading, span[2], False)
            rest = markdown.CODE_SPAN.sub("", block.text)
            self._check_code(f"{name}:{block.line}", heading, rest, True)

    def _check_code(self, where, heading, code, is_text):
        """One line of code, each command of a pipe by itself; or a line of text."""
        parts = re.split(r"\||&&|;", re.sub(r"(^|\s)#\s.*", "", code))
        for part in [code] if is_text else parts:
            options = OPTION.findall(part)
            if where.startswith("docs/guide/"):
                self.described[""].update(options)
                self.described.setdefault(heading, set()).update(options)
            if not is_text:
                self._check_command(where, part.split())
            known = self._known_options([] if is_text else part.split())
            for option in options:
                if known is not None and option not in known:
                    self.problems.append(f"{where}: {option}: no such option: {part.strip()}")

    def _check_command(self, where, words):
        """Each word that names a command of the program, down to its last subcommand."""
        words = self._without_prefixes(words)
        program = self.programs.get(Path(words[0]).name) if words else None
        command = program.name if program else ""
        for word in words[1:] if program else []:
            below = program.subcommands[command]
            if not below or not re.fullmatch(r"[a-z][a-z-]*", word):
                return
            if word not in below:
                self.problems.append(f"{where}: {command} {word}: no such command")
                return
            command = f"{command} {word}"

    @staticmethod
    def _without_prefixes(words):
        while words and (words[0] in PREFIXES or re.match(r"[A-Z_]+=", words[0])):
            words = words[1:]
        return words

    def _known_options(self, words):
        """What may stand on a line of these words; None: another program's options."""
        words = self._without_prefixes(words)
        if not words or not re.fullmatch(r"[\w./+][\w./+-]*", words[0]):
            return set().union(*(program.all_options() for program in self.programs.values()))
        program = self.programs.get(Path(words[0]).name)
        if program:
            return program.options_of([program.name, *words[1:]])
        for program in self.programs.values():
            if f"{program.name} {words[0]}" in program.options:  # "run --json"
                return program.options_of([program.name, *words])
        return None

    def _check_described(self, program):
        for command, options in program.options.items():
            words = command.split()
            while words and " ".join(words) not in self.described:
                words.pop()
            heading = " ".join(words)
            for option in sorted(options - self.described[heading]):
                if option in ("--help", "--help-all") and option in self.described[""]:
                    continue
                place = f"below the heading {heading}" if heading else "anywhere"
                self.problems.append(
                    f"docs/guide: {option} of {command}: not described {place}")

    def _check_table(self, program):
        """Every command of the program whose page this is stands in the first table of the page."""
        rows, last = "", None
        for block in self.blocks.get(self.root / COMMAND_LINE, []):
            if block.kind == "table" and last in (None, block.line - 1):
                rows, last = f"{rows}{block.text}\n", block.line
        if f"`{program.name} " not in rows:
            return
        for command in program.subcommands[program.name]:
            if f"| `{program.name} {command}` |" not in rows:
                self.problems.append(
                    f"{COMMAND_LINE}: {program.name} {command} is not in the first table")

    def report(self):
        for problem in sorted(set(self.problems)):
            print(problem)
        return 1 if self.problems else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", metavar="PROGRAM", help="a built program")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1],
                        help="the repository (default: that of this script)")
    options = parser.parse_args()
    checker = Checker(options.root, [Program(path) for path in options.programs])
    checker.run()
    return checker.report()


if __name__ == "__main__":
    sys.exit(main())
