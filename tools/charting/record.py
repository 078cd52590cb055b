"""What tools/experiments.py wrote, and its numbers as text."""

import gzip
import json
import re
import sys
import zlib

import numpy as np


class Case:
    """One case: its parameters, the reports of its runs and what was found of the result."""

    def __init__(self, raw):
        self.key = raw["key"]
        self.parameters = raw.get("parameters", {})
        self.runs = raw.get("runs", [])
        self.findings = raw.get("findings") or {}
        failed = raw.get("failed") or self.findings.get("failed")
        self.failure = failure_text(failed) if failed else None
        # Seconds after which it was stopped; older files have only how long it took to stop.
        self.limit = limit_of(failed) if failed else None

    def __getitem__(self, name):
        return self.parameters[name]

    def get(self, name):
        return self.parameters.get(name)

    def seconds(self, *names):
        """A number a run: the sum of these of its times."""
        return np.array([sum(run["seconds"].get(name, 0) for name in names) for run in self.runs])

    def median(self, *names):
        return np.median(self.seconds(*names))

    def answer_seconds(self):
        """What the question takes besides its inputs, a context and writing its result."""
        return self.seconds("thin", "plan", "field", "engine", "search")

    def values(self, name):
        return np.array([run[name] for run in self.runs])

    def wrong(self):
        """How many points were decided wrongly: against exact distances, or the exact set."""
        return sum(self.findings.get(name, 0) for name in
                   ("false_hits", "misses", "only_here", "only_in_reference"))


class Record:
    """One file of one experiment."""

    def __init__(self, path, raw):
        self.path = path
        self.experiment = raw["experiment"]
        self.size = raw.get("size", "")
        self.machine = raw.get("machine", {})
        self.clearway = raw.get("clearway", {})
        self.parameters = raw.get("parameters", {})
        self.cases = [Case(one) for one in raw["cases"]]

    def where(self, **wanted):
        """The cases whose parameters have these values."""
        return [case for case in self.cases
                if all(case.get(name) == value for name, value in wanted.items())]

    def measured(self, **wanted):
        """Those of where() that have run."""
        return [case for case in self.where(**wanted) if case.runs]

    def names(self, name):
        """The values of a parameter, each once, as they come."""
        return list(dict.fromkeys(case[name] for case in self.cases if case.get(name) is not None))


def read_record(path):
    """The record in a file of JSON, compressed if its name ends in .gz; None where the JSON is of
    something else."""
    try:
        data = path.read_bytes()
        raw = json.loads(gzip.decompress(data) if path.suffix == ".gz" else data)
    except (ValueError, EOFError, gzip.BadGzipFile, zlib.error) as error:
        sys.exit(f"{path}: is not JSON: {error}")
    if not isinstance(raw, dict) or not {"experiment", "cases"} <= raw.keys():
        return None
    return Record(path, raw)


def limit_of(failed):
    return failed.get("limit", failed.get("after_seconds"))


def failure_text(failed):
    """Why a run failed, in a line."""
    if "after_seconds" in failed:
        return f"stopped after {limit_of(failed):.0f} s"
    lines = [line.strip() for line in failed.get("log", "").splitlines() if line.strip()]
    reason = re.sub(r"^(\[[^]]*\]\s*)+", "", lines[-1]) if lines else "no message"
    reason = re.sub(r"^(error: |clearway( \w+)?: )+", "", reason)
    reason = re.sub(r"\d+\.\d{5,}", lambda number: f"{float(number[0]):.4g}", reason)
    reason = re.sub(r"(?:/[^\s/:]+)+/([^\s/:]+)", r"\1", reason)
    return f"{reason} (exit code {failed.get('exit_code')})"


def markdown_table(head, rows, below=""):
    """A table in Markdown, and a paragraph below it."""
    lines = ["| " + " | ".join(head).lstrip() + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + (f"\n\n{below}\n" if below else "\n")


MEASURED = {"search": lambda case: case.seconds("search"), "answer": lambda case: case.answer_seconds(),
            "total": lambda case: case.seconds("total")}


def markdown(record):
    """For charts that have no table of their own, a row for each case: its parameters, the median
    seconds of its runs, the single numbers that were found of its result, and how it failed."""
    rows = [row_of(case) for case in record.cases]
    columns = list(dict.fromkeys(column for row in rows for column in row))
    columns = [column for column in columns if any(row.get(column) for row in rows)]
    return markdown_table([name.replace("_", " ") for _, name in columns],
                          [[row.get(column, "") for column in columns] for row in rows],
                          "Search, answer and total: medians in seconds.")


def row_of(case):
    """The cells of a case by (kind, name of the column), in the order of the columns."""
    row = {("parameter", name): cell(value) for name, value in case.parameters.items()}
    row |= {("seconds", name): "" for name in MEASURED}
    if case.runs:
        row |= {("seconds", name): cell(float(np.median(measure(case))))
                for name, measure in MEASURED.items()}
    row |= {("found", name): cell(value) for name, value in case.findings.items()
            if isinstance(value, (bool, int, float, str))}
    if case.failure:
        row["failed", "failed"] = cell(case.failure)
    return row


def cell(value):
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.3g}"
    return f"{value:,}" if isinstance(value, int) else str(value).replace("|", "/")
