# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a written glTF back and compares it with the scene: its lights, and which objects cast no shadow."""

import json
import pathlib
import struct
from dataclasses import dataclass, field

import numpy as np

from . import light_table, photometry

TYPES = {"point": photometry.POINT, "spot": photometry.SPOT, "directional": photometry.DIRECTIONAL}
NEAR_M = 1e-3  # tolerance: positions are written as decomposed matrices and decimal numbers


@dataclass
class Check:
    """`errors`: one line for each difference between the file and the scene."""
    errors: list = field(default_factory=list)
    extra: list = field(default_factory=list)  # names of lights that are in the file but not in the scene
    lights: int = 0


def read_json(path):
    """The JSON of a .gltf or .glb. Raises ValueError, which says what is wrong with the file."""
    data = pathlib.Path(path).read_bytes()
    if data[:4] == b"glTF":
        if len(data) < 20 or data[16:20] != b"JSON":
            raise ValueError(f"{path}: is not a complete .glb")
        data = data[20:20 + struct.unpack_from("<I", data, 12)[0]]
    try:
        return json.loads(data)
    except ValueError as error:
        raise ValueError(f"{path}: is not JSON ({error})") from None


def matrix_of(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    rotation = np.array(((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                         (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                         (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y))))
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * node.get("scale", (1, 1, 1))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def placed_lights(gltf):
    """(node's name, world matrix, light) of each node with a light."""
    lights = gltf.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    nodes, found = gltf.get("nodes", []), []
    scenes = gltf.get("scenes", [])
    waiting = [(root, np.eye(4)) for root in scenes[gltf.get("scene", 0)].get("nodes", [])] if scenes else []
    while waiting:
        number, parent = waiting.pop()
        node = nodes[number]
        matrix = parent @ matrix_of(node)
        light = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
        if light is not None:
            found.append((node.get("name", ""), matrix, lights[light]))
        waiting += [(child, matrix) for child in node.get("children", [])]
    return found


def to_gltf(vectors):
    """Converts from Blender's Z up to glTF's Y up."""
    return np.stack((vectors[:, 0], vectors[:, 2], -vectors[:, 1]), axis=1).astype(float)


def check_shadows(gltf, objects, materials):
    """A line for each name whose shadow switch differs; `objects`, `materials`: see shadows.meant."""
    out = {}
    for things, meant in (([node for node in gltf.get("nodes", []) if "mesh" in node], objects), (gltf.get("materials", []), materials)):
        for thing in things:
            name = thing.get("name", "")
            written = ((thing.get("extras") or {}).get("chandelier") or {}).get("shadow", True)
            if meant.get(name) not in (None, written):
                out[f"{name}: casts {'a' if written else 'no'} shadow in the file, but should cast {'none' if written else 'one'}"] = True
    return list(out)


def check(path, table, objects, materials):
    """`table`: the LightTable that was to be exported; `objects`, `materials`: which cast shadows, see shadows.meant."""
    gltf = read_json(path)
    result = check_lights(gltf, table)
    result.errors += check_shadows(gltf, objects, materials)
    return result


def check_lights(gltf, table):
    placed = placed_lights(gltf)
    result = Check(lights=len(placed))
    types = np.array([TYPES[light["type"]] for _, _, light in placed], int)
    positions = np.array([matrix[:3, 3] for _, matrix, _ in placed]).reshape(-1, 3)
    intensities = np.array([light.get("intensity", 1) for _, _, light in placed], float)
    free = np.ones(len(placed), bool)
    wanted = to_gltf(table.position)
    ways = to_gltf(table.direction)
    for row, name in enumerate(table.names):
        apart = np.linalg.norm(positions - wanted[row], axis=1)
        near = free & (types == table.type[row]) & (apart < NEAR_M * (1 + np.linalg.norm(wanted[row])))
        if table.type[row] == photometry.DIRECTIONAL:
            near = free & (types == table.type[row])  # a sun has no position
        if not near.any():
            result.errors.append(f"{name}: the file has no light of its type at its position")
            continue
        numbers = np.flatnonzero(near)
        misfit = apart[numbers] + abs(intensities[numbers] / table.intensity[row] - 1)
        misfit += [0 if placed[number][0] in name else 1 for number in numbers]
        best = int(numbers[misfit.argmin()])
        free[best] = False
        result.errors += [f"{name}: {what}" for what in differences(table, row, ways[row], *placed[best][1:])]
    result.extra = [placed[number][0] for number in np.flatnonzero(free)]
    return result


def differences(table, row, way, matrix, light):
    """The differences between a light of the file and a row of the table."""
    out = []

    def compare(what, unit, written, meant, tolerance):
        if abs(written - meant) > tolerance * max(abs(meant), 1e-9):
            out.append(f"{what} is {written:.7g}{unit} in the file, but should be {meant:.7g}{unit}")

    extras = (light.get("extras") or {}).get("chandelier") or {}
    compare("intensity", " lx" if table.type[row] == photometry.DIRECTIONAL else " cd", light.get("intensity", 1),
            float(table.intensity[row]), 1e-6)
    compare("power_w", " W", float(np.float32(extras.get("power_w", -1))), float(table.power_w[row]), 0)
    compare("range", " m", float(np.float32(light.get("range", 0))), float(table.range_m[row]), 0)
    compare("radius", "" if table.type[row] == photometry.DIRECTIONAL else " m", float(np.float32(extras.get("radius_m", 0))),
            float(table.radius_m[row]), 0)
    for part, name in enumerate(("red", "green", "blue")):
        compare(name, "", light.get("color", (1, 1, 1))[part], float(table.colour[row, part]), 1e-6)
    out += extras_differences(table, row, extras)
    if table.type[row] == photometry.SPOT:
        cone = (light.get("spot") or {}).get("outerConeAngle", np.pi / 4)
        compare("outerConeAngle", " rad", cone, float(table.spot_outer_rad[row]), 1e-5)
    if table.type[row] != photometry.POINT:
        forward = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        if forward @ way < 0.9999:
            written, meant = (", ".join(f"{part:g}" for part in vector.round(3) + 0.0) for vector in (forward, way))
            out.append(f"shines towards ({written}) in the file, but should shine towards ({meant})")
    return out


def extras_differences(table, row, extras):
    """Compares the artist's settings. The table has only numbers of groups, so only the presence of a name is compared."""
    flags = int(table.flags[row])
    meant = {"priority": int(table.priority[row]), "dynamic": bool(flags & light_table.DYNAMIC),
             "cluster": not flags & light_table.OWN_MAP, "shadow": not flags & light_table.NO_SHADOW}
    written = {"priority": extras.get("priority", 128), "dynamic": extras.get("dynamic", False),
               "cluster": extras.get("cluster", True), "shadow": extras.get("shadow", True)}
    out = [f"{name} is {json.dumps(written[name])} in the file, but should be {json.dumps(meant[name])}"
           for name in meant if written[name] != meant[name]]
    if bool(extras.get("group")) != (table.group[row] != light_table.NO_GROUP):
        out.append("is in a group in the file, but should be in none" if extras.get("group") else "has lost its group in the file")
    return out
