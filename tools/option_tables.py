#!/usr/bin/env python3
"""Writes the tables of commands and options of the guide, from the program's help.

    option_tables.py PROGRAM PAGE...          writes them
    option_tables.py PROGRAM PAGE... --check  says which are stale

A table stands between two lines: <!-- options of COMMAND: GROUP --> and <!-- end of options -->.
Without a group it has all options of the command that are in no other table of the page. Options
that another command has with the same text, such as those of the trajectory, share one row, which
names that command. <!-- commands of PROGRAM --> begins a table of the program's commands.
"""

import re
import sys
from pathlib import Path

from prose.program import OPTION, Entry, Program

COMMANDS = re.compile(r"<!-- commands of (.*?) -->\n(.*?)<!-- end of commands -->", re.S)
TABLE = re.compile(r"<!-- options of ([^:]*?)(?:: (.*?))? -->\n(.*?)<!-- end of options -->", re.S)


# The commands to which the tables of others refer, in this order.
BASES = ("clearway run", "clearway convert", "clearway conflicts", "clearway report")
ALWAYS_SHOWN = ("--force", "--json")


def with_options_in_code(text, options):
    """Options as code spans; those of another program with its name, as in `sbatch --array`."""
    def in_code(found):
        before = found[1] or ""
        return f"{before}`{found[2]}`" if found[2] in options else f"`{before}{found[2]}`"
    return re.sub(rf"(\w+ )?({OPTION.pattern})", in_code, text)


def commands(program):
    """The table of the program's commands, as its help describes them."""
    options = program.all_options()
    rows = "".join(f"| `{program.name} {name}` | {text[:1].lower()}{with_options_in_code(text[1:], options)} |\n"
                   for section, name, text in program.entries[program.name]
                   if section == "Subcommands")
    return (f"<!-- commands of {program.name} -->\n| command | what it does |\n|---|---|\n"
            f"{rows}<!-- end of commands -->")


def row(name, text, options):
    """A row of the table, from what the help has on its left and right side. options: of the program."""
    entry = Entry(name, text)
    text = entry.text.replace("|", r"\|")
    usual = re.search(r"(?: \(default: ([^()]*(?:\([^()]*\))?[^()]*)\))", text)
    default = ("required" if entry.required else usual[1] if usual else
               entry.default or ("none" if entry.value else "off"))
    meaning = text.replace(usual[0], "") if usual else text
    if not re.match(r"[A-Z]{2}", meaning):
        meaning = meaning[:1].lower() + meaning[1:]
    choices = entry.choices
    named = [name for name in choices if re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", meaning)]
    if len(named) < min(4, len(choices)):
        meaning += ": " + ", ".join(f"`{name}`" for name in choices)
    if entry.limits:
        least, most = entry.limits
        meaning += f"; {least} to {most}" if int(most) < 1_000_000 else f"; at least {least}"
    meaning = with_options_in_code(meaning, options)
    names = [f"`{flag}`" for flag in re.sub(r"\{.*", "", entry.flags).split(",")]
    if entry.value and entry.flags.startswith("-"):
        names[-1] = f"{names[-1][:-1]} {entry.value}`"
    return f"| {', '.join(names)} | {default} | {meaning} |\n"


def rows(program, command, entries):
    """A row for each entry, and one for all that a command of BASES has with the same row."""
    bases = BASES[:BASES.index(command)] if command in BASES else BASES
    bases = [base for base in bases if base in program.entries]
    options = program.all_options()
    of_base = {base: {row(name, text, options) for _, name, text in program.entries[base]}
               for base in bases}
    own, shared = "", {base: [] for base in bases}
    for _, name, text in entries:
        line, option = row(name, text, options), name.split()[0].split(",")[-1]
        base = next((base for base in bases if line in of_base[base]), None)
        if base is None or "| required |" in line or option in ALWAYS_SHOWN:
            own += line
        else:
            shared[base].append(option)
    return own + "".join(
        f"| {', '.join(f'`{name}`' for name in names)} | | as in [`{base}`](#{base.replace(' ', '-')}) |\n"
        for base, names in shared.items() if names)


def tables(program, page):
    """The page with its tables as they should be."""
    placed = {(command, group) for command, group, _ in TABLE.findall(page) if group}

    def table(found):
        command, group = found[1], found[2]
        entries = [entry for entry in program.entries[command]
                   if not entry[1].startswith(("-h,", "--help-all")) and entry[0] != "Subcommands"
                   and (entry[0] == group if group else (command, entry[0]) not in placed)]
        if not entries:
            raise SystemExit(f"option_tables.py: {command} has no options of {group}")
        words = command.split()
        title = group or (f"option of `{words[-1]}`" if len(words) > 2 else "option")
        head = f"| {title} | default | meaning |\n|---|---|---|\n"
        mark = f"<!-- options of {command}{': ' + group if group else ''} -->\n"
        return f"{mark}{head}{rows(program, command, entries)}<!-- end of options -->"
    return COMMANDS.sub(lambda _: commands(program), TABLE.sub(table, page))


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
