#!/usr/bin/env python3
"""Writes the tables of options of the guide, from the program's help.

    option_tables.py PROGRAM PAGE...          writes them
    option_tables.py PROGRAM PAGE... --check  says which are stale

A table stands between two lines: <!-- options of COMMAND: GROUP --> and <!-- end of options -->.
Without a group it has all options of the command that are in no other table of the page.
"""

import re
import sys
from pathlib import Path

from prose.program import Program

TABLE = re.compile(r"<!-- options of ([^:]*?)(?:: (.*?))? -->\n(.*?)<!-- end of options -->", re.S)


def row(name, text):
    """A row of the table, from what the help has on its left and right side."""
    flags, _, rest = name.partition(" ")
    value = re.match(r"(?!REQUIRED|Excludes:|\.\.\.)[^\s:={]+", rest)
    usual = re.search(r"(?: \(default: ([^()]*(?:\([^()]*\))?[^()]*)\))", text)
    given = re.search(r"=(\S+)", rest)
    default = ("required" if re.search(r"\bREQUIRED\b", rest) else usual[1] if usual else
               given[1] if given else "none" if value else "off")
    meaning = text.replace(usual[0], "") if usual else text
    if not re.match(r"[A-Z]{2}", meaning):
        meaning = meaning[:1].lower() + meaning[1:]
    choices = re.search(r":\{([^}]*)\}", rest)
    if choices:
        names = choices[1].split(",")
        named = [name for name in names if re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", meaning)]
        if len(named) < min(4, len(names)):
            meaning += ": " + ", ".join(f"`{name}`" for name in names)
    if limits := re.search(r" in \[(\S+) - (\S+)\]", rest):
        meaning += (f"; {limits[1]} to {limits[2]}" if int(limits[2]) < 1_000_000 else
                    f"; at least {limits[1]}")
    meaning = re.sub(r"(?<![\w`-])(--[a-z][\w-]*)", r"`\1`", meaning).replace("|", r"\|")
    names = [f"`{flag}`" for flag in flags.split(",")]
    if value and flags.startswith("-"):
        names[-1] = f"{names[-1][:-1]} {value[0]}`"
    return f"| {', '.join(names)} | {default} | {meaning} |\n"


def tables(program, page):
    """The page with its tables as they should be."""
    placed = {(command, group) for command, group, _ in TABLE.findall(page) if group}

    def table(found):
        command, group = found[1], found[2]
        entries = [entry for entry in program.entries[command]
                   if not entry[1].startswith("-h,") and entry[0] != "Subcommands"
                   and (entry[0] == group if group else (command, entry[0]) not in placed)]
        if not entries:
            raise SystemExit(f"option_tables.py: {command} has no options of {group}")
        head = f"| {group or 'option'} | default | meaning |\n|---|---|---|\n"
        rows = "".join(row(name, text) for _, name, text in entries)
        mark = f"<!-- options of {command}{': ' + group if group else ''} -->\n"
        return f"{mark}{head}{rows}<!-- end of options -->"
    return TABLE.sub(table, page)


def main():
    check = "--check" in sys.argv
    path, *pages = [word for word in sys.argv[1:] if word != "--check"]
    program = Program(path)
    stale = []
    for page in map(Path, pages):
        before = page.read_text(encoding="utf-8")
        after = tables(program, before)
        if before != after:
            stale.append(page.name)
            if not check:
                page.write_text(after, encoding="utf-8")
    if check and stale:
        raise SystemExit(f"the tables of options in {', '.join(stale)} are stale; write them with "
                         f"tools/option_tables.py {path} {' '.join(pages)}")


if __name__ == "__main__":
    main()
