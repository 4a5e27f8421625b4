# SPDX-License-Identifier: Apache-2.0
# Python's generated module reads what C++ wrote: the values of pack_sample.cpp.
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pack_schema
import xxhash


class PackFile(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "a.pack"
        subprocess.run([os.environ["CHANDELIER_WRITE_SAMPLE"], self.path], check=True)

    def tearDown(self):
        self.folder.cleanup()

    def write_compressed(self, name):
        subprocess.run([os.environ["CHANDELIER_WRITE_SAMPLE"], self.path, name], check=True)


class PackPython(PackFile):
    def test_values(self):
        pack = pack_schema.read_pack(self.path)
        self.assertEqual({name: len(getattr(pack, name)) for name, _ in pack_schema.SECTIONS.values()}, {
            "bake_info": 1, "strings": 96, "positions": 7, "vertex_attributes": 7, "indices": 9, "batches": 3,
            "instances": 3, "batch_instances": 5, "materials": 2, "textures": 2, "images": 3, "image_data": 576,
            "lights": 3, "cameras": 1, "meshes": 2, "batch_bvh": 3, "batch_bvh_items": 4, "instance_bvh": 3,
            "instance_bvh_items": 2, "triangle_bvh": 4, "triangle_bvh_items": 3, "triangle_bvh_areas": 4,
            "light_bvh": 3, "voxel_grid": 1, "voxel_cells": 2, "voxel_runs": 4, "voxel_indices": 24,
            "voxel_vertices": 10, "voxel_occupancy": 1, "nodes": 2, "animations": 1, "animation_channels": 3,
            "animation_times": 3, "animation_values": 23, "skins": 1, "joints": 2, "skin_vertices": 3})
        info = pack.bake_info[0]
        self.assertEqual(pack.text(info["source"]), "hall.glb\nlamps.gltf")
        self.assertEqual((info["unique_triangles"], info["instanced_triangles"], info["batch_triangles"]), (3, 5, 100))
        self.assertEqual(pack.positions["position_ls"][:4].tolist(), [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, -0.5]])
        self.assertEqual(pack.vertex_attributes["tangent_ls"][2], 0x80007FFF)  # +x, sign negative
        self.assertEqual(pack.vertex_attributes["uv1"][3].tolist(), [6, -1])
        self.assertEqual(pack.vertex_attributes["color"][1], 0xFF804021)
        self.assertEqual(pack.indices["vertex"].tolist(), [0, 1, 2, 0, 2, 3, 4, 5, 6])
        self.assertEqual(pack.batches["first_index"].tolist(), [0, 3, 6])
        self.assertEqual(pack.instances["world_from_local"][1].tolist(), [[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 0]])
        self.assertEqual(pack.voxel_grid["resolution"].tolist(), [[1, 1, 2]])
        self.assertEqual(pack.batch_bvh["leaf"].tolist(), [pack_schema.NONE, 2, 34])
        self.assertEqual([pack.text(node["name"]) for node in pack.nodes], ["pole", "cloth"])
        self.assertEqual([pack_schema.INTERPOLATION[i] for i in pack.animation_channels["interpolation"]],
                         ["linear", "step", "cubic_spline"])
        self.assertEqual(pack.texels(0).tolist(), [i * 5 % 256 for i in range(44)])
        self.assertEqual(pack.texels(1).tolist(), [240, 245, 250, 255])
        self.assertEqual(pack.texels(2).view("<f2")[::32].tolist(), [1 + i / 1024 for i in range(8)])

    def test_names_and_enums(self):
        pack = pack_schema.read_pack(self.path)
        self.assertEqual([pack.text(m["name"]) for m in pack.materials], ["stone", "Blätter"])
        self.assertEqual(pack.materials["base_color_texture"].tolist(), [0, 0])
        self.assertEqual(pack.materials["emissive_texture"].tolist(), [pack_schema.NONE] * 2)
        self.assertEqual(pack.materials["alpha_mode"].tolist(),
                         [pack_schema.ALPHA_MODE_OPAQUE, pack_schema.ALPHA_MODE_MASK])
        self.assertEqual([pack_schema.LIGHT_TYPE[t] for t in pack.lights["type"]], ["point", "spot", "directional"])
        self.assertEqual([pack_schema.RANGE_SOURCE[t] for t in pack.lights["range_source"]],
                         ["authored", "derived", "unbounded"])
        self.assertEqual(pack.lights["intensity"].tolist(), [12.5, 12.5, 1000])
        self.assertEqual(pack.textures["wrap_v"].tolist(), [pack_schema.WRAP_MIRRORED_REPEAT, pack_schema.WRAP_REPEAT])
        self.assertEqual(pack.text(pack.cameras[0]["name"]), "eye")

    def test_the_code_of_triangles_is_refused_by_name(self):
        self.write_compressed("sheet")
        with self.assertRaisesRegex(pack_schema.PackError, "triangles|zstandard"):
            pack_schema.read_pack(self.path)

    def test_damage_is_refused(self):
        good = self.path.read_bytes()
        table_end = pack_schema.FileHeader.itemsize + len(pack_schema.SECTIONS) * pack_schema.SectionEntry.itemsize
        for at in [*range(0, table_end, 3), *range(table_end, len(good), 13)]:
            bad = bytearray(good)
            bad[at] ^= 0x10
            self.path.write_bytes(bad)
            # The zeros between sections carry nothing that this reader hands out.
            if at < pack_schema.FileHeader.itemsize or good[at] != 0:
                with self.assertRaises(pack_schema.PackError, msg=f"byte {at}"):
                    pack_schema.read_pack(self.path)
        for size in (0, 1, 39, 40, 700, len(good) - 1):
            self.path.write_bytes(good[:size])
            with self.assertRaises(pack_schema.PackError, msg=f"{size} bytes"):
                pack_schema.read_pack(self.path)


