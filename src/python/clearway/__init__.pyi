from collections.abc import Callable, Iterable, Sequence
from os import PathLike
from pathlib import Path as _Path
from typing import Any, ClassVar, Final, Literal, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

_AnyPath = str | bytes | PathLike[str] | PathLike[bytes]
_Doubles = NDArray[np.float64]
_Sources = NDArray[np.uint64]
_Poses = NDArray[np.uint32]
_Flags = NDArray[np.bool_]
_Axis = Literal["+x", "x", "-x", "+y", "y", "-y", "+z", "z", "-z"]
_Progress = Callable[["ProgressUpdate"], Any]
_Tell = Callable[["Message"], Any]
class _Stop(Protocol):
    def is_set(self) -> bool: ...
__version__: str
METRES_PER_MILLIMETRE: float
METRES_PER_CENTIMETRE: float
METRES_PER_INCH: float
METRES_PER_FOOT: float
METRES_PER_US_SURVEY_FOOT: float
class Error(Exception):
    remedy: str | None
    amount: float

class UsageError(Error, ValueError): ...
class InputError(Error): ...
class ResourceError(Error): ...
class Interrupted(Error): ...
class Message:
    severity: Final[Literal["note", "warning"]]
    code: Final[str]
    text: Final[str]
    numbers: Final[dict[str, float]]
    body: Final[str]
    stretches: Final[list[tuple[int, int]]]
class ProgressUpdate:
    stage: Final[str]
    done: Final[int]
    total: Final[int]
    unit: Final[str]
    finished: Final[bool]

class Box:
    def __init__(self, lo: ArrayLike, hi: ArrayLike) -> None: ...
    lo: Final[_Doubles]
    hi: Final[_Doubles]
class FoundPlace:
    source: Final[int]
    pose: Final[int]
    xyz: Final[_Doubles]
    distance: Final[float]
class PoseLabels:
    def __init__(self) -> None: ...
    time: Final[_Doubles]
    station: Final[_Doubles]
    name: Final[list[str]]

class OriginsPathReport:
    point_clock: Final[str]
    path_clock: Final[str]
    first_point: Final[float]
    last_point: Final[float]
    first_pose: Final[float]
    last_pose: Final[float]
    shifts: Final[list[float]]
    before: Final[int]
    after: Final[int]
    in_gaps: Final[int]
    without_time: Final[int]

class ConvertReport:
    was_finished: Final[bool]
    points: Final[int]
    cells: Final[int]
    non_finite_points: Final[int]
    absent_points: Final[int]
    withheld_points: Final[int]
    kept_withheld_points: Final[int]
    origins: Final[int]
    points_without_origin: Final[int]
    origins_path: Final[OriginsPathReport | None]
    scale: Final[_Doubles]
    offset: Final[_Doubles]
    box: Final[Box | None]
    largest_change: Final[float]
    temporary_bytes: Final[int]
    output_bytes: Final[int]
    count_seconds: Final[float]
    distribute_seconds: Final[float]
    partition_seconds: Final[float]
    confirm_seconds: Final[float]
    busy_seconds: Final[dict[str, float]]
    warnings: Final[list[Message]]

class Store:
    def __init__(self, path: _AnyPath) -> None: ...
    def point_count(self) -> int: ...
    def cell_count(self) -> int: ...
    def box(self) -> Box: ...
    def crs_wkt(self) -> str: ...
    def class_points(self) -> dict[int, int]: ...
    def has_origins(self) -> bool: ...
    def length_unit(self) -> str: ...
    def metres_per_unit(self) -> float: ...
    def warnings(self) -> list[Message]: ...
    path: Final[_Path]

class Model:
    vertices: Final[_Doubles]
    triangles: Final[_Poses]
    solid_of: Final[_Poses]
    NO_SOLID: ClassVar[int]
    spacing: Final[float]
    file_axes: Final[tuple[str, str]]
    def __init__(
        self, vertices: ArrayLike, triangles: ArrayLike = ..., spacing: float = 0.0,
    ) -> None: ...
class Body:
    name: Final[str]
    model: Final[_Doubles | Model]
    poses: Final[_Doubles]
    path_pose: Final[_Poses]
    def __init__(
        self, name: str, model: ArrayLike | Model, poses: ArrayLike,
        path_pose: ArrayLike | None = None,
    ) -> None: ...
