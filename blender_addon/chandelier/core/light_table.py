# SPDX-License-Identifier: GPL-3.0-or-later
"""All lights of a scene as columns, one row for each place where one shines."""

from dataclasses import dataclass, replace

import numpy as np

from . import photometry

DYNAMIC, OWN_MAP, NO_SHADOW, MOVES = 1, 2, 4, 8  # flags; MOVES: the exported file animates it, which implies dynamic
NO_GROUP = -1

# The properties of a light's data-block, which all objects that use it share.
DATA = np.dtype([
    ("type", "u1"),  # photometry.POINT, SPOT, DIRECTIONAL
    ("flags", "u1"),
    ("priority", "u1"),
    ("group", "<i4"),
    ("intensity", "<f4"),  # candela, or lux of a directional light
    ("colour", "<f4", 3),  # linear, brightest part at most 1
    ("range_m", "<f4"),  # 0: to be derived
    ("radius_m", "<f4"),  # for a sun: the tangent of half its angle
    ("spot_outer_rad", "<f4"),  # half angle; pi if there is no cone
    ("power_w", "<f4"),
])


@dataclass
class LightTable:
    """Blender's world frame: metres, Z up. Columns are contiguous."""
    position: np.ndarray  # f4 (n, 3)
    direction: np.ndarray  # f4 (n, 3), unit length: the direction in which a spot or sun shines
    type: np.ndarray
    flags: np.ndarray
    priority: np.ndarray
    group: np.ndarray
    intensity: np.ndarray
    colour: np.ndarray
    range_m: np.ndarray
    radius_m: np.ndarray
    spot_outer_rad: np.ndarray
    power_w: np.ndarray
    names: list  # unique; an instance's is "instancer/light"
    owners: list  # the name of the object to select for it: the light itself, or its instancer

    def __len__(self):
        return len(self.names)


def frames(matrices):
    """Positions and directions of (n, 4, 4) matrices whose rows are the matrix's columns, as Blender stores them."""
    matrices = np.asarray(matrices, np.float32)
    back = matrices[:, 2, :3]
    length = np.linalg.norm(back, axis=1, keepdims=True)
    direction = np.where(length > 0, -back / np.where(length > 0, length, 1), np.float32((0, 0, -1)))
    return {"position": np.ascontiguousarray(matrices[:, 3, :3]), "direction": direction.astype(np.float32)}


def make_table(matrices, data, names, owners):
    """`data`: a record of DATA for each light."""
    columns = {name: np.ascontiguousarray(data[name]) for name in DATA.names}
    return LightTable(**frames(matrices), **columns, names=unique(names), owners=owners)


def moved(table, matrices):
    """The same lights at other positions."""
    return replace(table, **frames(matrices))


def unique(names):
    """The same names; repeated ones get a number at the end."""
    if len(set(names)) == len(names):
        return names
    taken, numbers, first, out = set(names), {}, set(), []
    for name in names:
        chosen = name
        while chosen in (first if chosen == name else taken):
            numbers[name] = numbers.get(name, 1) + 1
            chosen = f"{name} {numbers[name]}"
        first.add(name)
        taken.add(chosen)
        out.append(chosen)
    return out


def record(kind, power_w, colour, range_m=0.0, radius_m=0.0, spot_outer_rad=np.pi, dynamic=False, cluster=True, shadow=True,
           priority=128, group=NO_GROUP):
    """A row of DATA. A colour above 1, which glTF forbids, becomes intensity."""
    brightest = max(1.0, *colour)
    return ((kind, dynamic * DYNAMIC | (not cluster) * OWN_MAP | (not shadow) * NO_SHADOW, priority, group,
             photometry.intensity_of(kind, power_w) * brightest, tuple(part / brightest for part in colour), range_m, radius_m,
             spot_outer_rad, power_w))
