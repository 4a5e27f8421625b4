#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A Cornell box with 32 point lights of random place, range and colour: the LightCluster paper's second scene.

The box is 1 m wide and open to the front (+z). SEED was searched for, so that light clusters of d_init 0.3, 0.4, 0.5 and
0.6 m number 13, 6, 5 and 4 from the camera "front", as in the paper's Table 1.
"""

import math

import numpy as np

from gltf_writer import Document, main, yaw
from shapes import box, join, quad, sphere

HALF = 0.5  # half the inner width; the floor is y = 0 and the ceiling y = 1
CAMERA = (0.0, 0.5, 1.55)
SEED = 30
SPHERE = ((0.22, 0.17, 0.12), 0.17)  # centre, radius
BOXES = [((-0.2, 0.0, -0.15), (0.3, 0.58, 0.3), 18.0),  # centre of the base, size, yaw in degrees
         ((-0.16, 0.0, 0.27), (0.16, 0.16, 0.16), -24.0)]
BALLS = [((-0.16, 0.16 + 0.055, 0.27), 0.055), ((0.36, 0.06, 0.34), 0.06)]
CLEARANCE = 0.05


def clear_of_objects(p):
    """Whether a light at p keeps CLEARANCE from the walls and from every object."""
    if max(abs(p[0]), abs(p[2]), abs(p[1] - 0.5)) > HALF - CLEARANCE:
        return False
    if any(np.linalg.norm(np.subtract(p, center)) < radius + CLEARANCE for center, radius in [SPHERE, *BALLS]):
        return False
    for (x, y, z), size, degrees in BOXES:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        dx, dz = p[0] - x, p[2] - z
        local = (c * dx - s * dz, p[1] - y - size[1] / 2, s * dx + c * dz)
        if all(abs(v) < extent / 2 + CLEARANCE for v, extent in zip(local, size)):
            return False
    return True


def random_lights(seed):
    """(position, range in metres, colour, intensity in candela) of each of the 32 lights."""
    rng = np.random.default_rng(seed)
    lights = []
    while len(lights) < 32:
        position = rng.uniform((-HALF, 0, -HALF), (HALF, 1, HALF))
        if not clear_of_objects(position):
            continue
        hue = rng.uniform(0, 2 * math.pi)
        color = [0.8 + 0.2 * math.cos(hue + shift) for shift in (0, 2.1, 4.2)]
        lights.append((position, rng.uniform(0.5, 1.5), color, rng.uniform(0.03, 0.09)))
    return lights


def make():
    doc = Document("Cornell box")
    white = doc.add_material("White", color=(0.73, 0.71, 0.68), roughness=0.95)
    red = doc.add_material("Red", color=(0.6, 0.06, 0.05), roughness=0.95)
    green = doc.add_material("Green", color=(0.13, 0.43, 0.1), roughness=0.95)
    gloss = doc.add_material("Glossy blue", color=(0.16, 0.24, 0.55), roughness=0.25)
    gold = doc.add_material("Gold", color=(0.95, 0.66, 0.26), roughness=0.3, metallic=1.0)
    h = HALF
    doc.add_node("Room", mesh=doc.add_mesh("Room", [
        (join([quad((-h, 0, h), (h, 0, h), (h, 0, -h), (-h, 0, -h), 0.125),
               quad((-h, 1, -h), (h, 1, -h), (h, 1, h), (-h, 1, h), 0.125),
               quad((-h, 0, -h), (h, 0, -h), (h, 1, -h), (-h, 1, -h), 0.125)]), white),
        (quad((-h, 0, h), (-h, 0, -h), (-h, 1, -h), (-h, 1, h), 0.125), red),
        (quad((h, 0, -h), (h, 0, h), (h, 1, h), (h, 1, -h), 0.125), green)]))
    for i, (base, (sx, sy, sz), degrees) in enumerate(BOXES):
        mesh = doc.add_mesh(f"Box {i}", [(box((-sx / 2, 0, -sz / 2), (sx / 2, sy, sz / 2), 0.1), white)])
        doc.add_node(f"Box {i}", mesh=mesh, translation=base, rotation=yaw(degrees))
    unit = [doc.add_mesh(f"Ball {name}", [(sphere(1.0, 40), material)]) for name, material in (("blue", gloss), ("gold", gold))]
    doc.add_node("Sphere", mesh=unit[0], translation=SPHERE[0], scale=[SPHERE[1]] * 3)
    for i, (center, radius) in enumerate(BALLS):
        doc.add_node(f"Ball {i}", mesh=unit[1], translation=center, scale=[radius] * 3)
    for i, (position, range_m, color, intensity) in enumerate(random_lights(SEED)):
        doc.add_point_light(f"Light {i}", position, color, intensity, range_m)
    doc.add_camera("front", CAMERA, (0.0, 0.5, 0.0), 45.0, 0.02, 10.0)
    return doc


if __name__ == "__main__":
    main(make, "Writes a Cornell box with 32 lights as a GLB file.")