def follow(
    name: str, model: ArrayLike | Model, path: ArrayLike, *, at: float | None = None,
    pivots: tuple[float, float] | None = None, towed_by: Body | Literal["path"] | None = None,
    messages: list[Message] | None = None,
) -> Body: ...

class UnsearchedStretch:
    first_pose: Final[int]
    last_pose: Final[int]
    chainage_from: Final[float]
    chainage_to: Final[float]
    bodies: Final[list[int]]
    has_answer: Final[bool]
def unsearched_stretches(path: ArrayLike, bodies: Sequence[Body]) -> list[UnsearchedStretch]: ...

class Query:
    model: Any  # any array or a Model is taken, and float64 or a Model given
    poses: Any
    radius: float
    first_pose: bool
    between_poses: bool
    clearance: float
    profile: float
    seen: bool
    seen_cube: float
    seen_min: int
    ignore_classes: list[int]
    ignore_boxes: list[Box]
    allow_non_rigid: bool
    bodies: list[Body]
    error_scan: float | None
    error_registration: float | None
    error_pose: float | None
    error_angle: float | None
    error_model: float | None
    sigmas: float
    gap: float
    def __init__(
        self, model: ArrayLike | Model = ..., poses: ArrayLike = ..., radius: float | None = None, *,
        first_pose: bool = False, between_poses: bool = False, clearance: float = 0.0,
        profile: float = 0.0, ignore_classes: Sequence[int] = ...,
        ignore_boxes: Sequence[Box] = ..., allow_non_rigid: bool = False,
        bodies: Sequence[Body] = ..., error_scan: float | None = None,
        error_registration: float | None = None, error_pose: float | None = None,
        error_angle: float | None = None, error_model: float | None = None, sigmas: float = 3.0,
        gap: float = 0.0,
        seen: bool = False, seen_cube: float = 0.0, seen_min: int = 8,
    ) -> None: ...
class QueryParameters:
    radius: Final[float]
    first_pose: Final[bool]
    between_poses: Final[bool]
    clearance: Final[float]
    profile: Final[float]
    seen: Final[bool]
    seen_cube: Final[float]
    seen_min: Final[int]
    ignore_classes: Final[list[int]]
    ignore_boxes: Final[list[Box]]
    error_scan: Final[float | None]
    error_registration: Final[float | None]
    error_pose: Final[float | None]
    error_angle: Final[float | None]
    error_model: Final[float | None]
    sigmas: Final[float]
    gap: Final[float]
class IgnoredPointCounts:
    points: Final[int]
    of_classes: Final[list[int]]
    in_boxes: Final[list[int]]
class SearchSeconds:
    total: Final[float]
    context: Final[float]
    context_wait: Final[float]
    check: Final[float]
    ignored: Final[float]
    field: Final[float]
    plan: Final[float]
    engine: Final[float]
    search: Final[float]
    read: Final[float]
    upload: Final[float]
    compute: Final[float]
    collect: Final[float]
    swept: Final[float]
    beams: Final[float]
    write: Final[float]
    end_wait: Final[float]
class DeviceEstimate:
    cpu: Final[float]
    cuda: Final[float]
class SearchedLength:
    path: Final[float]
    whole: Final[float]
    part: Final[float]

class SeenSummary:
    cube: Final[float]
    swept: Final[int]
    seen: Final[int]
    unseen: Final[int]
    groups: Final[int]
    listed_groups: Final[int]
    listed_cubes: Final[int]
    not_scanned_length: Final[float]
class Answer:
    verdict: Final[Literal["clear", "conflict", "undecided", "unknown"]]
    reasons: Final[list[str]]
    margins: Final[dict[str, float] | None]
    near_points: Final[int]
    certain_points: Final[int]
    seen: Final[SeenSummary | None]
    warnings: Final[list[Message]]
    doubts: Final[list[str]]
    warned_of: Final[list[str]]
    parameters: Final[QueryParameters]
    environment_points: Final[int]
    model_points: Final[int]
    poses: Final[int]
    model_solids: Final[int]
    model_spacing: Final[float]
    colliding_points: Final[int]
    inside_points: Final[int]
    clearance_points: Final[int]
    profile_poses: Final[int]
    ignored: Final[IgnoredPointCounts]
    ignored_colliding: Final[int | None]
    ignored_colliding_high: Final[int | None]
    first_place: Final[FoundPlace | None]
    least_clearance: Final[FoundPlace | None]
    least_profile: Final[FoundPlace | None]
    first: Final[FoundPlace | None]
    least: Final[FoundPlace | None]
    searched: Final[SearchedLength | None]
    shard: Final[tuple[int, int] | None]
