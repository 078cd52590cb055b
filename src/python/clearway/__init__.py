"""Clearway: which points of a scanned environment lie within the search radius of a moving model?

    import clearway

    clearway.convert("scan.las", "site.h5")
    store = clearway.Store("site.h5")
    query = clearway.Query(clearway.read_model("car.ply"), clearway.read_trajectory("path.txt"), 0.1)
    report = clearway.search(store, query, "out.h5")
    print(report, report.warnings)
    points = clearway.Result("out.h5").xyz()

Lengths are in metres, unless the scans are in feet. Points are arrays of n x 3 float64.
Poses are arrays of n x 4 x 4 float64.
"""

from ._clearway import *  # noqa: F403
from ._clearway import __version__  # noqa: F401
