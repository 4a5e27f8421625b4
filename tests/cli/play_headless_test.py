# SPDX-License-Identifier: Apache-2.0
# Runs chandelier-play as a user without a display would: pictures, statistics, and everything that can go wrong.
import os
import pathlib
import re
import sys
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from pictures import read_pfm
from play_tool import LIGHTS, PlayTest, SMALL, main, png_size


class Headless(PlayTest):
    def test_statistics_say_what_was_asked_and_done(self):
        stats = self.stats("--frames", 3, "--preset", "lightcluster", "--d-init", 0.25, "--cull", "none")
        self.assertEqual(stats["size"], {"width": 96, "height": 54})
        self.assertEqual(stats["frames"], 3)
        self.assertEqual(stats["preset"], "lightcluster")
        self.assertEqual(stats["recipe"]["select"], "light-clusters")
        self.assertEqual(stats["recipe"]["cull"], "none")
        self.assertEqual(stats["recipe"]["settings"]["d_init_m"], 0.25)
        self.assertEqual(stats["recipe"]["settings"]["face_size_px"], 64)
        self.assertEqual(stats["counters"]["lights"], LIGHTS)
        self.assertEqual(stats["image"], "s.png")
        self.assertGreater(stats["frame_ms"], 0)
        self.assertEqual(png_size(self.folder / "s.png"), (96, 54))
        self.assertEqual(sorted(os.listdir(self.folder)), ["s.json", "s.png"])

    def test_counters_fit_together(self):
        counters = self.stats()["counters"]
        self.assertEqual(counters["light_clusters"], counters["lights_in_view"])  # per-light
        self.assertEqual(counters["shadow_views"], 6 * counters["shadow_maps"])  # cubes
        self.assertEqual(counters["shadow_bytes"] % (counters["shadow_views"] * 64 * 64), 0)
        self.assertGreater(counters["shadow_triangles"], 0)
        self.assertLessEqual(counters["shadow_draws"], counters["shadow_triangles"])

    def test_shadow_maps_are_kept_where_asked(self):
        drawn = self.stats("--frames", 2)["counters"]
        picture = (self.folder / "s.png").read_bytes()
        kept = self.stats("--frames", 2, "--keep-shadow-maps")["counters"]
        self.assertEqual(drawn["shadow_maps_kept"], 0)
        self.assertEqual(kept["shadow_maps_kept"], kept["shadow_maps"])  # of the last frame
        self.assertEqual(kept["shadow_triangles"], 0)
        self.assertEqual((self.folder / "s.png").read_bytes(), picture)

    def test_runs_repeat(self):
        first = self.stats()
        picture = (self.folder / "s.png").read_bytes()
        second = self.stats()
        self.assertEqual(first["counters"], second["counters"])
        self.assertEqual(picture, (self.folder / "s.png").read_bytes())

    def test_a_smaller_budget_takes_rounds_and_changes_nothing_else(self):
        whole = self.stats()
        picture = (self.folder / "s.png").read_bytes()
        rounds = self.stats("--shadow-budget", 1)
        self.assertEqual(whole["counters"]["shadow_rounds"], 1)
        self.assertGreater(rounds["counters"]["shadow_rounds"], 1)
        self.assertLessEqual(rounds["counters"]["shadow_pool_bytes"], 1 << 20)
        self.assertEqual(rounds["counters"]["shadow_bytes"], whole["counters"]["shadow_bytes"])
        self.assertEqual(picture, (self.folder / "s.png").read_bytes())

    def test_exposure_is_a_factor_on_the_shown_picture_only(self):
        for ev in (-2, 0):
            for ext in ("png", "pfm"):
                self.play_well(self.pack, "--output", f"{ev}.{ext}", "--exposure", ev, *SMALL)
        self.assertNotEqual((self.folder / "-2.png").read_bytes(), (self.folder / "0.png").read_bytes())
        self.assertEqual((self.folder / "-2.pfm").read_bytes(), (self.folder / "0.pfm").read_bytes())
        self.assertGreater(read_pfm(self.folder / "0.pfm").mean(), 0)

    def test_ambient_light_adds_radiance(self):
        for ambient in (0, 1):
            self.play_well(self.pack, "--output", f"{ambient}.pfm", "--ambient", ambient, *SMALL)
        self.assertGreater(read_pfm(self.folder / "1.pfm").mean(), read_pfm(self.folder / "0.pfm").mean())

    def test_ambient_light_by_direction(self):
        from_above, from_below, everywhere = (self.stats("--ambient", each)["ambient"] for each in ("2,0", "0,2", "1,1"))
        self.assertEqual(everywhere, 1)
        self.assertEqual([from_above[0], from_above[2:]], [[1, 1, 1], [[0, 0, 0]] * 7])
        self.assertAlmostEqual(from_above[1][0], 2 / 3, 6)
        self.assertAlmostEqual(from_below[1][0], -2 / 3, 6)
        for ambient in ("2,0", "0,2"):
            self.play_well(self.pack, "--output", f"{ambient}.pfm", "--ambient", ambient, *SMALL)
        self.assertFalse(numpy.array_equal(read_pfm(self.folder / "2,0.pfm"), read_pfm(self.folder / "0,2.pfm")))

    def test_cameras_by_name_and_by_numbers(self):
        named = self.stats()["camera"]
        self.assertNotEqual(named["name"], "")
        self.assertEqual(self.stats("--camera", named["name"])["camera"], named)
        numbers = self.stats("--camera", "1,2,3,1,2,-1,60")["camera"]
        self.assertEqual(numbers["eye_m"], [1, 2, 3])
        self.assertEqual(numbers["forward_ws"], [0, 0, -1])
        self.assertAlmostEqual(numbers["yfov_deg"], 60, 4)
        self.assert_fails(1, f"the pack has .*{named['name']}.*, none of that name \\(nowhere\\)", self.pack,
                          "--output", "x.png", "--camera", "nowhere")

    def test_the_validation_layer_is_silent(self):
        done = self.play_well(self.pack, "--output", "v.png", "--validation", "--preset", "lightcluster", *SMALL)
        self.assertIn("0 messages from the validation layer", done.stderr)

    def test_devices(self):
        listed = self.play_well("--list-devices").stdout.splitlines()
        self.assertGreater(len(listed), 0)
        device = self.stats()["device"]
        self.assertTrue(any(device in line for line in listed), listed)
        self.assertEqual(self.stats("--device", device)["device"], device)
        self.assert_fails(1, "no-such-device", self.pack, "--output", "x.png", "--device", "no-such-device")

    def test_help_and_version(self):
        self.assertIn("--preset", self.play_well("--help").stdout)
        self.assertRegex(self.play_well("--version").stdout, r"chandelier-play \d+\.\d+\.\d+")


