# SPDX-License-Identifier: Apache-2.0
# Runs chandelier-play for its reports: two presets side by side, and a camera that moves.
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from pictures import read_pfm
from play_tool import LIGHTS, PlayTest, SMALL, main, png_size, schema_validator


class Links(html.parser.HTMLParser):
    """Collects what a page links to, and whether its elements nest."""

    VOID = {"meta", "img", "br", "input", "rect", "stop"}

    def __init__(self):
        super().__init__()
        self.targets, self.open = [], []

    def handle_starttag(self, tag, attributes):
        self.targets += [value for name, value in attributes if name in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, f"</{tag}> closes something else"


class Compare(PlayTest):
    def compare(self, *arguments, presets="reference,lightcluster", size=SMALL):
        done = self.play_well(self.pack, "--compare", presets, "--report", "out/report", "--frames", 2, *size, *arguments)
        self.said = done.stderr
        self.report = self.folder / "out/report"
        comparison = json.loads((self.report / "comparison.json").read_text())
        schema_validator("comparison.schema.json").validate(comparison)
        return comparison

    def test_writes_everything_that_the_page_links(self):
        self.compare()
        self.assertEqual(sorted(os.listdir(self.report)),
                         ["comparison.json", "difference.png", "flip.png", "lightcluster.exr", "lightcluster.png", "reference.exr",
                          "reference.png", "report.html"])
        for picture in ("difference.png", "flip.png"):
            self.assertEqual(png_size(self.report / picture), (96, 54))
        page = (self.report / "report.html").read_text()
        links = Links()
        links.feed(page)
        self.assertEqual(links.open, [])
        self.assertEqual({target for target in links.targets if not target.startswith("#")},
                         {"reference.png", "lightcluster.png", "reference.exr", "lightcluster.exr", "difference.png",
                          "flip.png"})

    def test_agrees_with_single_pictures_at_the_same_exposure(self):
        comparison = self.compare("--d-init", 0.6)
        exposure = comparison["a"]["exposure_ev"]
        self.assertEqual(comparison["b"]["exposure_ev"], exposure)
        for side in ("reference", "lightcluster"):
            for ext in ("png", "pfm"):
                self.play_well(self.pack, "--output", f"{side}.{ext}", "--preset", side, "--d-init", 0.6, "--exposure",
                               repr(exposure), *SMALL)
            self.assertEqual((self.folder / f"{side}.png").read_bytes(), (self.report / f"{side}.png").read_bytes())
        error = read_pfm(self.folder / "reference.pfm").astype(float) - read_pfm(self.folder / "lightcluster.pfm")
        self.assertAlmostEqual(comparison["rmse"]["linear"], numpy.sqrt(numpy.mean(error**2)), 9)
        self.assertAlmostEqual(comparison["max_error"]["linear"], numpy.abs(error).max(), 9)
        self.assertGreater(comparison["rmse"]["linear"], 0)
        self.assertTrue(0 < comparison["flip"]["mean"] < 0.5 < comparison["ssim"] < 1)
        self.assertLess(comparison["b"]["counters"]["shadow_maps"], comparison["a"]["counters"]["shadow_maps"])

    def test_a_budget_is_told_as_it_is_drawn(self):
        """The second side is drawn with the first one's exposure, and what keeps a budget depends on that."""
        for preset in ("chandelier", "lightcluster"):
            drawn = self.compare("--max-error", 0.0379, presets=f"reference,{preset}")
            side = drawn["b"]
            self.assertIn(f"makes {side['counters']['shadow_maps']} shadow maps, expected", self.said)
            self.play_well(self.pack, "--predict", "--stats", "p.json", "--preset", preset, "--max-error", 0.0379,
                           "--exposure", repr(drawn["a"]["exposure_ev"]), *SMALL)
            told = json.loads((self.folder / "p.json").read_text())
            for what in ("recipe", "expected_rmse_shown", "lights_without_own_map"):
                self.assertEqual(side[what], told[what])

    @unittest.skipUnless(shutil.which("compare"), "ImageMagick is not installed")
    def test_rmse_is_imagemagick_s(self):
        comparison = self.compare("--d-init", 0.6)
        done = subprocess.run(["compare", "-metric", "RMSE", self.report / "reference.png",
                               self.report / "lightcluster.png", "null:"], stderr=subprocess.PIPE, text=True)
        found = float(re.search(r"\((.*)\)", done.stderr).group(1))
        self.assertAlmostEqual(comparison["rmse"]["shown"], found, 6)  # it prints six digits

    def test_tiny_pictures_have_no_ssim(self):
        for width, has_ssim in ((10, False), (11, True)):
            comparison = self.compare(size=["--size", f"{width}x54", "--face-size", "64"])
            self.assertEqual(comparison["ssim"] is not None, has_ssim, width)

    def test_light_clusters_of_one_light_each_are_the_reference(self):
        comparison = self.compare("--d-init", 0, "--filter", "hard")
        self.assertEqual(comparison["rmse"], {"linear": 0, "shown": 0})
        self.assertEqual(comparison["max_error"], {"linear": 0, "shown": 0})
        # Light clusters of one light each do not pay: the frame is the reference's (LightCluster §5.4).
        self.assertEqual(comparison["b"]["counters"], {**comparison["a"]["counters"], "reference_path": 1})

    def test_a_preset_against_itself(self):
        comparison = self.compare(presets="reference,reference")
        self.assertEqual(comparison["rmse"], {"linear": 0, "shown": 0})
        self.assertEqual((comparison["ssim"], comparison["flip"]["mean"]), (1, 0))
        self.assertNotEqual(comparison["a"]["image"], comparison["b"]["image"])
        for side in "ab":
            self.assertTrue((self.report / comparison[side]["image"]).exists())


class Path(PlayTest):
    """A camera walks through the Cornell box."""
    KEYS = ["0.2,1,3.4,0,1,0,50", "-0.6,1.2,1.2,0.3,0.8,-1,50"]

    def walk(self, *options):
        (self.folder / "walk.json").write_text(json.dumps({"keys": self.KEYS}))
        report = self.folder / "report"
        self.play_well(self.pack, "--path", self.folder / "walk.json", "--report", report, "--frames", 12, *SMALL, *options)
        found = json.loads((report / "path.json").read_text())
        schema_validator("path.schema.json").validate(found)
        self.assertEqual(png_size(report / "last.png"), (96, 54))
        self.assertEqual(len(found["frames"]), 12)
        return found

    def test_stability_changes_fewer_lights_and_less_of_the_picture(self):
        clusters = ["--preset", "lightcluster", "--d-init", 0.3, "--z-far", 10]
        plain, stable = self.walk(*clusters), self.walk(*clusters, "--stability", 0.3)
        print("lights that change a frame:", plain["mean"]["lights_changed"], "to", stable["mean"]["lights_changed"])
        self.assertGreater(plain["mean"]["lights_changed"], 0)
        self.assertLess(stable["mean"]["lights_changed"], plain["mean"]["lights_changed"])
        self.assertLess(stable["mean"]["unexplained_rmse"], plain["mean"]["unexplained_rmse"])

    def test_the_reference_changes_nothing(self):
        found = self.walk("--preset", "reference")
        self.assertEqual(found["mean"]["lights_changed"], 0)
        self.assertEqual(found["mean"]["unexplained_rmse"], 0)
        self.assertEqual(found["frames"][3]["lights_kept_in_view"], LIGHTS)

    def test_a_bad_path_is_told_in_one_line(self):
        for text, what in (("{", "not JSON"), ("[]", "keys"), ('{"keys": ["0,0,0,0,0,1,50"]}', "two cameras"),
                           ('{"keys": ["0,0,0,0,0,1,50", 3]}', "keys: 1: must be"), ('{"keys": ["a", "b"]}', '"a"')):
            (self.folder / "bad.json").write_text(text)
            done = self.play(self.pack, "--path", self.folder / "bad.json", "--report", self.folder / "report")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn("bad.json", done.stderr)
            self.assertIn(what, done.stderr)
        for path in (self.folder, self.folder / "none.json"):
            done = self.play(self.pack, "--path", path, "--report", self.folder / "report")
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{path}: cannot be read", done.stderr)
        self.assertFalse((self.folder / "report").exists())

    def test_what_does_not_go_with_a_path_is_refused(self):
        for options in (["--predict"], ["--output", "x.png"], ["--camera", "front"], ["--max-shadow-maps", 3], ["--frames", 1]):
            done = self.play(self.pack, "--path", "walk.json", "--report", "report", *options)
            self.assertEqual(done.returncode, 2, options)
            self.assertIn("--path", done.stderr)


if __name__ == "__main__":
    main()
