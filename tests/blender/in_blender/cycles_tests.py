# SPDX-License-Identifier: Apache-2.0
"""Truth: a Cornell box with 32 point lights, exported from Blender, baked and played, against Cycles.

CHANDELIER_CYCLES_REPORT names a folder for the pictures. Cycles renders each lamp by itself, at the middle of each pixel: with
point lamps of no size there is no noise then, and the sum of all is what it converges to; those with a radius take samples."""

import json
import math
import os
import pathlib
import random

import addon_utils
import bpy
import numpy as np

from blender_case import ADDON, SOURCE, BlenderCase, part

BIN = pathlib.Path(os.environ.get("CHANDELIER_BIN", SOURCE / "build" / "bin"))
SIZE = (160, 160)
AT_PIXEL_CENTERS = {"pixel_filter_type": "BOX", "filter_width": 0.01}
BOXES = (((-0.35, 0.3, 0.6), (0.55, 0.55, 1.2), 20), ((0.35, -0.3, 0.3), (0.55, 0.55, 0.6), -18))  # centre, size, degrees


def clear_of_boxes(place):
    return all(math.dist(place, center) > 0.55 * math.hypot(*size) + 0.05 for center, size, _ in BOXES)


class Cornell(BlenderCase):
    def setUp(self):
        super().setUp()
        if not (BIN / "chandelier-bake").exists():
            self.skipTest(f"no chandelier-bake in {BIN}")
        if not hasattr(bpy.types.Scene, "cycles"):
            addon_utils.enable("cycles", default_set=True)
        bpy.context.preferences.addons[ADDON].preferences.tools_folder = str(BIN)
        self.compare = part("cycles_compare")
        self.error = part("core.picture_error")
        self.make_room()
        self.lamps = self.make_lamps()
        self.make_camera()

    def material(self, name, colour):
        """Principled, as artists have it and glTF takes it."""
        made = bpy.data.materials.new(name)
        made.use_nodes = True
        made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
        return made

    def wall(self, location, rotation, material):
        bpy.ops.mesh.primitive_plane_add(size=2, location=location, rotation=rotation)
        bpy.context.object.data.materials.append(material)

    def make_room(self):
        white, red, green = (self.material(name, colour) for name, colour in (
            ("White", (0.73, 0.71, 0.68)), ("Red", (0.6, 0.06, 0.05)), ("Green", (0.13, 0.43, 0.1))))
        quarter = math.pi / 2
        self.wall((0, 0, 0), (0, 0, 0), white)
        self.wall((0, 0, 2), (2 * quarter, 0, 0), white)
        self.wall((0, 1, 1), (quarter, 0, 0), white)
        self.wall((-1, 0, 1), (0, quarter, 0), red)
        self.wall((1, 0, 1), (0, -quarter, 0), green)
        for center, size, degrees in BOXES:
            bpy.ops.mesh.primitive_cube_add(size=1, location=center, rotation=(0, 0, math.radians(degrees)), scale=size)
            bpy.context.object.data.materials.append(white)

    def make_lamps(self):
        rng = random.Random(7)
        lamps = []
        while len(lamps) < 32:
            place = [rng.uniform(-0.85, 0.85), rng.uniform(-0.85, 0.85), rng.uniform(0.2, 1.9)]
            if clear_of_boxes(place):
                lamps.append(self.add_light(f"Lamp {len(lamps)}", location=place, energy=rng.uniform(1, 4), shadow_soft_size=0,
                                            color=[rng.uniform(0.5, 1) for _ in range(3)]))
        return lamps

    def make_camera(self):
        camera = self.add("Camera", bpy.data.cameras.new("Camera"), (0, -3.6, 1))
        camera.rotation_euler = (math.pi / 2, 0, 0)
        self.scene.camera = camera
        self.scene.render.resolution_x, self.scene.render.resolution_y = SIZE

    def make_lambertian(self):
        """In Cycles alone, and after export: so that light and shadow are compared, and not two models of gloss."""
        for material in bpy.data.materials:
            nodes, links = material.node_tree.nodes, material.node_tree.links
            diffuse = nodes.new("ShaderNodeBsdfDiffuse")
            diffuse.inputs["Color"].default_value = nodes["Principled BSDF"].inputs["Base Color"].default_value
            links.new(diffuse.outputs["BSDF"], nodes["Material Output"].inputs["Surface"])

    def ours(self, *options, preset="reference"):
        pack = self.compare.bake_now(bpy.context, self.folder)
        return self.compare.chandelier_picture(self.scene, pack, self.folder / "ours.pfm", SIZE, preset, "--face-size", "1024",
                                               "--shade", "lambert", *options)

    def converged(self, samples=1):
        for lamp in self.lamps:
            lamp.hide_render = True
        total = np.zeros((SIZE[1], SIZE[0], 3), np.float64)
        for lamp in self.lamps:
            lamp.hide_render = False
            total += self.compare.cycles_picture(self.scene, self.folder / "one.exr", samples, SIZE, **AT_PIXEL_CENTERS)
            lamp.hide_render = True
        for lamp in self.lamps:
            lamp.hide_render = False
        return total.astype(np.float32)

    def report(self, name, cycles, ours):
        folder = os.environ.get("CHANDELIER_CYCLES_REPORT")
        error = self.error.error_of(cycles, ours)
        print(f"{name}: {error.line()}")
        if folder:
            folder = pathlib.Path(folder)
            folder.mkdir(parents=True, exist_ok=True)
            image = self.compare.show(self.error.sheet(cycles, ours))
            image.filepath_raw, image.file_format = str(folder / f"{name}.png"), "PNG"
            image.save()
            (folder / f"{name}.json").write_text(json.dumps(error.__dict__))
        return error

    def test_radiance_and_shadows_are_those_of_cycles(self):
        ours = self.ours()
        self.make_lambertian()
        cycles = self.converged()
        self.assertGreater(cycles.mean(), 0)
        error = self.report("cornell", cycles, ours)
        self.assertLess(abs(error.mean), 0.02)
        self.assertLess(error.mean_absolute, 0.02)
        self.assertLess(error.apart, 0.03)  # along shadows' edges

    def test_radius_and_shadow_are_those_of_cycles(self):
        bpy.data.batch_remove(self.lamps[8:])
        del self.lamps[8:]
        for lamp in self.lamps:
            lamp.data.shadow_soft_size = 0.1
        self.lamps[0].data.use_shadow = False
        self.scene.chandelier.d_init, self.scene.chandelier.face_size = 0.1, 1024
        played = part("handover").play_command(self.scene)[1:]  # as Play asks for it
        played = self.compare.without(played, "--preset", "--camera", "--face-size")
        pictures = {"soft_truth": self.ours(preset="truth"), "soft_played": self.ours(*played, preset="lightcluster")}
        self.make_lambertian()
        cycles = self.converged(samples=64)
        for name, picture in pictures.items():
            error = self.report(name, cycles, picture)
            self.assertLess(abs(error.mean), 0.02)
            self.assertLess(error.mean_absolute, 0.035)
            self.assertLess(error.apart, 0.05)

    def test_a_light_that_is_lost_is_found_out(self):
        ours = self.ours()
        self.make_lambertian()
        self.lamps.pop().hide_render = True
        error = self.report("without_a_lamp", self.converged(), ours)
        self.assertGreater(error.mean_absolute, 0.02)

    def test_the_operator_shows_both(self):
        self.scene.chandelier.d_init = 0.3
        world, engine = self.scene.world, self.scene.render.engine
        self.assertEqual(bpy.ops.chandelier.compare(samples=4, scale=50), {"FINISHED"})
        image = bpy.data.images["Chandelier against Cycles"]
        self.assertEqual(tuple(image.size), (3 * 80 + 8, 80))
        self.assertEqual((self.scene.world, self.scene.render.engine), (world, engine))
        self.assertEqual(bpy.ops.chandelier.compare(samples=2, scale=10, preset="truth"), {"FINISHED"})

    def test_without_cycles_it_says_so(self):
        addon_utils.disable("cycles")
        self.addCleanup(addon_utils.enable, "cycles")
        with self.assertRaisesRegex(RuntimeError, "'Cycles Render Engine' is switched off"):
            bpy.ops.chandelier.compare()
