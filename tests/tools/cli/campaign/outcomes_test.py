"""What a campaign says of its runs: a conflict, an undecided one, a clear one with warnings, one
that ignores points, a clear one, a failed one and one that is not done are told alike by `campaign
run`, `status`, `report --json` and the page, and the counts add up.

outcomes_test.py PROGRAM
"""

import json
import math
import pathlib
import re
import tempfile

from campaign_scene import expect, outcome, program, status

OUTCOMES = ("conflict", "undecided", "clear_with_warnings", "clear", "failed", "not_done")
WORDS = ("conflict", "undecided", "clear with warnings", "clear", "failed", "not done")


def write_scene(work):
    """A street 40 m long with walls at 3 m to both sides, a floor, and a pole in the middle of a
    second lane."""
    points = []
    for i in range(401):
        x = 0.1 * i - 10
        for k in range(31):
            points += [(x, -3, 0.1 * k), (x, 3, 0.1 * k)]
        for j in range(-30, 31):
            points.append((x, 0.1 * j, 0))
    points += [(10, 0.5, 0.1 * k) for k in range(5, 25)]
    (work / "scan.xyz").write_text("".join(f"{x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in points))
    program("convert", work / "scan.xyz", "-o", work / "site.h5")
    write_box(work / "slim.off", 1, 0.3)
    write_box(work / "wide.off", 1, 1.0)


def write_box(file, half_length, half_width):
    corners = [(x * half_length, y * half_width, z) for x in (-1, 1) for y in (-1, 1)
               for z in (0.5, 2)]
    faces = ["0 1 3", "0 3 2", "4 6 7", "4 7 5", "0 4 5", "0 5 1",
             "2 3 7", "2 7 6", "0 2 6", "0 6 4", "1 5 7", "1 7 3"]
    file.write_text("OFF\n8 12 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners)
                    + "".join(f"3 {face}\n" for face in faces))


def write_path(file, y=0.0, at=0.0, step=0.05):
    file.write_text("".join(f"1 0 0 {at + step * i} 0 1 0 {y} 0 0 1 0\n" for i in range(401)))


def campaign_of(work, **changes):
    campaign = {"name": "All outcomes", "environments": {"street": "site.h5"},
                "vehicles": {"slim": "slim.off", "wide": "wide.off"},
                "routes": {"middle": "middle.txt", "far": "far.txt"}, "radii": [0.1],
                "query": {"first_pose": True, "clearance": 0.5},
                "limits": {"memory": "300M", "threads": 1}}
    campaign.update(changes)
    (work / "campaign.json").write_text(json.dumps(campaign))
    return work / "campaign.json"


def numbers_in(text):
    """The counts of "5 runs: 1 conflict, ..."."""
    found = re.search(r"(\d+) runs?: (.*)$", text, re.M)
    expect(found, f"no counts in: {text}")
    counts = {}
    for part in found[2].split(", "):
        number, words = part.split(" ", 1)
        counts[OUTCOMES[WORDS.index(words)]] = int(number)
    return int(found[1]), counts


def told_alike(path, expected):
    """By status, as text and as JSON, by report and by its page."""
    runs = sum(expected.values())
    look = status(path)
    expect(look["outcomes"] == expected and look["runs"] == runs, f"status --json: {look}")
    said = program("campaign", "status", path)
    expect(numbers_in(said) == (runs, expected), f"status: {said}")
    done = outcome("campaign", "report", path, "--force", "--json")
    facts = json.loads(done.stdout)
    expect({name: facts[name] for name in OUTCOMES} == expected, f"report --json: {done.stdout}")
    expect(numbers_in(done.stderr) == (runs, expected), f"report: {done.stderr}")
    for name in OUTCOMES:
        of_runs = sum(run["outcome"] == name for run in facts["runs"])
        expect(of_runs == expected[name], f"{name}: {of_runs} of the runs")
    page = (path / "index.html").read_text()
    for name in OUTCOMES:
        cells = page.count(f'<td class="{name}"')
        expect(cells == expected[name], f"page: {cells} cells are {name}")
        legend = re.search(rf'<li class="{name}"><span class="sign" aria-hidden="true">.</span> <b>(\d+)</b>', page)
        expect((int(legend[1]) if legend else 0) == expected[name], f"page: the legend of {name}")
    answer = re.search(r'<p class="answer">(.*)</p>', page)[1]
    counted = [int(n) for n in re.findall(r"\b(\d+)\b", answer.split(". In ")[0])]
    expect(counted[0] == runs and sum(counted[1:]) == runs, answer)
    return look, facts, page


def outcome_by_run(path, name):
    """The outcome of a run that is done, by what `clearway run --json` said."""
    run = json.loads((path / "runs" / name / "run.json").read_text())
    if run["verdict"] == "clear":
        return "clear_with_warnings" if run["warnings"] else "clear"
    return run["verdict"]


def every_outcome(work):
    """slim passes, wide hits the pole, and far away nothing can be found."""
    path = work / "out"
    program("campaign", "plan", campaign_of(work), "-o", path)
    told_alike(path, dict(zip(OUTCOMES, (0, 0, 0, 0, 0, 4))))
    sound = (work / "wide.off").read_bytes()
    (work / "wide.off").write_bytes(sound[:60])
    done = outcome("campaign", "run", path, "--task", "0-1,3", "--fail-on-collision")
    expect(done.returncode == 3, f"a failure goes first: {done.returncode}: {done.stderr}")
    (work / "wide.off").write_bytes(sound)
    done = outcome("campaign", "run", path, "--task", "0-2", "--fail-on-collision")
    expect(done.returncode == 1, f"then a conflict: {done.returncode}: {done.stderr}")
    counts = dict.fromkeys(OUTCOMES, 0)
    for name in ("slim/middle/0.1", "slim/far/0.1", "wide/middle/0.1"):
        counts[outcome_by_run(path, name)] += 1
    counts["failed"] += 1
    expect(counts["conflict"] == 1 and counts["undecided"] == 1, f"{counts}")
    look, facts, page = told_alike(path, counts)
    expect(numbers_in(done.stderr)[1]["conflict"] == 1, done.stderr)
    far = facts["runs"][1]
    expect(far["verdict"] == "undecided" and far["reasons"] == ["question-in-doubt"], f"{far}")
    expect("out-of-reach" in far["warnings"] and "out-of-reach" in page, f"{far}")
    said = program("campaign", "status", path).split("runs:")[1]
    expect("far" in said and "the question is in doubt (out-of-reach)" in said, f"status: {said}")
    expect(look["list"][1]["warnings"] == far["warnings"], f"{look['list'][1]}")
    done = outcome("campaign", "run", path, "--task", "0-1", "--fail-on-collision")
    expect(done.returncode == 6,
           f"then an undecided one: {done.returncode}: {done.stderr}")
    done = outcome("campaign", "run", path, "--task", "0", "--fail-on-collision")
    expect(done.returncode == 0, f"and a clear one: {done.returncode}: {done.stderr}")


def warnings_are_repeated(work):
    path = work / "warned"
    program("campaign", "plan", campaign_of(work, vehicles={"slim": "slim.off"}), "-o", path)
    done = outcome("campaign", "run", path, "--all")
    expect(re.search(r"slim/far/0\.1: undecided; \d warnings? \(.*out-of-reach", done.stderr),
           done.stderr)


def ignored_points_are_told(work):
    path = work / "ignoring"
    program("campaign", "plan",
            campaign_of(work, query={"ignore_boxes": [[9, -1, 0.3, 11, 1, 3]], "first_pose": True},
                        vehicles={"wide": "wide.off"}, routes={"middle": "middle.txt"}),
            "-o", path)
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0 and "20 points ignored" in done.stderr, done.stderr)
    look, facts, page = told_alike(path, status(path)["outcomes"])
    expect(facts["runs"][0]["ignored"]["points"] == 20, f"{facts}")
    expect(look["list"][0]["ignored"]["points"] == 20, f"{look}")
    colliding = facts["runs"][0]["ignored"]["colliding"]
    expect(f"20 ignored, of which {colliding} would collide" in page and "In 1 run points were left out of the search." in page,
           "the page does not tell ignored points")
    expect("20 points ignored" in program("campaign", "status", path), "status")


def lengths_are_rounded(work):
    """A distance of rounding errors alone is 0 for people."""
    path = work / "rounded"
    (work / "touching.xyz").write_text("0 3.0000000000000001 1\n0 0.3 1\n")
    turn = 0.3
    c, s = math.cos(turn), math.sin(turn)
    (work / "turned.txt").write_text(f"{c} {-s} 0 {3 * s} {s} {c} 0 {3 - 3 * c} 0 0 1 0\n")
    program("campaign", "plan",
            campaign_of(work, vehicles={"touching": "touching.xyz"},
                        routes={"turned": "turned.txt"}), "-o", path)
    program("campaign", "run", path, "--all")
    told_alike(path, status(path)["outcomes"])
    page = (path / "index.html").read_text()
    shown = page.split('id="facts"')[0]
    expect(not re.search(r"\de-\d", shown), "an exponent on the page")
    expect("<b>touches" in shown, "what touches is said in a word")


def put_back(work):
    """An input that was changed and is put back: its runs can be made."""
    path = work / "restored"
    program("campaign", "plan", campaign_of(work, routes={"middle": "middle.txt"}), "-o", path)
    sound = (work / "slim.off").read_text()
    (work / "slim.off").write_text(sound.replace("0.3 ", "0.4 "))
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 3 and "put it back" in done.stderr, done.stderr)
    expect(status(path)["failed"] == 1, "the changed one")
    expect(program("campaign", "status", path, "--missing") == "0\n", "it may be put back")
    again = outcome("campaign", "run", path, "--all")
    expect(again.returncode == 3 and "put it back" in again.stderr, again.stderr)
    (work / "slim.off").write_text(sound)
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0 and status(path)["done"] == 2, done.stderr)
    out = path / "runs/slim/middle/0.1/out.h5"
    out.write_bytes(b"no result")
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 3 and "is damaged or no result" in done.stderr, done.stderr)
    out.unlink()
    expect(outcome("campaign", "run", path, "--all").returncode == 0, "then")


