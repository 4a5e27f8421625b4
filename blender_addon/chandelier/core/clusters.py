# SPDX-License-Identifier: GPL-3.0-or-later
"""Which lights will share a shadow map: the runtime's own selection, by its C interface (chandelier_preview.h), or, where
that cannot be loaded, by the program chandelier-lights. Both give the same Selection."""

import ctypes
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, fields

import numpy as np

from .bill import MIB, Bill
from .light_table import DYNAMIC, MOVES, NO_SHADOW, OWN_MAP
from .photometry import RANGE_THRESHOLD_LX

ABI = 2
NONE = 0xFFFFFFFF
SELECTS = ("per-light", "light-clusters")
FILTERS = ("hard", "pcf", "pcss")
SCALINGS = ("grow", "paper-formula", "none")
DYNAMIC_LIGHTS = ("cluster", "own")
TYPES = ("point", "spot", "directional")

CLUSTER = np.dtype([("center", "<u4"), ("light_count", "<u4"), ("d_min_m", "<f4"), ("range_m", "<f4"),
                    ("spread_m", "<f4")])

# Columns of a table of lights: name in the C interface, attributes that may hold it, type, numbers per light. The first is required.
COLUMNS = (("position", ("position",), np.float32, 3), ("direction", ("direction",), np.float32, 3),
           ("type", ("type",), np.uint8, 1), ("intensity", ("intensity",), np.float32, 1),
           ("color", ("colour", "color"), np.float32, 3), ("range_m", ("range_m",), np.float32, 1),
           ("radius_m", ("radius_m",), np.float32, 1), ("spot_outer_rad", ("spot_outer_rad",), np.float32, 1),
           ("flags", ("flags",), np.uint8, 1), ("priority", ("priority",), np.uint8, 1), ("group", ("group",), np.int32, 1))


class PreviewError(Exception):
    """Its text is one line for the user."""


@dataclass(frozen=True)
class Settings:
    select: str = "light-clusters"
    filter: str = "pcss"
    distance_scaling: str = "grow"
    dynamic_lights: str = "cluster"
    face_size_px: int = 512
    d_init_m: float = 0.5
    z_far_m: float = 30.0
    reference_share: float = 0.85
    range_threshold_lx: float = RANGE_THRESHOLD_LX
    budget_maps: int = 0  # 0: none
    budget_mib: int = 0


@dataclass(frozen=True)
class Camera:
    """In the coordinates of the lights. Without `forward` all lights are in view, and only the position counts."""
    eye: tuple
    forward: tuple = None
    up: tuple = (0.0, 0.0, 1.0)
    yfov_rad: float = 1.0
    znear_m: float = 0.05
    size_px: tuple = (1280, 720)


@dataclass
class Selection:
    """Arrays with one entry per light, in the table's order, and the clusters."""
    center: np.ndarray  # i4: the light whose map it takes, -1 out of view, without shadow, or where it gives no light
    range_m: np.ndarray  # f4: as used, derived where none was given; 0 for directional lights
    over_budget: np.ndarray  # bool: whether the budget takes away the map that it would have alone
    clusters: np.ndarray  # of CLUSTER, in ascending order of centre
    bill: Bill


# ---- The library ------------------------------------------------------------------------------------------------------


def _structure(name, *members):
    return type(name, (ctypes.Structure,), {"_fields_": list(members)})


_u32, _u64, _f32, _pointer = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_float, ctypes.c_void_p
_Column = _structure("Column", ("first", _pointer), ("stride_bytes", ctypes.c_int64))
_Lights = _structure("Lights", ("struct_bytes", _u32), ("count", _u32), *((name, _Column) for name, *_ in COLUMNS))
_Settings = _structure("Settings", ("struct_bytes", _u32), ("select", _u32), ("filter", _u32), ("distance_scaling", _u32),
                       ("dynamic_lights", _u32), ("face_size_px", _u32), ("d_init_m", _f32), ("z_far_m", _f32),
                       ("reference_share", _f32), ("range_threshold_lx", _f32), ("max_shadow_maps", _u64),
                       ("max_shadow_bytes", _u64))
_Camera = _structure("Camera", ("struct_bytes", _u32), ("sees_all", _u32), ("eye_ws", _f32 * 3), ("forward_ws", _f32 * 3),
                     ("up_ws", _f32 * 3), ("yfov_rad", _f32), ("znear_m", _f32), ("width_px", _u32), ("height_px", _u32))
