#!/usr/bin/env python3
"""Prints crs_cases.tsv: coordinate reference systems, and what PROJ says of them.

    python3 tests/io/scans/crs_cases.py > tests/io/scans/crs_cases.tsv

It was run with pyproj 3.4.1 and PROJ 9.1.1 of Debian 12. Columns: name; metres per unit of easting
and northing, or "degrees"; metres per unit of heights, 0 where there are none; easting and northing
of a place; the scale of the map there along the axis of Tissot's ellipse that is farther from 1, and
the root of the areal scale, 0 where the system is no map; the text.
"""

import json
import math
import warnings

from pyproj import CRS, Proj, Transformer

warnings.filterwarnings("ignore")
DEGREE = math.pi / 180
US_FOOT = 1200 / 3937


def without_usage(wkt):
    """Well-known text without its areas of use, which are long."""
    while ",USAGE[" in wkt:
        begin = wkt.index(",USAGE[")
        depth, end = 0, begin
        while True:
            depth += {"[": 1, "]": -1}.get(wkt[end], 0)
            end += 1
            if depth == 0 and wkt[end - 1] == "]":
                break
        wkt = wkt[:begin] + wkt[end:]
    return wkt


def wkt(crs, version):
    return without_usage(CRS.from_user_input(crs).to_wkt(version, pretty=False))


def projjson(crs):
    text = json.loads(CRS.from_user_input(crs).to_json())
    for key in ("scope", "area", "bbox"):
        text.pop(key, None)
    return json.dumps(text)


def plane_of(crs):
    while crs.is_bound or crs.is_compound:
        crs = crs.source_crs if crs.is_bound else crs.sub_crs_list[0]
    return crs


def map_of(crs):
    """The projected system under a derived one."""
    while crs.source_crs is not None and not crs.source_crs.is_geographic:
        crs = crs.source_crs
    return crs


def heights_of(crs):
    crs = crs.source_crs if crs.is_bound else crs
    if not crs.is_compound:
        axes = plane_of(crs).axis_info
        return axes[2].unit_conversion_factor if len(axes) > 2 else 0
    vertical = crs.sub_crs_list[1]
    return plane_of(vertical).axis_info[0].unit_conversion_factor


def row(name, text, place=None, read=None, heights=None, unit=None, factors=None):
    """place: longitude from the map's own meridian and latitude, degrees. read: what PROJ reads as a
    whole, where this is not the text. The others take the place of what pyproj says."""
    crs = CRS.from_user_input(read or text)
    plane = plane_of(crs)
    axis = plane.axis_info[0]
    if unit is None:
        unit = "degrees" if axis.unit_name.lower() in ("degree", "grad") else axis.unit_conversion_factor
    x = y = farthest = mean = 0
    if place:
        projected = map_of(plane)
        base = projected.geodetic_crs
        angle = base.axis_info[0].unit_conversion_factor
        x, y = Transformer.from_crs(base, plane, always_xy=True).transform(
            *(value * DEGREE / angle for value in place))[:2]
        meridian = base.prime_meridian
        east = meridian.longitude * meridian.unit_conversion_factor / DEGREE
        if factors is None:
            found = Proj(projected).get_factors(place[0] + east, place[1])
            factors = (found.tissot_semimajor, found.tissot_semiminor, found.areal_scale)
        farthest = max(factors[:2], key=lambda scale: abs(scale - 1))
        mean = math.sqrt(factors[2])
    print(name, unit, heights_of(crs) if heights is None else heights, f"{x:.3f}", f"{y:.3f}",
          f"{farthest:.10g}", f"{mean:.10g}", text, sep="\t")


GDAL, ESRI, WKT_2015, WKT_2019 = "WKT1_GDAL", "WKT1_ESRI", "WKT2_2015", "WKT2_2019"
row("projected, WKT 1", wkt(25832, GDAL), (11, 48))
row("projected, ESRI", wkt(26917, ESRI), (-80, 37))
row("projected, WKT 2 of 2015", wkt(32633, WKT_2015), (14, 52))
row("projected, WKT 2 of 2019, oblique", wkt(2056, WKT_2019), (8.5, 47.3))
row("projected, PROJJSON", projjson(27700), (-1.5, 53))
row("projected, EPSG code", "EPSG:31370", (4.4, 50.8))
row("projected, URN", "urn:ogc:def:crs:EPSG::2154", (2.3, 48.8))
row("projected, address", "http://www.opengis.net/def/crs/EPSG/0/25832", (11, 48))
row("projected, code of another authority", "IGNF:LAMB93", (2.3, 48.8))
row("projected, name", "ETRS89 / UTM zone 33N", (15, 50), read="EPSG:25833")
row("projected, PROJ string", "+proj=utm +zone=32 +ellps=GRS80", (10, 45))
row("US survey feet over metres, PROJ string",
    "+proj=utm +zone=10 +ellps=GRS80 +units=us-ft +vunits=m +type=crs", (-122, 44))
