"""Clearway: does this vehicle pass through this scanned environment without touching it?

    import clearway

    clearway.convert("scan.las", "site.h5")
    store = clearway.Store("site.h5")
    model = clearway.read_model("car.ply")
    query = clearway.Query(model, clearway.read_trajectory("path.txt"), radius=0.1, first_pose=True)
    report = clearway.search(store, query, "out.h5")
    print(report, report.warnings)
    points = clearway.Result("out.h5").xyz()

Points are arrays of n x 3 float64, poses arrays of n x 4 x 4 float64.
Lengths are in metres, or in the unit of the scans where that is another one.
METRES_PER_FOOT and its siblings are the metres of other units, for arguments such as unit.
"""

from ._arguments import check_class as _check_class, checked as _checked
from ._clearway import *
from ._clearway import __version__

__all__ = [name for name in dir() if not name.startswith("_")]

for _name in __all__:
    _value = globals()[_name]
    if isinstance(_value, type):
        if not issubclass(_value, Exception):
            _check_class(_value)
    elif callable(_value):
        _value = globals()[_name] = _checked(_name, _value)
    if hasattr(_value, "__module__"):
        _value.__module__ = __name__  # not that of the compiled part
del _name, _value
