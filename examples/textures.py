# SPDX-License-Identifier: Apache-2.0
"""Procedural textures for the example scenes: each tiles, and each call with the same arguments gives the same pixels."""

import numpy as np


def noise(size, cells, seed, octaves=4):
    """Tiling value noise in 0..1: random values on a grid of cells × cells, blended smoothly, in halving octaves."""
    rng = np.random.default_rng(seed)
    total, weight = np.zeros((size, size)), 0.0
    nx, ny = cells if isinstance(cells, tuple) else (cells, cells)
    for octave in range(octaves):
        grid = rng.random((ny, nx))
        y, x = (np.arange(size) * ny / size, np.arange(size) * nx / size)
        iy, ix = y.astype(int), x.astype(int)
        fy, fx = y - iy, x - ix
        fy, fx = (fy * fy * (3 - 2 * fy))[:, None], (fx * fx * (3 - 2 * fx))[None, :]
        a, b = grid[np.ix_(iy % ny, ix % nx)], grid[np.ix_(iy % ny, (ix + 1) % nx)]
        c, d = grid[np.ix_((iy + 1) % ny, ix % nx)], grid[np.ix_((iy + 1) % ny, (ix + 1) % nx)]
        amplitude = 0.5**octave
        total += amplitude * ((a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy)
        weight += amplitude
        nx, ny = min(2 * nx, size), min(2 * ny, size)
    return total / weight


def tint(value, dark, light):
    """Colours between two sRGB colours (0..255) by value 0..1; steps of 4 keep the PNG small."""
    value = np.clip(value, 0, 1)[..., None]
    colors = np.asarray(dark) * (1 - value) + np.asarray(light) * value
    return np.clip(np.round(colors / 4) * 4, 0, 255).astype(np.uint8)


def normal_map(height, depth):
    """A tangent-space normal map (+Y up in the texture) of a tiling height field; depth is height 1 in texels."""
    dx = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) * depth / 2
    dy = (np.roll(height, -1, axis=0) - np.roll(height, 1, axis=0)) * depth / 2
    n = np.dstack((-dx, dy, np.ones_like(height)))
    n /= np.linalg.norm(n, axis=2)[..., None]
    return np.round((n * 0.5 + 0.5) * 127.5).astype(np.uint8) * 2


def tiles(size, columns, rows, joint, offset=0.0, seed=1):
    """Brick or tile courses: (mask 0 in joints to 1 inside, a random value of each tile)."""
    y, x = np.mgrid[0:size, 0:size] / size
    row = np.floor(y * rows).astype(int)
    shifted = x * columns + offset * (row % 2)
    column = np.floor(shifted).astype(int) % columns
    fx, fy = shifted % 1.0, y * rows % 1.0
    edge = np.minimum(np.minimum(fx, 1 - fx) / columns, np.minimum(fy, 1 - fy) / rows)
    values = np.random.default_rng(seed).random((rows, columns))
    return np.clip(edge / joint, 0, 1), values[row, column]


def plaster(size=256, seed=3, dark=(176, 158, 128), light=(222, 206, 176)):
    return tint(0.65 * noise(size, 4, seed) + 0.35 * noise(size, 32, seed + 1, 2), dark, light)


def bricks(size=256, seed=5, dark=(120, 70, 48), light=(186, 124, 88), joint_color=(168, 152, 132)):
    """Colour and height of eight courses of four bricks."""
    mask, value = tiles(size, 4, 8, 0.008, 0.5, seed)
    grain = noise(size, 16, seed + 1, 3)
    color = tint(0.6 * value + 0.4 * grain, dark, light)
    mortar = tint(grain, np.multiply(joint_color, 0.85), joint_color)
    return np.where(mask[..., None] > 0.4, color, mortar), mask * 0.8 + 0.2 * grain


def ashlar(size=256, seed=7, dark=(160, 144, 118), light=(206, 192, 164)):
    """Colour and height of cut stone, four courses of two blocks."""
    mask, value = tiles(size, 2, 4, 0.006, 0.5, seed)
    grain = noise(size, 8, seed + 1)
    color = tint(0.35 * value + 0.65 * grain, dark, light)
    return np.where(mask[..., None] > 0.5, color, (color * 0.7).astype(np.uint8)), mask * 0.8 + 0.2 * grain


def checker(size=256, seed=9, a=((128, 60, 44), (160, 84, 60)), b=((190, 172, 140), (224, 208, 178))):
    """Colour and height of a floor of two by two tiles in two colours."""
    mask, _ = tiles(size, 2, 2, 0.006, 0.0, seed)
    y, x = np.mgrid[0:size, 0:size] * 2 // size
    grain = noise(size, 8, seed)
    color = np.where(((x + y) % 2 == 0)[..., None], tint(grain, *a), tint(grain, *b))
    return np.where(mask[..., None] > 0.5, color, (color * 0.55).astype(np.uint8)), mask * 0.9 + 0.1 * grain


def wood(size=256, boards=1, seed=11, dark=(84, 50, 28), light=(152, 100, 60)):
    """Colour and height of boards that run along u: long grain, and a dark joint between boards."""
    grain = 0.6 * noise(size, (2, 24), seed, 4) + 0.4 * noise(size, (4, 64), seed + 1, 2)
    mask, value = tiles(size, 1, boards, 0.004, 0.0, seed + 2) if boards > 1 else (np.ones((size, size)), 0.5)
    if boards > 1:  # every board is cut from another part of the tree
        rows = np.arange(size) * boards // size
        shift = (np.random.default_rng(seed + 3).random(boards) * size).astype(int)
        grain = np.stack([np.roll(grain[i], shift[rows[i]]) for i in range(size)])
        y = np.arange(size) * boards / size % 1.0
        mask = np.repeat(np.clip(np.minimum(y, 1 - y) * 30, 0, 1)[:, None], size, axis=1)
    color = tint(0.7 * grain + 0.3 * value, dark, light)
    return (color * (0.35 + 0.65 * mask[..., None])).astype(np.uint8) // 4 * 4, mask * 0.8 + 0.2 * grain
