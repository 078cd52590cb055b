"""The codes of warnings and notes: in the sources, and in the guide's list of them."""

import re

LIST = "docs/guide/warnings.md"
SOURCES = ("src", "tools/cli")
ENDINGS = (".cpp", ".hpp", ".cu", ".cuh")

# Literals of this form that are no codes: names of formats, units, clocks, encodings, rails and programs, and the
# reasons of a verdict, which docs/guide/results.md explains.
OTHERS = {
    "bin-cells", "inside-rail", "left-rail", "not-known", "not-scanned", "outside-rail", "question-in-doubt", "right-rail",
    "unknown-bin-cells", "unknown-cells",
    "ft-us", "int-ft", "international-feet", "international-foot", "intl-ft", "pose-wxyz",
    "pose-xyzw", "unix-none", "us-ft", "us-survey-feet", "us-survey-foot", "utf-8", "week-seconds", "xdg-open",
}
KEBAB = re.compile(r'"([a-z]+[0-9]*(?:-[a-z0-9]+)+)"')
GIVEN = re.compile(r'\b(?:warn|warning|note)\w*\(\s*(?:\w+,\s*)?"([a-z0-9-]+)"')
LISTED = re.compile(r"^\| ((?:`[a-z0-9-]+`(?:, )?)+) \|", re.MULTILINE)


def in_sources(root, files):
    """Each code, and a place where it stands."""
    found = {}
    folders = tuple(str(root / folder) + "/" for folder in SOURCES)
    for path in sorted(files):
        if path.suffix not in ENDINGS or not str(path).startswith(folders):
            continue
        text = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        for match in [*KEBAB.finditer(text), *GIVEN.finditer(text)]:
            line = text.count("\n", 0, match.start(1)) + 1
            found.setdefault(match[1], f"{path.relative_to(root)}:{line}")
    return {code: place for code, place in found.items() if code not in OTHERS}


def in_guide(root):
    path = root / LIST
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return {code for row in LISTED.findall(text) for code in re.findall(r"`([a-z0-9-]+)`", row)}


def problems(root, files):
    given, listed = in_sources(root, files), in_guide(root)
    for code in sorted(given.keys() - listed):
        yield f"{given[code]}: the code {code} is not listed in {LIST}"
    for code in sorted(listed - given.keys()):
        yield f"{LIST}: {code}: no such code in the sources"
