# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay's drawing of a selection of shadow maps: arrays of points and line segments with their colours."""

import colorsys
import zlib
from dataclasses import dataclass, field

import numpy as np

from .light_table import NO_SHADOW

CIRCLE_SEGMENTS = 48
LEAST_SEGMENTS = 12
MOST_FINE_SPHERES = 250  # if there are more, each gets fewer segments
OUT_OF_VIEW = (0.45, 0.45, 0.45, 0.6)
WITHOUT_SHADOW = (1.0, 0.95, 0.65, 0.8)  # paler than any cluster's
OVER_BUDGET = (1.0, 0.08, 0.05, 1.0)
AXES = ((0, 1), (1, 2), (2, 0))  # planes of the three circles that represent a sphere


@dataclass
class Lines:
    """Line segments: the two ends of each segment follow each other."""
    ends: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.float32))  # (2 n, 3), metres
    colours: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), np.float32))  # (2 n, 4)


def colour_of(name):
    """The colour of a cluster. It depends only on the name of its centre, so it stays when other clusters change. Red is for lights
    over budget."""
    number = zlib.crc32(name.encode()) * 2654435761 % 2**32  # Knuth's hash: names that differ in a digit get other colours
    hue = 0.08 + 0.84 * (number >> 16) / 65536
    return (*colorsys.hsv_to_rgb(hue, 0.55 + 0.3 * (number >> 15 & 1), 0.8 + 0.2 * (number >> 14 & 1)), 1.0)


def light_colours(center, over_budget, names, flags):
    """(n, 4): the cluster's colour; red if the budget takes a light's own map, pale yellow if a light casts no shadow (`flags`: of the
    table), grey if it is out of view."""
    colours = np.empty((len(center), 4), np.float32)
    colours[:] = OUT_OF_VIEW
    colours[(flags & NO_SHADOW) != 0] = WITHOUT_SHADOW
    in_view = center >= 0
    numbers, which = np.unique(center[in_view], return_inverse=True)
    if len(numbers):
        colours[in_view] = np.array([colour_of(names[number]) for number in numbers.tolist()], np.float32)[which]
    colours[over_budget] = OVER_BUDGET
    return colours


def links(position, center, colours):
    """Lines from each light that uses another light's map to that light."""
    member = np.flatnonzero((center >= 0) & (center != np.arange(len(center))))
    ends = np.stack([position[member], position[center[member]]], axis=1).reshape(-1, 3)
    return Lines(np.ascontiguousarray(ends, np.float32), np.repeat(colours[member], 2, axis=0))


def seen_at(places, perspective, width, height):
    """(row, x, y) of each position that is visible in a region of `width` × `height` pixels. `perspective`: rows of the view's matrix."""
    clip = np.column_stack((places, np.ones(len(places)))) @ np.asarray(perspective, float).T
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y = ((clip[:, axis] / clip[:, 3] + 1) / 2 * size for axis, size in ((0, width), (1, height)))
    seen = np.flatnonzero((clip[:, 3] > 0) & (x >= 0) & (x < width) & (y >= 0) & (y < height))
    return zip(seen.tolist(), x[seen].tolist(), y[seen].tolist())


def circle_segments(count):
    """The segments of each circle of `count` spheres. From MOST_FINE_SPHERES on, the total stays about the same."""
    return max(LEAST_SEGMENTS, min(CIRCLE_SEGMENTS, CIRCLE_SEGMENTS * MOST_FINE_SPHERES // max(count, 1)))


def spheres(centers, radii, colours):
    """Three circles for each sphere."""
    segments = circle_segments(len(centers))
    angle = np.linspace(0, 2 * np.pi, segments + 1)
    circles = np.zeros((3, segments + 1, 3), np.float32)
    for circle, (a, b) in zip(circles, AXES):
        circle[:, a], circle[:, b] = np.cos(angle), np.sin(angle)
    unit = np.stack([circles[:, :-1], circles[:, 1:]], axis=2).reshape(-1, 3)
    ends = np.asarray(centers, np.float32)[:, None, :] + np.asarray(radii, np.float32)[:, None, None] * unit
    return Lines(np.ascontiguousarray(ends.reshape(-1, 3), np.float32), np.repeat(colours, len(unit), axis=0))