row("feet, PROJ string with a factor",
    "+proj=tmerc +lon_0=9 +k_0=0.9999 +ellps=GRS80 +to_meter=0.3048 +type=crs", (9.5, 45))
row("US survey feet, WKT 1", wkt(2227, GDAL), (-122, 37.5))
row("US survey feet, ESRI", wkt(2277, ESRI), (-98, 30.3))
row("US survey feet, WKT 2", wkt(2903, WKT_2019), (-106.2, 35))
row("US survey feet, PROJJSON", projjson(2903), (-106.2, 35))
row("international feet, WKT 1", wkt(2992, GDAL), (-123, 44.05))
row("Clarke's feet", wkt(2314, WKT_2019), (-61.2, 10.4))
# pyproj takes the sphere for this projection; these are proj_factors() of the system itself.
WEB_MERCATOR = (1.49621266184, 1.49171140208, 2.2319174876)
row("web Mercator, WKT 1 with a PROJ string", wkt(3857, GDAL), (11, 48), factors=WEB_MERCATOR)
row("web Mercator, WKT 2", wkt(3857, WKT_2019), (11, 48), factors=WEB_MERCATOR)
row("world Mercator", wkt(3395, GDAL), (10, 60))
row("UTM far outside of its zone", wkt(32632, GDAL), (30, 48))
row("polar stereographic", wkt(3031, GDAL), (60, -75))
row("Krovak", wkt(5514, WKT_2019), (14.4, 50.1))
row("Albers", wkt(5070, GDAL), (-96, 40))
row("Lambert azimuthal", wkt(3035, WKT_2019), (11, 52))
row("from the meridian of Paris, in grads", "EPSG:27561", (1.5, 49.5))
row("northing first", wkt(2193, WKT_2019), (174.8, -41.3))
row("northing first, Gauss and Krueger", wkt(31467, WKT_2019), (9.5, 50))
row("westing and southing", "EPSG:2053", (29.5, -26))
row("compound, WKT 1, feet over metres", wkt("EPSG:26917+6360", GDAL), (-80, 37))
row("compound, WKT 2", wkt("EPSG:25832+5783", WKT_2019), (11, 48))
row("compound, codes", "EPSG:26910+5703", (-122, 44))
row("compound, codes, feet over metres", "EPSG:26910+8228", (-122, 44))
row("compound, one code", "EPSG:5555", (11, 48))

PLANE = wkt(26917, GDAL)
HEIGHTS = ('VERT_CS["heights",VERT_DATUM["d",2005],UNIT["US survey foot",0.3048006096012192],'
           'AXIS["Up",UP]]')
ESRI_HEIGHTS = ('VERTCS["h",VDATUM["d"],PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",1.0],'
                'UNIT["Foot_US",0.3048006096012192]]')
for name, text in (
    ("after the closing bracket", f"{PLANE},{HEIGHTS}"),
    ("after one bracket too many", f"{PLANE}],{HEIGHTS}"),
    ("between brackets too many", f"{PLANE} {HEIGHTS}]]"),
    ("before the plane", f"{HEIGHTS},{PLANE}"),
    ("within the projected system", f"{PLANE[:-1]},{HEIGHTS}]"),
    ("of ESRI in a compound system", f'COMPD_CS["c",{PLANE},{ESRI_HEIGHTS}]'),
    ("with the wrong length of their unit",
     f"{PLANE}," + HEIGHTS.replace("0.3048006096012192", "1.0")),
):
    row(f"heights in feet {name}", text, (-80, 37), read=PLANE, heights=US_FOOT)
row("heights in feet, ESRI, after the plane", wkt("EPSG:26917+6360", ESRI), (-80, 37))
row("heights in feet, ESRI, alone", ESRI_HEIGHTS, read=PLANE, unit=0, heights=US_FOOT)
row("heights by a grid", f'COMPD_CS["c",{wkt(2992, GDAL)},VERT_CS["NAVD88",VERT_DATUM["d",2005,'
    'EXTENSION["PROJ4_GRIDS","g2012a_conus.gtx"]],UNIT["foot",0.3048],AXIS["Up",UP]]]',
    (-123, 44.05))
