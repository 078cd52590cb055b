#!/usr/bin/env python3
"""Prints crs_cases.tsv again, with what PROJ says of the texts in it: coordinate reference systems.

    python3 tests/io/scans/crs_cases.py > new.tsv

It was run with pyproj 3.4.1 and PROJ 9.1.1 of Debian 12. Columns: name; metres per unit of easting
and northing, or "degrees"; metres per unit of heights, 0 where there are none; easting and northing
of a place; the scale of the map there along the axis of Tissot's ellipse that is farther from 1, and
the root of the areal scale, 0 where the system is no map; the text. Only the name, the place and the
text of a new row are needed. Scales differ by up to 2e-8 with the last digits of the place, because
PROJ differentiates numerically.
"""

import math
import warnings
from pathlib import Path

from pyproj import CRS, Proj, Transformer

warnings.filterwarnings("ignore")
DEGREE = math.pi / 180
US_FOOT = 1200 / 3937
# pyproj takes the sphere for this projection; these are proj_factors() of the system itself.
WEB_MERCATOR = (1.49621266184, 1.49171140208, 2.2319174876)
# The scale of the base, 0.9997022845766084, times that of the derivation
DERIVED = (0.9997022845766084 * 1.0004,) * 2 + (0.9997022845766084**2 * 1.0004**2,)
# By the beginning of the name: what PROJ reads where it does not read the text as a whole, and what
# takes the place of what pyproj says of the unit, of heights and of the map's scale
OTHERWISE = {
    "projected, name": {"read": "EPSG:25833"},
    "web Mercator": {"factors": WEB_MERCATOR},
    "heights in feet, ESRI, alone": {"read": "EPSG:26917", "unit": 0, "heights": US_FOOT},
    "heights in feet, ESRI, after": {},
    "heights in feet": {"read": "EPSG:26917", "heights": US_FOOT},
    "derived from a projected one, times 1.0004": {"factors": DERIVED},
    "local, without a unit": {"unit": 0},
}


def plane_of(crs):
    while crs.is_bound or crs.is_compound:
        crs = crs.source_crs if crs.is_bound else crs.sub_crs_list[0]
    return crs


def heights_of(crs):
    crs = crs.source_crs if crs.is_bound else crs
    if crs.is_compound:
        return plane_of(crs.sub_crs_list[1]).axis_info[0].unit_conversion_factor
    axes = plane_of(crs).axis_info
    return axes[2].unit_conversion_factor if len(axes) > 2 else 0


def scale_of(plane, x, y, factors):
    projected = plane  # the projected system under a derived one
    while projected.source_crs is not None and not projected.source_crs.is_geographic:
        projected = projected.source_crs
    base = projected.geodetic_crs
    degrees = base.axis_info[0].unit_conversion_factor / DEGREE
    meridian = base.prime_meridian
    east = meridian.longitude * meridian.unit_conversion_factor / DEGREE
    longitude, latitude = Transformer.from_crs(plane, base, always_xy=True).transform(x, y)[:2]
    if factors is None:
        found = Proj(projected).get_factors(longitude * degrees + east, latitude * degrees)
        factors = (found.tissot_semimajor, found.tissot_semiminor, found.areal_scale)
    return max(factors[:2], key=lambda scale: abs(scale - 1)), math.sqrt(factors[2])


for line in (Path(__file__).parent / "crs_cases.tsv").read_text().splitlines():
    name, _, _, x, y, _, _, text = line.split("\t")
    other = next((value for key, value in OTHERWISE.items() if name.startswith(key)), {})
    crs = CRS.from_user_input(other.get("read", text))
    axis = plane_of(crs).axis_info[0]
    degrees = axis.unit_name.lower() in ("degree", "grad")
    unit = other.get("unit", "degrees" if degrees else axis.unit_conversion_factor)
    scale = (0, 0)
    if (x, y) != ("0.000", "0.000"):
        scale = scale_of(plane_of(crs), float(x), float(y), other.get("factors"))
    print(name, unit, other.get("heights", heights_of(crs)), x, y, *(f"{s:.10g}" for s in scale),
          text, sep="\t")