_Bill = _structure("Bill", ("lights", _u32), ("lights_in_view", _u32), ("shadowless_in_view", _u32),
                   ("shadow_maps", _u32), ("shadow_views", _u32), ("wanted_shadow_maps", _u32), ("shadow_bytes", _u64),
                   ("wanted_shadow_bytes", _u64), ("lights_over_budget", _u32), ("d_init_m", _f32), ("reference_path", _u32), ("over_budget", _u32),
                   ("misses_budget", _u32), ("reserved", _u32))
_Result = _structure("Result", ("struct_bytes", _u32), ("capacity", _u32), ("center_of_light", _pointer),
                     ("range_of_light_m", _pointer), ("over_budget_of_light", _pointer), ("clusters", _pointer),
                     ("cluster_count", _u32), ("reserved", _u32), ("bill", _Bill))


def _column(table, names, kind, parts, count):
    """The column as an array that C can read, not copied if possible; None if the table lacks it."""
    values = next((getattr(table, name) for name in names if getattr(table, name, None) is not None), None)
    if values is None:
        return None
    values = np.asarray(values, kind)
    shape = (count, parts) if parts > 1 else (count,)
    if values.shape != shape:
        raise PreviewError(f"{names[0]}: has shape {values.shape} instead of {shape}")
    inner_is_dense = parts == 1 or values.strides[1] == values.itemsize
    outer_is_forward = values.strides[0] == 0 or values.strides[0] >= parts * values.itemsize
    return values if inner_is_dense and outer_is_forward else np.ascontiguousarray(values)


def _columns(table):
    """Name -> array, for the columns that the table has."""
    count = len(table.position)
    columns = {name: _column(table, names, kind, parts, count) for name, names, kind, parts in COLUMNS}
    if columns["flags"] is not None:
        columns["flags"] = np.where(columns["flags"] & MOVES, columns["flags"] | DYNAMIC, columns["flags"]).astype(np.uint8)
    return count, {name: values for name, values in columns.items() if values is not None}


def _number(names, name, what):
    if name not in names:
        raise PreviewError(f"{what}: is none of {', '.join(names)} ({name})")
    return names.index(name)


def _settings(settings):
    return _Settings(
        ctypes.sizeof(_Settings), _number(SELECTS, settings.select, "select"), _number(FILTERS, settings.filter, "filter"),
        _number(SCALINGS, settings.distance_scaling, "distance_scaling"),
        _number(DYNAMIC_LIGHTS, settings.dynamic_lights, "dynamic_lights"), settings.face_size_px, settings.d_init_m,
        settings.z_far_m, settings.reference_share, settings.range_threshold_lx, settings.budget_maps,
        settings.budget_mib * MIB)


def _camera(camera):
    forward = (0, 0, 0) if camera.forward is None else camera.forward
    return _Camera(ctypes.sizeof(_Camera), camera.forward is None, tuple(camera.eye), tuple(forward), tuple(camera.up),
                   camera.yfov_rad, camera.znear_m, *camera.size_px)


def _bill(values):
    """A Bill from `values`, which has an attribute or a key for each field."""
    get = values.__getitem__ if isinstance(values, dict) else lambda name: getattr(values, name)
    return Bill(**{field.name: bool(get(field.name)) if field.type in (bool, "bool") else get(field.name)
                   for field in fields(Bill)})


