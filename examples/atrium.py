#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""An arcaded atrium with 80 lights in ten hanging lamps of eight: the LightCluster paper's first scene.

The court runs along x, an arcade on either side of it (z = ±3 to ±6) and a gallery above. The lamps hang in every
second bay, so that light clusters of d_init 0.1, 0.3, 0.5 and 1.6 m number 80, 44, 26 and 10 (paper, Table 1).
"""

import math

import numpy as np

import textures
from gltf_writer import Document, main, yaw
from shapes import arch_wall, archivolt, box, cylinder, join, lathe, quad, ring, sweep

CAMERA = (-11.0, 2.0, 2.0)
LAMP_X = (-10.0, -5.0, 0.0, 5.0, 10.0)
LAMP_Z = (-4.5, 4.5)
LAMP_Y = 2.5
CIRCLE_RADIUS = 0.44
RANGE_M = 7.0

BAY = 2.5
COLUMNS_X = [-13.75 + BAY * i for i in range(12)]
END_X = 14.4  # inner face of the end walls
COURT_Z, WALL_Z = 3.0, 6.0  # row of columns; inner face of the outer walls
FLOOR_2, ROOF_Y = 4.7, 8.4  # top of the gallery's joists; eaves
GALLERY_WALL = 0.5


def materials(doc):
    brick, brick_height = textures.bricks(512)
    stone, stone_height = textures.ashlar(512)
    floor, floor_height = textures.checker(512)
    wood, _ = textures.wood()
    plaster = doc.add_texture(textures.plaster())

    def bumpy(name, color, height, depth, **more):
        return doc.add_material(name, texture=doc.add_texture(color),
                                normal=doc.add_texture(textures.normal_map(height[::2, ::2], depth)), **more)

    return {"brick": bumpy("Brick", brick, brick_height, 3, tile_m=1.0, roughness=0.9),
            "ashlar": bumpy("Ashlar", stone, stone_height, 3, tile_m=1.6, roughness=0.75),
            "floor": bumpy("Floor tiles", floor, floor_height, 4, tile_m=1.0, roughness=0.35),
            "plaster": doc.add_material("Plaster", texture=plaster, tile_m=2.0, roughness=0.95),
            "stone": doc.add_material("Column stone", color=(0.95, 0.9, 0.8), texture=plaster, tile_m=1.1, roughness=0.6),
            "wood": doc.add_material("Timber", texture=doc.add_texture(wood), tile_m=1.0, roughness=0.7),
            "iron": doc.add_material("Wrought iron", color=(0.09, 0.08, 0.07), roughness=0.5, metallic=0.6),
            "clay": doc.add_material("Terracotta", color=(0.55, 0.24, 0.13), roughness=0.85),
            "leaf": doc.add_material("Leaves", color=(0.12, 0.26, 0.07), roughness=0.7, double_sided=True),
            "bulb": doc.add_material("Bulb", color=(1, 0.9, 0.75), emissive=(1.0, 0.72, 0.4))}


def column(height, radius, segments):
    """A column with a moulded base, entasis (the shaft narrows upwards) and a bell capital under a square abacus."""
    r, plinth, top = radius, 0.18, height - 0.12
    base = [(0, plinth), (1.35 * r, plinth), (1.38 * r, plinth + 0.04), (1.3 * r, plinth + 0.08), (1.12 * r, plinth + 0.11),
            (1.22 * r, plinth + 0.15), (1.18 * r, plinth + 0.19), (1.0 * r, plinth + 0.22)]
    y0, y1 = plinth + 0.22, top - 0.36
    shaft = [(r * (1 - 0.16 * t**1.6), y0 + (y1 - y0) * t) for t in np.linspace(0.2, 1, 5)]
    bell = [(0.98 * r, top - 0.34), (0.98 * r, top - 0.31), (0.86 * r, top - 0.28), (0.92 * r, top - 0.18),
            (1.1 * r, top - 0.09), (1.4 * r, top - 0.02), (1.42 * r, top), (0, top)]
    a = 1.5 * r
    return join([box((-a, 0, -a), (a, plinth, a)), lathe(base + shaft + bell, segments), box((-a, top, -a), (a, height, a))])


def arcade(doc, mat):
    """Columns and arches of the ground floor and of the gallery, each mesh shared by all its bays and by both sides."""
    ground_column = doc.add_mesh("Column", [(column(2.9, 0.24, 18), mat["stone"])])
    ground_arch = doc.add_mesh("Arch", [
        (arch_wall(BAY, 2.9, FLOOR_2 - 0.3, 0.95, 0.62, 20), mat["brick"]),
        (archivolt(2.9, 0.95, 0.2, 0.31, 0.36, 20), mat["stone"])])
    gallery_column = doc.add_mesh("Gallery column", [(column(1.45, 0.15, 12).moved(y=FLOOR_2 + 0.75), mat["stone"])])
    gallery_arch = doc.add_mesh("Gallery arch", [
        (arch_wall(BAY, FLOOR_2 + 2.2, ROOF_Y - 0.25, 1.0, GALLERY_WALL, 16), mat["plaster"]),
        (archivolt(FLOOR_2 + 2.2, 1.0, 0.16, 0.25, 0.3, 16), mat["stone"])])
    parapet = doc.add_mesh("Parapet", [
        (box((-BAY / 2, FLOOR_2, -0.2), (BAY / 2, FLOOR_2 + 0.65, 0.2)), mat["plaster"]),
        (box((-BAY / 2, FLOOR_2 + 0.65, -0.26), (BAY / 2, FLOOR_2 + 0.75, 0.26)), mat["stone"])])
    for z, name, turn in ((-COURT_Z, "North", 0), (COURT_Z, "South", 180)):
        side = doc.add_node(f"{name} arcade", translation=(0, 0, z), rotation=yaw(turn))
        for i, x in enumerate(COLUMNS_X):
            doc.add_node(f"{name} column {i}", side, ground_column, (x, 0, 0))
            doc.add_node(f"{name} gallery column {i}", side, gallery_column, (x, 0, 0))
        for i in range(len(COLUMNS_X) - 1):
            x = COLUMNS_X[i] + BAY / 2
            for what, mesh in (("arch", ground_arch), ("gallery arch", gallery_arch), ("parapet", parapet)):
                doc.add_node(f"{name} {what} {i}", side, mesh, (x, 0, 0))


def cornice(z, y, depth, height):
    """A stepped moulding along the whole court on the wall whose face is at z; it juts out towards z = 0."""
    steps = [(0.35, 0.0, 0.4), (0.7, 0.4, 0.7), (1.0, 0.7, 1.0)]
    s = math.copysign(1, z)
    return join([box((-END_X, y + height * a, min(z, z - s * depth * d)), (END_X, y + height * b, max(z, z - s * depth * d)))
                 for d, a, b in steps])


def shell(doc, mat):
    """Floors, outer and end walls, ceilings of the aisles and the roof."""
    ex, wz = END_X, WALL_Z
    doc.add_node("Floor", mesh=doc.add_mesh("Floor", [
        (quad((-ex, 0, wz), (ex, 0, wz), (ex, 0, -wz), (-ex, 0, -wz), 1.0), mat["floor"])]))
    walls, trims, plasters = [], [], []
    for s in (-1, 1):
        z = s * wz
        walls.append(box((-ex, 0, min(z, z + s * 0.3)), (ex, FLOOR_2 - 0.3, max(z, z + s * 0.3)), 1.2))
        plasters.append(box((-ex, FLOOR_2, min(z, z + s * 0.3)), (ex, ROOF_Y, max(z, z + s * 0.3)), 1.4))
        trims += [cornice(s * (COURT_Z - 0.31), FLOOR_2 - 0.3, 0.22, 0.3), cornice(s * (COURT_Z - 0.25), ROOF_Y - 0.3, 0.35, 0.3),
                  cornice(z, 0.0, 0.08, 0.35)]
        for x in COLUMNS_X:  # pilasters answer the columns
            trims.append(box((x - 0.22, 0, min(z, z - s * 0.14)), (x + 0.22, FLOOR_2 - 0.45, max(z, z - s * 0.14))))
            trims.append(box((x - 0.28, 2.72, min(z, z - s * 0.2)), (x + 0.28, 2.9, max(z, z - s * 0.2))))
        z0, z1 = sorted((s * (COURT_Z - 0.31), s * (COURT_Z + 0.31)))
        plasters.append(box((-ex, FLOOR_2 - 0.3, z0), (ex, FLOOR_2, z1), 1.4))
        x = s * ex
        walls.append(box((min(x, x + s * 0.3), 0, -wz), (max(x, x + s * 0.3), FLOOR_2, wz), 1.2))
        plasters.append(box((min(x, x + s * 0.3), FLOOR_2, -wz), (max(x, x + s * 0.3), ROOF_Y, wz), 1.4))
        trims.append(box((min(x, x - s * 0.15), FLOOR_2 - 0.3, -COURT_Z), (max(x, x - s * 0.15), FLOOR_2, COURT_Z)))
    doc.add_node("Walls", mesh=doc.add_mesh("Walls", [(join(walls), mat["brick"]), (join(plasters), mat["plaster"]),
                                                      (join(trims), mat["stone"])]))


def timber(doc, mat):
    """The gallery's open joists, through which the lamps light the storey above, and a roof of trusses and boards."""
    beams = []
    for s in (-1, 1):
        for z in (3.6, 4.05, 4.5, 4.95, 5.4, 5.85):
            beams.append(box((-END_X, FLOOR_2 - 0.3, s * z - 0.06), (END_X, FLOOR_2 - 0.1, s * z + 0.06)))
        for x in COLUMNS_X:
            z0, z1 = sorted((s * (COURT_Z + 0.31), s * WALL_Z))
            beams.append(box((x - 0.11, FLOOR_2 - 0.55, z0), (x + 0.11, FLOOR_2 - 0.3, z1)))
    ridge = ROOF_Y + 2.2
    for x in COLUMNS_X:
        beams.append(box((x - 0.12, ROOF_Y - 0.35, -WALL_Z), (x + 0.12, ROOF_Y - 0.05, WALL_Z)))
        beams.append(box((x - 0.1, ROOF_Y - 0.05, -0.1), (x + 0.1, ridge - 0.15, 0.1)))
        for s in (-1, 1):
            beams.append(sweep([(x, ROOF_Y, s * WALL_Z), (x, ridge - 0.2, 0)], 0.12, 4))
            beams.append(sweep([(x, ROOF_Y, s * 0.15), (x, ROOF_Y + 1.15, s * 2.6)], 0.08, 4))
    roof = []
    for s in (-1, 1):
        a, b = (-END_X, ROOF_Y, s * (WALL_Z + 0.3)), (END_X, ROOF_Y, s * (WALL_Z + 0.3))
        c, d = (END_X, ridge, 0), (-END_X, ridge, 0)
        roof.append(quad(a, b, c, d, 1.6) if s < 0 else quad(b, a, d, c, 1.6))
    gables = []
    for s in (-1, 1):
        x, z = s * END_X, WALL_Z
        gables.append(quad((x, ROOF_Y, s * z), (x, ROOF_Y, -s * z), (x, ridge, -s * z), (x, ridge, s * z), 1.4))
    doc.add_node("Timber", mesh=doc.add_mesh("Timber", [(join(beams), mat["wood"]), (join(roof), mat["wood"]),
                                                        (join(gables), mat["plaster"])]))


