# SPDX-License-Identifier: Apache-2.0
# Packs that would be black: without lights, without cameras, closed, under a sky. Each says so, or is seen all the same.
import json
import sys
import unittest

import numpy

from play_tool import SMALL, SOURCE, PlayTest, bake, main, schema_validator

sys.path[:0] = [str(SOURCE / "examples"), str(SOURCE / "tests")]
from gltf_writer import Document
from pictures import read_pfm
from shapes import box, quad, sphere

WALL = 0.2  # thickness, metres
GREY = (0.7, 0.7, 0.7)


def house(document, width=6.0, height=3.0, length=6.0):
    """Closed on all sides; the floor is y = 0."""
    x, z = width / 2, length / 2
    walls = [((-x - WALL, -WALL, -z - WALL), (x + WALL, 0, z + WALL)), ((-x - WALL, height, -z - WALL), (x + WALL, height + WALL, z + WALL)),
             ((-x - WALL, 0, -z), (-x, height, z)), ((x, 0, -z), (x + WALL, height, z)),
             ((-x - WALL, 0, -z - WALL), (x + WALL, height, -z)), ((-x - WALL, 0, z), (x + WALL, height, z + WALL))]
    grey = document.add_material("Grey", color=GREY)
    for low, high in walls:
        document.add_node("Wall", mesh=document.add_mesh("Wall", [(box(low, high), grey)]))


def sky(document, radius):
    """A dome that is seen from both sides, as its own colour."""
    blue = document.add_material("Sky", color=(0.1, 0.15, 0.4), double_sided=True)
    document.json["materials"][blue]["extensions"] = {"KHR_materials_unlit": {}}
    document.add_node("Sky", mesh=document.add_mesh("Sky", [(sphere(radius), blue)]))


def yard(document):
    """A floor with a box on it."""
    grey = document.add_material("Grey", color=GREY)
    floor = quad((-20, 0, 20), (20, 0, 20), (20, 0, -20), (-20, 0, -20))
    document.add_node("Yard", mesh=document.add_mesh("Yard", [(floor, grey), (box((-1, 0, -1), (1, 2, 1)), grey)]))


class DarkTest(PlayTest):
    def baked(self, build):
        """The pack of a scene that `build` puts into a document."""
        document = Document("Test")
        build(document)
        if any("extensions" in material for material in document.json["materials"]):
            document.json.setdefault("extensionsUsed", []).append("KHR_materials_unlit")
        scene = self.folder / "dark.glb"
        scene.write_bytes(document.glb())
        bake(scene, scene.with_suffix(".chandelier"))
        return scene.with_suffix(".chandelier")

    def draw(self, pack, *options):
        """Statistics, linear radiance, and the lines that were said before the last, which tells of the picture."""
        done = self.play_well(pack, "--output", "dark.pfm", "--stats", "dark.json", *SMALL, *options)
        stats = json.loads((self.folder / "dark.json").read_text())
        schema_validator("stats.schema.json").validate(stats)
        warnings = [line for line in done.stderr.splitlines() if ": warning: " in line]
        return stats, read_pfm(self.folder / "dark.pfm"), warnings


