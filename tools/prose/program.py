"""The commands, options and prose of a program, from its help texts."""

import re
import subprocess
from pathlib import Path

OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*")
TITLE = re.compile(r"^([A-Z][a-z][\w ]*):$")
TEXT_COLUMN = 30  # where the help texts of options begin
NOT_OPTIONS = {"Positionals", "Subcommands"}  # sections; every other one is a group of options


class Entry:
    """An option or argument, from what the help has on its left and right side."""

    def __init__(self, name, text=""):
        self.flags, _, rest = name.partition(" ")
        value = re.match(r"(?!REQUIRED|Excludes:|Needs:|\.\.\.)[^\s:={]+", rest)
        choices, given = re.search(r":\{([^}]*)\}", rest), re.search(r"=(\S+)", rest)
        excluded = re.search(r"\bExcludes: (.*)", rest)
        limits = re.search(r" in \[(\S+) - (\S+)\]", rest)
        self.value = value[0] if value else ""
        self.choices = choices[1].split(",") if choices else []
        self.text = text
        at_end = None if choices else re.search(r": ([\w-]+(?:, [\w-]+){3,})$", text)
        if at_end:  # choices too long for the left side
            self.text, self.choices = text[:at_end.start()], at_end[1].split(", ")
        self.default = given[1] if given else ""
        self.excluded = excluded[1].split() if excluded else []
        self.limits = limits.groups() if limits else ()
        self.required = bool(re.search(r"\bREQUIRED\b", rest))


class Program:
    def __init__(self, path):
        self.name = Path(path).name
        self.options = {}  # of each command, named by its words: "clearway run"
        self.subcommands = {}  # of each command: the names of those below it
        self.prose = []  # (where, text)
        self.entries = {}  # of each command: (section, name with its value, text)
        self.rest = {}  # of each command the lines outside the sections; an empty one for the usage
        self._read(str(path), [])

    def _read(self, path, words):
        """The help of one command, then those of its subcommands."""
        command = " ".join([self.name, *words])
        lines = subprocess.run([path, *words, "--help-all"], capture_output=True, text=True,
                               check=True).stdout.splitlines()
        entries, rest = self._split(lines)
        self.entries[command], self.rest[command] = entries, rest
        self._add_paragraphs(f"{command} --help", rest)
        entries = [(section, name.split()[0], text) for section, name, text in entries]
        self.prose += [(f"{command} --help, {name}", text) for _, name, text in entries]
        self.options[command] = {option for section, name, _ in entries
                                 if section not in NOT_OPTIONS for option in OPTION.findall(name)}
        self.subcommands[command] = [name for section, name, _ in entries
                                     if section == "Subcommands"]
        for section, name, _ in entries:
            if section == "Subcommands":
                self._read(path, [*words, name])

    @staticmethod
    def _split(lines):
        """The entries [section, name, text] of all sections, and the lines outside them."""
        section, entries, rest = "", [], []
        for line, following in zip(lines, [*lines[1:], ""]):
            title = TITLE.match(line)
            if title and (title[1] in NOT_OPTIONS or following.startswith("  -")):
                section = title[1]
            elif line.startswith("Usage:"):
                rest.append("")
            elif section and line.startswith(" " * 6) and entries:
                entries[-1][2] = f"{entries[-1][2]} {line.strip()}".strip()
            elif section and line.startswith("  "):
                names, _, text = line.strip().partition("  ")
                # A name that ends one column before the texts has one blank behind it.
                if not text and re.match(r" (?!Excludes:|Needs:|REQUIRED)[A-Z]",
                                         line[TEXT_COLUMN - 1:]):
                    names, text = line[:TEXT_COLUMN].strip(), line[TEXT_COLUMN:]
                entries.append([section, names, text.strip()])
            else:
                section = section if not line else ""
                rest.append(line)
        return entries, rest

    def _add_paragraphs(self, where, lines):
        """Lines at the margin are prose; indented lines and examples are not."""
        paragraph = []
        for line in [*lines, ""]:
            if line and not line.startswith((" ", "Example")):
                paragraph.append(line)
            elif paragraph:
                self.prose.append((where, " ".join(paragraph)))
                paragraph = []

    def options_of(self, words):
        """Of the longest command that the words begin with; of a bare program name, all."""
        while len(words) > 1 and " ".join(words) not in self.options:
            words = words[:-1]
        return self.options[" ".join(words)] if len(words) > 1 else self.all_options()

    def all_options(self):
        return set().union(*self.options.values())