def lamp_mesh(doc, mat):
    """An iron hoop on chains with eight pendants. Origin: the lights' circle. Every light hangs free 4 cm under its bulb."""
    hoop_y, top = 0.3, FLOOR_2 - 0.3 - LAMP_Y
    iron = [ring(CIRCLE_RADIUS, 0.018, 32, 6).moved(y=hoop_y), ring(0.12, 0.012, 20, 6).moved(y=hoop_y + 0.7),
            cylinder(0.012, hoop_y + 0.7, top, 8), lathe([(0.02, top - 0.08), (0.09, top - 0.02), (0.09, top), (0, top)], 20)]
    bulbs = []
    for k in range(8):
        a = k * math.pi / 4
        x, z = CIRCLE_RADIUS * math.cos(a), CIRCLE_RADIUS * math.sin(a)
        hood = lathe([(0.014, 0.11), (0.05, 0.085), (0.052, 0.09), (0.02, 0.13), (0.008, 0.14), (0.008, hoop_y)], 9)
        iron.append(hood.moved(x=x, z=z))
        bulbs.append(lathe([(0, 0.04), (0.018, 0.048), (0.026, 0.065), (0.024, 0.085), (0.014, 0.105)], 8).moved(x=x, z=z))
        if k % 2 == 0:
            iron.append(sweep([(x, hoop_y, z), (0.27 * x, hoop_y + 0.7, 0.27 * z)], 0.007, 5))
        iron.append(sweep([(0, hoop_y, 0), (x, hoop_y, z)], 0.008, 5))
    return doc.add_mesh("Ring lamp", [(join(iron), mat["iron"]), (join(bulbs), mat["bulb"])])