class Dark(DarkTest):
    def no_lights(self):
        def build(document):
            yard(document)
            document.add_camera("Eye", (0, 8, 0), (0, 0, 1e-3), 40)
        return self.baked(build)

    def test_a_pack_without_lights_is_lit_from_the_camera_and_says_so_once(self):
        stats, picture, warnings = self.draw(self.no_lights())
        self.assertEqual(stats["headlight"], 1)
        self.assertEqual((stats["counters"]["lights"], stats["counters"]["shadowless_in_view"]), (0, 0))
        # A surface that faces the camera reflects what its colour is; depth does not matter: box and floor alike.
        self.assertAlmostEqual(float(picture[27, 48].max()), GREY[0], delta=0.01)
        self.assertGreater(float(picture.min()), 0.8 * GREY[0])
        self.assertEqual(len(warnings), 1, warnings)
        self.assertRegex(warnings[0], r"dark.chandelier: has no lights: .*--headlight off.*chandelier-bake SCENE.glb LAMPS.glb")

    def test_the_headlight_is_the_same_in_every_preset(self):
        pack = self.no_lights()
        pictures = [self.draw(pack, "--preset", preset)[1] for preset in ("reference", "lightcluster", "chandelier", "truth")]
        for picture in pictures[1:]:
            numpy.testing.assert_array_equal(picture, pictures[0])
        self.play_well(pack, "--compare", "truth,lightcluster", "--report", "report", *SMALL)
        comparison = json.loads((self.folder / "report" / "comparison.json").read_text())
        self.assertEqual(comparison["a"]["headlight"], 1)
        self.assertEqual(comparison["rmse"]["linear"], 0)

    def test_without_any_light_the_picture_is_black_and_that_is_said_once(self):
        stats, picture, warnings = self.draw(self.no_lights(), "--headlight", "off")
        self.assertEqual(float(picture.max()), 0)
        self.assertEqual(stats["headlight"], 0)
        self.assertEqual(len(warnings), 1, warnings)
        self.assertRegex(warnings[0], "has no lights: .*--headlight on or --ambient")

    def test_who_asked_for_light_is_told_nothing(self):
        pack = self.no_lights()
        for options in (("--headlight", "2"), ("--ambient", "0.5")):
            stats, picture, warnings = self.draw(pack, *options)
            self.assertEqual(warnings, [])
            self.assertAlmostEqual(float(picture[27, 48].max()), float(options[1]) * GREY[0], delta=0.02)
            self.assertEqual(stats["headlight"], 2 if options[0] == "--headlight" else 0)

    def test_what_shines_or_is_unlit_needs_no_light(self):
        def unlit(document):
            sky(document, 2)
        stats, picture, warnings = self.draw(self.baked(unlit), "--headlight", "off")
        self.assertEqual(warnings, [])
        self.assertEqual(stats["camera"]["chosen"], "whole scene")
        self.assertGreater(float(picture.max()), 0)

        def glowing(document):
            lamp = document.add_material("Lamp", emissive=(1, 1, 1))
            document.add_node("Lamp", mesh=document.add_mesh("Lamp", [(sphere(1), lamp)]))
            document.add_point_light("Inside", (0, 0, 0), (1, 1, 1), 1, 0.5)
        self.assertEqual(self.draw(self.baked(glowing))[2], [])

    def test_a_camera_that_sees_nothing_lit_is_told_of(self):
        def build(document):
            house(document)
            document.add_point_light("Lamp", (0, 2.5, 0), (1, 1, 1), 50, 20)
            document.add_camera("Outside", (0, 2, 12), (0, 1, 0), 50)
        pack = self.baked(build)
        stats, picture, warnings = self.draw(pack)
        self.assertEqual(float(picture.max()), 0)
        self.assertEqual(stats["headlight"], 0, "the pack has lights")
        self.assertEqual(len(warnings), 1, warnings)
        self.assertRegex(warnings[0], "the picture is black: .*--headlight on.*--ambient.*--camera")
        self.assertEqual(self.draw(pack, "--headlight", "on")[2], [])
        self.assertIn("sees nothing", self.draw(pack, "--headlight", "on", "--camera", "0,2,12,0,2,20,50")[2][0])
        self.assertEqual(self.draw(pack, "--camera", "0,1.6,2,0,1,0,60")[2], [])
        self.assertRegex(self.draw(pack, "--camera", "0,1.6,2,0,1,0,60", "--exposure", "-20")[2][0], "black with --exposure -20")


