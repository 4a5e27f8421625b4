# SPDX-License-Identifier: Apache-2.0
"""The runtime's selection on Blender's lights, and what it lets an artist select."""

import math

import bpy

from blender_case import BlenderCase, part

selection = part("selection")


class Select(BlenderCase):
    """Two heaps of lights, far from each other, and one light by itself."""

    def setUp(self):
        super().setUp()
        try:
            selection.find()
        except selection.clusters.PreviewError as error:
            self.skipTest(str(error))
        self.heaps = [[self.add_light(f"Heap {heap} {i}", location=(20 * heap + 0.1 * i, 0, 2), use_custom_distance=True,
                                      cutoff_distance=4) for i in range(4)] for heap in range(2)]
        self.alone = self.add_light("Alone", location=(10, 0, 2))
        self.scene.chandelier.d_init = 1
        self.scene.chandelier.distance_scaling = "none"

    def selected(self):
        return sorted(thing.name for thing in bpy.context.selected_objects)

    def names(self, heap):
        return [light.name for light in self.heaps[heap]]

    def test_the_cluster_of_the_selected(self):
        self.select(self.heaps[0][2])
        bpy.ops.chandelier.select_cluster()
        self.assertEqual(self.selected(), self.names(0))
        self.assertIs(bpy.context.view_layer.objects.active, self.heaps[0][2])
        self.select(self.alone)
        bpy.ops.chandelier.select_cluster()
        self.assertEqual(self.selected(), ["Alone"])
        self.select(self.heaps[1][0], self.alone)
        bpy.ops.chandelier.select_cluster()
        self.assertEqual(self.selected(), sorted(["Alone", *self.names(1)]))

    def test_own_maps_are_never_shared(self):
        self.heaps[0][2].data.chandelier.cluster = False
        self.select(self.heaps[0][0])
        bpy.ops.chandelier.select_cluster()
        self.assertEqual(self.selected(), ["Heap 0 0", "Heap 0 1", "Heap 0 3"])

    def test_groups_share_whatever_the_distance(self):
        for light in (self.alone, self.heaps[1][0]):
            light.data.chandelier.group = "bar"
        self.select(self.alone)
        bpy.ops.chandelier.select_cluster()
        self.assertEqual(self.selected(), ["Alone", "Heap 1 0"])

    def test_over_budget(self):
        bpy.ops.chandelier.select_over_budget()
        self.assertEqual(self.selected(), [])
        self.scene.chandelier.budget_maps = 2
        self.select()
        bpy.ops.chandelier.select_over_budget()
        self.assertTrue(self.selected())
        table, found = selection.select(bpy.context)
        self.assertLessEqual(found.bill.shadow_maps, 2)

    def test_instances_select_their_instancer(self):
        collection = bpy.data.collections.new("Candles")
        self.add_light("Candle", collection=collection, use_custom_distance=True, cutoff_distance=4)
        instancer = self.add("Candlestick", location=(0.2, 0.1, 2))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        self.select(self.heaps[0][0])
        bpy.ops.chandelier.select_cluster()
        self.assertEqual(self.selected(), sorted(["Candlestick", *self.names(0)]))

    def test_no_lights_at_all(self):
        bpy.data.batch_remove([self.alone, *self.heaps[0], *self.heaps[1]])
        bpy.ops.chandelier.select_over_budget()
        self.assertEqual(self.selected(), [])


class Camera(BlenderCase):
    def camera(self):
        table = part("scene_lights").read(bpy.context.evaluated_depsgraph_get())
        return part("cameras").camera_of(bpy.context, table)

    def test_the_scenes_camera_as_the_exporter_writes_it(self):
        bpy.ops.object.camera_add(location=(1, 2, 3), rotation=(math.pi / 2, 0, math.pi / 2))
        eye = self.scene.camera = bpy.context.object
        gltf = part("core.gltf_check")
        path = self.folder / "camera.glb"
        for width, height, fit in ((1920, 1080, "AUTO"), (600, 800, "AUTO"), (1920, 1080, "VERTICAL"), (600, 800, "HORIZONTAL")):
            self.scene.render.resolution_x, self.scene.render.resolution_y, eye.data.sensor_fit = width, height, fit
            camera = self.camera()
            part("export").export(bpy.context, str(path))
            written = gltf.read_json(path)["cameras"][0]["perspective"]
            self.assertAlmostEqual(camera.yfov_rad, written["yfov"], places=5, msg=f"{width} x {height}, {fit}")
            self.assertAlmostEqual(camera.znear_m, written["znear"], places=5)
        self.assertClose(camera.eye, (1, 2, 3))
        self.assertClose(camera.forward, (-1, 0, 0))
        self.assertClose(camera.up, (0, 0, 1))

    def test_nobody_looks(self):
        for place in ((1, 0, 0), (3, 2, 4)):
            self.add_light(location=place)
        bpy.context.view_layer.update()
        camera = self.camera()
        self.assertClose(camera.eye, (2, 1, 2))
        self.assertIsNone(camera.forward)

    def test_pixels_that_are_not_square(self):
        bpy.ops.object.camera_add()
        self.scene.camera = bpy.context.object
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.pixel_aspect_x = 400, 200, 1.5
        self.assertEqual(self.camera().size_px, (600, 200))

    def test_what_the_player_cannot_take_is_no_camera(self):
        self.add_light(location=(1, 2, 3))
        self.scene.camera = self.add("Empty", location=(5, 5, 5))
        for kind in ("", "ORTHO", "PANO"):
            if kind:
                self.scene.camera = self.add(kind, bpy.data.cameras.new(kind))
                self.scene.camera.data.type = kind
            bpy.context.view_layer.update()
            camera = self.camera()
            self.assertIsNone(camera.forward)
            self.assertClose(camera.eye, (1, 2, 3))
            self.assertNotIn("--camera", part("handover").play_command(self.scene))
            self.assertFalse(bpy.ops.chandelier.compare.poll())
        self.scene.camera.data.type = "PERSP"
        self.assertIn("--camera", part("handover").play_command(self.scene))
        self.assertTrue(bpy.ops.chandelier.compare.poll())

    def test_the_viewport(self):
        self.scene.chandelier.view = "viewport"
        camera = self.camera()
        areas = [area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D"]
        view = max(areas, key=lambda area: area.width * area.height).spaces.active.region_3d
        self.assertClose(camera.eye, view.view_matrix.inverted().translation)
        self.assertTrue(camera.forward is not None or not view.is_perspective)
