# SPDX-License-Identifier: Apache-2.0
"""Shapes for the example scenes: closed or open triangle meshes with normals, and UVs in metres."""

import math

import numpy as np

CREASE_DEG = 40.0  # profile corners sharper than this stay sharp


class Shape:
    """Positions, normals and UVs (metres) of each vertex, and triangles that are counter-clockwise seen from outside."""

    def __init__(self, positions, normals, uvs, triangles):
        self.positions = np.asarray(positions, dtype=float).reshape(-1, 3)
        self.normals = np.asarray(normals, dtype=float).reshape(-1, 3)
        self.uvs = np.asarray(uvs, dtype=float).reshape(-1, 2)
        self.triangles = np.asarray(triangles, dtype=np.uint32).reshape(-1, 3)

    def moved(self, x=0.0, y=0.0, z=0.0):
        return Shape(self.positions + (x, y, z), self.normals, self.uvs, self.triangles)

    def turned(self, axis, degrees):
        """Turned about the x, y or z axis through the origin, counter-clockwise seen from its positive end."""
        i = "xyz".index(axis)
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        m = np.eye(3)
        j, k = (i + 1) % 3, (i + 2) % 3
        m[j, j], m[j, k], m[k, j], m[k, k] = c, -s, s, c
        return Shape(self.positions @ m.T, self.normals @ m.T, self.uvs, self.triangles)


def join(shapes):
    positions, normals, uvs, triangles, base = [], [], [], [], 0
    for shape in shapes:
        positions.append(shape.positions)
        normals.append(shape.normals)
        uvs.append(shape.uvs)
        triangles.append(shape.triangles + np.uint32(base))
        base += len(shape.positions)
    return Shape(np.concatenate(positions), np.concatenate(normals), np.concatenate(uvs), np.concatenate(triangles))


def quad(a, b, c, d, step_m=None):
    """The flat parallelogram a, b, c, d (counter-clockwise from its front), divided into cells of about step_m."""
    a, b, d = (np.asarray(p, dtype=float) for p in (a, b, d))
    along, up = b - a, d - a
    width, height = np.linalg.norm(along), np.linalg.norm(up)
    nu = max(1, round(width / step_m)) if step_m else 1
    nv = max(1, round(height / step_m)) if step_m else 1
    u, v = (g.reshape(-1, 1) for g in np.meshgrid(np.linspace(0, 1, nu + 1), np.linspace(0, 1, nv + 1)))
    normal = np.cross(along, up)
    positions = a + u * along + v * up
    triangles = []
    for row in range(nv):
        for i in range(row * (nu + 1), row * (nu + 1) + nu):
            triangles += [(i, i + 1, i + nu + 2), (i, i + nu + 2, i + nu + 1)]
    return Shape(positions, np.tile(normal / np.linalg.norm(normal), (len(positions), 1)),
                 np.hstack((u * width, (1 - v) * height)), triangles)