def outdated(work):
    """A run whose model was replaced after it was done is no longer clear, and runs again."""
    path = work / "outdated"
    program("campaign", "plan", campaign_of(work, routes={"middle": "middle.txt"}), "-o", path)
    program("campaign", "run", path, "--all")
    before = status(path)["outcomes"]
    model, sound = work / "slim.off", (work / "slim.off").read_text()
    out = (path / "runs/slim/middle/0.1/out.h5").read_bytes()
    model.write_text(sound.replace("0.3 ", "1.0 "))
    words = "the model file slim.off changed since this run"
    look = status(path)
    expect(look["outdated"] == 1 and look["list"][0]["status"] == "outdated", f"{look}")
    expect(look["list"][0]["changed"] == words and "verdict" not in look["list"][0], f"{look}")
    expect(look["outcomes"]["not_done"] == 1, f"{look}")
    expect(words in program("campaign", "status", path), "status does not say it")
    expect(program("campaign", "status", path, "--missing") == "0\n", "it is to be done")
    told_alike(path, look["outcomes"])
    expect(words in (path / "index.html").read_text(), "the page does not say it")
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 3 and words + "; it runs again" in done.stderr
           and "an input has changed since it was planned" in done.stderr, done.stderr)
    expect(status(path)["failed"] == 1 and status(path)["outcomes"]["clear"] == 0, "not clear")
    model.write_text(sound)
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0 and status(path)["outcomes"] == before, done.stderr)
    expect((path / "runs/slim/middle/0.1/out.h5").read_bytes() == out, "another result")
    model.touch()
    expect(status(path)["outdated"] == 1, "its time alone says no more")
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0 and status(path)["outcomes"] == before, done.stderr)