class Library:
    """libchandelier_preview, loaded. Raises PreviewError if the file is no such library or of another version."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        try:
            library = ctypes.CDLL(str(self.path))
            abi = library.chandelier_preview_abi
            self._select = library.chandelier_preview_select
        except (OSError, AttributeError) as error:
            raise PreviewError(f"{self.path}: cannot be loaded ({error})") from error
        abi.restype, abi.argtypes = _u32, ()
        if abi() != ABI:
            raise PreviewError(f"{self.path}: has interface version {abi()}, but the add-on needs {ABI}")
        self._select.restype = ctypes.c_int32
        self._select.argtypes = (_pointer,) * 5 + (ctypes.c_size_t,)

    def select(self, table, settings, camera):
        count, columns = _columns(table)
        lights = _Lights(ctypes.sizeof(_Lights), count)
        for name, values in columns.items():
            setattr(lights, name, _Column(values.ctypes.data, values.strides[0]))
        center, range_m = np.empty(count, np.uint32), np.empty(count, np.float32)
        over_budget, clusters = np.empty(count, np.bool_), np.empty(count, CLUSTER)
        result = _Result(ctypes.sizeof(_Result), count, center.ctypes.data, range_m.ctypes.data, over_budget.ctypes.data,
                         clusters.ctypes.data)
        error = ctypes.create_string_buffer(512)
        asked, eye = _settings(settings), _camera(camera)
        status = self._select(ctypes.byref(lights), ctypes.byref(asked), ctypes.byref(eye), ctypes.byref(result), error,
                              len(error))
        if status != 0:
            raise PreviewError(error.value.decode("utf-8", "replace") or f"chandelier_preview_select: status {status}")
        return Selection(center.view(np.int32), range_m, over_budget, clusters[:result.cluster_count], _bill(result.bill))


# ---- The program --------------------------------------------------------------------------------------------------------


def _request(table, settings, camera):
    count, columns = _columns(table)
    lights = {name: values.tolist() for name, values in columns.items()}
    if "type" in lights:
        lights["type"] = [TYPES[number] if number < len(TYPES) else number for number in lights["type"]]
    if "range_m" in lights:
        lights["range_m"] = [metres or None for metres in lights["range_m"]]  # 0: to be derived
    flags = np.asarray(columns.get("flags", np.zeros(count, np.uint8)))
    lights.pop("flags", None)
    lights["dynamic"] = ((flags & DYNAMIC) != 0).tolist()
    lights["cluster"] = ((flags & OWN_MAP) == 0).tolist()
    lights["shadow"] = ((flags & NO_SHADOW) == 0).tolist()
    asked = {field.name: getattr(settings, field.name) for field in fields(Settings)}
    asked["max_shadow_maps"] = asked.pop("budget_maps")
    asked["max_shadow_bytes"] = asked.pop("budget_mib") * MIB
    seen = {"eye_ws": list(map(float, camera.eye)), "yfov_rad": camera.yfov_rad, "znear_m": camera.znear_m,
            "up_ws": list(map(float, camera.up)), "size_px": list(camera.size_px)}
    if camera.forward is not None:
        seen["forward_ws"] = list(map(float, camera.forward))
    # JSON has no NaN and no infinities. The library would name the light that has one.
    try:
        return json.dumps({"lights": lights, "settings": asked, "camera": seen}, allow_nan=False)
    except ValueError as error:
        raise PreviewError("a number among the lights, the settings or the camera is not finite") from error


class Program:
    """chandelier-lights: gives the same results as the library, with one process per selection."""

    def __init__(self, path):
        self.path = pathlib.Path(path)

    def select(self, table, settings, camera):
        try:
            done = subprocess.run([str(self.path)], input=_request(table, settings, camera), capture_output=True, text=True,
                                  encoding="utf-8", timeout=30, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise PreviewError(f"{self.path}: cannot be run ({error})") from error
        if done.returncode != 0:
            raise PreviewError(re.sub(r"^chandelier-lights: error: (standard input: )?", "", done.stderr.strip()) or f"{self.path}: failed")
        answer = json.loads(done.stdout)
        center = np.array([-1 if number is None else number for number in answer["center_of_light"]], np.int32)
        over_budget = np.zeros(len(center), np.bool_)
        over_budget[answer["over_budget"]] = True
        clusters = np.array([tuple(cluster[name] for name in CLUSTER.names) for cluster in answer["clusters"]], CLUSTER)
        return Selection(center, np.array(answer["range_of_light_m"], np.float32), over_budget, clusters,
                         _bill(answer["bill"]))


# ---- Which one ----------------------------------------------------------------------------------------------------------


def library_name():
    return {"win32": "chandelier_preview.dll", "darwin": "libchandelier_preview.dylib"}.get(sys.platform,
                                                                                        "libchandelier_preview.so")


def program_name():
    return "chandelier-lights" + (".exe" if sys.platform == "win32" else "")


def default_folders():
    """The add-on's own bin/, then the build folder of a source tree that the add-on is in."""
    addon = pathlib.Path(__file__).resolve().parents[1]
    folders = [addon / "bin"]
    if os.environ.get("CHANDELIER_BUILD"):
        folders.append(pathlib.Path(os.environ["CHANDELIER_BUILD"]))
    folders.append(addon.parents[1] / "build")
    return [inner for folder in folders for inner in (folder, folder / "lib", folder / "bin")]


def find(folders=()):
    """The library of the first folder where it works, else the program of the first folder that has it, else a program in PATH.
    Raises PreviewError, which says what was wrong with each library."""
    faults = []
    places = [pathlib.Path(folder) for folder in folders] + default_folders()
    for path in (folder / library_name() for folder in places):
        if not path.is_file():
            continue
        try:
            return Library(path)
        except PreviewError as error:
            faults.append(str(error))
    programs = [str(folder / program_name()) for folder in places] + [shutil.which(program_name())]
    for path in filter(None, programs):
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return Program(path)
    raise PreviewError("; ".join(faults) or f"neither {library_name()} nor {program_name()} was found")
