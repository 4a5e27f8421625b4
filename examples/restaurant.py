#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Part of a restaurant: two laid tables, a chandelier, candles and wall lamps, 14 lights of range 2 m.

The LightCluster paper's third scene. The chandelier's radius and the candles' distance are chosen so that light clusters
of d_init 0.2, 0.3, 0.4 and 0.5 m number 12, 9, 8 and 7 from the camera "table", as in the paper's Table 1: first the pairs
of candles merge, then the chandelier's six lights become three, two and one.
"""

import math

import numpy as np

import textures
from gltf_writer import Document, main, yaw
from shapes import Shape, box, cylinder, join, lathe, quad, ring, sphere, sweep

RANGE_M = 2.0
ROOM_X, ROOM_Z, ROOM_Y = 2.3, 1.7, 2.7  # half width, half depth, height
TABLES_X = (-0.95, 0.95)
TABLE_Y = 0.75
CHANDELIER = (0.0, 1.72, 0.05)  # centre of its six lights
CHANDELIER_RADIUS = 0.24
CANDLE_DISTANCE = 0.16
WALL_LAMPS = [(-1.5, 1.55, -1.58), (0.0, 1.55, -1.58), (1.5, 1.55, -1.58), (2.18, 1.55, 0.3)]
CAMERA = (-1.05, 1.45, 2.75)


def materials(doc):
    boards, boards_height = textures.wood(512, boards=8)
    wood, _ = textures.wood(256, seed=21, dark=(66, 36, 20), light=(128, 78, 44))
    plaster = doc.add_texture(textures.plaster(seed=31, dark=(196, 178, 146), light=(226, 210, 180)))
    return {"floor": doc.add_material("Floor boards", texture=doc.add_texture(boards), tile_m=1.2, roughness=0.45,
                                      normal=doc.add_texture(textures.normal_map(boards_height[::2, ::2], 2))),
            "wood": doc.add_material("Walnut", texture=doc.add_texture(wood), tile_m=0.6, roughness=0.4),
            "plaster": doc.add_material("Plaster", texture=plaster, tile_m=1.5, roughness=0.95),
            "cloth": doc.add_material("Table cloth", color=(0.82, 0.8, 0.74), roughness=0.95, double_sided=True),
            "china": doc.add_material("China", color=(0.9, 0.9, 0.88), roughness=0.15),
            "glass": doc.add_material("Green glass", color=(0.06, 0.2, 0.1), roughness=0.08),
            "brass": doc.add_material("Brass", color=(0.87, 0.62, 0.26), roughness=0.3, metallic=1.0),
            "silver": doc.add_material("Silver", color=(0.9, 0.88, 0.85), roughness=0.25, metallic=1.0),
            "wax": doc.add_material("Wax", color=(0.92, 0.86, 0.7), roughness=0.6),
            "leather": doc.add_material("Red leather", color=(0.42, 0.05, 0.04), roughness=0.5),
            "flame": doc.add_material("Flame", color=(1, 0.8, 0.4), emissive=(1.0, 0.62, 0.2)),
            "bulb": doc.add_material("Bulb", color=(1, 0.95, 0.8), emissive=(1.0, 0.8, 0.5))}


def room(doc, mat):
    x, z, y, rail = ROOM_X, ROOM_Z, ROOM_Y, 0.95
    walls = [quad((-x, rail, -z), (x, rail, -z), (x, y, -z), (-x, y, -z), 0.6),
             quad((-x, rail, z), (-x, rail, -z), (-x, y, -z), (-x, y, z), 0.6),
             quad((x, rail, -z), (x, rail, z), (x, y, z), (x, y, -z), 0.6),
             quad((-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z), 0.6)]
    panels = [box((-x, 0, -z - 0.05), (x, rail, -z)), box((-x - 0.05, 0, -z), (-x, rail, z)), box((x, 0, -z), (x + 0.05, rail, z)),
              box((-x, rail - 0.06, -z), (x, rail, -z + 0.05)), box((-x, 0, -z), (x, 0.12, -z + 0.02)),
              box((-x, rail - 0.06, -z), (-x + 0.05, rail, z)), box((x - 0.05, rail - 0.06, -z), (x, rail, z)),
              box((-x, y - 0.16, -z), (x, y, -z + 0.1))]
    for px in np.linspace(-x + 0.25, x - 0.25, 9):  # raised fields of the wainscot
        panels.append(box((px - 0.2, 0.2, -z), (px + 0.2, 0.82, -z + 0.018)))
    for pz in np.linspace(-z + 0.3, z - 0.3, 6):
        panels.append(box((-x, 0.2, pz - 0.2), (-x + 0.018, 0.82, pz + 0.2)))
        panels.append(box((x - 0.018, 0.2, pz - 0.2), (x, 0.82, pz + 0.2)))
    for bz in (-1.1, 0.05, 1.2):
        panels.append(box((-x, y - 0.2, bz - 0.08), (x, y, bz + 0.08)))
    for px in (-0.75, 0.75):  # picture frames on the back wall
        for lo, hi in (((-0.3, 1.3), (0.3, 1.34)), ((-0.3, 1.72), (0.3, 1.76)), ((-0.3, 1.34), (-0.26, 1.72)), ((0.26, 1.34), (0.3, 1.72))):
            panels.append(box((px + lo[0], lo[1], -z), (px + hi[0], hi[1], -z + 0.04)))
    doc.add_node("Room", mesh=doc.add_mesh("Room", [
        (quad((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z), 0.6), mat["floor"]), (join(walls), mat["plaster"]),
        (join(panels), mat["wood"])]))


def cloth(radius, drop, folds=11, segments=132):
    """A round table cloth: flat on the table, then falling in folds that deepen towards the hem; seen from both sides."""
    rows = [(0.0, 0.0, 0.0), (radius, 0.0, 0.0)] + [(radius + 0.012 + 0.03 * t, -0.008 - drop * t, 0.05 * t) for t in np.linspace(0.1, 1, 7)]
    angles = np.linspace(0, 2 * math.pi, segments + 1)
    grid = np.array([[((r + wave * math.sin(folds * a)) * math.cos(a), y, (r + wave * math.sin(folds * a)) * math.sin(a))
                      for a in angles] for r, y, wave in rows])
    along, down = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    normals = np.cross(along, down)
    normals[:2] = (0, 1, 0)
    normals /= np.linalg.norm(normals, axis=2)[..., None]
    triangles, m = [], segments + 1
    for i in range(len(rows) - 1):
        for k in range(segments):
            a, b = i * m + k, (i + 1) * m + k
            triangles += [(a, b + 1, b)] + ([(a, a + 1, b + 1)] if i else [])
    return Shape(grid.reshape(-1, 3), normals.reshape(-1, 3), grid.reshape(-1, 3)[:, (0, 2)], triangles)


def table_mesh(doc, mat):
    foot = lathe([(0.28, 0), (0.3, 0.02), (0.26, 0.05), (0.08, 0.1), (0.05, 0.16), (0.06, 0.3), (0.045, 0.45), (0.06, 0.6),
                  (0.12, 0.68), (0.14, TABLE_Y - 0.04), (0, TABLE_Y - 0.04)], 24)
    top = lathe([(0, TABLE_Y - 0.04), (0.5, TABLE_Y - 0.04), (0.5, TABLE_Y - 0.004), (0, TABLE_Y - 0.004)], 48)
    return doc.add_mesh("Table", [(join([foot, top]), mat["wood"]), (cloth(0.5, 0.22).moved(y=TABLE_Y), mat["cloth"])])


def chair_mesh(doc, mat):
    """A bentwood chair that faces -z; origin on the floor under its seat."""
    wood = [lathe([(0.0, 0.43), (0.2, 0.43), (0.215, 0.445), (0.2, 0.46), (0, 0.46)], 28)]
    for sx in (-1, 1):
        wood.append(sweep([(sx * 0.15, 0.44, -0.14), (sx * 0.165, 0.22, -0.16), (sx * 0.175, 0, -0.18)], 0.016, 8))
        wood.append(sweep([(sx * 0.14, 0.44, 0.14), (sx * 0.16, 0.2, 0.18), (sx * 0.17, 0, 0.22)], 0.016, 8))
    for width, height, radius in ((0.18, 0.9, 0.016), (0.11, 0.8, 0.011)):  # the two bent hoops of the back
        t = np.linspace(0, math.pi, 17)
        wood.append(sweep([(width * math.cos(a), 0.44 + (height - 0.44) * math.sin(a) ** 0.6, 0.17 + 0.07 * math.sin(a)) for a in t],
                          radius, 8))
    wood.append(ring(0.15, 0.01, 24, 6).moved(y=0.22))
    seat = lathe([(0.2, 0.455), (0.19, 0.475), (0.1, 0.487), (0, 0.49)], 28)
    return doc.add_mesh("Chair", [(join(wood), mat["wood"]), (seat, mat["leather"])])


def setting_mesh(doc, mat):
    """A plate, knife, fork and a wine glass for a guest who sits towards +z; origin at the plate."""
    plate = lathe([(0.05, 0), (0.07, 0.002), (0.11, 0.014), (0.112, 0.017), (0.075, 0.008), (0, 0.006)], 32)
    bowl = lathe([(0.032, 0), (0.055, 0.03), (0.058, 0.042), (0.054, 0.042), (0.03, 0.012), (0, 0.01)], 24).moved(y=0.008)
    glass = lathe([(0, 0), (0.032, 0.001), (0.03, 0.004), (0.005, 0.012), (0.0045, 0.075), (0.02, 0.09), (0.034, 0.12), (0.03, 0.165),
                   (0.0285, 0.165), (0.032, 0.12), (0.018, 0.093), (0, 0.085)], 20).moved(x=0.1, z=-0.12)
    knife = box((0.128, 0.001, -0.08), (0.138, 0.004, 0.09))
    fork = box((-0.138, 0.001, -0.03), (-0.13, 0.004, 0.09))
    prongs = [box((-0.143 + 0.006 * i, 0.001, -0.09), (-0.14 + 0.006 * i, 0.003, -0.03)) for i in range(3)]
    return doc.add_mesh("Setting", [(join([plate, bowl]), mat["china"]), (glass, mat["glass"]),
                                    (join([knife, fork, *prongs]), mat["silver"])])


def flame(y):
    """A flame 2.4 cm high. The light stands 1.5 cm over its tip, so that no mesh encloses it."""
    return lathe([(0, y), (0.005, y + 0.003), (0.0065, y + 0.008), (0.003, y + 0.018), (0, y + 0.024)], 10)


def candle_stand(doc, mat):
    """A brass stand with two candles CANDLE_DISTANCE apart; origin on the table. Returns the mesh and the lights' height."""
    half, arm_y, wax_y = CANDLE_DISTANCE / 2, 0.12, 0.24
    brass = [lathe([(0.055, 0), (0.058, 0.006), (0.03, 0.018), (0.01, 0.03), (0.016, 0.05), (0.008, 0.07), (0.012, arm_y), (0.006, arm_y + 0.03),
                    (0, arm_y + 0.04)], 24)]
    t = np.linspace(0, 1, 11)
    wax, flames = [], []
    for s in (-1, 1):
        brass.append(sweep([(s * half * v, arm_y - 0.035 * math.sin(math.pi * v), 0) for v in t], 0.005, 8))
        brass.append(lathe([(0, arm_y - 0.004), (0.012, arm_y), (0.026, arm_y + 0.008), (0.024, arm_y + 0.012), (0, arm_y + 0.01)], 16).moved(x=s * half))
        wax.append(cylinder(0.01, arm_y + 0.01, wax_y, 14).moved(x=s * half))
        flames.append(flame(wax_y + 0.004).moved(x=s * half))
    return doc.add_mesh("Candle stand", [(join(brass), mat["brass"]), (join(wax), mat["wax"]), (join(flames), mat["flame"])]), wax_y + 0.043