class SearchReport(Answer):
    was_finished: Final[bool]
    model_triangles: Final[int]
    ignored_looked_at: Final[int]
    engine: Final[str]
    device: Final[str]
    device_name: Final[str]
    estimate: Final[DeviceEstimate | None]
    shard_share: Final[float | None]
    searches: Final[int]
    cells_total: Final[int]
    cells_read: Final[int]
    bytes_read: Final[int]
    resumed_cells: Final[int]
    resumed_poses: Final[int]
    pages: Final[int]
    page_bytes: Final[int]
    slots: Final[int]
    needed_host_bytes: Final[int]
    pinned_bytes: Final[int]
    peak_device_bytes: Final[int]
    seconds: Final[SearchSeconds]
class PartWarning(Message):
    parts: Final[int]

class MergeReport(Answer):
    was_finished: Final[bool]
    length_unit: Final[str]
    parts: Final[int]
    warnings: Final[list[PartWarning]]

class UnseenCubes:
    cube: Final[NDArray[np.int32]]
    first_pose: Final[_Poses]
    group: Final[_Poses]
    def __len__(self) -> int: ...
class Collisions:
    source: Final[_Sources]
    xyz: Final[_Doubles]
    first_pose: Final[_Poses | None]
    last_pose: Final[_Poses | None]
    body: Final[_Poses | None]
    certain: Final[_Flags | None]
    def __len__(self) -> int: ...
class Clearances:
    source: Final[_Sources]
    xyz: Final[_Doubles]
    distance: Final[_Doubles]
    pose: Final[_Poses]
    body: Final[_Poses]
    def __len__(self) -> int: ...
class Profile:
    NO_POINT: ClassVar[int]
    distance: Final[_Doubles]
    source: Final[_Sources]
    xyz: Final[_Doubles]
    chainage: Final[_Doubles]
    def __len__(self) -> int: ...

class Result:
    def __init__(self, path: _AnyPath) -> None: ...
    def size(self) -> int: ...
    def __len__(self) -> int: ...
    def parameters(self) -> QueryParameters: ...
    def environment_points(self) -> int: ...
    def ignored(self) -> IgnoredPointCounts: ...
    def poses(self) -> int: ...
    def answer(self) -> Answer: ...
    def warnings(self) -> list[Message]: ...
    def collisions(self) -> Collisions: ...
    def source(self) -> _Sources: ...
    def xyz(self) -> _Doubles: ...
    def first_pose(self) -> _Poses | None: ...
    def last_pose(self) -> _Poses | None: ...
    def bodies(self) -> list[str]: ...
    def first_body(self) -> _Poses | None: ...
    def near(self) -> Collisions | None: ...
    def unseen(self) -> UnseenCubes | None: ...
    def clearance(self) -> Clearances | None: ...
    def profile(self) -> Profile | None: ...
    def model_spacing(self) -> float: ...
    def model_axes(self) -> tuple[str, str]: ...
    def model_box(self) -> Box | None: ...
class SessionAnswer(SearchReport):
    collisions: Final[Collisions]
    near: Final[Collisions | None]
    clearances: Final[Clearances | None]
    profile: Final[Profile | None]
    unseen: Final[UnseenCubes | None]
    def save(self, path: _AnyPath, overwrite: bool = False) -> None: ...
class Session:
    def __init__(
        self, path: _AnyPath, device: Literal["auto", "cpu", "cuda"] = "auto", threads: int = 0,
        memory_bytes: int = 4294967296, device_memory_bytes: int = 0, gpus: Sequence[int] = (),
    ) -> None: ...
    store: Final[Store]
    closed: Final[bool]
    def search(
        self, query: Query, *, engine: Literal["auto", "sweep", "grid", "kdtree"] = "auto",
        strict: bool = False, input_warnings: Iterable[Message] = (), model_is_cut: bool = False,
        progress: _Progress | None = None, message: _Tell | None = None, stop: _Stop | None = None,
    ) -> SessionAnswer: ...
    def forget_models(self) -> None: ...
    def kept_bytes(self) -> int: ...
    def close(self) -> None: ...
    def __enter__(self) -> Self: ...
    def __exit__(self, *raised: object) -> None: ...
