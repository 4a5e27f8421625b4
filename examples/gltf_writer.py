# SPDX-License-Identifier: Apache-2.0
"""Writes small glTF 2.0 binaries from Python: documents, materials, PNG textures, lights and cameras.

Units are glTF's: metres, candela, +Y up, counter-clockwise front faces. Shapes are made in shapes.py.
"""

import argparse
import json
import math
import os
import pathlib
import struct
import zlib

import numpy as np


def png_bytes(pixels):
    """An 8-bit PNG of an array (height, width, 3); rows use the Sub filter, which suits smooth noise."""
    pixels = np.ascontiguousarray(pixels, dtype=np.uint8)
    height, width, _ = pixels.shape
    rows = pixels.astype(np.int16)
    rows[:, 1:] -= pixels[:, :-1].astype(np.int16)
    filtered = np.ones((height, 1 + width * 3), dtype=np.uint8)
    filtered[:, 1:] = (rows % 256).astype(np.uint8).reshape(height, -1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(filtered.tobytes(), 9)) +
            chunk(b"IEND", b""))


def look_at(eye, target):
    """The glTF rotation (x, y, z, w) of a camera at eye that looks along its own -Z towards target."""
    back = np.subtract(eye, target).astype(float)
    back /= np.linalg.norm(back)
    right = np.cross((0.0, 1.0, 0.0), back)
    right /= np.linalg.norm(right)
    return rotation_of(np.column_stack((right, np.cross(back, right), back)))


def rotation_of(m):
    """The quaternion (x, y, z, w) of a rotation matrix, by its largest component (Shepperd)."""
    q2 = np.array([1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2],
                   1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + m[0, 0] + m[1, 1] + m[2, 2]])
    i = int(np.argmax(q2))
    wx, wy, wz = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    xy, xz, yz = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
    rows = [(q2[0], xy, xz, wx), (xy, q2[1], yz, wy), (xz, yz, q2[2], wz), (wx, wy, wz, q2[3])]
    q = np.array(rows[i])
    return [float(v) for v in q / np.linalg.norm(q)]


def yaw(degrees):
    """The rotation (x, y, z, w) about +Y."""
    half = math.radians(degrees) / 2
    return [0.0, math.sin(half), 0.0, math.cos(half)]


