"""The glossary: each term once, and the words that a term replaces."""

import re

GLOSSARY = "docs/design/glossary.md"
REPLACED = "Words that are not used"
ROW = re.compile(r"^\| ([^|]+) \| ([^|]+) \|$")


class Glossary:
    def __init__(self, root):
        self.defined = {}  # each term: its lines
        self.replaced = []  # (pattern of the word, the term)
        path = root / GLOSSARY
        section = ""
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        for number, line in enumerate(lines, 1):
            if line.startswith("#"):
                section = line.lstrip("# ")
            row = ROW.match(line)
            if not row or row[1] in ("term", "not") or row[1].startswith("---"):
                continue
            for word in row[1].split(", "):
                if section == REPLACED:
                    pattern = r"\b" + re.escape(word).replace(r"\ ", r"\s+") + r"s?\b"
                    self.replaced.append((re.compile(pattern, re.IGNORECASE), row[2]))
                else:
                    self.defined.setdefault(word, []).append(number)

    def problems(self):
        for term, lines in self.defined.items():
            if len(lines) > 1:
                yield f"{GLOSSARY}:{lines[1]}: {term} is defined in line {lines[0]} already"

    def not_used(self, where, line, text):
        """Words of a text, which begins in `line` (0 where it has none), that a term replaces."""
        for pattern, term in self.replaced:
            for match in pattern.finditer(text):
                place = f"{where}:{line + text.count(chr(10), 0, match.start())}" if line else where
                word = " ".join(match[0].split())
                yield f"{place}: {word}: the glossary's term is: {term}"
