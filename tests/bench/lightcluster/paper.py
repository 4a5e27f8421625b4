# SPDX-License-Identifier: Apache-2.0
"""What the paper measured: LightCluster (Wiesenhütter, Klein, Nischwitz), section 5. Each number stands here and nowhere else.

Its machine: Intel Xeon E5620, 8 GB, NVIDIA GeForce GTX 680; 1920x1080, cube faces of 1024², PCF and PCSS with eight samples.
"""

SIZE = (1920, 1080)
FACE_SIZE = 1024
Z_FAR_M = 30.0

# Table 1: d_init in metres, clusters, milliseconds with PCF and with PCSS; milliseconds of the reference.
TABLE_1 = {
    "sponza": {"lights": 80, "reference_ms": 97.8,
               "rows": ((0.1, 80, 100.1, 115.3), (0.3, 44, 57.0, 67.3), (0.5, 26, 36.4, 43.1), (1.6, 10, 18.7, 20.7))},
    "cornell": {"lights": 32, "reference_ms": 20.0,
                "rows": ((0.3, 13, 12.9, 18.0), (0.4, 6, 9.8, 12.9), (0.5, 5, 9.1, 12.1), (0.6, 4, 8.6, 11.1))},
    "restaurant": {"lights": 14, "reference_ms": 39.3,
                   "rows": ((0.2, 12, 36.0, 40.1), (0.3, 9, 28.9, 32.9), (0.4, 8, 26.8, 30.5), (0.5, 7, 24.9, 27.8))},
}

# Table 2: Sponza with 44 clusters, milliseconds with PCF and with PCSS.
TABLE_2_CLUSTERS = 44
TABLE_2 = (("Clustering", 0.05, 0.05), ("GBuffer", 0.53, 0.53), ("Shadows", 49.20, 59.42), ("Lighting", 7.05, 7.05),
           ("Compositing", 0.20, 0.20), ("Total", 57.03, 67.25))

# Section 5.3, 26 clusters of Sponza. Both are MiB: 26 x 1920 x 1080 x 4 bytes, and 26 x 6 x 1024² x 4 bytes.
MEMORY_CLUSTERS = 26
VISIBILITY_MIB = 205
SHADOW_MAPS_MIB = 624

# Section 5.4 and Figure 4.
SELECTION_LIGHTS = 2048
SELECTION_MS = 1.0


def reference_ratio(scene, clusters, filter_name):
    """How many times longer the paper's reference took than its LightCluster, from Table 1."""
    table = TABLE_1[scene]
    row = next(row for row in table["rows"] if row[1] == clusters)
    return table["reference_ms"] / row[2 if filter_name == "pcf" else 3]
