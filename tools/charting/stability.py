"""Where methods fail: origin, boundary, sparseness, radius, memory, poses."""

import re

import numpy as np

from charting.plot import (axis_with_zero, count_axis, fail, legend_in, line, lines, log_axis, panels,
                           power, right_axes, room_for_failures, seconds_axis, value_of)
from charting.sheet import Sheet
from charting.style import BLACK, GREY, SKY, Style, engine_styles

LAYOUTS = {"adaptive": Style(BLACK, "o", "-", ""),
           "regular, 50 cells along": Style(SKY, "p", "--", ""),
           "regular, 2 m": Style("#888888", ">", "-.", "")}
GIB = 2**30


def draw(record):
    sheet = Sheet(record, "Where methods fail", 8.0, times=("answer",))
    axes, place = panels(sheet, 4, 3, legend_lines=2)
    most = record.names("chunk_points")
    chunks = f"; regular cells are cut to chunks of {most[0]:,} points" if most else ""
    sheet.say("Hall; the tunnel in d to f. Wrong points of a and b: against exact distances. "
              "c: grey dots, the hall's points that close to the radius, in ulps (double's spacing "
              "there); lines, right axis: of points made to lie exactly so many ulps beside it, "
              "the share that an engine decides wrongly. "
              f"d to f: eight stray points stretch the tunnel's bounding box{chunks}; full markers: grid, "
              "hollow: sweep (e, f: conversion, and in f hollow the most that a run held). "
              "h and i: the budget relative to the least that the program names; with less "
              "it refuses to search, which is not drawn.")
    number, distance, boundary, *sparse = axes.flat[:6]
    radius, memory, device_memory, *poses = axes.flat[6:]
    draw_origin(sheet, number, distance, record)
    draw_boundary(sheet, boundary, record)
    draw_sparseness(sheet, sparse, record)
    engine_lines(sheet, radius, record.where(vary="radius"), answer)
    radius.set(title="g  radius", xlabel="radius (m)", ylabel="answer (s)")
    log_axis(radius.xaxis)
    seconds_axis(radius.yaxis)
    draw_memory(sheet, memory, record, "--memory", "h  --memory (hall)")
    draw_memory(sheet, device_memory, record, "--device-memory", "i  --device-memory (hall)")
    for panel, (vary, title, label) in zip(poses, (
            ("noise of the poses", "j  noise of the poses", "sigma (m and rad)"),
            ("stretch of the poses", "k  stretch, allowed", "stretch"),
            ("stretch without --allow-non-rigid", "l  stretch, not allowed", "stretch"))):
        cases = record.where(vary=vary)
        engine_lines(sheet, panel, cases, answer)
        axis_with_zero(panel.xaxis, [case["value"] for case in cases], 2)
        panel.set(title=title, xlabel=label, ylabel="answer (s)")
        seconds_axis(panel.yaxis)
    for panel in axes.flat:
        room_for_failures(panel)
    layouts = {name: style for name, style in LAYOUTS.items() if record.where(layout=name)}
    legend_in(place, engine_styles(record.names("engine")) | layouts, 4)
    say_differences(sheet, record)
    return sheet


def engine_lines(sheet, axes, cases, y_of, x_of=value_of):
    lines(sheet, axes, cases, engine_styles(case["engine"] for case in cases), "engine", y_of, x_of)


def answer(case):
    return case.answer_seconds()


def draw_origin(sheet, number, distance, record):
    cases = record.where(vary="origin")

    def wrong(case):
        return np.array([case.wrong()] if "false_hits" in case.findings else [])

    def farthest(case):
        return np.array([case.findings["largest_distance"]] if case.wrong() else [])

    engine_lines(sheet, number, cases, wrong)
    count_axis(number, max(case.wrong() for case in cases) if cases else 1, "wrong points")
    number.set_title("a  far origin: how many")
    engine_lines(sheet, distance, cases, farthest)
    distance.set(title="b  far origin: how far", ylabel="largest |d − r| (m)")
    distances = [farthest(case)[0] for case in cases if case.wrong()]
    if distances:
        distance.set_yscale("log")
        distance.set_ylim(min(distances) / 20, max(distances) * 20)
    else:
        distance.text(0.5, 0.5, "no wrong points", ha="center", transform=distance.transAxes)
    for axes in (number, distance):
        axis_with_zero(axes.xaxis, [case["value"] for case in cases], 2)
        axes.set_xlabel("origin moved in x and y (m)")


