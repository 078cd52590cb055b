"""`clearway campaign` with ledgers: each run keeps its own from epoch to epoch, the page shows what was
before the update, and runs at the same time lose nothing.

ledger_campaign_test.py PROGRAM
"""

import csv
import json
import pathlib
import re
import subprocess
import tempfile

from campaign_scene import PROGRAM, expect, make_scene, outcome, program, status, write_campaign

OUTPUTS = {"conflicts": ["csv"], "report": True, "ledger": "books", "worse_by": "5cm", "min_points": 1}


def rows_of(table):
    with open(table, newline="") as file:
        return list(csv.DictReader(file))


def set_statuses(table, value):
    with open(table, newline="") as file:
        rows = list(csv.reader(file))
    for row in rows[1:]:
        row[1] = value
    with open(table, "w", newline="") as file:
        csv.writer(file).writerows(rows)


def plan(work, path, **changes):
    return outcome("campaign", "plan", write_campaign(work, **{"outputs": OUTPUTS, **changes}), "-o", path)


def page_facts(path):
    text = path.read_text()
    return json.loads(re.search(r'<script[^>]*id="facts"[^>]*>(.*?)</script>', text, re.S).group(1))


def refusals(work):
    for outputs, message in (({"conflicts": ["csv"], "worse_by": 1}, 'outputs.worse_by: needs "ledger" beside it'),
                             ({"ledger": "books"}, 'outputs.ledger: needs "conflicts" beside it'),
                             ({"conflicts": ["csv"], "ledger": ""}, "outputs.ledger: is empty"),
                             ({**OUTPUTS, "worse_by": -1}, "outputs.worse_by")):
        done = plan(work, work / "refused", outputs=outputs)
        expect(done.returncode == 3 and message in done.stderr, f"{message}: {done.stderr}")
    expect(not (work / "refused").exists() and not (work / "books").exists(), "a refused plan left something")


def epochs(work, tables):
    done = plan(work, work / "march")
    expect(done.returncode == 0 and "2 ledgers are begun" in done.stderr, done.stderr)
    expect(all(table.exists() and not rows_of(table) for table in tables), "no tables were begun")
    done = outcome("campaign", "run", work / "march", "--all", "--fail-on-collision")
    expect(done.returncode == 1, done.stderr)
    found = status(work / "march")
    for task, table in zip(found["list"], tables):
        rows = rows_of(table)
        expect(len(rows) == task["ledger"]["new"] == task["ledger"]["conflicts"] > 1, f"{table}: {task}")
        expect(task["ledger"]["outside"] == "conflict", task)
    expect(found["ledgers"]["new"] == sum(len(rows_of(table)) for table in tables), found)
    for table in tables:
        set_statuses(table, "accepted")
    before = [table.read_bytes() for table in tables]

    expect(plan(work, work / "april").returncode == 0, "april")
    done = outcome("campaign", "run", work / "april", "--all", "--jobs", 2, "--fail-on-collision")
    found = status(work / "april")
    outside = {task["ledger"]["outside"] for task in found["list"]}
    expect(outside == {"clear"} and done.returncode == 0, f"{outside}, {done.returncode}: {done.stderr}")
    expect("ledgers: " in done.stderr and "accepted" in program("campaign", "status", work / "april"), done.stderr)
    expect(found["outcomes"]["conflict"] == 2, "accepted conflicts are conflicts")
    expect([table.read_bytes() for table in tables] == before, "an update of the same day changed accepted rows")
    program("campaign", "report", work / "april")
    expect(" accepted" in (work / "april/index.html").read_text(), "the page does not say what is accepted")


def gone_on_the_page(work, tables):
    """A route that ends early: its rows were not searched, and then all of it with a path aside: gone or not searched."""
    text = (work / "routes/r00.txt").read_text().splitlines(keepends=True)
    (work / "routes/r00.txt").write_text("".join(text[:len(text) // 2]))
    expect(plan(work, work / "may").returncode == 0, "may")
    program("campaign", "run", work / "may", "--all")
    for task, table in zip(status(work / "may")["list"], tables):
        facts = page_facts(work / "may" / task["folder"] / "report.html")["ledger"]
        expect(facts["not-searched"] == task["ledger"]["not-searched"] > 0, task)
        expect(facts["worse"] == 0 and facts["name"] == "0.1.csv", facts)
        expect(all(row["status"] == "accepted" for row in rows_of(table)), "a row that was not searched changed")


def at_the_same_time(work, tables):
    """Two campaigns that update the same ledgers lose no row and add none twice."""
    for table in tables:
        table.unlink()
        table.with_name("0.1.places.h5").unlink()
    for path in (work / "one", work / "two"):
        expect(plan(work, path).returncode == 0, path)
    both = [subprocess.Popen([PROGRAM, "campaign", "run", path, "--all", "--jobs", "2"], stderr=subprocess.PIPE, text=True)
            for path in (work / "one", work / "two")]
    for one in both:
        words = one.communicate()[1]
        expect(one.returncode == 0, words)
    for task, table in zip(status(work / "one")["list"], tables):
        rows = rows_of(table)
        expect(len(rows) == task["ledger"]["conflicts"], f"{len(rows)} rows of {task['ledger']['conflicts']} conflicts")
        expect(len({row["key"] for row in rows}) == len(rows), "a key twice")


def broken_tables(work, tables):
    tables[0].write_text(tables[0].read_text().replace("new", "nwe"))
    done = plan(work, work / "broken")
    expect(done.returncode == 3 and "expected new, open, accepted or resolved" in done.stderr, done.stderr)
    expect(not (work / "broken").exists(), "a plan with a broken ledger was written")


def main():
    with tempfile.TemporaryDirectory(prefix="clearway-ledger-campaign-") as folder:
        work = pathlib.Path(folder)
        make_scene(work, vehicles=2, routes=1)
        tables = [work / f"books/v{i:02}/r00/0.1.csv" for i in range(2)]
        refusals(work)
        epochs(work, tables)
        gone_on_the_page(work, tables)
        at_the_same_time(work, tables)
        broken_tables(work, tables)
    print("ledgers of campaigns: as expected")


main()
