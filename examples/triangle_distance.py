# SPDX-License-Identifier: Apache-2.0
"""The distance from a point to the nearest of many triangles, for checking that lights and cameras hang free."""

import numpy as np


def nearest_distance(point, triangles, within=1.0):
    """triangles: an array (n, 3, 3). The distance, or `within` where no triangle is nearer. Ericson, Real-Time Collision
    Detection 5.1.5, as: the plane where the foot falls inside the triangle, and the three edges otherwise."""
    point = np.asarray(point, dtype=float)
    near = (triangles.min(axis=1) < point + within).all(axis=1) & (triangles.max(axis=1) > point - within).all(axis=1)
    triangles = triangles[near]
    if len(triangles) == 0:
        return within
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    best = min(within, _segment(point, a, b), _segment(point, b, c), _segment(point, c, a))
    normal = np.cross(b - a, c - a)
    area2 = np.einsum("ij,ij->i", normal, normal)
    solid = area2 > 0
    a, b, c, normal, area2 = a[solid], b[solid], c[solid], normal[solid], area2[solid]
    height = np.einsum("ij,ij->i", point - a, normal)
    foot = point - normal * (height / area2)[:, None]
    inside = np.ones(len(a), dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(q - p, foot - p), normal) >= 0
    if inside.any():
        best = min(best, float(np.min(np.abs(height[inside]) / np.sqrt(area2[inside]))))
    return best


def _segment(point, p, q):
    along = q - p
    length2 = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
    t = np.clip(np.einsum("ij,ij->i", point - p, along) / length2, 0, 1)
    return float(np.min(np.linalg.norm(p + t[:, None] * along - point, axis=1)))
