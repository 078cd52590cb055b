"""What a campaign costs beside its runs: overhead.py PROGRAM [--runs N]

Prints wall clock and processor time of N small runs by `campaign run --all`, the time that the runs
themselves report, and the same number of calls of `clearway run`. Not one of the tests: it measures.
"""

import argparse
import json
import pathlib
import resource
import subprocess
import tempfile
import time

from campaign_scene import PROGRAM, make_scene, program, write_campaign


def measured(call):
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    call()
    after, end = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    return [end - begin, after.ru_utime - before.ru_utime, after.ru_stime - before.ru_stime]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=1000)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        make_scene(work, runs // 20, 20)
        path = work / "out"
        plan = write_campaign(work, outputs={})
        times = {"plan": measured(lambda: program("campaign", "plan", plan, "-o", path))}
        times["campaign"] = measured(lambda: program("campaign", "run", path, "--all"))
        files = list(path.glob("runs/*/*/*/run.json"))
        inside = sum(json.loads(file.read_text())["seconds"]["total"] for file in files)
        times["all done already"] = measured(lambda: program("campaign", "run", path, "--all"))
        times["status"] = measured(lambda: program("campaign", "status", path))
        times["report"] = measured(lambda: program("campaign", "report", path))
        command = json.loads((path / "plan.json").read_text())["tasks"][0]["commands"][0]

        def call_each():
            for _ in files:
                (work / "out.h5").unlink(missing_ok=True)
                subprocess.run([PROGRAM, *command], cwd=work, check=True, capture_output=True)

        times["clearway run, one by one"] = measured(call_each)
        print(f"{len(files)} runs; milliseconds of each: wall clock, user, system")
        for name, seconds in times.items():
            print(f"{name:26}" + "".join(f"{1000 * one / len(files):8.2f}" for one in seconds))
        print(f"{'inside of the runs':26}{1000 * inside / len(files):8.2f}")


main()