def outdated_poses(work):
    """A route in a folder of 3DTK, one of whose files changed or was removed."""
    path, poses = work / "outdated_poses", work / "poses"
    poses.mkdir()
    for i in range(5):
        (poses / f"scan{i:03}.pose").write_text(f"0 0 {100 * i}\n0 0 0\n")
    program("campaign", "plan", campaign_of(work, routes={"poses": "poses"}), "-o", path)
    outcome("campaign", "run", path, "--all")
    expect(status(path)["outdated"] == 0, f"{status(path)}")
    sound = (poses / "scan004.pose").read_text()
    (poses / "scan004.pose").write_text("0 0 401\n0 0 0\n")
    expect(status(path)["outdated"] == 2, f"{status(path)}")
    (poses / "scan004.pose").unlink()
    expect(status(path)["outdated"] == 2, f"{status(path)}")
    (poses / "scan004.pose").write_text(sound)


def options_of_run(work):
    """Every option of `clearway run` that a campaign can pass on reaches its command line."""
    path = work / "options"
    model = {"model": "slim.off", "as": "solid"}
    points = {"model": "slim.off", "as": "points", "spacing": 0.05}
    program("campaign", "plan",
            campaign_of(work, vehicles={"solid": model, "points": points},
                        routes={"middle": {"trajectory": "middle.txt", "chainage_start": 1000}},
                        outputs={"report": True, "conflicts": ["csv"]},
                        limits={"engine": "sweep", "journal_interval": 2.5,
                                "threads": 1}), "-o", path)
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0, done.stderr)
    run = json.loads((path / "runs/solid/middle/0.1/run.json").read_text())
    expect(run["model_as"] == "solid" and run["model_solids"] == 1, f"{run['model_as']}")
    run = json.loads((path / "runs/points/middle/0.1/run.json").read_text())
    expect(run["model_as"] == "points", f"{run['model_as']}")
    plan = (path / "plan.json").read_text()
    for option in ("--model-as=solid", "--journal-interval=2.5",
                   "--chainage-start=1000"):
        expect(option in plan, option)
    refused = outcome("campaign", "plan", campaign_of(work, vehicles={"slim": {
        "model": "slim.off", "as": "cloud"}}), "-o", work / "none")
    expect(refused.returncode == 3 and "vehicles.slim.as: " in refused.stderr, refused.stderr)
    known = set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", program("run", "--help-all"), re.M))
    # What a campaign sets itself, or what makes no sense in one.
    own = {"--help", "--help-all", "--env", "--model", "--vehicle", "--trajectory", "--radius", "--output",
           "--shard", "--force", "--resume", "--json", "--fail-on-collision"}
    passed = set()
    source = pathlib.Path(__file__).parents[4] / "src"
    for described in (source / "campaign/campaign_file.cpp", *source.glob("core/describe/*.hpp")):
        text = described.read_text()
        passed |= set(re.findall(r'"(--[\w-]+)"', text))
    expect(known - own <= passed, f"options of run unknown to a campaign: {known - own - passed}")


