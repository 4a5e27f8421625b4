#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""80 lights and three cameras, and no meshes, for Crytek's Sponza as Khronos gives it (metres, court along x).

Bake both together: `chandelier-bake crytek_sponza.gltf rig.glb -o sponza.chandelier`. Ten circles of eight hang in the
ground floor's aisles, one in each bay of the arcades, between the columns (z = -2.4 and 1.9) and the walls (-6.3 and 5.8).
"""

import math

import numpy as np

from gltf_writer import Document, main

BAYS_X = (-8.2, -4.2, -0.4, 3.5, 7.3)
AISLES_Z = (-4.45, 3.85)
LAMP_Y = 2.6
CIRCLE_RADIUS = 0.44
RANGE_M = 7.0
CAMERAS = {"hall": ((-11.2, 1.7, -0.25), (0.0, 2.3, -0.25), 60.0),
           "arcade": ((-12.4, 1.7, -4.3), (0.0, 2.0, -4.3), 60.0),
           "gallery": ((-11.0, 6.2, -3.9), (1.0, 1.5, 1.0), 65.0)}


def light_positions():
    return [(x + CIRCLE_RADIUS * math.cos(k * math.pi / 4), LAMP_Y, z + CIRCLE_RADIUS * math.sin(k * math.pi / 4))
            for z in AISLES_Z for x in BAYS_X for k in range(8)]


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
