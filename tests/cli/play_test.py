# SPDX-License-Identifier: Apache-2.0
# Runs chandelier-play as a user would: pictures, statistics, comparisons, a window, and everything that can go wrong.
import html.parser
import json
import os
import pathlib
import re
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import jsonschema
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from pictures import read_pfm

SOURCE = pathlib.Path(os.environ["CHANDELIER_SOURCE"])
PLAY = os.environ["CHANDELIER_PLAY"]
BAKE = os.environ["CHANDELIER_BAKE"]
SKIPPED = 77  # exit status that ctest shows as "Skipped"
LIGHTS = 32  # in examples/cornell.py
SMALL = ["--size", "96x54", "--face-size", "64"]
PATIENCE_S = 120  # before a hang is called one; no test asserts a time


def schema_validator(name):
    schemas = {page.name: json.loads(page.read_text()) for page in (SOURCE / "schemas").glob("*.schema.json")}
    jsonschema.Draft202012Validator.check_schema(schemas[name])
    resolver = jsonschema.RefResolver(name, schemas[name], store=schemas)
    return jsonschema.Draft202012Validator(schemas[name], resolver=resolver)


def png_size(path):
    head = pathlib.Path(path).read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:24])


class PlayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.pack = pathlib.Path(cls.made.name) / "cornell.chandelier"
        scene = cls.pack.with_suffix(".glb")
        for command in ([sys.executable, SOURCE / "examples/cornell.py", "-o", scene], [BAKE, scene, "-o", cls.pack]):
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.made.cleanup()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def play(self, *arguments, env=None):
        return subprocess.run([PLAY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, env=env,
                              timeout=PATIENCE_S)

    def play_well(self, *arguments):
        done = self.play(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def assert_fails(self, code, because, *arguments, env=None):
        before = sorted(self.folder.rglob("*"))
        done = self.play(*arguments, env=env)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, r"\Achandelier-play: error: [^\n]+\n\Z")
        self.assertRegex(done.stderr, because)
        self.assertEqual(sorted(self.folder.rglob("*")), before, "something was left behind")

    def stats(self, *arguments):
        self.play_well(self.pack, "--output", "s.png", "--stats", "s.json", *SMALL, *arguments)
        stats = json.loads((self.folder / "s.json").read_text())
        schema_validator("stats.schema.json").validate(stats)
        return stats


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

    def test_cameras_by_name_and_by_numbers(self):
        named = self.stats()["camera"]
        self.assertNotEqual(named["name"], "")
        self.assertEqual(self.stats("--camera", named["name"])["camera"], named)
        numbers = self.stats("--camera", "1,2,3,1,2,-1,60")["camera"]
        self.assertEqual(numbers["eye_ws"], [1, 2, 3])
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


class Predict(PlayTest):
    """--predict and budgets; that predictions come true is tested on whole scenes, in tests/scenes."""

    def predict(self, *arguments):
        done = self.play(self.pack, "--predict", "--stats", "p.json", *SMALL, *arguments,
                         env={**os.environ, "VK_DRIVER_FILES": "/nowhere.json"})
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads((self.folder / "p.json").read_text())
        schema_validator("prediction.schema.json").validate(told)
        return told, done

    def test_prints_what_it_writes_and_needs_no_driver(self):
        told, done = self.predict("--preset", "lightcluster")
        self.assertEqual(done.stderr, "")
        rows = dict(line.split(maxsplit=1) for line in done.stdout.splitlines()[1:])
        for name in ("lights", "shadow_maps", "shadow_triangles", "shadow_draws"):
            self.assertEqual(rows[name], str(told["counters"][name]))
        self.assertGreater(told["counters"]["shadow_triangles"], 0)
        self.assertEqual(sorted(os.listdir(self.folder)), ["p.json"])

    def test_budgets_name_the_lights_that_lose_their_map(self):
        told, done = self.predict("--preset", "lightcluster", "--max-shadow-maps", 9)
        maps, shared = told["counters"]["shadow_maps"], told["lights_without_own_map"]
        self.assertLessEqual(maps, 9)
        self.assertEqual(len(shared), LIGHTS - maps)
        names = {f"Light {i}" for i in range(LIGHTS)}
        without = {each["light"] for each in shared}
        self.assertLessEqual(without, names)
        self.assertLessEqual({each["map_of"] for each in shared}, names - without)
        self.assertRegex(done.stderr, r"\Alightcluster: over budget [^\n]*Light \d+ \(Light \d+'s\), [^\n]* and \d+ more\n\Z")
        drawn = self.stats("--preset", "lightcluster", "--max-shadow-maps", 9)
        self.assertEqual(drawn["lights_without_own_map"], shared)
        self.assertEqual(drawn["recipe"], told["recipe"])

    def test_a_budget_for_every_light_is_silent(self):
        told, done = self.predict("--preset", "lightcluster", "--max-shadow-maps", LIGHTS)
        self.assertEqual(done.stderr, "")
        self.assertEqual(told["recipe"]["settings"]["d_init_m"], 0)
        self.assertEqual(told["lights_without_own_map"], [])

    def test_an_error_that_the_budget_misses_is_told(self):
        told, done = self.predict("--preset", "lightcluster", "--max-error", 0.05)
        self.assertLessEqual(told["expected_rmse_shown"], 0.05)
        self.assertGreater(told["recipe"]["settings"]["d_init_m"], 0)
        told, done = self.predict("--preset", "lightcluster", "--max-error", 0.001, "--max-shadow-maps", 4)
        self.assertLessEqual(told["counters"]["shadow_maps"], 4)
        missed = float(re.search(r"--max-error 0.001 is missed by ([0-9.]+)", done.stderr).group(1))
        self.assertAlmostEqual(told["expected_rmse_shown"], 0.001 + missed, delta=2e-4)
        drawn = self.stats("--preset", "lightcluster", "--max-error", 0.05)
        self.assertLessEqual(drawn["expected_rmse_shown"], 0.05)

    def test_selection_by_error_keeps_budgets_itself(self):
        told, done = self.predict("--preset", "chandelier", "--max-shadow-maps", 9)
        self.assertLessEqual(told["counters"]["shadow_maps"], 9)
        self.assertEqual(told["recipe"]["settings"]["max_maps"], 9)
        self.assertRegex(done.stderr, r"\Achandelier: over budget [^\n]* selection by error makes \d; [^\n]* and \d+ more\n\Z")
        drawn = self.stats("--preset", "chandelier", "--max-shadow-maps", 9)
        self.assertEqual((drawn["recipe"], drawn["lights_without_own_map"]), (told["recipe"], told["lights_without_own_map"]))
        without = {each["light"] for each in told["lights_without_own_map"]}
        self.assertEqual(len(without), told["counters"]["lights_in_view"] - told["counters"]["shadow_maps"])
        clusters, _ = self.predict("--preset", "lightcluster", "--max-shadow-maps", 9)
        self.assertLess(told["expected_rmse_shown"], 0.6 * clusters["expected_rmse_shown"])
        within, _ = self.predict("--preset", "chandelier", "--max-error", 0.05)
        self.assertLessEqual(within["expected_rmse_shown"], 0.05)
        self.assertLess(within["counters"]["shadow_maps"], 9)

    def test_a_limit_that_holds_a_map_for_each_light_is_not_called_short(self):
        _, done = self.predict("--preset", "chandelier", "--max-error", 0.05, "--max-shadow-maps", LIGHTS)
        self.assertRegex(done.stderr, r"\Achandelier: selection by error makes [^\n]*\n\Z")
        told, done = self.predict("--preset", "chandelier", "--max-error", 0)
        self.assertEqual((told["counters"]["shadow_maps"], told["expected_rmse_shown"]), (LIGHTS, 0))
        self.assertRegex(done.stderr, r"\Achandelier: selection by error makes [^\n]*\n\Z")
        self.assertNotIn("d_init_m", done.stdout)

    def test_bytes_are_a_budget_too(self):
        told, _ = self.predict("--preset", "lightcluster", "--max-shadow-bytes", 1)
        self.assertLessEqual(told["counters"]["shadow_bytes"], 1 << 20)
        self.assertGreater(told["counters"]["shadow_bytes"], 1 << 19)


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


class Window(PlayTest):
    @classmethod
    def setUpClass(cls):
        if not shutil.which("Xvfb"):
            raise unittest.SkipTest("Xvfb is not installed")
        super().setUpClass()
        reading, writing = os.pipe()
        command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "320x240x24", "-nolisten", "tcp", "-noreset"]
        cls.server = subprocess.Popen(command, pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.addClassCleanup(cls.stop_server)
        os.close(writing)
        assert select.select([reading], [], [], PATIENCE_S)[0], "Xvfb did not start"
        with os.fdopen(reading) as number:  # to the end of the line: a closed pipe would end the server
            cls.env = {**os.environ, "DISPLAY": ":" + number.readline().strip()}

    @classmethod
    def stop_server(cls):
        cls.server.terminate()
        cls.server.wait()

    def screen(self):
        raw = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], env=self.env, check=True,
                             stdout=subprocess.PIPE).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(240, 320, 3)

    def test_closes_after_the_frames_asked_for(self):
        done = self.play(self.pack, "--frames", 3, "--validation", *SMALL, env=self.env)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("0 messages from the validation layer", done.stderr)

    @unittest.skipUnless(shutil.which("import") and shutil.which("convert"), "ImageMagick is not installed")
    def test_shows_the_picture_until_a_signal(self):
        self.play_well(self.pack, "--output", "frame.png", *SMALL)
        raw = subprocess.run(["convert", self.folder / "frame.png", "-depth", "8", "rgb:-"], check=True,
                             stdout=subprocess.PIPE).stdout
        wanted = numpy.frombuffer(raw, numpy.uint8).reshape(54, 96, 3)
        window = subprocess.Popen([PLAY, self.pack, *SMALL], env=self.env, stderr=subprocess.PIPE, text=True)
        try:
            patience = time.monotonic() + PATIENCE_S
            while not numpy.array_equal(self.screen()[:54, :96], wanted) and time.monotonic() < patience:
                self.assertIsNone(window.poll(), "the window closed by itself")
                time.sleep(0.1)
            shown = self.screen()
            numpy.testing.assert_array_equal(shown[:54, :96], wanted)
            self.assertEqual(shown[54:].max(), 0)
        finally:
            window.send_signal(signal.SIGTERM)
            _, said = window.communicate(timeout=PATIENCE_S)
        self.assertEqual(window.returncode, 0, said)

    def test_without_a_display_there_is_a_hint(self):
        blind = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.assert_fails(1, "no display: use --output FILE.png", self.pack, env=blind)


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if len(result.skipped) > 0 and result.testsRun <= len(result.skipped) else 0)