def errors_and_seen_space(work):
    """A campaign with an error budget and seen space has the verdicts and reasons of its runs, also
    where these are divided into shards."""
    for name, z in (("above", 6), ("below", -6)):  # from below no beam enters the lane
        (work / "origins.csv").write_text(f"first,x,y,z\n0,10,0,{z}\n")
        program("convert", work / "scan.xyz", "--origins", work / "origins.csv", "-o",
                work / f"{name}.h5", "--cell-points", 1000)
    query = {"first_pose": True, "error_scan": 0.005, "error_registration": 0.005, "sigmas": 4,
             "seen": True, "seen_cube": 0.25, "seen_min": 4}
    found = {}
    for limits in ({"memory": "300M", "threads": 1},
                   {"memory": "300M", "threads": 1, "shard_seconds": 0.008}):
        path = work / f"seen-{len(limits)}"
        program("campaign", "plan",
                campaign_of(work, environments={"above": "above.h5", "below": "below.h5"},
                            routes={name: {"trajectory": "middle.txt", "environment": name}
                                    for name in ("above", "below")},
                            vehicles={"slim": "slim.off",
                                      "wide": {"model": "wide.off", "as": "solid"}},
                            query=query, limits=limits), "-o", path)
        done = outcome("campaign", "run", path, "--all", "--fail-on-collision")
        expect(done.returncode == 1, f"a conflict goes first: {done.returncode}: {done.stderr}")
        expect(any(path.glob("runs/*/*/*/shards/2")) == ("shard_seconds" in limits), "its shards")
        facts = told_alike(path, status(path)["outcomes"])[1]
        found[len(limits)] = {
            f"{run['route']}/{run['vehicle']}": (run["verdict"], run["reasons"])
            for run in facts["runs"]}
    expect(found[2] == found[3], f"{found}")
    expected = {"above/slim": ("clear", []), "above/wide": ("conflict", []),
                "below/slim": ("undecided", ["not-scanned"]), "below/wide": ("conflict", [])}
    expect(found[2] == expected, f"{found[2]}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        write_scene(work)
        write_path(work / "middle.txt")
        write_path(work / "far.txt", y=5000)
        for check in [every_outcome, warnings_are_repeated, ignored_points_are_told,
                      lengths_are_rounded, put_back, outdated, outdated_poses, options_of_run,
                      errors_and_seen_space]:
            check(work)
            print(check.__name__, flush=True)


main()
