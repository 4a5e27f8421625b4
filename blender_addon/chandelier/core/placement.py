# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions for lights: along lines, around objects, with a minimum distance. Points are arrays (n, 3), metres; the same seed gives the
same points."""

import math

import numpy as np

TRIES = 40  # random points per wanted point, before a volume counts as full
FILLING = 1000  # random points per attempt if as many are wanted as there is room for
MOST = 20000


def polylines(edges, count):
    """The chains of vertices that edges form, each as (indices, closed). Splines converted to a mesh become such chains."""
    neighbours = [[] for _ in range(count)]
    for a, b in edges:
        neighbours[a].append(b)
        neighbours[b].append(a)
    ends = [i for i in range(count) if len(neighbours[i]) == 1]
    chains, seen = [], set()
    for start in (*ends, *range(count)):
        if start in seen or not neighbours[start]:
            continue
        chain, here = [], start
        while here is not None:
            seen.add(here)
            chain.append(here)
            here = next((i for i in neighbours[here] if i not in seen), None)
        chains.append((chain, len(chain) > 2 and start in neighbours[chain[-1]]))
    return chains


def along(points, closed=False, count=0, spacing=0.0):
    """`count` points along a line, including its ends, or points `spacing` apart from its start on; and the line's
    directions there."""
    points = np.asarray(points, float).reshape(-1, 3)
    if closed:
        points = np.concatenate((points, points[:1]))
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    steps, starts, lengths = steps[lengths > 0], points[:-1][lengths > 0], lengths[lengths > 0]
    if not len(lengths):
        return points[:1], np.array(((1.0, 0, 0),))[:len(points)]
    distances = np.concatenate(((0,), np.cumsum(lengths)))
    total = distances[-1]
    if spacing > 0:
        places = np.arange(0, total * (1 - 1e-9) if closed else total * (1 + 1e-9), spacing)
    elif count == 1:
        places = np.zeros(1) if closed else np.array((total / 2,))
    else:
        places = np.linspace(0, total, count, endpoint=not closed)
    segment = np.clip(np.searchsorted(distances, places, side="right") - 1, 0, len(lengths) - 1)
    ways = steps[segment] / lengths[segment, None]
    return starts[segment] + ways * (places - distances[segment])[:, None], ways


def ring(centre, radius, count=0, spacing=0.0):
    """Points on a horizontal circle, `count` of them or as many as fit `spacing` apart; and the directions outwards."""
    if spacing > 0:
        count = max(1, int(2 * math.pi * radius / spacing + 1e-9))
    angles = np.arange(count) * (2 * math.pi / max(count, 1))
    outwards = np.stack((np.cos(angles), np.sin(angles), np.zeros(count)), axis=1)
    return np.asarray(centre, float) + radius * outwards, outwards


class Apart:
    """A set of points of which no two are closer than a distance; stored in cells of that size."""

    def __init__(self, distance):
        self.distance, self.cells = distance, {}

    def add(self, point):
        """Adds the point if it is far enough from all others. Returns whether it was added."""
        if self.distance <= 0:
            return True
        x, y, z = (math.floor(part / self.distance) for part in point)
        for i in range(x - 1, x + 2):
            for j in range(y - 1, y + 2):
                for k in range(z - 1, z + 2):
                    for other in self.cells.get((i, j, k), ()):
                        if math.dist(point, other) < self.distance:
                            return False
        self.cells.setdefault((x, y, z), []).append(tuple(point))
        return True


def thinned(points, distance, count, rng):
    """The numbers of at most `count` points (0: any number) that are `distance` apart, in ascending order. They are chosen at random,
    so that they are spread over all points."""
    apart, chosen = Apart(distance), []
    for number in rng.permutation(len(points)):
        if count and len(chosen) == count:
            break
        if apart.add(points[number].tolist()):
            chosen.append(int(number))
    return sorted(chosen)


def scattered(lower, upper, distance, count, rng, inside=None):
    """Up to `count` points in a box (0: as many as there is room for, up to MOST), `distance` apart; `inside`: (n, 3) -> which of
    them are in the volume. Fewer if no more fit."""
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    apart, points, tried = Apart(distance), [], 0
    while tried < TRIES * (count or max(len(points), FILLING // TRIES)):
        thrown = lower + rng.random((count or FILLING, 3)) * (upper - lower)
        tried += len(thrown)
        if inside is not None:
            thrown = thrown[inside(thrown)]
        for point in thrown.tolist():
            if len(points) == (count or MOST):
                return np.array(points).reshape(-1, 3)
            if apart.add(point):
                points.append(point)
    return np.array(points).reshape(-1, 3)


def jittered(points, amount, rng):
    """Moves each point at random within a ball of radius `amount`."""
    points = np.asarray(points, float).reshape(-1, 3)
    ways = rng.normal(size=points.shape)
    lengths = np.linalg.norm(ways, axis=1, keepdims=True)
    ways /= np.where(lengths > 0, lengths, 1)
    return points + ways * amount * rng.random((len(points), 1)) ** (1 / 3)