def box(low, high, step_m=None):
    """An axis-aligned box with sharp edges."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return join([
        quad((x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1), step_m),
        quad((x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0), step_m),
        quad((x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0), step_m),
        quad((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1), step_m),
        quad((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1), step_m),
        quad((x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0), step_m)])


def lathe(profile, segments=24):
    """Turns a profile of (radius, y) about the y axis; going up with the profile, its outside is on the right."""
    points = np.asarray(profile, dtype=float)
    along = np.diff(points, axis=0)
    lengths = np.hypot(along[:, 0], along[:, 1])
    out = np.column_stack((along[:, 1], -along[:, 0])) / lengths[:, None]
    angles = np.linspace(0, 2 * math.pi, segments + 1)
    c, s = np.cos(angles), np.sin(angles)
    u_radius = points[:, 0].max()
    arc = np.concatenate(([0], np.cumsum(lengths)))
    cos_crease = math.cos(math.radians(CREASE_DEG))
    parts = []
    for i in range(len(along)):
        ends = []
        for point, neighbour in ((i, i - 1), (i + 1, i + 1)):
            normal = out[i]
            if 0 <= neighbour < len(out) and out[neighbour] @ out[i] > cos_crease:
                normal = (out[neighbour] + out[i]) / np.linalg.norm(out[neighbour] + out[i])
            radius, y = points[point]
            ends.append((np.column_stack((radius * c, np.full_like(c, y), radius * s)),
                         np.column_stack((normal[0] * c, np.full_like(c, normal[1]), normal[0] * s)),
                         np.column_stack((angles * u_radius, np.full_like(c, -arc[point])))))
        n = segments + 1
        triangles = []
        for k in range(segments):
            if points[i, 0] > 0:
                triangles.append((k, n + k + 1, k + 1))
            if points[i + 1, 0] > 0:
                triangles.append((k, n + k, n + k + 1))
        parts.append(Shape(*(np.concatenate((low, high)) for low, high in zip(*ends)), triangles))
    return join(parts)


def cylinder(radius, y0, y1, segments=24):
    return lathe([(0, y0), (radius, y0), (radius, y1), (0, y1)], segments)


def sphere(radius, segments=24):
    angles = np.linspace(-math.pi / 2, math.pi / 2, max(4, segments // 2) + 1)
    profile = [(max(0.0, radius * math.cos(a)), radius * math.sin(a)) for a in angles]
    profile[0], profile[-1] = (0.0, -radius), (0.0, radius)
    return lathe(profile, segments)


def sweep(path, radius, sides=8, closed=False):
    """A round tube along a path of points; open ends stay open."""
    points = np.asarray(path, dtype=float)
    n = len(points)
    if closed:
        tangents = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    else:
        tangents = np.gradient(points, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    first = np.eye(3)[np.argmin(np.abs(tangents[0]))]
    side, rings, normals = first, [], []
    angles = np.linspace(0, 2 * math.pi, sides + 1)
    for point, tangent in zip(points, tangents):
        side = side - tangent * (side @ tangent)  # carried along, so that the tube does not twist
        side /= np.linalg.norm(side)
        other = np.cross(tangent, side)
        around = np.outer(np.cos(angles), side) + np.outer(np.sin(angles), other)
        rings.append(point + radius * around)
        normals.append(around)
    arc = np.concatenate(([0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    uvs = [np.column_stack((angles * radius, np.full_like(angles, v))) for v in arc]
    triangles, m = [], sides + 1
    for i in range(n - 1):
        for k in range(sides):
            a, b = i * m + k, (i + 1) * m + k
            triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
    if closed:
        rings.append(rings[0])
        normals.append(normals[0])
        uvs.append(np.column_stack((angles * radius, np.full_like(angles, arc[-1] + np.linalg.norm(points[0] - points[-1])))))
        for k in range(sides):
            a, b = (n - 1) * m + k, n * m + k
            triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
    return Shape(np.concatenate(rings), np.concatenate(normals), np.concatenate(uvs), triangles)


def ring(radius, tube, segments=32, sides=8):
    """A torus around the y axis. Its path is planar, so carrying the frame once round brings it back to itself."""
    angles = np.arange(segments) * 2 * math.pi / segments
    return sweep(np.column_stack((radius * np.cos(angles), np.zeros(segments), radius * np.sin(angles))), tube, sides, True)


def arch_wall(width, y_spring, y_top, radius, thickness, segments=24):
    """A piece of wall in the xy plane, centred on x = 0 and z = 0, whose underside is a round arch (Norman style).

    The spandrel is a fan of quads from the arc to the rectangle, which puts vertices in the corners."""
    half, height, zf = width / 2, y_top - y_spring, thickness / 2
    corner = math.atan2(height, half)
    angles = sorted(set(np.linspace(0, math.pi, segments + 1)) | {corner, math.pi - corner})
    inner, outer = [], []
    for a in angles:
        c, s = math.cos(a), math.sin(a)
        reach = min(half / abs(c) if abs(c) > 1e-9 else math.inf, height / s if s > 1e-9 else math.inf)
        inner.append((radius * c, y_spring + radius * s))
        outer.append((reach * c, y_spring + reach * s))
    inner, outer, angles = np.array(inner), np.array(outer), np.array(angles)
    n = len(angles)
    parts = []
    for z, sign in ((zf, 1), (-zf, -1)):
        flat = np.vstack((inner, outer))
        triangles = []
        for i in range(n - 1):
            face = [(i, n + i, n + i + 1), (i, n + i + 1, i + 1)]
            triangles += face if sign > 0 else [t[::-1] for t in face]
        parts.append(Shape(np.column_stack((flat, np.full(2 * n, z))), np.tile((0, 0, sign), (2 * n, 1)),
                           np.column_stack((flat[:, 0] * sign, -flat[:, 1])), triangles))
    parts.append(_arc_band(angles, radius, y_spring, -zf, zf, inside=True))
    for sign in (1, -1):  # the imposts: what of the underside the arc leaves at either end
        x0, x1 = sorted((sign * radius, sign * half))
        parts.append(quad((x0, y_spring, -zf), (x1, y_spring, -zf), (x1, y_spring, zf), (x0, y_spring, zf)))
    return join(parts)


def _arc_band(angles, radius, y_spring, z0, z1, inside):
    c, s = np.cos(angles), np.sin(angles)
    n, sign = len(angles), -1 if inside else 1
    rim = np.column_stack((radius * c, y_spring + radius * s))
    positions = np.vstack([np.column_stack((rim, np.full(n, z))) for z in (z0, z1)])
    normals = np.tile(np.column_stack((sign * c, sign * s, np.zeros(n))), (2, 1))
    uvs = np.vstack([np.column_stack((angles * radius, np.full(n, z))) for z in (z0, z1)])
    triangles = []
    for i in range(n - 1):
        face = [(i, i + 1, n + i + 1), (i, n + i + 1, n + i)]
        triangles += [t[::-1] for t in face] if inside else face
    return Shape(positions, normals, uvs, triangles)


def archivolt(y_spring, radius, width, z0, z1, segments=24):
    """The raised moulding around an arch on the side of +z: its front at z1, its back (not made) in the wall at z0."""
    angles = np.linspace(0, math.pi, segments + 1)
    n = len(angles)
    flat = np.vstack([np.column_stack((r * np.cos(angles), y_spring + r * np.sin(angles))) for r in (radius, radius + width)])
    triangles = []
    for i in range(n - 1):
        triangles += [(i, n + i, n + i + 1), (i, n + i + 1, i + 1)]
    uvs = np.vstack([np.column_stack((angles * radius, np.full(n, v))) for v in (0.0, width)])
    front = Shape(np.column_stack((flat, np.full(2 * n, z1))), np.tile((0, 0, 1), (2 * n, 1)), uvs, triangles)
    return join([front, _arc_band(angles, radius, y_spring, z0, z1, inside=True),
                 _arc_band(angles, radius + width, y_spring, z0, z1, inside=False)])