def lamps(doc, mat):
    mesh = lamp_mesh(doc, mat)
    rng = np.random.default_rng(80)
    count = 0
    for z in LAMP_Z:
        for x in LAMP_X:
            warmth, intensity = rng.random(), rng.uniform(8, 14)
            color = (1.0, 0.66 + 0.14 * warmth, 0.32 + 0.26 * warmth)
            lamp = doc.add_node(f"Lamp {count // 8}", mesh=mesh, translation=(x, LAMP_Y, z))
            for k in range(8):
                a = k * math.pi / 4
                doc.add_point_light(f"Lamp {count // 8} light {k}", (CIRCLE_RADIUS * math.cos(a), 0, CIRCLE_RADIUS * math.sin(a)),
                                    color, intensity, RANGE_M, lamp)
                count += 1


def pot_with_plant(mat, seed):
    """A terracotta pot with arching leaves, each a strip of quads that narrows to its tip."""
    pot = lathe([(0, 0), (0.2, 0), (0.24, 0.1), (0.3, 0.42), (0.34, 0.42), (0.34, 0.5), (0.28, 0.5), (0.27, 0.44), (0, 0.44)], 28)
    rng = np.random.default_rng(seed)
    leaves = []
    for i in range(26):
        yaw_rad, reach, rise = i * 2.4 + rng.uniform(-0.3, 0.3), rng.uniform(0.25, 0.6), rng.uniform(0.35, 0.9)
        t = np.linspace(0, 1, 7)
        r, y = 0.04 + reach * t, 0.44 + rise * (1.9 * t - 1.1 * t * t)
        out, side = np.array((math.cos(yaw_rad), 0, math.sin(yaw_rad))), np.array((-math.sin(yaw_rad), 0, math.cos(yaw_rad)))
        for j in range(6):
            w0, w1 = (0.035 * math.sin(math.pi * (0.15 + 0.85 * s)) + 0.002 for s in (t[j], t[j + 1]))
            low, high = out * r[j] + (0, y[j], 0), out * r[j + 1] + (0, y[j + 1], 0)
            middle = (w0 + w1) / 2
            leaves.append(quad(low - side * middle, low + side * middle, high + side * middle, high - side * middle))
    return [(pot, mat["clay"]), (join(leaves), mat["leaf"])]