class Conflict:
    id: Final[int]
    points: Final[int]
    source: Final[int]
    box: Final[Box]
    centroid: Final[_Doubles]
    body: Final[int | None]
    first_pose: Final[int]
    last_pose: Final[int]
    chainage_from: Final[float]
    chainage_to: Final[float]
    station_from: Final[float | None]
    station_to: Final[float | None]
    certain: Final[bool | None]
    obstacle_chainage: Final[float | None]
    shift_left: Final[float | None]
    shift_right: Final[float | None]
    least_distance: Final[float | None]
    nearest_pose: Final[int | None]
    nearest_source: Final[int | None]
    encroachment: Final[float | None]
    depth: Final[float | None]
    points_inside: Final[int | None]
    nearest_point: Final[_Doubles | None]
    side: Final[str]
    lateral: Final[float | None]
    height: Final[float | None]
    group: Final[int]
class SmallGroup:
    points: Final[int]
    source: Final[int]
    box: Final[Box]
    first_pose: Final[int]
    last_pose: Final[int]
    chainage_from: Final[float]
    chainage_to: Final[float]
    station_from: Final[float | None]
    station_to: Final[float | None]
class Overthrow:
    end: Final[float | None]
    middle: Final[float | None]
class StationRow:
    chainage_from: Final[float]
    chainage_to: Final[float]
    station_from: Final[float | None]
    station_to: Final[float | None]
    least: Final[FoundPlace | None]
    left: Final[FoundPlace | None]
    right: Final[FoundPlace | None]
    above: Final[FoundPlace | None]
    verdict: Final[str]
    reasons: Final[list[str]]
    doubts: Final[list[str]]
    searched: Final[bool]
    overthrow: Final[list[Overthrow]]
class StationTable:
    bodies: Final[list[str]]
    rows: Final[list[StationRow]]
    warnings: Final[list[Message]]
    def __len__(self) -> int: ...
class Conflicts:
    listed: Final[list[Conflict]]
    small: Final[list[SmallGroup]]
    has_last_poses: Final[bool]
    conflict_of: Final[_Poses]
    colliding_points: Final[int]
    groups: Final[int]
    small_groups: Final[int]
    small_points: Final[int]
    path_length: Final[float]
    longest_group: Final[float]
    longest_group_points: Final[int]
    def __len__(self) -> int: ...
class SectionParameters:
    rear: Final[float]
    front: Final[float]
    window: Final[tuple[float, float, float, float]]
    cell: Final[float]
    bin: Final[float]
    margin: Final[float]
    between_poses: Final[bool]
    pivots: Final[tuple[float, float] | None]
    ignore_classes: Final[list[int]]
    ignore_boxes: Final[list[Box]]
    seen: Final[bool]
    seen_cube: Final[float]
class SectionSeenCounts:
    cube: Final[float]
    unknown: Final[int]
    unknown_in_bins: Final[int]
class SectionIgnoredCells:
    blocked: Final[int]
    high: Final[int]
class SectionReport:
    blocked: Final[int]
    blocked_in_bins: Final[int]
    bins: Final[int]
    rounding: Final[float]
    motion: Final[list[float] | None]
    ignored_points: Final[int]
    ignored_cells: Final[SectionIgnoredCells | None]
    seen: Final[SectionSeenCounts | None]
    warnings: Final[list[Message]]
    device: Final[Literal["cpu", "cuda"]]
    peak_device_bytes: Final[int]
    needed_host_bytes: Final[int]
    seconds: Final[float]
    search_seconds: Final[float]
class SectionStop:
    bin: Final[int]
    first_pose: Final[int]
    chainage: Final[float]
    cell: Final[tuple[int, int]]
class SectionCheck:
    verdict: Final[Literal["passes", "stopped", "unknown"]]
    reason: Final[str | None]
    stop: Final[SectionStop | None]
    stops: Final[list[SectionStop]]
    unknowns: Final[list[SectionStop]]
