#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""80 lights and three cameras, and no meshes, for Crytek's Sponza as Khronos gives it (metres, court along x).

Bake both together: `chandelier-bake crytek_sponza.gltf rig.glb -o sponza.chandelier`. Ten circles of eight hang at five
bays on both sides, in turns in the court before an arch, from where they light court and banners, and in the aisle behind
it, from where columns and curtains cast their shadows into the court.
"""

import math

import numpy as np

from gltf_writer import Document, main

BAYS_X = (-8.2, -4.2, -0.4, 3.5, 7.3)
HALL = (3.1, (-1.45, 1.0))  # height and z of the circles in front of the arches
AISLE = (2.6, (-4.45, 3.85))  # and of those behind the curtains
CIRCLE_RADIUS = 0.44
RANGE_M = 7.0
CAMERAS = {"hall": ((-11.2, 1.7, -0.25), (0.0, 2.3, -0.25), 60.0),
           "arcade": ((-11.3, 1.7, -4.9), (0.0, 1.9, -4.0), 60.0),
           "gallery": ((-8.2, 6.6, -2.5), (1.5, 1.0, 1.2), 65.0)}


def circle_centers():
    centers = []
    for side in (0, 1):
        for bay, x in enumerate(BAYS_X):
            y, z = AISLE if bay % 2 else HALL
            centers.append((x, y, z[side]))
    return centers


def light_positions():
    return [(x + CIRCLE_RADIUS * math.cos(k * math.pi / 4), y, z + CIRCLE_RADIUS * math.sin(k * math.pi / 4))
            for x, y, z in circle_centers() for k in range(8)]


def make():
    doc = Document("Sponza rig")
    rng = np.random.default_rng(80)
    for i, position in enumerate(light_positions()):
        if i % 8 == 0:
            warmth, intensity = rng.random(), rng.uniform(8, 14)
        color = (1.0, 0.66 + 0.14 * warmth, 0.32 + 0.26 * warmth)
        doc.add_point_light(f"Lamp {i // 8} light {i % 8}", position, color, intensity, RANGE_M)
    for name, (eye, target, fov) in CAMERAS.items():
        doc.add_camera(name, eye, target, fov)
    return doc


if __name__ == "__main__":
    main(make, "Writes 80 lights and three cameras for Crytek's Sponza as a GLB file.")
