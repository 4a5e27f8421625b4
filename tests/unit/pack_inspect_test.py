# SPDX-License-Identifier: Apache-2.0
# chandelier-inspect on the sample pack: what it says and how it exits.
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pack_schema
import xxhash


def inspect(*arguments, **more):
    return subprocess.run([os.environ["CHANDELIER_INSPECT"], *arguments], capture_output=True, text=True, **more)


class PackInspect(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "a.pack"
        subprocess.run([os.environ["CHANDELIER_WRITE_SAMPLE"], self.path], check=True)

    def tearDown(self):
        self.folder.cleanup()

    def test_json(self):
        run = inspect(self.path, "--json")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        report = json.loads(run.stdout)
        self.assertEqual(report["size_bytes"], self.path.stat().st_size)
        self.assertEqual(report["sources"], ["hall.glb", "lamps.gltf"])
        self.assertEqual(report["bounds_min_ws"], [-2, 0, -0.5])
        self.assertEqual(report["sections"][2], {"kind": 3, "name": "positions", "count": 7, "stride_bytes": 12,
                                                 "size_bytes": 84, "stored_bytes": 84, "codec": "raw"})
        self.assertEqual(report["triangles"], {"stored": 3, "drawn": 5, "shadowless": 4})
        self.assertEqual(report["batches"], {"count": 3, "drawn": 5, "closed": 0, "triangles": {"min": 1, "mean": 1, "max": 1}})
        self.assertEqual([m["name"] for m in report["materials"]], ["stone", "Blätter"])
        self.assertEqual(report["images"][0], {"name": "bricks.png", "width": 4, "height": 2, "level_count": 3,
                                               "format": "rgba8_srgb", "size_bytes": 44, "stored_bytes": 44, "codec": "raw"})
        self.assertEqual([image["format"] for image in report["images"]], ["rgba8_srgb", "rgba8_unorm", "rgba16_sfloat"])
        self.assertEqual([(light["name"], light["type"], light["range_source"]) for light in report["lights"]],
                         [("bulb", "point", "authored"), ("torch", "spot", "derived"),
                          ("sun", "directional", "unbounded")])
        self.assertEqual(report["lights"][0]["position_ws"], [1, 2, 3])
        self.assertEqual(report["cameras"][0]["name"], "eye")
        self.assertEqual([light["dynamic"] for light in report["lights"]], [False, False, True])
        self.assertEqual([light["group"] for light in report["lights"]], [1, 1, 0])
        self.assertEqual([light["shadowless"] for light in report["lights"]], [False, True, False])
        self.assertAlmostEqual(report["lights"][1]["radius_m"], 0.1)
        self.assertEqual((report["dynamic_instances"], report["skinned_instances"]), (1, 1))
        self.assertEqual(report["batch_bvh"], {"nodes": 3, "depth": 2})
        self.assertEqual(report["triangle_bvh"], {"nodes": 4, "depth": 2})
        self.assertEqual(report["light_bvh"], {"nodes": 3, "depth": 2})
        self.assertEqual(report["voxels"], {"resolution": [1, 1, 2], "mode": "clip", "occupied": 2, "triangles": 8,
                                            "no_cull_triangles": 0})
        self.assertEqual(report["animations"], [{"name": "wave", "duration_s": 1.5, "channels": 3}])

    def test_text(self):
        run = inspect(self.path)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        for part in ("positions                      7      12              84              84  raw", "3 stored, 5 drawn by 3 instances",
                     "3: 1 point, 1 spot, 1 directional; 1 dynamic, 1 unclustered, 1 without shadow, 2 in 1 groups",
                     "3 nodes, 2 deep", "1 x 1 x 2, clip; 2 (100.0 %) occupied; 0 of 4 static triangles (0.0 %) always drawn",
                     "0 (0.0 %) closed", "2 nodes, 1 animations, 1 skins; 1 of 3 instances move, 1 by a skin",
                     "3 channels  wave\n", "instance BVH", "triangle BVH", "1 authored, 1 derived at 0.05 lx", "bricks.png", "eye"):
            self.assertIn(part, run.stdout)
        self.assertNotIn("torch", run.stdout)

    def test_light_table(self):
        lines = inspect(self.path, "--lights").stdout.splitlines()
        torch = next(line for line in lines if "torch" in line)
        self.assertEqual(torch.split(), ["spot", "1000001.00,", "0.40,", "250000.38", "12.5", "cd", "15.8", "m", "derived", "torch"])
        sun = next(line for line in lines if "sun" in line)
        self.assertEqual(sun.split(), ["directional", "to", "0,", "0,", "-1", "1000", "lx", "no", "end", "sun"])

    def assert_error(self, run, path, what):
        self.assertEqual((run.returncode, run.stdout), (1, ""))
        self.assertEqual(run.stderr, f"chandelier-inspect: error: {path}: {what}\n")

    def test_errors(self):
        self.assert_error(inspect("none.pack", cwd=self.folder.name), "none.pack",
                          "cannot open (No such file or directory)")
        self.assert_error(inspect(self.folder.name), self.folder.name, "not a file (a folder)")
        data = bytearray(self.path.read_bytes())
        self.path.write_bytes(data[:-1])
        self.assert_error(inspect(self.path, "--json"), self.path,
                          f"header.file_bytes: {len(data)} where the file has {len(data) - 1}")

    def damage_image(self, number):
        """Turns over the first byte of a stored image, with right checksums."""
        data = np.fromfile(self.path, np.uint8)
        header = data[:pack_schema.FileHeader.itemsize].view(pack_schema.FileHeader)
        end = pack_schema.FileHeader.itemsize + int(header["section_count"][0]) * pack_schema.SectionEntry.itemsize
        table = data[pack_schema.FileHeader.itemsize:end].view(pack_schema.SectionEntry)
        entries = {pack_schema.SECTIONS[int(entry["kind"])][0]: entry for entry in table}
        first, size = (int(entries["image_data"][name]) for name in ("offset_bytes", "size_bytes"))
        data[first + int(pack_schema.read_pack(self.path).images[number]["first_byte"])] ^= 0xFF
        entries["image_data"]["checksum"] = xxhash.xxh3_64_intdigest(data[first:first + size])
        header["table_checksum"] = xxhash.xxh3_64_intdigest(table)
        data.tofile(self.path)

    def test_images_are_decoded_too(self):
        subprocess.run([os.environ["CHANDELIER_WRITE_SAMPLE"], self.path, "compressed"], check=True)
        report = json.loads(inspect(self.path, "--json").stdout)
        self.assertEqual([image["codec"] for image in report["images"]], ["raw", "raw", "zstd"])
        self.assertEqual(report["images"][2]["size_bytes"], 512)
        self.assertLess(report["images"][2]["stored_bytes"], 100)
        self.assertRegex(inspect(self.path).stdout, r"images     3, 560 bytes, stored as \d+ bytes\n(.*\n){2}.*zstd.*sky\.exr")
        self.damage_image(2)
        run = inspect(self.path)
        self.assertEqual((run.returncode, run.stdout), (1, ""))
        self.assertRegex(run.stderr, f"^chandelier-inspect: error: {self.path}: images\\[2\\] \\(sky.exr\\).codec: zstd: .*\n$")

    def test_usage(self):
        for arguments in ([], ["a", "b"], [str(self.path), "--no-such-option"]):
            run = inspect(*arguments)
            self.assertEqual((run.returncode, run.stdout), (2, ""), arguments)
            self.assertNotEqual(run.stderr, "")
        run = inspect("--help")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("Examples:", run.stdout)

    def test_full_disk(self):
        with open("/dev/full", "w") as full:
            run = subprocess.run([os.environ["CHANDELIER_INSPECT"], self.path], stdout=full, stderr=subprocess.PIPE)
        self.assertEqual((run.returncode, run.stderr), (1, b"chandelier-inspect: error: cannot write to standard output\n"))


if __name__ == "__main__":
    unittest.main()