class SectionCells:
    bin: Final[_Poses | None]
    j: Final[NDArray[np.int32]]
    k: Final[NDArray[np.int32]]
    first_pose: Final[_Poses]
    def __len__(self) -> int: ...
class SectionGrid:
    j_from: Final[int]
    j_to: Final[int]
    k_from: Final[int]
    k_to: Final[int]
class SectionBand:
    z_from: Final[float]
    z_to: Final[float]
    left: Final[float | None]
    left_pose: Final[int | None]
    right: Final[float | None]
    right_pose: Final[int | None]
    left_end: Final[Literal["blocked", "not-known"] | None]
    right_end: Final[Literal["blocked", "not-known"] | None]
class SectionStretch:
    bin: Final[int]
    chainage_from: Final[float]
    chainage_to: Final[float]
    bands: Final[list[SectionBand]]
class Section:
    def __init__(self, path: _AnyPath) -> None: ...
    def parameters(self) -> SectionParameters: ...
    def environment_points(self) -> int: ...
    def ignored_points(self) -> int: ...
    def ignored_cells(self) -> SectionIgnoredCells | None: ...
    def poses(self) -> int: ...
    def load_poses(self) -> int: ...
    def rounding(self) -> float: ...
    def motion(self) -> list[float] | None: ...
    def warnings(self) -> list[Message]: ...
    def crs_wkt(self) -> str: ...
    def length_unit(self) -> str: ...
    path: Final[_Path]
    def chainage(self) -> _Doubles: ...
    def bins(self) -> _Poses: ...
    def grid(self) -> SectionGrid: ...
    def cells(self) -> SectionCells: ...
    def bin_cells(self) -> SectionCells: ...
    def unknown_cells(self) -> SectionCells | None: ...
    def unknown_bin_cells(self) -> SectionCells | None: ...
    def check(self, outline: ArrayLike, margin: float | None = None) -> SectionCheck: ...
    def free_cells(self, margin: float | None = None) -> _Flags: ...
    def bands(self, band: float = 0.0, base: float | None = None) -> list[SectionBand]: ...
    def boxes(self, band: float = 0.0, base: float | None = None) -> list[SectionBand]: ...
    def stations(self, band: float = 0.0, base: float | None = None) -> list[SectionStretch]: ...
    def symmetric_width(self, band: SectionBand) -> float | None: ...
class StretchShift:
    conflict: Final[int]
    first_pose: Final[int]
    last_pose: Final[int]
    chainage_from: Final[float]
    chainage_to: Final[float]
    station_from: Final[float | None]
    station_to: Final[float | None]
    shift: Final[float | None]
    least_distance: Final[float | None]
    searches: Final[int]
    warned_of: Final[list[str]]
class ShiftTable:
    path: Final[StretchShift]
    conflicts: Final[list[StretchShift]]
    lateral_from: Final[float]
    lateral_to: Final[float]
    step: Final[float]
    searches: Final[int]
    seconds: Final[float]
    def __len__(self) -> int: ...
class ReportSummary:
    clear: Final[bool]
    verdict: Final[Literal["clear", "conflict", "undecided"]]
    bytes: Final[int]
    conflicts: Final[Conflicts]
    facts: Final[str]

