"""Clearway: does this vehicle pass through this scanned environment without touching it?

    import clearway

    clearway.convert("scan.las", "site.h5")
    store = clearway.Store("site.h5")
    query = clearway.Query(clearway.read_model("car.ply"), clearway.read_trajectory("path.txt"), 0.1)
    report = clearway.search(store, query, "out.h5")
    print(report, report.warnings)
    points = clearway.Result("out.h5").xyz()

Points are arrays of n x 3 float64, poses arrays of n x 4 x 4 float64.
Lengths are in metres, or in the unit of the scans where that is another one.
"""

from ._clearway import (
    METRES_PER_CENTIMETRE,
    METRES_PER_FOOT,
    METRES_PER_INCH,
    METRES_PER_MILLIMETRE,
    Body,
    Box,
    Clearances,
    Conflict,
    Conflicts,
    ConvertReport,
    DeviceEstimate,
    EngineEstimate,
    Error,
    FoundPlace,
    IgnoredPointCounts,
    InputError,
    Interrupted,
    MergeReport,
    Message,
    ModelShape,
    PartWarning,
    PoseLabels,
    Profile,
    ProgressUpdate,
    Query,
    QueryParameters,
    ReportSummary,
    ResourceError,
    Result,
    SearchReport,
    SearchSeconds,
    Store,
    ToleranceReport,
    UsageError,
    __version__,
    convert,
    find_conflicts,
    follow,
    merge,
    read_model,
    read_model_shape,
    read_trajectory,
    read_vehicle,
    search,
    write_report,
)

__all__ = [name for name in dir() if not name.startswith("_")]

for _name in __all__:
    if hasattr(globals()[_name], "__module__"):
        globals()[_name].__module__ = __name__  # not that of the compiled part
del _name