class BadInput(PlayTest):
    def bad_pack(self, content):
        path = self.folder / "bad.chandelier"
        path.write_bytes(content)
        self.assert_fails(1, re.escape(str(path)), path, "--output", "x.png", "--stats", "x.json")
        self.assert_fails(1, re.escape(str(path)), path, "--compare", "reference,lightcluster", "--report", "x")

    def test_packs_that_are_none(self):
        self.bad_pack(b"")
        self.bad_pack(b"no pack at all\n" * 1000)
        self.assert_fails(1, "missing", self.folder / "missing.chandelier", "--output", "x.png")
        self.assert_fails(1, re.escape(str(self.folder)), self.folder, "--output", "x.png")

    def test_truncated_packs(self):
        whole = self.pack.read_bytes()
        for size in (1, 7, 8, 40, 300, len(whole) // 2, len(whole) - 1):
            with self.subTest(size=size):
                self.bad_pack(whole[:size])

    def test_altered_packs(self):
        whole = self.pack.read_bytes()
        for at in (0, 9, 17, 25, 41, len(whole) // 2, len(whole) - 1):
            with self.subTest(at=at):
                self.bad_pack(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])

    def test_unwritable_output(self):
        (self.folder / "taken.png").mkdir()
        self.assert_fails(1, "taken.png: cannot write", self.pack, "--output", "taken.png")
        self.assert_fails(1, "none/x.png: cannot write", self.pack, "--output", "none/x.png")
        self.assert_fails(1, "none/x.json: cannot write", self.pack, "--output", "x.png", "--stats", "none/x.json")
        (self.folder / "file").write_text("in the way")
        self.assert_fails(1, "file/report: cannot make the folder", self.pack, "--compare",
                          "reference,lightcluster", "--report", "file/report")

    def test_full_disk(self):
        done = self.play(self.pack, "--output", "whole.png", "--stats", "/dev/full", *SMALL)
        self.assertEqual(done.returncode, 1)
        self.assertIn("/dev/full: cannot write (No space left on device)", done.stderr)
        self.assertEqual(os.listdir(self.folder), ["whole.png"])

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_read_only_folder(self):
        self.folder.chmod(0o555)
        self.addCleanup(self.folder.chmod, 0o755)
        self.assert_fails(1, "x.png: cannot write", self.pack, "--output", "x.png")

    def test_usage_errors(self):
        self.assert_fails(2, "PACK is missing")
        self.assert_fails(2, "must end in .png", self.pack, "--output", "x.jpg")
        self.assert_fails(2, "--size", self.pack, "--output", "x.png", "--size", "0x0")
        self.assert_fails(2, "--bogus", self.pack, "--bogus")
        self.assert_fails(2, "soft filter", self.pack, "--output", "x.png", "--select", "light-clusters",
                          "--filter", "hard")
        self.assert_fails(2, "--select", self.pack, "--compare", "reference,lightcluster", "--report", "x",
                          "--select", "per-light")


if __name__ == "__main__":
    main()
