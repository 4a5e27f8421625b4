#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Six rooms of a house cut open, on two floors, with sconces back to back on the thin walls between them.

What it is for: the two sconces on either side of a wall hang nearer to each other than the sconces of one room do, so that
light clusters of the plain metric reach through the wall, and one room's lamps take a shadow map that is drawn next door.
"""

import math

import numpy as np

import textures
from gltf_writer import Document, main, yaw
from shapes import box, cylinder, join, lathe, quad, sphere

ROOM_X, ROOM_Y, ROOM_Z = 3.0, 2.5, 3.6  # width, height and depth within the walls
WALL = 0.1
SLAB = 0.2
COLUMNS, ROWS = 3, 2
SCONCE_Y = 1.7  # over its floor
SCONCE_OUT = 0.16  # of the bulbs from the wall
BULBS = 0.11  # half the distance between a sconce's two bulbs
SCONCES_Z = (-0.9, 0.7)  # on each side of each wall between rooms
RANGE_M = 4.5
INTENSITY_CD = 2.4
COLORS = [(1.0, 0.72, 0.42), (0.5, 0.75, 1.0), (1.0, 0.55, 0.5), (0.6, 1.0, 0.6), (1.0, 0.85, 0.6), (0.75, 0.6, 1.0)]
CAMERA = ((0.0, 2.75, 9.4), (0.0, 2.5, 0.0), 42.0)
BEDROOM = ((-1.1, 1.5, 1.7), (1.3, 1.0, -1.2), 62.0)


def low_corner(column, row):
    """Of a room's inside: left, floor, back."""
    pitch = ROOM_X + WALL
    return (column - COLUMNS / 2) * pitch + WALL / 2, row * (ROOM_Y + SLAB), -ROOM_Z / 2


def materials(doc):
    boards, boards_height = textures.wood(512, boards=8)
    plaster = doc.add_texture(textures.plaster(seed=12, dark=(206, 198, 184), light=(232, 226, 214)))
    wood, _ = textures.wood(256, seed=4, dark=(92, 56, 32), light=(150, 98, 58))
    return {"plaster": doc.add_material("Plaster", texture=plaster, tile_m=1.5, roughness=0.95),
            "floor": doc.add_material("Boards", texture=doc.add_texture(boards), tile_m=1.2, roughness=0.6,
                                      normal=doc.add_texture(textures.normal_map(boards_height[::2, ::2], 2))),
            "wood": doc.add_material("Oak", texture=doc.add_texture(wood), tile_m=0.7, roughness=0.55),
            "brass": doc.add_material("Brass", color=(0.87, 0.62, 0.26), roughness=0.35, metallic=1.0),
            "cloth": doc.add_material("Blanket", color=(0.36, 0.12, 0.14), roughness=0.95),
            "leaf": doc.add_material("Leaves", color=(0.1, 0.28, 0.09), roughness=0.8),
            "bulb": doc.add_material("Bulb", color=(1, 0.95, 0.85), emissive=(1.0, 0.85, 0.6))}


def house(doc, mat):
    """Slabs, walls and floor boards; open to the front (+z)."""
    half_x, top = COLUMNS * (ROOM_X + WALL) / 2 + WALL / 2, ROWS * (ROOM_Y + SLAB)
    z0, z1 = -ROOM_Z / 2, ROOM_Z / 2
    solid = [box((-half_x, -SLAB + row * (ROOM_Y + SLAB), z0 - WALL), (half_x, row * (ROOM_Y + SLAB), z1), 0.6) for row in range(ROWS + 1)]
    boards = []
    for row in range(ROWS):
        floor, ceiling = row * (ROOM_Y + SLAB), row * (ROOM_Y + SLAB) + ROOM_Y
        solid.append(box((-half_x, floor, z0 - WALL), (half_x, ceiling, z0), 0.6))
        for i in range(COLUMNS + 1):
            x = (i - COLUMNS / 2) * (ROOM_X + WALL)
            solid.append(box((x - WALL / 2, floor, z0), (x + WALL / 2, ceiling, z1), 0.6))
        for column in range(COLUMNS):
            x, y, z = low_corner(column, row)
            boards.append(quad((x, y + 0.005, z1), (x + ROOM_X, y + 0.005, z1), (x + ROOM_X, y + 0.005, z), (x, y + 0.005, z), 0.6))
    assert math.isclose(top - SLAB, ROWS * ROOM_Y + (ROWS - 1) * SLAB)
    doc.add_node("House", mesh=doc.add_mesh("House", [(join(solid), mat["plaster"]), (join(boards), mat["floor"])]))