class NoCamera(DarkTest):
    def lit_share(self, pack, *options):
        """Of the picture's pixels; with how the view was chosen."""
        stats, picture, warnings = self.draw(pack, *options)
        self.assertEqual(warnings, [])
        return float((picture.max(axis=-1) > 0.01).mean()), stats["camera"]

    def test_a_closed_house_is_seen_from_inside(self):
        def build(document):
            house(document)
            document.add_point_light("Lamp", (0, 2, 0), (1, 1, 1), 50, 20)
        pack = self.baked(build)
        share, camera = self.lit_share(pack)
        self.assertGreater(share, 0.9)
        self.assertEqual(camera["chosen"], "inside")
        for low, at, high in zip((-3, 0, -3), camera["eye_m"], (3, 3, 3)):
            self.assertTrue(low < at < high, camera)
        # It is named for those who want to begin from there, and the same wherever it is chosen.
        done = self.play_well(pack, "--predict", "--stats", "predicted.json", *SMALL)
        said = done.stderr.splitlines()[0]
        self.assertRegex(said, r"dark.chandelier: has no camera: chosen inside, .* --camera [-+.,e\d]+$")
        self.assertEqual(json.loads((self.folder / "predicted.json").read_text())["camera"], camera)
        numbers = self.draw(pack, "--camera", said.split()[-1])[0]["camera"]
        numpy.testing.assert_allclose(numbers["eye_m"] + numbers["forward_ws"], camera["eye_m"] + camera["forward_ws"], atol=1e-4)
        self.play_well(pack, "--compare", "reference,lightcluster", "--report", "report", *SMALL)
        self.assertEqual(json.loads((self.folder / "report" / "comparison.json").read_text())["a"]["camera"], camera)
        self.assertIn("inside", (self.folder / "report" / "report.html").read_text())

    def test_a_lamp_in_its_bulb_and_two_storeys(self):
        def build(document):
            house(document, height=2.6)
            grey = document.add_material("Grey", color=GREY)
            document.add_node("Storey", mesh=document.add_mesh("Storey", [(box((-3.2, 2.8, -3.2), (3.2, 5.4, 3.2)), grey)]))
            bulb = document.add_material("Bulb", emissive=(1, 1, 1))
            node = document.add_node("Bulb", mesh=document.add_mesh("Bulb", [(sphere(0.05).moved(1, 2.2, 0), bulb)]))
            document.json["nodes"][node]["extras"] = {"chandelier": {"shadow": False}}
            document.add_point_light("Lamp", (1, 2.2, 0), (1, 1, 1), 50, 20)
        share, camera = self.lit_share(self.baked(build))
        self.assertGreater(share, 0.8)
        self.assertEqual(camera["chosen"], "inside")
        self.assertTrue(1 < camera["eye_m"][1] < 2, camera)  # in the lamp's own storey, out of the bulb

    def test_a_yard_under_a_sky_is_seen_below_it(self):
        def build(document):
            yard(document)
            sky(document, 5000)
            document.add_point_light("Lamp", (2, 3, 2), (1, 1, 1), 60, 30)
        share, camera = self.lit_share(self.baked(build))
        self.assertGreater(share, 0.1)
        self.assertEqual(camera["chosen"], "without sky")
        self.assertLess(max(map(abs, camera["eye_m"])), 100)

        def unlit(document):  # its headlight is as good as a lamp
            yard(document)
            sky(document, 5000)
        stats, picture, _ = self.draw(self.baked(unlit))
        self.assertEqual(stats["camera"]["chosen"], "without sky")
        self.assertGreater(float((picture.max(axis=-1) > 0.1).mean()), 0.2)

    def test_what_is_lit_outside_is_seen_as_a_whole(self):
        def build(document):
            house(document)
            document.add_point_light("Lamp", (0, 2, 0), (1, 1, 1), 50, 20)
            document.add_point_light("Outside", (5, 6, 7), (1, 1, 1), 500, 40)
        share, camera = self.lit_share(self.baked(build))
        self.assertEqual(camera["chosen"], "whole scene")
        numpy.testing.assert_allclose(numpy.sign(camera["eye_m"]), [1, 1, 1])

    def test_where_nothing_is_lit_anywhere_all_is_seen(self):
        def build(document):
            house(document)
            document.add_point_light("Far", (0, 900, 0), (1, 1, 1), 1, 1)
        stats, _, warnings = self.draw(self.baked(build))
        self.assertEqual(stats["camera"]["chosen"], "whole scene")
        self.assertEqual(len(warnings), 1)


if __name__ == "__main__":
    main()
