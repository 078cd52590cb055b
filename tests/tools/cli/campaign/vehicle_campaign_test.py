"""Campaigns of vehicles of several bodies: beside models, divided into shards, and what is refused.

vehicle_campaign_test.py PROGRAM
"""

import csv
import json
import pathlib
import struct
import tempfile

from campaign_scene import expect, make_scene, outcome, program, status, write_campaign

LIMITS = {"memory": "300M", "threads": 1}
WAGON = {"bodies": [{"name": 'middle, "low"', "model": "v00.ply", "pivots": [1.05, -1.05]},
                    {"name": "front", "model": "v00.ply", "at": 1},
                    {"name": "tail", "model": "v00.ply",
                     "towed": {"by": "front", "at": -1, "pivots": [1, -1]}}]}


def plan(work, name, **changes):
    given = {"limits": LIMITS, "vehicles": {"wagon": "vehicles/wagon.json",
                                            "car": "vehicles/v00.ply"},
             "outputs": {"conflicts": ["csv", "bcf"], "report": True}, **changes}
    return outcome("campaign", "plan", write_campaign(work, **given), "-o", work / name)


def runs_are_those_of_the_program(work):
    done = plan(work, "whole")
    expect(done.returncode == 0 and "2 tasks" in done.stdout, done.stderr)
    program("campaign", "run", work / "whole", "--all")
    folder = work / "whole/runs/wagon/r00/0.1"
    program("run", "--env", work / "site.h5", "--vehicle", work / "vehicles/wagon.json",
            "--trajectory", work / "routes/r00.txt", "--radius", 0.1, "--first-pose", "-o",
            work / "out.h5")
    expect((folder / "out.h5").read_bytes() == (work / "out.h5").read_bytes(), "another result")
    with open(folder / "conflicts.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    expect(rows and rows[0]["body_name"] in ('middle, "low"', "front", "tail"), f"{rows[:1]}")
    program("conflicts", work / "out.h5", "--vehicle", work / "vehicles/wagon.json",
            "--trajectory", work / "routes/r00.txt", "-o", work / "conflicts.csv")
    expect((folder / "conflicts.csv").read_bytes() == (work / "conflicts.csv").read_bytes() and
           "unknown" not in (folder / "conflicts.csv").read_text(), "sides are not of the bodies")
    expect('"name":"middle, \\"low' in (folder / "report.html").read_text(), "the page has no bodies")
    facts = json.loads(program("campaign", "report", work / "whole", "--json"))
    expect(facts["not_done"] == 0 and facts["conflict"] >= 1, f"{facts}")


def divided_runs_are_whole_ones(work):
    limits = {**LIMITS, "shard_seconds": 0.03}
    done = plan(work, "divided", limits=limits, outputs={"conflicts": ["csv"]})
    expect(done.returncode == 0, done.stderr)
    tasks = [json.loads(line.rstrip(",")) for line in
             (work / "divided/plan.json").read_text().splitlines()[1:-1]]
    expect(sum(task["vehicle"] == "wagon" for task in tasks) > 2, "it is not divided")
    program("campaign", "run", work / "divided", "--all", "--jobs", "2")
    for name in ["out.h5", "conflicts.csv"]:
        one, other = [(work / kind / "runs/wagon/r00/0.1" / name).read_bytes()
                      for kind in ["whole", "divided"]]
        expect(one == other, name)


def a_changed_body_is_another_question(work):
    model = work / "vehicles/wagon.json"
    sound = model.read_text()
    model.write_text(json.dumps({"bodies": WAGON["bodies"][:1]}))
    done = plan(work, "whole")
    expect(done.returncode != 0 and "--force" in done.stderr, done.stderr)
    model.write_text(sound)


def refusals_name_the_key(work):
    for bodies, words in [([{"name": "a", "model": "none.ply"}], ["bodies[0].model", "none.ply"]),
                          ([{"name": "a", "model": "v00.ply", "at": 1, "pivots": [1, -1]}],
                           ["bodies[0]: a body moves in one way"])]:
        (work / "vehicles/broken.json").write_text(json.dumps({"bodies": bodies}))
        done = plan(work, "refused", vehicles={"wagon": "vehicles/broken.json"})
        expect(done.returncode in (3, 4) and all(
            word in done.stderr for word in ["campaign.json: vehicles.wagon", *words]), done.stderr)
    done = plan(work, "refused", limits={**LIMITS, "engine": "kdtree"})
    expect(done.returncode in (2, 3) and "expected engine sweep" in done.stderr, done.stderr)


def a_model_with_other_axes_is_turned(work):
    """v00.ply as text whose y axis points ahead, so that its x axis points to the right."""
    points = work / "vehicles/ahead_y.xyz"
    program("model", work / "vehicles/v00.ply", "-o", work / "points.ply")
    data = (work / "points.ply").read_bytes()
    head, rows = data.split(b"end_header\n", 1)
    kind = {b"double": "d", b"float": "f"}[head.split(b"property ")[1].split()[0]]
    step = struct.calcsize("<3" + kind)
    points.write_text("".join("{} {} {}\n".format(*(repr(v) for v in (-y, x, z))) for x, y, z in
                              (struct.unpack_from("<3" + kind, rows, at)
                               for at in range(0, len(rows), step))))
    turned = {"model": "vehicles/ahead_y.xyz", "forward": "+y", "turn": True}
    done = plan(work, "turned", vehicles={"turned": turned, "upright": {"model": "points.ply"}},
                outputs={"conflicts": ["csv"], "report": True})
    expect(done.returncode == 0, done.stderr)
    program("campaign", "run", work / "turned", "--all")
    folders = [work / f"turned/runs/{name}/r00/0.1" for name in ["turned", "upright"]]
    program("compare", *[folder / "out.h5" for folder in folders])
    one, other = [(folder / "conflicts.csv").read_bytes() for folder in folders]
    expect(one == other and len(one) > 100, "other conflicts")
    expect(status(work / "turned")["done"] == 2, "the results are not those of the plan")
    for wrong, words in [({"turn": True, "forward": "z"}, "same axis"), ({"turn": True}, "needs forward or up"),
                         ({"turn": 1, "forward": "y"}, "vehicles.turned.turn")]:
        done = plan(work, "refused", vehicles={"turned": {"model": "vehicles/ahead_y.xyz", **wrong}})
        expect(done.returncode != 0 and "vehicles.turned" in done.stderr and words in done.stderr,
               done.stderr)


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        make_scene(work, vehicles=1, routes=1)
        (work / "vehicles/wagon.json").write_text(json.dumps(WAGON))
        for check in [runs_are_those_of_the_program, divided_runs_are_whole_ones,
                      a_changed_body_is_another_question, refusals_name_the_key,
                      a_model_with_other_axes_is_turned]:
            check(work)
            print(check.__name__, flush=True)


main()
