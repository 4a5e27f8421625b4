# SPDX-License-Identifier: Apache-2.0
"""LightCluster's selection of centres by brute force (paper, section 3.1.2), as the scenes' layouts are planned with it."""

import numpy as np


def light_clusters(positions, ranges, camera, d_init_m, z_far_m=30.0):
    """Indices of the cluster centres: largest range first, ties by index, d_min growing with the camera distance."""
    positions = np.asarray(positions, dtype=float)
    centers, d_min = [], []
    for i in sorted(range(len(positions)), key=lambda i: (-ranges[i], i)):
        distances = np.linalg.norm(positions[centers] - positions[i], axis=1)
        if np.all(distances > d_min):
            centers.append(i)
            d_min.append(d_init_m * (1 + np.linalg.norm(positions[i] - camera) / z_far_m))
    return centers
