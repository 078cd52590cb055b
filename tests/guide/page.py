"""A page of the guide as a reader follows it: its blocks of commands, and what they are said to print."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from prose import markdown  # noqa: E402

SHELL = {"", "sh"}
NOT_SHELL = re.compile(r'\s*[{"]')  # a block without a language that is JSON
LEFT_OUT = "..."


class Block:
    """Commands of one block, or a snippet in another language; `output` is the text block below."""

    def __init__(self, block):
        self.line, self.language, self.output = block.line, block.language, None
        self.text = "\n".join(line.removeprefix("    ") for line in block.text.splitlines()) \
            if not block.language else block.text
        if self.language in SHELL and NOT_SHELL.match(self.text):
            self.language = "json"

    @property
    def commands(self):
        """Its lines, with those joined that end in a backslash, without comments and blank ones."""
        if self.language not in SHELL:
            return []
        joined = self.text.replace("\\\n", " ").splitlines()
        lines = (re.sub(r"(^|\s+)#\s.*", "", line).strip() for line in joined)
        return [re.sub(r"\s+", " ", line) for line in lines if line]


def blocks(path):
    """The blocks of a page in order; a text block belongs to the block above it."""
    found = []
    for block in markdown.parse(path.read_text(encoding="utf-8")):
        if block.kind != "code":
            continue
        here = Block(block)
        if here.language == "text" and found and found[-1].output is None:
            found[-1].output = here
        else:
            found.append(here)
    return found


def stray_commands(path):
    """Lines that look like commands in a block, but are in none, as in a list."""
    text = path.read_text(encoding="utf-8")
    inside = "\n".join(block.text for block in markdown.parse(text) if block.kind == "code")
    return [line.strip() for line in text.splitlines()
            if re.match(r"\s{2,}(\$ )?clearway ", line) and line.strip() not in inside]


# What depends on the machine, and what stands for it.
MASKS = [(re.compile(pattern), word) for pattern, word in (
    (r"\b\d[\d,]*(\.\d+)? (s|min|h)\b", "TIME"),
    (r"\b(count|distribute|partition|confirm) \d+\.\d+", r"\1 TIME"),
    (r"\bengine \w+ on [^,;]+", "ENGINE"),
    (r"^info: tests: .*", "TESTS"),
    (r"\b\d+ threads?\b", "THREADS"),
    (r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", "DATE"),
)]


def masked(line):
    for pattern, word in MASKS:
        line = pattern.sub(word, line)
    return line.rstrip()


def same(shown, printed):
    """Whether the page shows what was printed; a line of three dots stands for any lines."""
    parts, rest = _parts(shown), [masked(line) for line in printed]
    for number, part in enumerate(parts):
        part = [masked(line) for line in part]
        if number == len(parts) - 1 and number > 0:
            at = len(rest) - len(part)
            return at >= 0 and rest[at:] == part
        starts = range(len(rest) - len(part) + 1) if number else [0]
        at = next((i for i in starts if rest[i:i + len(part)] == part), None)
        if at is None:
            return False
        rest = rest[at + len(part):]
    return not rest


def refreshed(shown, printed):
    """What the page is to show: lines that differ only by the machine stay, and so does what is left out.

    Between dots, the first part keeps its number of lines and the last part keeps its own."""
    parts = _parts(shown)
    new = printed
    if len(parts) > 1:
        last = len(printed) - len(parts[-1])
        new = [*printed[:len(parts[0])], LEFT_OUT, *printed[max(last, len(parts[0])):]]
    old = {masked(line): line for line in shown}
    return [old.get(masked(line), line) for line in new]


def _parts(lines):
    parts = [[]]
    for line in lines:
        if line.strip() == LEFT_OUT:
            parts.append([])
        else:
            parts[-1].append(line)
    return parts