THREE = wkt(32632, WKT_2019)
END = THREE.rindex("]],ID[") + 2 if "]],ID[" in THREE else len(THREE) - 1
row("three axes, the third in feet",
    THREE[:END].replace("CS[Cartesian,2]", "CS[Cartesian,3]") +
    ',AXIS["up (h)",up,ORDER[3],LENGTHUNIT["foot",0.3048]]]', (11, 48))
BESSEL = ("+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=3500000 +y_0=0 +ellps=bessel "
          "+towgs84=598.1,73.7,418.2,0.202,0.045,-2.455,6.7 +units=m +type=crs")
row("bound, WKT 2", wkt(BESSEL, WKT_2019), (9.5, 50))
row("bound, WKT 1", wkt(BESSEL, GDAL), (9.5, 50))
BASE = ('BASEPROJCRS["WGS 84 / UTM zone 32N",BASEGEOGCRS["WGS 84",'
        'DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563,'
        'LENGTHUNIT["metre",1]]],PRIMEM["Greenwich",0,ANGLEUNIT["degree",0.0174532925199433]]],'
        'CONVERSION["UTM zone 32N",METHOD["Transverse Mercator",ID["EPSG",9807]],'
        'PARAMETER["Latitude of natural origin",0,ANGLEUNIT["degree",0.0174532925199433],'
        'ID["EPSG",8801]],PARAMETER["Longitude of natural origin",9,'
        'ANGLEUNIT["degree",0.0174532925199433],ID["EPSG",8802]],'
        'PARAMETER["Scale factor at natural origin",0.9996,SCALEUNIT["unity",1],ID["EPSG",8805]],'
        'PARAMETER["False easting",500000,LENGTHUNIT["metre",1],ID["EPSG",8806]],'
        'PARAMETER["False northing",0,LENGTHUNIT["metre",1],ID["EPSG",8807]]]]')


def derived(scale, factors=None):
    coefficients = (("A0", 8623, -600000), ("A1", 8624, scale), ("A2", 8625, 0),
                    ("B0", 8639, -5000000), ("B1", 8640, 0), ("B2", 8641, scale))
    parameters = ",".join(
        f'PARAMETER["{name}",{value},'
        + ('LENGTHUNIT["metre",1]' if name[1] == "0" else 'SCALEUNIT["coefficient",1]')
        + f',ID["EPSG",{code}]]' for name, code, value in coefficients)
    row(f"derived from a projected one, times {scale}",
        f'DERIVEDPROJCRS["site",{BASE},DERIVINGCONVERSION["shift",METHOD['
        f'"Affine parametric transformation",ID["EPSG",9624]],{parameters}],CS[Cartesian,2],'
        'AXIS["(E)",east,ORDER[1],LENGTHUNIT["metre",1]],'
        'AXIS["(N)",north,ORDER[2],LENGTHUNIT["metre",1]]]', (10.2, 47), factors=factors)


derived(1)
# The scale of the base, 0.9997022845766084, times that of the derivation.
derived(1.0004, (0.9997022845766084 * 1.0004,) * 2 + (0.9997022845766084**2 * 1.0004**2,))
row("geographic, WKT 1", wkt(4326, GDAL))
row("geographic, three axes", "EPSG:4979")
row("geographic, heights in feet", wkt("EPSG:4269+8228", WKT_2019))
row("geocentric, code", "EPSG:4978")
row("geocentric, WKT 1", wkt(4978, GDAL))
row("local, metres", 'LOCAL_CS["site",UNIT["metre",1]]')
row("local, feet", 'LOCAL_CS["site",UNIT["foot",0.3048]]')
row("local, without a unit", 'LOCAL_CS["site"]', unit=0)
row("local, heights in feet",
    'COMPD_CS["c",LOCAL_CS["l",UNIT["metre",1]],VERT_CS["v",VERT_DATUM["d",2005],'
    'UNIT["foot",0.3048],AXIS["Up",UP]]]')
row("local, three axes, the third in feet",
    'ENGCRS["a",EDATUM["x"],CS[Cartesian,3],AXIS["x",east,LENGTHUNIT["metre",1]],'
    'AXIS["y",north,LENGTHUNIT["metre",1]],AXIS["z",up,LENGTHUNIT["foot",0.3048]]]')