def tables(doc, mat):
    table, chair, setting = table_mesh(doc, mat), chair_mesh(doc, mat), setting_mesh(doc, mat)
    stand, light_y = candle_stand(doc, mat)
    bottle = doc.add_mesh("Bottle", [(lathe([(0.034, 0), (0.037, 0.01), (0.037, 0.17), (0.03, 0.205), (0.014, 0.23), (0.013, 0.29),
                                             (0.016, 0.292), (0.016, 0.3), (0, 0.3)], 24), mat["glass"])])
    for i, x in enumerate(TABLES_X):
        group = doc.add_node(f"Table {i}", mesh=table, translation=(x, 0, 0.1), rotation=yaw(20 * i))
        for k, degrees in enumerate((35, 145, 215, 325)):
            c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            doc.add_node(f"Chair {i}.{k}", group, chair, (0.72 * s, 0, 0.72 * c), yaw(degrees + 6 * (k - 1.5)))
            doc.add_node(f"Setting {i}.{k}", group, setting, (0.34 * s, TABLE_Y, 0.34 * c), yaw(degrees))
        doc.add_node(f"Bottle {i}", group, bottle, (-0.02, TABLE_Y, -0.16))
        candles = doc.add_node(f"Candle stand {i}", group, stand, (0, TABLE_Y, 0.02), yaw(-15))
        for k, side in enumerate((-1, 1)):
            doc.add_point_light(f"Candle {i}.{k}", (side * CANDLE_DISTANCE / 2, light_y, 0), (1.0, 0.62, 0.28), 0.9, RANGE_M, candles)


