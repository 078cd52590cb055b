"""tools/measure_peers.py keeps what each library gave, also how it failed, lets one search at a time,
and measures nothing again that its file has."""

import json
import subprocess
import tempfile
from pathlib import Path

TOOL = Path(__file__).resolve().parents[3] / "tools" / "measure_peers.py"
FOUND = {"all_poses_seconds": 2, "every_pose": 1, "false_hits": 0, "misses": 0,
         "colliding_points": 5, "prepare_seconds": 0.5}
SEARCH = f"""echo prepared >&2
read line
mkdir "$0.searching" || exit 9
sleep 0.1
rmdir "$0.searching"
echo '{json.dumps(FOUND)}'
"""


def program(folder, name, text):
    path = folder / name
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(0o755)


def measured(folder, *options):
    done = subprocess.run([TOOL, folder, "--scene", "hall", "--env", "e", "--model", "m",
                           "--trajectory", "t", "-o", folder / "peers.json", "--threads", "2",
                           *options], capture_output=True, text=True, check=True)
    return done, json.loads((folder / "peers.json").read_text())


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program(folder, "clearway", "echo 0.2.0\n")
        # All that searches is one program, which fails if two of it search at the same time.
        program(folder, "search", SEARCH)
        for peer in ("nanoflann", "octomap"):
            program(folder, f"peer_{peer}", f'exec "{folder}/search"\n')
        program(folder, "peer_cgal", "echo 'error: no room' >&2\nexit 1\n")
        program(folder, "peer_pcl", "exec sleep 60\n")
        done, record = measured(folder, "--together", "8", "--patience", "3",
                                "--cells", "0.1,0.05")
        assert "peer_open3d: not built" in done.stderr, done.stderr
        assert record["experiment"] == "peers" and record["clearway"] == {"version": "0.2.0"}
        cases = {case["key"]: case for case in record["cases"]}
        assert list(cases) == ["hall/nanoflann/2 threads", "hall/cgal/2 threads",
                               "hall/pcl/2 threads", "hall/octomap 0.1 m/2 threads",
                               "hall/octomap 0.05 m/2 threads"], list(cases)
        assert cases["hall/nanoflann/2 threads"]["findings"] == FOUND
        assert cases["hall/octomap 0.05 m/2 threads"]["parameters"]["cell"] == 0.05
        assert cases["hall/octomap 0.05 m/2 threads"]["findings"] == FOUND
        assert cases["hall/cgal/2 threads"]["failed"] == {"exit_code": 1,
                                                          "log": "error: no room"}
        assert cases["hall/pcl/2 threads"]["failed"]["limit"] == 3
        for peer in ("nanoflann", "cgal", "pcl", "octomap"):
            program(folder, f"peer_{peer}", "exit 7\n")
        _, again = measured(folder, "--cells", "0.1,0.05")
        assert again == record


main()
