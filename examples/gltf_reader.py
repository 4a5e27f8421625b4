# SPDX-License-Identifier: Apache-2.0
"""Reads a glTF or GLB back as plain world-space arrays: just enough to check the example scenes and place lights in others."""

import json
import math
import os
import struct

import numpy as np

COMPONENTS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Scene:
    """triangles and normals: (n, 3, 3) in world space; lights: (name, position, light); cameras: name -> (matrix, camera)."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        if data[:4] == b"glTF":
            size = struct.unpack_from("<I", data, 12)[0]
            self.json, self.buffers = json.loads(data[20:20 + size]), [data[28 + size:]]
        else:
            self.json = json.loads(data)
            self.buffers = []
            for buffer in self.json.get("buffers", []):
                with open(os.path.join(os.path.dirname(path), buffer["uri"]), "rb") as file:
                    self.buffers.append(file.read())
        self.lights, self.cameras, self._triangles, self._normals = [], {}, [], []
        for root in self.json["scenes"][self.json.get("scene", 0)]["nodes"]:
            self._visit(root, np.eye(4))
        empty = np.zeros((0, 3, 3))
        self.triangles = np.concatenate([empty, *self._triangles])
        self.normals = np.concatenate([empty, *self._normals])

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width, kind = WIDTHS[accessor["type"]], np.dtype(COMPONENTS[accessor["componentType"]])
        stride = view.get("byteStride", width * kind.itemsize)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.ndarray((accessor["count"], width), kind, self.buffers[view["buffer"]], start, (stride, kind.itemsize))

    def _visit(self, index, parent):
        node = self.json["nodes"][index]
        world = parent @ local_matrix(node)
        if "mesh" in node:
            self._add_mesh(self.json["meshes"][node["mesh"]], world)
        if "camera" in node:
            self.cameras[node["name"]] = (world, self.json["cameras"][node["camera"]])
        light = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
        if light is not None:
            light = self.json["extensions"]["KHR_lights_punctual"]["lights"][light]
            self.lights.append((node.get("name", ""), world[:3, 3], light))
        for child in node.get("children", []):
            self._visit(child, world)

    def _add_mesh(self, mesh, world):
        for primitive in mesh["primitives"]:
            corners = self.accessor(primitive["indices"]).reshape(-1, 3)
            positions = self.accessor(primitive["attributes"]["POSITION"]).astype(float) @ world[:3, :3].T + world[:3, 3]
            self._triangles.append(positions[corners])
            if "NORMAL" in primitive["attributes"]:
                normals = self.accessor(primitive["attributes"]["NORMAL"]).astype(float) @ np.linalg.inv(world[:3, :3])
                self._normals.append(normals[corners])


def local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def spheres_in_view(positions, radii, matrix, camera, aspect=16 / 9):
    """Which bounding spheres are not wholly outside one of the four side planes or the near plane of a camera."""
    half = camera["perspective"]["yfov"] / 2
    local = (np.asarray(positions) - matrix[:3, 3]) @ matrix[:3, :3]
    radii = np.asarray(radii)
    inside = -local[:, 2] > -radii
    for axis, angle in ((0, math.atan(math.tan(half) * aspect)), (1, half)):
        for side in (-1, 1):
            inside &= side * local[:, axis] * math.cos(angle) + local[:, 2] * math.sin(angle) < radii
    return inside
