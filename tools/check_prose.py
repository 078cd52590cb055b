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

from prose import markdown, names, terms
from prose.program import OPTION, Program

OUTPUT_LANGUAGES = {"text", "json", "csv", "console"}
PREFIXES = {"$", "time", "nice", "sudo"}
SOURCE_PATH = re.compile(r"(?:src|include|tools|tests|examples|cmake|docs)/[\w./-]*\w")
COMMAND_LINE = "docs/guide/command-line.md"
ENDINGS = ("", ".hpp", ".cpp", ".cu", ".py", ".sh")


def files_of(root):
    """All files that git does not ignore; where git knows none of them, all."""
    command = ["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    listed = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    paths = (root / name for name in listed.split("\0") if name) if listed else root.rglob("*")
    return {path for path in paths if path.is_file()}


class Checker:
    def __init__(self, root, programs):
        self.root, self.programs = root.resolve(), {p.name: p for p in programs}
        self.files = files_of(self.root)
        self.blocks = {path: markdown.parse(path.read_text(encoding="utf-8"))
                       for path in sorted(self.files) if path.suffix == ".md"}
        self.described = {"": set()}  # in docs/guide, below each heading that is a command; "": all

    def problems(self):
        glossary = terms.Glossary(self.root)
        yield from glossary.problems()
        sources = names.Names(self.root, self.files)
        yield from sources.incomplete()
        for path, blocks in self.blocks.items():
            name = str(path.relative_to(self.root))
            yield from self._broken_links(path, name, blocks)
            if name != "CHANGELOG.md":  # which names files of earlier versions too
                yield from self._missing_paths(name, blocks)
                yield from sources.unknown(name, blocks)
            if name == "README.md" or name.startswith("docs/guide/"):
                for block in blocks:
                    if block.kind != "code":
                        yield from glossary.not_used(name, block.line, block.text)
                yield from self._wrong_options(name, blocks)
        for program in self.programs.values():
            for where, text in program.prose:
                yield from glossary.not_used(where, 0, text)
            yield from self._not_described(program)
            yield from self._not_in_table(program)
        yield from names.code_problems(self.root, self.files)

    def _broken_links(self, path, name, blocks):
        for block in blocks:
            for link in markdown.link_targets(block):
                if re.match(r"([a-z][a-z0-9+.-]*:|//)", link):
                    continue
                target = unquote(link)
                file, _, anchor = target.partition("#")
                base = self.root if file.startswith("/") else path.parent
                found = (base / file.lstrip("/")).resolve() if file else path
                if found not in self.files and not any(found in known.parents for known in self.files):
                    yield f"{name}:{block.line}: broken link: {target}: no such file"
                elif anchor and found in self.blocks and (
                        anchor not in markdown.anchors(self.blocks[found])):
                    yield f"{name}:{block.line}: broken link: {target}: no such heading"

    def _missing_paths(self, name, blocks):
        for block in blocks:
            for _, code in markdown.code_spans(block):
                if SOURCE_PATH.fullmatch(code) and "NAME" not in code and not (
                        (self.root / code).is_dir() or
                        any(self.root / (code + ending) in self.files for ending in ENDINGS)):
                    yield f"{name}:{block.line}: {code}: no such file or folder"

    def _wrong_options(self, name, blocks):
        heading = ""
        for block in blocks:
            if block.kind == "heading":
                heading = block.text.replace("`", "")
            if block.kind == "code":
                is_text = block.language in OUTPUT_LANGUAGES
                lines = block.text.replace("\\\n", "  ").splitlines()
                parts = [(block.line + i, line, is_text) for i, line in enumerate(lines)]
            else:
                parts = [(line, code, False) for line, code in markdown.code_spans(block)]
                parts.append((block.line, markdown.CODE_SPAN.sub("", block.text), True))
            for line, code, is_text in parts:
                yield from self._wrong_code(f"{name}:{line}", heading, code, is_text)

    def _wrong_code(self, where, heading, code, is_text):
        """One line of code, each command of a pipe by itself; or a line of text."""
        parts = re.split(r"\||&&|;", re.sub(r"(^|\s)#\s.*", "", code))
        for part in [code] if is_text else parts:
            options, words = OPTION.findall(part), [] if is_text else part.split()
            while words and (words[0] in PREFIXES or re.match(r"[A-Z_]+=", words[0])):
                words = words[1:]
            if where.startswith("docs/guide/"):
                self.described[""].update(options)
                self.described.setdefault(heading, set()).update(options)
            yield from self._wrong_command(where, words)
            known = self._known_options(words)
            for option in options:
                if known is not None and option not in known:
                    yield f"{where}: {option}: no such option: {part.strip()}"

    def _wrong_command(self, where, words):
        """Each word that names a command of the program, down to its last subcommand."""
        program = self.programs.get(Path(words[0]).name) if words else None
        command = program.name if program else ""
        for word in words[1:] if program else []:
            below = program.subcommands[command]
            if not below or not re.fullmatch(r"[a-z][a-z-]*", word):
                return
            if word not in below:
                yield f"{where}: {command} {word}: no such command"
                return
            command = f"{command} {word}"

    def _known_options(self, words):
        """What may stand on a line of these words; None: another program's options."""
        if not words or not re.fullmatch(r"[\w./+][\w./+-]*", words[0]):
            return set().union(*(program.all_options() for program in self.programs.values()))
        program = self.programs.get(Path(words[0]).name)
        if program:
            return program.options_of([program.name, *words[1:]])
        for program in self.programs.values():
            if f"{program.name} {words[0]}" in program.options:  # "run --json"
                return program.options_of([program.name, *words])
        return None

    def _not_described(self, program):
        for command, options in program.options.items():
            words = command.split()
            while words and " ".join(words) not in self.described:
                words.pop()
            heading = " ".join(words)
            for option in sorted(options - self.described[heading]):
                if option in ("--help", "--help-all") and option in self.described[""]:
                    continue
                place = f"below the heading {heading}" if heading else "anywhere"
                yield f"docs/guide: {option} of {command}: not described {place}"

    def _not_in_table(self, program):
        """Every command of the program whose page this is stands in the first table of the page."""
        rows, last = "", None
        for block in self.blocks.get(self.root / COMMAND_LINE, []):
            if block.kind == "table" and last in (None, block.line - 1):
                rows, last = f"{rows}{block.text}\n", block.line
        for command in program.subcommands[program.name] if f"`{program.name} " in rows else ():
            if f"| `{program.name} {command}` |" not in rows:
                yield f"{COMMAND_LINE}: {program.name} {command} is not in the first table"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", metavar="PROGRAM", help="a built program")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1],
                        help="the repository (default: that of this script)")
    options = parser.parse_args()
    problems = set(Checker(options.root, [Program(path) for path in options.programs]).problems())
    for problem in sorted(problems):
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