def chandelier(doc, mat):
    """Six arms from a turned stem; the candle lights stand at the origin's height, CHANDELIER_RADIUS from the stem."""
    up = ROOM_Y - 0.2 - CHANDELIER[1]
    stem = lathe([(0, -0.26), (0.02, -0.25), (0.03, -0.225), (0.016, -0.2), (0.012, -0.16), (0.045, -0.12), (0.05, -0.09), (0.02, -0.05),
                  (0.012, 0.02), (0.025, 0.05), (0.012, 0.08), (0.008, 0.2), (0.004, 0.22), (0.004, up - 0.05), (0.05, up - 0.03), (0.055, up), (0, up)], 28)
    brass, wax, flames = [stem], [], []
    for k in range(6):
        a = k * math.pi / 3
        x, z = math.cos(a), math.sin(a)
        curve = [(0.04, -0.1), (0.08, -0.14), (0.13, -0.165), (0.18, -0.16), (0.22, -0.135), (CHANDELIER_RADIUS, -0.1)]
        brass.append(sweep([(r * x, y, r * z) for r, y in curve], 0.006, 8))
        cup = lathe([(0, -0.105), (0.01, -0.1), (0.03, -0.088), (0.028, -0.084), (0, -0.086)], 16)
        brass.append(cup.moved(x=CHANDELIER_RADIUS * x, z=CHANDELIER_RADIUS * z))
        wax.append(cylinder(0.0095, -0.087, -0.043, 14).moved(x=CHANDELIER_RADIUS * x, z=CHANDELIER_RADIUS * z))
        flames.append(flame(-0.039).moved(x=CHANDELIER_RADIUS * x, z=CHANDELIER_RADIUS * z))
        brass.append(sphere(0.011, 12).moved(x=0.13 * x, y=-0.185, z=0.13 * z))
    node = doc.add_node("Chandelier", translation=CHANDELIER, mesh=doc.add_mesh("Chandelier", [
        (join(brass), mat["brass"]), (join(wax), mat["wax"]), (join(flames), mat["flame"])]))
    for k in range(6):
        a = k * math.pi / 3
        doc.add_point_light(f"Chandelier {k}", (CHANDELIER_RADIUS * math.cos(a), 0, CHANDELIER_RADIUS * math.sin(a)),
                            (1.0, 0.68, 0.36), 1.4, RANGE_M, node)


