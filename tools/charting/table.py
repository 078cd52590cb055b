"""Table 1: colliding points of every engine on the four scenes, beside the paper's."""

from charting.paper import TABLE
from charting.plot import panels
from charting.sheet import Sheet


NO_PAPER = ("", "", "", "", "", "")  # of a scene that is not like one of the paper's


def grouped(number):
    return f"{number:,}" if number != "" else ""


def is_float(case):
    return not case.get("exact")


def difference(case):
    """How many points a result differs by, from the exact set."""
    return case.findings["only_here"] + case.findings["only_in_reference"]


def counted(case):
    """What to say of a case's colliding points."""
    if case.failure:
        return "failed"
    return grouped(case.runs[-1]["colliding_points"])


def equality(case):
    if case.failure or is_float(case):
        return ""
    return "=" if case.findings["equal"] else f"differs by {grouped(difference(case))}"


def rows_of(cases, paper):
    """Rows (what, here, beside it a note, the paper's)."""
    run = next((case.runs[-1] for case in cases if case.runs), {})
    name, points, model, poses, on_cpu, on_gpu = paper
    rows = [("points E", run.get("environment_points"), "", points),
            ("model points M", run.get("model_points"), "", model),
            ("poses T", run.get("poses"), "", poses)]
    rows = [(what, "" if here is None else grouped(here), note, grouped(theirs))
            for what, here, note, theirs in rows]
    for case in cases:
        theirs = ""
        if case["engine"] == "kdtree cpu":
            theirs = grouped(on_cpu)
        elif is_float(case):
            theirs = grouped(on_gpu)
        rows.append((case["engine"], counted(case), equality(case), theirs))
    for case in cases:
        if is_float(case) and not case.failure:
            rows.append(("float differs by", grouped(difference(case)),
                         f"+{case.findings['only_here']} −{case.findings['only_in_reference']}",
                         f"{on_gpu - on_cpu} or more" if on_gpu else ""))
    return rows


def draw(record):
    scenes = record.names("scene")
    count = max(len(rows_of(record.where(scene=scene), TABLE.get(scene, NO_PAPER))) for scene in scenes)
    lines = -(-len(scenes) // 2)
    sheet = Sheet(record, "Table 1: colliding points of every engine", lines * (count + 2) * 0.19,
                  times=())
    axes, _ = panels(sheet, lines, 2)
    for place in axes.flat:
        place.set_axis_off()
    for place, scene in zip(axes.flat, scenes):
        draw_scene(place, rows_of(record.where(scene=scene), TABLE.get(scene, NO_PAPER)), scene, count)
    sheet.say("Rows of engines: colliding points; = the same set, point by point, as sweep cpu. "
              "Float differs by: points that only float finds (+) and that it misses (−). The "
              "paper's columns are its own data sets with its k-d tree (double) on the row of "
              "kdtree and its GPU method (float) on that of float; of its difference only that "
              "of the counts is known, so at least as many points differ.")
    for case in record.cases:
        if case.failure:
            sheet.number_of_failure(f"{case.key}: {case.failure}")
    return sheet


def draw_scene(axes, rows, scene, count):
    axes.set_xlim(0, 1)
    axes.set_ylim(count + 1.6, -0.2)
    columns = ((0.0, "left"), (0.5, "right"), (0.52, "left"), (1.0, "right"))
    head = (scene, "Clearway", "", TABLE.get(scene, NO_PAPER)[0])
    for row, cells in enumerate([head, *rows]):
        for (x, side), text in zip(columns, cells):
            axes.text(x, row + 0.5, text, ha=side, va="center",
                      weight="bold" if row == 0 else "normal")
    for y, width in ((0, 1.0), (1, 0.7), (4, 0.5), (len(rows) + 1, 1.0)):
        axes.plot([0, 1], [y, y], color="black", linewidth=width)


def markdown(record):
    """The same as a Markdown table, a row a scene."""
    engines = record.names("engine")
    head = (["scene", "E", "M", "T", *engines, "float differs by", "paper's data set", "its E",
             "its M", "its T", "CPU", "GPU", "counts differ by"])
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for scene in record.names("scene"):
        cases = record.where(scene=scene)
        run = next((case.runs[-1] for case in cases if case.runs), None)
        sizes = [grouped(run[name]) if run else "" for name in
                 ("environment_points", "model_points", "poses")]
        found = {case["engine"]: f"{counted(case)} {equality(case)}".strip() for case in cases}
        floats = [grouped(difference(case)) for case in cases
                  if is_float(case) and not case.failure]
        name, *numbers, on_cpu, on_gpu = TABLE.get(scene, NO_PAPER)
        cells = [scene, *sizes, *(found.get(engine, "") for engine in engines), "".join(floats[:1]),
                 name, *map(grouped, numbers), grouped(on_cpu), grouped(on_gpu),
                 grouped(on_gpu - on_cpu) if on_gpu else ""]
        lines.append("| " + " | ".join(cells) + " |")
    lines += ["", "Points of the environment E, of the model M, poses T; colliding points of each "
              "engine, = where the set is that of sweep cpu point by point. The paper's columns are "
              "its own data sets, k-d tree in double on the CPU and grid in float on the GPU."]
    return "\n".join(lines) + "\n"