@unittest.skipUnless(pack_schema.zstandard, "Python's zstandard module is absent")
class Compressed(PackFile):
    """By itself, so that CTest shows it as skipped."""

    def test_columns_are_decoded(self):
        self.write_compressed("points")
        pack = pack_schema.read_pack(self.path)
        self.assertEqual(len(pack.positions), 100 * 100)
        self.assertEqual(pack.positions["position_ls"][2 * 100 + 3].tolist()[:2], [3 / 64, 2 / 128])
        heights = pack.positions["position_ls"][:, 2] * 1024
        y, x = np.divmod(np.arange(100 * 100), 100)
        self.assertTrue((heights == np.round(heights)).all())
        self.assertLess(np.abs(heights - 300 * np.sin(x / 9) * np.cos(y / 7)).max(), 0.6)
        self.assertEqual(pack.vertex_attributes["normal_ls"].tolist(), [x * 7919 for y in range(100) for x in range(100)])
        self.assertEqual(pack.vertex_attributes["uv0"][:, 1].tolist(), [y / 16384 for y in range(100) for x in range(100)])

    def test_images_are_decoded_one_by_one(self):
        expected = pack_schema.read_pack(self.path)
        compressed = self.path.with_suffix(".small")
        subprocess.run([os.environ["CHANDELIER_WRITE_SAMPLE"], compressed, "compressed"], check=True)
        pack = pack_schema.read_pack(compressed)
        self.assertEqual([pack_schema.IMAGE_CODEC[codec] for codec in pack.images["codec"]], ["raw", "raw", "zstd"])
        self.assertLess(pack.images["stored_bytes"][2], 100)
        for i in range(3):
            self.assertEqual(pack.texels(i).tolist(), expected.texels(i).tolist())

    def test_damaged_frames_are_refused(self):
        self.write_compressed("points")
        data = bytearray(self.path.read_bytes())
        header = pack_schema.FileHeader.itemsize
        for at in range(0, 200):  # in the frame of the positions, with right checksums
            bad = np.frombuffer(bytes(data), np.uint8).copy()
            head = bad[:header].view(pack_schema.FileHeader)
            table = bad[header:header + int(head["section_count"][0]) * pack_schema.SectionEntry.itemsize]
            entry = table.view(pack_schema.SectionEntry)[1]
            first, size = int(entry["offset_bytes"]), int(entry["size_bytes"])
            bad[first + at] ^= 0x41
            entry["checksum"] = xxhash.xxh3_64_intdigest(bad[first:first + size])
            head["table_checksum"] = xxhash.xxh3_64_intdigest(table)
            bad.tofile(self.path)
            try:
                self.assertEqual(len(pack_schema.read_pack(self.path).positions), 100 * 100)
            except pack_schema.PackError:
                pass


if __name__ == "__main__":
    unittest.main()