def wall_lamps(doc, mat):
    """Brass arms that hold a bare bulb under the light; origin: the light."""
    brass = [sweep([(0, -0.1, -0.12), (0, -0.12, -0.06), (0, -0.1, -0.01), (0, -0.06, 0)], 0.007, 8),
             lathe([(0.04, 0), (0.04, 0.012), (0.02, 0.02), (0, 0.02)], 20).turned("x", 90).moved(y=-0.1, z=-0.12),
             lathe([(0, -0.065), (0.018, -0.06), (0.018, -0.05), (0, -0.05)], 14)]
    bulb = lathe([(0, -0.05), (0.012, -0.046), (0.016, -0.035), (0.01, -0.022), (0, -0.018)], 14)
    lamp = doc.add_mesh("Wall lamp", [(join(brass), mat["brass"]), (bulb, mat["bulb"])])
    for i, position in enumerate(WALL_LAMPS):
        node = doc.add_node(f"Wall lamp {i}", mesh=lamp, translation=position, rotation=yaw(-90 if position[0] > 2 else 0))
        doc.add_point_light(f"Wall lamp {i} light", (0, 0, 0), (1.0, 0.74, 0.45), 1.6, RANGE_M, node)


def make():
    doc = Document("Restaurant")
    mat = materials(doc)
    room(doc, mat)
    tables(doc, mat)
    chandelier(doc, mat)
    wall_lamps(doc, mat)
    doc.add_camera("table", CAMERA, (0.1, 1.05, 0.0), 50.0, 0.02, 20.0)
    return doc


if __name__ == "__main__":
    main(make, "Writes the restaurant with 14 lights as a GLB file.")