def draw_boundary(sheet, axes, record):
    for case in record.where(vary="boundary"):
        if case.failure:
            fail(sheet, axes, 1, case.failure)
            continue
        within = np.array(case.findings["within_ulps"], float)
        axes.plot(2.0 ** np.arange(len(within)), within, color=GREY, marker="o", markersize=3)
        count_axis(axes, within.max(), "points")
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda x, _: power(x))
    cases = record.where(vary="ulps")
    styles = engine_styles(case["engine"] for case in cases)
    made = [case for case in cases if case.findings]
    if made:
        right = right_axes(axes)
        for case in made:
            style = styles[case["engine"]]
            wrong = 100 * np.divide(case.findings["wrong"], case.findings["points"])
            right.plot(2.0 ** np.arange(len(wrong)), wrong, color=style.colour,
                       linestyle=style.line, marker=style.marker, markersize=2.5)
        right.set(ylim=(-5, 105), ylabel="made points, wrong (%)")
    for case in cases:
        if case.failure:
            fail(sheet, axes, 1, case.failure, styles[case["engine"]])
    axes.set(title="c  near the boundary", xlabel="|d − r|, at most (ulps of r)")


def draw_sparseness(sheet, axes, record):
    time, conversion, memory = axes
    for name, style in LAYOUTS.items():
        cases = record.where(vary="sparseness", layout=name)
        converted = [case for case in cases if case.get("engine") is None]
        for engine in dict.fromkeys(case["engine"] for case in cases if case.get("engine")):
            hollow = {"markerfacecolor": "white"} if engine.startswith("sweep") else {}
            of_engine = [case for case in cases if case.get("engine") == engine]
            line(sheet, time, of_engine, value_of, answer, style, name, **hollow)
            if hollow:
                line(sheet, memory, of_engine, value_of,
                     lambda case: case.values("peak_resident_bytes") / GIB, style, name, **hollow)
        for case in converted:
            if case.failure:
                fail(sheet, time, case["value"], case.failure, style)
        for panel, finding, unit in ((conversion, "convert_seconds", 1),
                                     (memory, "convert_peak_bytes", GIB)):
            line(sheet, panel, converted, value_of,
                 lambda case: np.array([case.findings[finding] / unit])
                 if finding in case.findings else np.array([]), style, name)
    for panel, title, label in zip(axes, ("d  sparse: answer", "e  sparse: conversion", "f  sparse: memory"),
                                   ("answer (s)", "conversion (s)", "peak memory (GiB)")):
        panel.set(title=title, ylabel=label, xlabel="bounding box made longer by")
        log_axis(panel.xaxis)
        seconds_axis(panel.yaxis)


def draw_memory(sheet, axes, record, option, title):
    axes.set(title=title, xlabel="budget / least that works", ylabel="answer (s)")
    cases = record.where(vary=option)
    if not cases:
        axes.text(0.5, 0.5, "not measured", ha="center", transform=axes.transAxes)
        axes.set(xticks=[], yticks=[])
        return
    least = {engine: least_of(record, option, engine)
             for engine in dict.fromkeys(case["engine"] for case in cases)}
    sheet.say("Least " + option + ": " + ", ".join(
        f"{engine} {bytes_text(needed) if needed else 'not named, so not drawn'}"
        for engine, needed in least.items()) + ".")

    def times_of(case):
        return round(case["value"] / least[case["engine"]], 2)

    cases = [case for case in cases if least[case["engine"]] and times_of(case) >= 1]
    steps = sorted({times_of(case) for case in cases})
    engine_lines(sheet, axes, cases, answer, lambda case: steps.index(times_of(case)))
    axes.set(xticks=range(len(steps)), xticklabels=[f"{step:g}" for step in steps],
             xlim=(-0.5, len(steps) - 0.5))
    axes.tick_params("x", labelsize=6.5)
    seconds_axis(axes.yaxis)


def bytes_text(count):
    return f"{count / GIB:.2f} GiB" if count >= GIB else f"{count / 2**20:.0f} MiB"


def least_of(record, option, engine):
    """As a refusal named it, or None."""
    for case in record.where(vary="least" + option, engine=engine):
        if found := re.search(re.escape(option) + r" (\d+) is enough", case.failure or ""):
            return int(found[1])
    return None


def say_differences(sheet, record):
    """Whether the engines of j and k give the k-d tree's set."""
    for letter, vary in (("j", "noise of the poses"), ("k", "stretch of the poses")):
        judged = [case for case in record.where(vary=vary) if "equal" in case.findings]
        differing = [f"{case['engine']} at {case['value']:g} by {case.wrong()} points"
                     for case in judged if not case.findings["equal"]]
        if judged:
            sheet.say(f"{letter}: " + ("differ from kdtree: " + ", ".join(differing)
                                       if differing else "all sets equal kdtree's") + ".")