class Document:
    """A glTF document in the making. Every add_… returns the index that other parts name it by."""

    def __init__(self, name):
        self.name = name
        self.buffer = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "Chandelier examples"}, "scene": 0}
        self.roots = []
        self.tile_m = {}  # material -> metres that one repeat of its textures covers
        self.triangles = 0  # as drawn: shared meshes count once per node
        self.mesh_triangles = []

    def _add(self, kind, value):
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def _view(self, data, target=None):
        self.buffer.extend(b"\0" * (-len(self.buffer) % 4))
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.buffer.extend(data)
        return self._add("bufferViews", view)

    def _accessor(self, array, kind, component, target, bounds=False):
        accessor = {"bufferView": self._view(array.tobytes(), target), "componentType": component,
                    "count": len(array), "type": kind}
        if bounds:
            accessor["min"] = [float(v) for v in array.min(axis=0)]
            accessor["max"] = [float(v) for v in array.max(axis=0)]
        return self._add("accessors", accessor)

    def add_texture(self, pixels):
        image = self._add("images", {"bufferView": self._view(png_bytes(pixels)), "mimeType": "image/png"})
        if "samplers" not in self.json:
            self._add("samplers", {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497})
        return self._add("textures", {"source": image, "sampler": 0})

    def add_material(self, name, color=(1, 1, 1), roughness=0.8, metallic=0.0, texture=None, normal=None,
                     emissive=None, double_sided=False, tile_m=1.0, normal_scale=1.0):
        pbr = {"baseColorFactor": [*color, 1.0], "roughnessFactor": roughness, "metallicFactor": metallic}
        material = {"name": name, "pbrMetallicRoughness": pbr}
        if texture is not None:
            pbr["baseColorTexture"] = {"index": texture}
        if normal is not None:
            material["normalTexture"] = {"index": normal, "scale": normal_scale}
        if emissive is not None:
            material["emissiveFactor"] = list(emissive)
        if double_sided:
            material["doubleSided"] = True
        index = self._add("materials", material)
        self.tile_m[index] = tile_m
        return index

    def add_mesh(self, name, parts):
        """parts: a list of (Shape, material); each becomes a primitive. UVs go from metres to repeats here."""
        primitives = []
        for shape, material in parts:
            uv = (shape.uvs / self.tile_m[material]).astype("<f4")
            primitives.append({
                "attributes": {"POSITION": self._accessor(shape.positions.astype("<f4"), "VEC3", 5126, 34962, True),
                               "NORMAL": self._accessor(shape.normals.astype("<f4"), "VEC3", 5126, 34962),
                               "TEXCOORD_0": self._accessor(uv, "VEC2", 5126, 34962)},
                "indices": self._accessor(shape.triangles.astype("<u4").reshape(-1), "SCALAR", 5125, 34963),
                "material": material})
        self.mesh_triangles.append(sum(len(shape.triangles) for shape, _ in parts))
        return self._add("meshes", {"name": name, "primitives": primitives})

    def add_node(self, name, parent=None, mesh=None, translation=None, rotation=None, scale=None, camera=None,
                 light=None):
        node = {"name": name}
        for key, value in (("mesh", mesh), ("translation", translation), ("rotation", rotation), ("scale", scale),
                           ("camera", camera)):
            if value is not None:
                node[key] = value if isinstance(value, int) else [float(v) for v in value]
        if light is not None:
            node["extensions"] = {"KHR_lights_punctual": {"light": light}}
        if mesh is not None:
            self.triangles += self.mesh_triangles[mesh]
        index = self._add("nodes", node)
        if parent is None:
            self.roots.append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def add_point_light(self, name, position, color, intensity_cd, range_m, parent=None):
        """A light of its own on a node of its own, so that every light can be named."""
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": "point", "name": name, "color": [round(float(c), 4) for c in color],
                       "intensity": round(float(intensity_cd), 4), "range": round(float(range_m), 4)})
        self.json["extensionsUsed"] = ["KHR_lights_punctual"]
        return self.add_node(name, parent=parent, translation=position, light=len(lights) - 1)

    def add_camera(self, name, eye, target, fov_deg, z_near=0.05, z_far=100.0):
        camera = self._add("cameras", {"name": name, "type": "perspective",
                                       "perspective": {"yfov": math.radians(fov_deg), "aspectRatio": 16 / 9,
                                                       "znear": z_near, "zfar": z_far}})
        return self.add_node(name, translation=eye, rotation=look_at(eye, target), camera=camera)

    def glb(self):
        """The document as the bytes of a GLB file; the same calls give the same bytes."""
        document = dict(self.json)
        document["scenes"] = [{"name": self.name, "nodes": self.roots}]
        if self.buffer:
            document["buffers"] = [{"byteLength": len(self.buffer)}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if self.buffer:
            data = bytes(self.buffer) + b"\0" * (-len(self.buffer) % 4)
            chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def main(make, description):
    """The command line of every scene script: `script.py -o OUT.glb`."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("-o", "--output", required=True, metavar="OUT.glb")
    options = parser.parse_args()
    document = make()
    data = document.glb()
    temporary = options.output + ".part"
    try:
        with open(temporary, "wb") as file:
            file.write(data)
        os.replace(temporary, options.output)
    except OSError as error:
        pathlib.Path(temporary).unlink(missing_ok=True)
        parser.exit(1, f"{parser.prog}: error: {options.output}: {error.strerror}\n")
    lights = document.json.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    print(f"{options.output}: {document.triangles} triangles, {len(lights)} lights, {len(data) / 1e6:.1f} MB")
