# SPDX-License-Identifier: Apache-2.0
"""What the preview says while a scene changes."""

import math
import time

import bpy

from blender_case import BlenderCase, part

preview = part("preview")


class Preview(BlenderCase):
    def setUp(self):
        super().setUp()
        self.scene.chandelier.distance_scaling = "none"
        self.scene.chandelier.d_init = 1.0

    def update(self):
        bpy.context.view_layer.update()
        selection = preview.PREVIEW.update(bpy.context)
        self.assertEqual(preview.PREVIEW.error, "")
        return selection

    def add_ring(self, name, center, lamps=8, radius=0.3, **values):
        return [self.add_light(f"{name} {i}", location=(
            center[0] + radius * math.cos(i * 2 * math.pi / lamps), center[1] + radius * math.sin(i * 2 * math.pi / lamps),
            center[2]), energy=20, use_custom_distance=True, cutoff_distance=3, **values) for i in range(lamps)]

    def add_camera(self, location=(0, -10, 1.5), width=1280, height=720):
        camera = self.add("Camera", bpy.data.cameras.new("Camera"), location)
        camera.rotation_euler = (math.pi / 2, 0, 0)
        self.scene.camera = camera
        self.scene.render.resolution_x, self.scene.render.resolution_y = width, height
        return camera

    def test_no_lights_no_selection(self):
        self.assertIsNone(self.update())

    def test_lights_that_are_near_share_a_map(self):
        self.add_ring("Left", (-4, 0, 1))
        self.add_ring("Right", (4, 0, 1))
        selection = self.update()
        self.assertEqual((selection.bill.lights, selection.bill.shadow_maps), (16, 2))
        self.assertEqual(selection.bill.shadow_bytes, 2 * 6 * 512 * 512 * 4)

    def test_nothing_is_done_where_nothing_changed(self):
        self.add_ring("Left", (-4, 0, 1))
        self.update()
        version = preview.PREVIEW.version
        self.add("Empty")
        self.update()
        self.assertEqual(preview.PREVIEW.version - version, 1)  # a new object might be a light
        self.update()
        self.assertEqual(preview.PREVIEW.version - version, 1)

    def test_follows_moves_data_settings_and_removal(self):
        lamps = self.add_ring("Left", (-4, 0, 1))
        self.assertEqual(self.update().bill.shadow_maps, 1)
        lamps[3].location.x += 2
        self.assertEqual(self.update().bill.shadow_maps, 2)
        lamps[5].data.chandelier.cluster = False
        lamps[5].data.update_tag()
        self.assertEqual(self.update().bill.shadow_maps, 3)
        self.scene.chandelier.d_init = 0
        self.assertEqual(self.update().bill.shadow_maps, 8)
        self.scene.chandelier.face_size = 256
        self.assertEqual(self.update().bill.shadow_bytes, 8 * 6 * 256 * 256 * 4)
        bpy.data.objects.remove(lamps[0])
        self.assertEqual(self.update().bill.lights, 7)

    def test_what_authors_set_needs_no_tag(self):
        lamps = self.add_ring("Left", (-4, 0, 1))
        self.update()
        lamps[5].data.chandelier.cluster = False
        self.assertEqual(self.update().bill.shadow_maps, 2)
        lamps[1].data.chandelier.group = lamps[2].data.chandelier.group = "pair"
        self.assertEqual(self.update().bill.shadow_maps, 3)

    def test_collection_instances_count(self):
        collection = bpy.data.collections.new("Chandelier")
        self.add_light("Candle", location=(0, 0, 1), energy=20, collection=collection)
        for x in (-5, 0, 5):
            empty = self.add(f"Place {x}", location=(x, 0, 0))
            empty.instance_type, empty.instance_collection = "COLLECTION", collection
        self.assertEqual(self.update().bill.shadow_maps, 3)

    def test_linked_libraries_count(self):
        self.add_ring("Left", (-4, 0, 1))
        library = self.folder / "library.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(library))
        bpy.ops.wm.read_homefile(use_empty=True)
        self.scene = bpy.context.scene
        with bpy.data.libraries.load(str(library), link=True) as (source, target):
            target.objects = source.objects
        for thing in target.objects:
            self.scene.collection.objects.link(thing)
        self.assertEqual(self.update().bill.lights, 8)

    def test_undo_is_followed(self):
        lamps = self.add_ring("Left", (-4, 0, 1))
        bpy.ops.ed.undo_push(message="made")
        self.assertEqual(self.update().bill.shadow_maps, 1)
        self.select(lamps[3])
        bpy.ops.transform.translate(value=(3, 0, 0))
        bpy.ops.ed.undo_push(message="moved")
        self.assertEqual(self.update().bill.shadow_maps, 2)
        bpy.ops.ed.undo()
        self.assertEqual(self.update().bill.shadow_maps, 1)
        bpy.ops.ed.redo()
        self.assertEqual(self.update().bill.shadow_maps, 2)

    def test_lights_that_the_camera_does_not_see_take_no_map(self):
        self.add_ring("Ahead", (0, 0, 1.5))
        behind = self.add_ring("Behind", (0, -30, 1.5))
        camera = self.add_camera()
        selection = self.update()
        self.assertEqual((selection.bill.lights, selection.bill.lights_in_view), (16, 8))
        row = preview.PREVIEW.table.names.index(behind[0].name)
        self.assertEqual(selection.center[row], -1)
        camera.rotation_euler.z = math.pi
        self.assertEqual(preview.PREVIEW.table.names[self.update().clusters["center"][0]].split()[0], "Behind")

    def test_budget_names_who_loses(self):
        self.add_ring("Left", (-4, 0, 1))
        self.add_ring("Right", (4, 0, 1))
        self.scene.chandelier.budget_maps = 1
        selection = self.update()
        self.assertEqual((selection.bill.shadow_maps, selection.bill.wanted_shadow_maps), (1, 2))
        self.assertEqual(selection.over_budget.sum(), 1)
        (title, _), *bad = preview.bill_lines(self.scene)
        self.assertEqual(title, "16 lights → 1 shadow map of 1, 6 MiB")
        lost = preview.PREVIEW.table.names[selection.over_budget.nonzero()[0][0]]
        self.assertTrue(any(lost in text for text, is_bad in bad if is_bad), bad)

    def test_two_thousand_lights(self):
        for ring in range(250):
            self.add_ring(f"Ring {ring}", (ring % 16 * 3, ring // 16 * 3, 1))
        self.assertEqual(self.update().bill.lights, 2000)
        lamp = bpy.data.objects["Ring 100 3"]
        times = []
        for step in range(10):
            lamp.location.x += 0.5
            bpy.context.view_layer.update()
            began = time.perf_counter()
            selection = preview.PREVIEW.update(bpy.context)
            times.append(1000 * (time.perf_counter() - began))
        self.assertEqual(selection.bill.shadow_maps, 251)
        print(f"2,000 lights, one moved: {sorted(times)[5]:.1f} ms an update, median of 10")
