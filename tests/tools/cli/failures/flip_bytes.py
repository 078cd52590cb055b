"""Flips bytes of a store, a result and journals, one at a time, and lets commands answer with them:
never another answer with exit code 0, and `verify` finds what they refuse.

flip_bytes.py PROGRAM [--tries N]

--tries: how many bytes of each file, spread over the whole of it.
"""

import argparse
import collections
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import Place  # noqa: E402

JOURNAL_BYTES = 1500


def flip(place, name, words, output, refusals, tries):
    """Tries the bytes of a file, which is put back. Returns how often the command refused."""
    file, made = place / name, place / output
    data = file.read_bytes()
    place.ask(words)
    expected = made.read_bytes()
    counts = collections.Counter()
    step = max(1, len(data) // tries)
    for i in range(min(tries, len(data))):
        at = i * step + i % step
        made.unlink(missing_ok=True)
        (place / "out.journal").unlink(missing_ok=True)  # of what came before the damage
        file.write_bytes(data[:at] + bytes([data[at] ^ (1 << at % 8)]) + data[at + 1:])
        codes = []
        for command in (f"verify {name}", words):
            process = place.start(command)
            said = process.communicate()[0]
            codes.append(process.returncode)
        what = f"{words}, byte {at}: {codes}: {said}"
        if codes[1] == 0:
            assert codes[0] in (0, 1) and made.read_bytes() == expected, what
        else:
            assert codes[0] == 1 and codes[1] in refusals and name in said and not made.exists(), what
        counts[tuple(codes)] += 1
    file.write_bytes(data)
    made.unlink(missing_ok=True)
    print(f"{words}, {len(data)} bytes: " + ", ".join(
        f"verify {a} and command {b}: {n}" for (a, b), n in sorted(counts.items())), flush=True)
    return sum(n for codes, n in counts.items() if codes[1])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--tries", type=int, default=60)
    tries = parser.parse_args().tries
    with tempfile.TemporaryDirectory() as folder:
        place = Place(folder)
        place.make_hall(12000, 200, 100)
        for engine, options in (("sweep", "--first-pose"), ("grid", ""), ("kdtree", "")):
            run = (f"run --model model.ply --trajectory trajectory.txt --radius 0.1 --device cpu --threads 1 "
                   f"--engine {engine} {options} -o out")
            # What a run leaves that may not write more than so many bytes to a file.
            place.ask(f"{run} --env site.h5 --journal-interval 0", 4, under=["prlimit", f"--fsize={JOURNAL_BYTES}"])
            [journal] = place.bytes("out.journal")
            (place / "out.journal").unlink()
            refused = flip(place, "site.h5", f"{run} --env site.h5", "out", [3], tries)
            assert refused > tries / 10, f"{refused} refused"
            assert len(journal) > JOURNAL_BYTES / 2, f"a journal of {len(journal)} bytes"
            (place / "out.journal").write_bytes(journal)
            # 2: it is no journal any more
            flip(place, "out.journal", f"{run} --env site.h5 --resume", "out", [2, 3], tries)
            (place / "out.journal").unlink()
        place.ask("run --env site.h5 --model model.ply --trajectory trajectory.txt --radius 0.1 --first-pose "
                  "-o result.h5")
        flip(place, "result.h5", "export result.h5 -o out.csv", "out.csv", [3], tries)


main()
