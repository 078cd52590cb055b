"""The numbers of a chart as text, for charts that have no table of their own."""

import numpy as np

MEASURED = {"search": lambda case: case.seconds("search"), "answer": lambda case: case.answer_seconds(),
            "total": lambda case: case.seconds("total")}


def markdown(record):
    """A Markdown table with a row for each case: its parameters, the median seconds of its runs,
    the single numbers that were found of its result, and how it failed."""
    rows = [row_of(case) for case in record.cases]
    columns = list(dict.fromkeys(column for row in rows for column in row))
    columns = [column for column in columns if any(row.get(column) for row in rows)]
    lines = ["| " + " | ".join(name.replace("_", " ") for _, name in columns) + " |",
             "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(row.get(column, "") for column in columns) + " |" for row in rows]
    return "\n".join(lines) + "\n\nSearch, answer and total: medians in seconds.\n"


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