def furniture(doc, mat):
    """A table, a bed, a plant and a shelf, put into the rooms in turns."""
    legs = [box((sx * 0.55 - 0.03, 0, sz * 0.3 - 0.03), (sx * 0.55 + 0.03, 0.7, sz * 0.3 + 0.03)) for sx in (-1, 1) for sz in (-1, 1)]
    table = doc.add_mesh("Table", [(join([box((-0.65, 0.7, -0.4), (0.65, 0.75, 0.4), 0.2), *legs]), mat["wood"])])
    bed = doc.add_mesh("Bed", [(join([box((-0.5, 0.1, -0.95), (0.5, 0.28, 0.95), 0.25), box((-0.5, 0.28, -1.0), (0.5, 0.85, -0.94), 0.25)]), mat["wood"]),
                               (box((-0.48, 0.28, -0.93), (0.48, 0.46, 0.93), 0.16), mat["cloth"])])
    rng = np.random.default_rng(5)
    crown = [sphere(0.13, 12).moved(*p) for p in rng.normal((0, 1.05, 0), (0.13, 0.16, 0.13), (9, 3))]
    pot = lathe([(0.0, 0.0), (0.15, 0.0), (0.2, 0.32), (0.17, 0.32), (0, 0.28)], 24)
    plant = doc.add_mesh("Plant", [(join(crown), mat["leaf"]), (join([pot, cylinder(0.025, 0.25, 1.0, 10)]), mat["wood"])])
    boards = [box((-0.45, y, -0.14), (0.45, y + 0.03, 0.14), 0.2) for y in (0.0, 0.45, 0.9, 1.35)]
    sides = [box((s * 0.45 - 0.015, 0, -0.14), (s * 0.45 + 0.015, 1.38, 0.14), 0.2) for s in (-1, 1)]
    books = [box((x - 0.03, 0.03 + 0.45 * i, -0.1), (x + 0.02, 0.03 + 0.45 * i + h, 0.08))
             for i in range(3) for x, h in zip(np.linspace(-0.38, 0.3, 7), rng.uniform(0.22, 0.34, 7))]
    shelf = doc.add_mesh("Shelf", [(join([*boards, *sides]), mat["wood"]), (join(books), mat["cloth"])])
    for column in range(COLUMNS):
        for row in range(ROWS):
            x, y, z = low_corner(column, row)
            y += 0.006
            name, kind = f"room {column} {row}", (column + row) % 2
            doc.add_node(f"Large, {name}", mesh=table if kind else bed, translation=(x + 1.5, y, z + (1.6 if kind else 1.05)))
            doc.add_node(f"Plant, {name}", mesh=plant, translation=(x + 0.55, y, z + 2.75), rotation=yaw(40.0 * column))
            doc.add_node(f"Shelf, {name}", mesh=shelf, translation=(x + 2.35, y, z + 0.17))


def sconces(doc, mat):
    """On both sides of each wall between rooms, back to back; each has two bulbs, one before the other."""
    plate = lathe([(0.0, 0.0), (0.06, 0.0), (0.05, 0.02), (0.0, 0.024)], 20).turned("z", -90.0)
    arm = box((0.01, -0.03, -BULBS), (SCONCE_OUT + 0.01, -0.015, BULBS))
    cups = [cylinder(0.018, -0.05, -0.02, 12).moved(x=SCONCE_OUT, z=s * BULBS) for s in (-1, 1)]
    bulbs = [sphere(0.014, 12).moved(x=SCONCE_OUT, y=-0.025, z=s * BULBS) for s in (-1, 1)]
    mesh = doc.add_mesh("Sconce", [(join([plate, arm, *cups]), mat["brass"]), (join(bulbs), mat["bulb"])])
    for row in range(ROWS):
        for i in range(1, COLUMNS):
            wall_x = (i - COLUMNS / 2) * (ROOM_X + WALL)
            for side, column in ((-1, i - 1), (1, i)):
                for number, z in enumerate(SCONCES_Z):
                    name = f"room {column} {row} {'right' if side < 0 else 'left'} {number}"
                    at = (wall_x + side * WALL / 2, row * (ROOM_Y + SLAB) + SCONCE_Y, z)
                    doc.add_node(f"Sconce, {name}", mesh=mesh, translation=at, rotation=yaw(0.0 if side > 0 else 180.0))
                    for s in (-1, 1):
                        doc.add_point_light(f"Bulb, {name} {'front' if s > 0 else 'back'}",
                                            (at[0] + side * SCONCE_OUT, at[1] + 0.02, z + s * BULBS), COLORS[column + COLUMNS * row],
                                            INTENSITY_CD, RANGE_M)


def make():
    doc = Document("Rooms")
    mat = materials(doc)
    house(doc, mat)
    furniture(doc, mat)
    sconces(doc, mat)
    doc.add_camera("house", *CAMERA, 0.05, 40.0)
    doc.add_camera("room", *BEDROOM, 0.05, 40.0)
    return doc


if __name__ == "__main__":
    main(make, "Writes six rooms with 32 lights as a GLB file.")
