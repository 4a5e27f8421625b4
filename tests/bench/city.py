#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A city of any number of triangles as one .glb, for measuring how the baker scales.

Streets of towers with inset windows (hard edges), round trees (smooth) and a hilly ground, each block of the city one
mesh under a node of its own. Float positions, normals and texture coordinates, 32-bit indices, no textures.

  city.py --triangles 1000000 -o city.glb
"""

import argparse
import json
import math
import os
import struct

import numpy as np

BLOCK_M = 80.0
BLOCK_TRIANGLES = 20000  # about; a block is one mesh
TREE_RINGS, TREE_SIDES = 8, 12
MATERIALS = [("ground", (0.3, 0.35, 0.25, 1)), ("plaster", (0.8, 0.75, 0.7, 1)), ("glass", (0.1, 0.15, 0.2, 1)),
             ("leaves", (0.15, 0.4, 0.1, 1))]


class Part:
    """Vertices (position 3, normal 3, uv 2) and triangles of one material."""

    def __init__(self, vertices, triangles):
        self.vertices = np.asarray(vertices, np.float32).reshape(-1, 8)
        self.triangles = np.asarray(triangles, np.uint32).reshape(-1, 3)


def join(parts):
    bases = np.cumsum([0] + [len(p.vertices) for p in parts[:-1]])
    return Part(np.concatenate([p.vertices for p in parts]),
                np.concatenate([p.triangles + np.uint32(b) for p, b in zip(parts, bases)]))


def quads(corners, normals):
    """Flat quads, corners (n, 4, 3) counter-clockwise from their fronts."""
    count = len(corners)
    uv = np.broadcast_to(np.array([(0, 1), (1, 1), (1, 0), (0, 0)], np.float32), (count, 4, 2))
    vertices = np.concatenate([corners, np.repeat(normals[:, None], 4, 1), uv], 2)
    base = np.arange(count, dtype=np.uint32)[:, None] * 4
    return Part(vertices.reshape(-1, 8), np.concatenate([base + (0, 1, 2), base + (0, 2, 3)]))


def facade(columns, rows, width, height, depth=0.15):
    """A wall in the xy plane that faces +z: (wall and reveals, panes)."""
    cell = np.array([width / columns, height / rows, 1])
    at = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), -1).reshape(-1, 2)
    origin = np.concatenate([at * cell[:2], np.zeros((len(at), 1))], 1)
    outer = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]) * cell
    inner = np.array([(0.2, 0.2, 0), (0.8, 0.2, 0), (0.8, 0.8, 0), (0.2, 0.8, 0)]) * cell
    back = inner - (0, 0, depth)
    walls, panes = [], []
    for i in range(4):
        j = (i + 1) % 4
        front = np.array([outer[i], outer[j], inner[j], inner[i]])
        walls.append(quads(origin[:, None] + front, np.tile((0.0, 0, 1), (len(at), 1))))
        reveal = np.array([inner[i], inner[j], back[j], back[i]])
        normal = np.cross(reveal[1] - reveal[0], reveal[3] - reveal[0])
        walls.append(quads(origin[:, None] + reveal, np.tile(normal / np.linalg.norm(normal), (len(at), 1))))
    panes.append(quads(origin[:, None] + back, np.tile((0.0, 0, 1), (len(at), 1))))
    return join(walls), join(panes)


def moved(part, turn=0.0, offset=(0, 0, 0)):
    c, s = math.cos(turn), math.sin(turn)
    m = np.array([(c, 0, -s), (0, 1, 0), (s, 0, c)], np.float32)
    vertices = part.vertices.copy()
    vertices[:, :3] = vertices[:, :3] @ m + np.asarray(offset, np.float32)
    vertices[:, 3:6] = vertices[:, 3:6] @ m
    return Part(vertices, part.triangles)


def tower(columns, floors):
    width, height = columns * 3.0, floors * 3.2
    wall, pane = facade(columns, floors, width, height)
    half = width / 2
    sides = [(k * math.pi / 2, np.array([half * x, 0, half * z])) for k, (x, z) in
             enumerate([(-1, 1), (1, 1), (1, -1), (-1, -1)])]
    roof = quads(np.array([[(-half, height, half), (half, height, half), (half, height, -half), (-half, height, -half)]]),
                 np.array([(0.0, 1, 0)]))
    return {1: join([moved(wall, t, o) for t, o in sides] + [roof]), 2: join([moved(pane, t, o) for t, o in sides])}


def tree():
    v, u = np.meshgrid(np.linspace(0, math.pi, TREE_RINGS + 1), np.linspace(0, 2 * math.pi, TREE_SIDES + 1), indexing="ij")
    n = np.stack([np.sin(v) * np.cos(u), np.cos(v), -np.sin(v) * np.sin(u)], -1).reshape(-1, 3)
    bumps = 1 + 0.12 * np.sin(5 * u.ravel()) * np.sin(v.ravel())
    vertices = np.concatenate([n * (2.0 * bumps)[:, None] + (0, 3.5, 0), n,
                               np.stack([u.ravel() / 6.2832, v.ravel() / 3.1416], 1)], 1)
    return {3: Part(vertices, grid_triangles(TREE_RINGS, TREE_SIDES))}


def grid_triangles(rows, columns):
    i = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1, 1)
    return np.concatenate([i + (0, columns + 1, 1), i + (1, columns + 1, columns + 2)]).astype(np.uint32)


def ground(cells, origin):
    z, x = np.meshgrid(np.linspace(0, BLOCK_M, cells + 1), np.linspace(0, BLOCK_M, cells + 1), indexing="ij")
    wx, wz = (x + origin[0]) / 35, (z + origin[1]) / 35
    y = 0.6 * np.sin(wx) * np.cos(wz) - 0.6
    normal = np.stack([-0.6 / 35 * np.cos(wx) * np.cos(wz), np.ones_like(y), 0.6 / 35 * np.sin(wx) * np.sin(wz)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    vertices = np.concatenate([np.stack([x, y, z], -1), normal, np.stack([x, z], -1) / 4], -1)
    return {0: Part(vertices.reshape(-1, 8), grid_triangles(cells, cells))}


def block(random, triangles, origin, shapes):
    """{material: Part} of about as many triangles: half towers, four tenths trees, one tenth ground."""
    parts = {m: [] for m in range(len(MATERIALS))}

    def add(shape, turn=0.0, offset=(0, 0, 0)):
        for material, part in shape.items():
            parts[material].append(moved(part, turn, offset))
        return sum(len(part.triangles) for part in shape.values())

    add(ground(max(1, round(math.sqrt(triangles * 0.1 / 2))), origin))
    for share, kind in ((0.5, "towers"), (0.4, "trees")):
        left = triangles * share
        while left > 0:
            place = (random.uniform(8, BLOCK_M - 8), 0, random.uniform(8, BLOCK_M - 8))
            left -= add(shapes[kind][random.integers(len(shapes[kind]))], random.uniform(0, 2 * math.pi), place)
    return {m: join(p) for m, p in parts.items() if p}


class Glb:
    """Writes the binary chunk's data as it comes, so that no city needs to fit in memory."""

    def __init__(self, path):
        self.data_path, self.path = path + ".bin.tmp", path
        self.data, self.bytes = open(self.data_path, "wb"), 0
        self.views, self.accessors, self.meshes, self.nodes = [], [], [], []

    def view(self, array, target):
        self.views.append({"buffer": 0, "byteOffset": self.bytes, "byteLength": array.nbytes, "target": target})
        self.data.write(array.tobytes())
        self.bytes += array.nbytes
        return len(self.views) - 1

    def accessor(self, view, offset, component, count, kind, **limits):
        self.accessors.append({"bufferView": view, "byteOffset": offset, "componentType": component, "count": count,
                               "type": kind, **limits})
        return len(self.accessors) - 1

    def add_block(self, parts, origin):
        primitives = []
        for material, part in parts.items():
            v, count = self.view(part.vertices, 34962), len(part.vertices)
            self.views[-1]["byteStride"] = 32
            low, high = part.vertices[:, :3].min(0).tolist(), part.vertices[:, :3].max(0).tolist()
            attributes = {"POSITION": self.accessor(v, 0, 5126, count, "VEC3", min=low, max=high),
                          "NORMAL": self.accessor(v, 12, 5126, count, "VEC3"),
                          "TEXCOORD_0": self.accessor(v, 24, 5126, count, "VEC2")}
            indices = self.accessor(self.view(part.triangles, 34963), 0, 5125, part.triangles.size, "SCALAR")
            primitives.append({"attributes": attributes, "indices": indices, "material": material})
        self.meshes.append({"primitives": primitives})
        self.nodes.append({"mesh": len(self.meshes) - 1, "name": f"block {len(self.nodes)}",
                           "translation": [origin[0], 0, origin[1]]})

    def close(self):
        self.data.close()
        materials = [{"name": n, "pbrMetallicRoughness": {"baseColorFactor": c, "metallicFactor": 0}} for n, c in MATERIALS]
        text = json.dumps({"asset": {"version": "2.0", "generator": "Chandelier city"}, "scene": 0,
                           "scenes": [{"nodes": list(range(len(self.nodes)))}], "nodes": self.nodes,
                           "meshes": self.meshes, "accessors": self.accessors, "bufferViews": self.views,
                           "buffers": [{"byteLength": self.bytes}], "materials": materials}).encode()
        text += b" " * (-len(text) % 4)
        with open(self.path, "wb") as out, open(self.data_path, "rb") as data:
            out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + self.bytes))
            out.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", self.bytes, b"BIN\0"))
            while chunk := data.read(1 << 24):
                out.write(chunk)
        os.unlink(self.data_path)


def write_city(path, triangles):
    """Writes the city and returns (triangles, bytes of its geometry)."""
    random = np.random.default_rng(7)
    shapes = {"towers": [tower(c, f) for c, f in ((2, 4), (3, 5), (3, 8), (4, 6), (5, 10))], "trees": [tree()]}
    blocks = max(1, round(triangles / BLOCK_TRIANGLES))
    side = math.ceil(math.sqrt(blocks))
    glb, made = Glb(str(path)), 0
    for b in range(blocks):
        origin = (b % side * BLOCK_M, b // side * BLOCK_M)
        parts = block(random, triangles / blocks, origin, shapes)
        made += sum(len(p.triangles) for p in parts.values())
        glb.add_block(parts, origin)
    glb.close()
    return made, glb.bytes


def main():
    parser = argparse.ArgumentParser(description="Writes a generated city as a .glb.")
    parser.add_argument("--triangles", type=int, default=1_000_000, help="about how many (default: %(default)s)")
    parser.add_argument("-o", "--output", required=True, help="the .glb to write")
    arguments = parser.parse_args()
    made, size = write_city(arguments.output, arguments.triangles)
    print(f"{made} triangles, {size} bytes of geometry")


if __name__ == "__main__":
    main()