def read_model_points(
    path: _AnyPath, *, spacing: float = 0.0, unit: float | str = 0.0, environment_unit: float | str | None = None,
    vertices_only: bool = False, above: float | None = None, forward: _Axis = "+x", up: _Axis = "+z",
    messages: list[Message] | None = None,
) -> _Doubles: ...
def read_model(
    path: _AnyPath, model_as: Literal["auto", "points", "surface", "solid"] = "auto", *, spacing: float = 0.0,
    unit: float | str = 0.0, environment_unit: float | str | None = None, vertices_only: bool = False,
    above: float | None = None, forward: _Axis = "+x", up: _Axis = "+z",
    messages: list[Message] | None = None,
) -> Model: ...
def box_model(length: float, width: float, height: float) -> Model: ...
def outline_model(outline: _Doubles | Sequence[Sequence[float]], rear: float, front: float) -> Model: ...
def read_outline(
    path: _AnyPath, *, mirror: bool = False, unit: float | str = 0.0, messages: list[Message] | None = None,
) -> _Doubles: ...
def read_trajectory(
    path: _AnyPath, *, format: str = "auto", allow_non_rigid: bool = False,
    angle_unit: Literal["declared", "deg", "rad"] = "declared",
    angle_frame: Literal["declared", "ned", "enu"] = "declared", crs: str = "",
    default_crs: str = "", datum: str = "", metres_per_unit: float | str = 0.0,
    environment_unit: float | str | None = None, lever_arm: Sequence[float] = (0.0, 0.0, 0.0),
    messages: list[Message] | None = None, labels: PoseLabels | None = None,
) -> _Doubles: ...
def read_alignment(
    path: _AnyPath, *, alignment: str = "", profile: str = "", station_from: float | None = None,
    station_to: float | None = None, step: float = 0.1, reverse: bool = False,
    cant: Literal["file", "none", "center", "inside-rail", "outside-rail", "left-rail",
                  "right-rail"] = "file",
    rail_distance: float | None = None, order: Literal["ne", "en"] = "ne", max_gap: float = 0.001,
    height: float | None = None, environment_crs: str = "", messages: list[Message] | None = None,
    labels: PoseLabels | None = None,
) -> _Doubles: ...
def read_line(
    path: _AnyPath, *, step: float = 0.1, reverse: bool = False, height: float | None = None,
    corner_radius: float | None = None, ground: Store | None = None, track: float | None = None,
    cant: Literal["none", "center", "inside-rail", "outside-rail", "left-rail",
                  "right-rail"] = "center",
    rail_distance: float | None = None, unit: float | str = 0.0,
    environment_unit: float | str | None = None, environment_crs: str = "",
    messages: list[Message] | None = None, labels: PoseLabels | None = None,
) -> _Doubles: ...
def read_vehicle(
    file: _AnyPath, poses: ArrayLike, model_as: Literal["auto", "points", "surface", "solid"] = "auto", *,
    spacing: float = 0.0, unit: float | str = 0.0, environment_unit: float | str | None = None,
    vertices_only: bool = False, above: float | None = None, forward: _Axis = "+x", up: _Axis = "+z",
    format: str = "auto", allow_non_rigid: bool = False, angle_unit: Literal["declared", "deg", "rad"] = "declared",
    angle_frame: Literal["declared", "ned", "enu"] = "declared", crs: str = "",
    default_crs: str = "", datum: str = "", metres_per_unit: float | str = 0.0,
    lever_arm: Sequence[float] = (0.0, 0.0, 0.0), messages: list[Message] | None = None,
) -> list[Body]: ...
def convert(
    inputs: _AnyPath | Iterable[_AnyPath], output: _AnyPath, *, scale: float | None = None,
    cell_points: int = 65536, regular_size: float | None = None, memory_bytes: int = 4294967296,
    threads: int = 0, unit: float | str = 0.0, unit_z: float | str = 0.0, ignore_crs: bool = False,
    columns: Sequence[str] = (),
    origins: _AnyPath | None = None, origins_path: _AnyPath | None = None,
    lever_arm: Sequence[float] = (0.0, 0.0, 0.0), format: str = "auto",
    angle_unit: Literal["declared", "deg", "rad"] = "declared",
    angle_frame: Literal["declared", "ned", "enu"] = "declared", crs: str = "", datum: str = "",
    metres_per_unit: float | str = 0.0, keep_withheld: bool = False, skip_unreadable: bool = False,
    strict: bool = False, overwrite: bool = False, resume: bool = False, progress: _Progress | None = None, message: _Tell | None = None,
    stop: _Stop | None = None,
) -> ConvertReport: ...
def search(
    store: Store, query: Query, output: _AnyPath, *,
    engine: Literal["auto", "sweep", "grid", "kdtree"] = "auto",
    device: Literal["auto", "cpu", "cuda"] = "auto", gpus: Sequence[int] = (), threads: int = 0,
    memory_bytes: int = 4294967296, device_memory_bytes: int = 0, shard: tuple[int, int] | None = None,
    overwrite: bool = False, resume: bool = False, strict: bool = False, input_warnings: Iterable[Message] = (),
    model_is_cut: bool = False, end_gpus: bool = False, journal_interval_seconds: float = 5.0,
    progress: _Progress | None = None, message: _Tell | None = None, stop: _Stop | None = None,
) -> SearchReport: ...
def merge(
    parts: _AnyPath | Iterable[_AnyPath], output: _AnyPath, *, threads: int = 0,
    memory_bytes: int = 4294967296, overwrite: bool = False, resume: bool = False,
    strict: bool = False, progress: _Progress | None = None, message: _Tell | None = None,
    stop: _Stop | None = None,
) -> MergeReport: ...
def find_conflicts(
    result: Result, poses: ArrayLike, *, gap: float = 0.3, min_points: int = 10,
    split: float = 25.0, chainage_start: float = 0.0, forward: _Axis = "+x", up: _Axis = "+z",
    model_box: Box | None = None, model: ArrayLike | Model | None = None,
    bodies: Sequence[Body] = (), labels: PoseLabels | None = None, memory_bytes: int = 4294967296,
    threads: int = 0, progress: _Progress | None = None, stop: _Stop | None = None,
) -> Conflicts: ...
def station_table(
    result: Result, poses: ArrayLike, *, every: float = 5.0, chainage_start: float = 0.0,
    forward: _Axis = "+x", up: _Axis = "+z", model_box: Box | None = None,
    bodies: Sequence[Body] = (), labels: PoseLabels | None = None, threads: int = 0,
    progress: _Progress | None = None, stop: _Stop | None = None,
) -> StationTable: ...
def find_section(
    store: Store, poses: ArrayLike, output: _AnyPath, rear: float, front: float, *,
    window: tuple[float, float, float, float] | None = None, cell: float = 0.0, bin: float = 0.0,
    margin: float = 0.0, between_poses: bool = False, pivots: tuple[float, float] | None = None,
    ignore_classes: Sequence[int] = (), ignore_boxes: Sequence[Box] = (), seen: bool = False,
    seen_cube: float = 0.0, device: Literal["auto", "cpu", "cuda"] = "auto",
    gpus: Sequence[int] = (), threads: int = 0, memory_bytes: int = 4294967296,
    device_memory_bytes: int = 0, overwrite: bool = False, strict: bool = False,
    input_warnings: Iterable[Message] = (), progress: _Progress | None = None,
    message: _Tell | None = None, stop: _Stop | None = None,
) -> SectionReport: ...
def export_section(
    section: Section,
    table: Literal["bands", "stations", "boxes", "cells", "bin-cells", "unknown-cells",
                   "unknown-bin-cells"],
    output: _AnyPath, *, band: float = 0.0, base: float | None = None, overwrite: bool = False,
) -> None: ...
def export_section_outline(
    section: Section, output: _AnyPath, *, band: float = 0.0, base: float | None = None,
    overwrite: bool = False,
) -> None: ...
def find_shifts(
    result: Result, store: Store, model: ArrayLike | Model | None, poses: ArrayLike, *,
    lateral: Sequence[float] = (-2.0, 2.0), step: float = 0.01, gap: float = 0.3,
    min_points: int = 10, split: float = 25.0, chainage_start: float = 0.0, forward: _Axis = "+x",
    up: _Axis = "+z", bodies: Sequence[Body] = (), labels: PoseLabels | None = None,
    memory_bytes: int = 4294967296, threads: int = 0, progress: _Progress | None = None,
    stop: _Stop | None = None,
) -> ShiftTable: ...
def write_report(
    result: Result, store: Store, model: ArrayLike | Model | None, poses: ArrayLike, output: _AnyPath, *,
    title: str = "", project: str = "", client: str = "", author: str = "", date: str = "",
    result_name: str = "", environment_name: str = "", model_name: str = "",
    trajectory_name: str = "", model_above: float | None = None, model_left_out: int = 0,
    classes: Sequence[float] = (), max_points: int = 1000000, gap: float = 0.3,
    min_points: int = 10, split: float = 25.0, chainage_start: float = 0.0, forward: _Axis = "+x",
    up: _Axis = "+z", memory_bytes: int = 4294967296, threads: int = 0,
    labels: PoseLabels | None = None, every: float = 0.0, shifts: ShiftTable | None = None,
    warnings: Iterable[Message] = (),
    bodies: Sequence[Body] = (), overwrite: bool = False,
    progress: _Progress | None = None, stop: _Stop | None = None,
) -> ReportSummary: ...