def furniture(doc, mat):
    """Pots with plants between columns, and a fountain in the middle of the court."""
    pot = doc.add_mesh("Plant", pot_with_plant(mat, 4))
    for i, (x, z) in enumerate(((-8.75, 2.35), (-3.75, -2.35), (1.25, 2.35), (6.25, -2.35), (8.75, 2.35), (-8.75, -2.35), (11.25, -2.35))):
        doc.add_node(f"Plant {i}", mesh=pot, translation=(x, 0, z), rotation=yaw(47 * i), scale=(1, 1 + 0.07 * (i % 3), 1))
    basin = [(1.25, 0), (1.3, 0.08), (1.2, 0.14), (1.2, 0.42), (1.32, 0.5), (1.32, 0.58), (1.08, 0.58), (1.04, 0.3), (0, 0.3)]
    foot = [(0.2, 0.3), (0.22, 0.4), (0.12, 0.5), (0.1, 0.95), (0.16, 1.02), (0.5, 1.2), (0.6, 1.3), (0.56, 1.33), (0.2, 1.2),
            (0.07, 1.2), (0.06, 1.5), (0.1, 1.6), (0.05, 1.75), (0, 1.78)]
    doc.add_node("Fountain", translation=(2.5, 0, 0), mesh=doc.add_mesh("Fountain", [
        (join([lathe(basin, 48), lathe(foot, 32)]), mat["stone"])]))


def make():
    doc = Document("Atrium")
    mat = materials(doc)
    shell(doc, mat)
    timber(doc, mat)
    arcade(doc, mat)
    furniture(doc, mat)
    lamps(doc, mat)
    doc.add_camera("hall", CAMERA, (0.0, 2.0, 0.0), 60.0)
    doc.add_camera("arcade", (-12.2, 1.6, -4.7), (0.0, 2.1, -2.9), 60.0)
    doc.add_camera("gallery", (-12.0, 6.3, 4.6), (2.0, 1.2, -2.0), 60.0)
    return doc


if __name__ == "__main__":
    main(make, "Writes the atrium with 80 lights as a GLB file.")
