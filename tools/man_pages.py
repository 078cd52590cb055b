#!/usr/bin/env python3
"""Writes the manual pages of programs, from their help: man_pages.py VERSION FOLDER PROGRAM...

The commands of clearway have pages of their own, such as clearway-run.1.gz. All commands below
those, and those of other programs, are sections of the page above them. Exit codes are those of
docs/guide/command-line.md.
"""

import gzip
import re
import sys
from pathlib import Path

from prose.program import Entry, Program

PAGED = {"clearway"}  # whose commands have pages of their own
COMMAND_LINE = Path(__file__).resolve().parents[1] / "docs" / "guide" / "command-line.md"


def escaped(text):
    """As roff prints it: hyphens that can be copied, no control line."""
    text = text.replace("\\", r"\e").replace("-", r"\-").replace("'", r"\(aq").replace("`", r"\(ga")
    text = text.replace("^", r"\(ha").replace("~", r"\(ti")
    return "\n".join(r"\&" + line if line.startswith((".", "'")) else line
                     for line in text.split("\n"))


def exit_codes():
    """[(code, meaning)] of the guide's table."""
    section = COMMAND_LINE.read_text(encoding="utf-8").split("## Exit codes\n")[1].split("\n##")[0]
    rows = re.findall(r"^\| (\d|other) \| (.*?) \|", section, re.M)
    return [(code, meaning.replace("`", "")) for code, meaning in rows]


def option(name, text):
    """The entry of an option or argument, from what the help has on its left and right side."""
    entry, notes = Entry(name), [text.rstrip(".")] if text else []
    if entry.excluded:
        notes.append("Not with " + " or ".join(entry.excluded))
    if entry.choices:
        notes.append("One of " + ", ".join(entry.choices))
    if entry.limits:
        notes.append("From {} to {}".format(*entry.limits))
    if entry.default:
        notes.append("Default: " + entry.default)
    if entry.required:
        notes.append("Required")
    head = ", ".join(rf"\fB{escaped(flag)}\fR" for flag in entry.flags.split(","))
    if entry.value:
        head += rf" \fI{escaped(entry.value)}\fR"
    return f".TP\n{head}\n" + escaped(". ".join(notes) + ".")


def paragraphs(lines):
    """Prose as paragraphs; indented lines and examples as they are."""
    out, plain = [], False
    for line in lines:
        as_is = line.startswith((" ", "Example"))
        if not line:
            out.append(".PP")
        elif as_is != plain:
            out.append(".PP\n.nf" if as_is else ".fi\n.PP")
        plain = as_is if line else plain
        if line:
            out.append(escaped(line))
    return [*out, ".fi"] if plain else out


def description(program, command):
    """What the command is, in one line, and what the help says behind its sections."""
    rest = program.rest[command]
    usage = rest.index("")
    return " ".join(rest[:usage]).removeprefix("Clearway: ").rstrip("."), rest[usage + 1:]


def body(program, command, level):
    """Sections of a command, and of those below it that have no page."""
    _, more = description(program, command)
    entries = program.entries[command]
    takes = " ".join(name.split()[0] for section, name, _ in entries if section == "Positionals")
    below = program.subcommands[command]
    synopsis = rf"\fB{escaped(command)}\fR [\fIOPTIONS\fR]" + \
        (r" \fICOMMAND\fR ..." if below else "") + (rf" \fI{takes}\fR" if takes else "")
    section = ".SH" if level == 0 else ".SS"
    lines = [".SH SYNOPSIS" if level == 0 else ".PP", synopsis]
    if any(more):
        lines += [*([".SH DESCRIPTION"] if level == 0 else [".PP"]), *paragraphs(more)]
    groups = {}  # in the help's order
    for kind, name, text in entries:
        if kind != "Subcommands":
            groups.setdefault(kind, []).append(option(name, text))
    lines += [f"{section} OPTIONS"] if groups else []
    for title, options in groups.items():
        lines += options if title in ("Positionals", "Options") else [f".SS {title}", *options]
    if below and command in PAGED:
        lines.append(".SH COMMANDS")
        for kind, name, text in entries:
            if kind == "Subcommands":
                lines.append(f".TP\n\\fB{escaped(command)}\\-{escaped(name)}\\fR(1)\n"
                             f"{escaped(text)}")
    elif below:
        for name in below:
            what, _ = description(program, f"{command} {name}")
            lines += [f'.SH "{escaped(command + " " + name).upper()}"', escaped(what),
                      *body(program, f"{command} {name}", level + 1)]
    return lines


def page(program, command, version):
    title = command.replace(" ", "-")
    what, _ = description(program, command)
    lines = [f'.TH {escaped(title).upper()} 1 "" "Clearway {version}" "Clearway"',
             ".SH NAME", rf"{escaped(title)} \- {escaped(what)}",
             *body(program, command, 0)]
    if command.split()[0] in PAGED:
        lines.append(".SH EXIT STATUS")
        lines += [f".TP\n.B {code}\n{escaped(meaning)}" for code, meaning in exit_codes()]
    if " " in command:
        lines += [".SH SEE ALSO", rf".BR {escaped(command.split()[0])} (1)"]
    return title, "\n".join(lines) + "\n"


def main():
    version, folder, *paths = sys.argv[1:]
    Path(folder).mkdir(parents=True, exist_ok=True)
    for old in Path(folder).glob("*.1.gz"):
        old.unlink()
    for path in paths:
        program = Program(path)
        for command in program.entries:
            if command == program.name or program.name in PAGED and command.count(" ") == 1:
                title, text = page(program, command, version)
                packed = gzip.compress(text.encode(), 9, mtime=0)
                (Path(folder) / f"{title}.1.gz").write_bytes(packed)


if __name__ == "__main__":
    main()
