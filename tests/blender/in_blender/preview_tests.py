# SPDX-License-Identifier: Apache-2.0
"""What the preview says while a scene changes."""

import math
import time

import bpy

from blender_case import ADDON, BlenderCase, part

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
        lamps[5].data.use_shadow = False
        bill = self.update().bill
        self.assertEqual((bill.shadow_maps, bill.shadowless_in_view, bill.lights_in_view), (2, 1, 8))

    def test_lights_that_move_may_keep_their_own_maps(self):
        lamps = self.add_ring("Left", (-4, 0, 1))
        lamps[1].data.chandelier.dynamic = True
        for frame in (1, 20):
            lamps[2].location.x += 0.1
            lamps[2].keyframe_insert("location", frame=frame)
        self.assertEqual(self.update().bill.shadow_maps, 1)
        self.scene.chandelier.dynamic_lights = "own"
        self.assertEqual(self.update().bill.shadow_maps, 3)
        lamps[2].animation_data_clear()
        lamps[2].location.x += 0.01
        self.assertEqual(self.update().bill.shadow_maps, 2)

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
        (title, _), *bad = preview.bill_lines(bpy.context)
        self.assertEqual(title, "16 lights → 1 shadow map of 1, 6 MiB")
        lost = preview.PREVIEW.table.names[selection.over_budget.nonzero()[0][0]]
        self.assertTrue(any(lost in text for text, is_bad in bad if is_bad), bad)

    def test_versions_never_come_again(self):
        """What is drawn is built again only with another version."""
        self.add_ring("Left", (-4, 0, 1))
        seen = []
        for step in range(4):
            bpy.ops.ed.undo_push(message="step")
            preview.PREVIEW.forget()
            self.update()
            seen.append(preview.PREVIEW.version)
        self.assertEqual(seen, sorted(set(seen)))

    def test_animation_is_followed(self):
        lamps = self.add_ring("Left", (-4, 0, 1))
        lamps[3].keyframe_insert("location", frame=1)
        lamps[3].location.x += 5
        lamps[3].keyframe_insert("location", frame=10)
        dimmed = lamps[5].data
        dimmed.keyframe_insert("energy", frame=1)
        dimmed.energy = 0
        dimmed.keyframe_insert("energy", frame=10)
        nodes = lamps[6].data
        nodes.use_nodes = True
        strength = nodes.node_tree.nodes["Emission"].inputs["Strength"]
        strength.default_value = 1
        strength.keyframe_insert("default_value", frame=1)
        strength.default_value = 0
        strength.keyframe_insert("default_value", frame=20)
        self.update()
        reader, seen = preview.PREVIEW.reader, []
        for frame in (1, 10, 20, 1, 10):
            self.scene.frame_set(frame)
            bill = preview.PREVIEW.update(bpy.context).bill
            seen.append((bill.lights, bill.shadow_maps))
        self.assertEqual(seen, [(8, 1), (7, 2), (6, 2), (8, 1), (7, 2)])
        self.assertIs(preview.PREVIEW.reader, reader)  # what stands still was not read again

    def in_scene(self, scene):
        bpy.context.window.scene = scene
        return self.update()

    def test_each_scene_and_view_layer_has_its_own(self):
        first = self.scene
        lamps = self.add_ring("First", (-4, 0, 1))
        self.scene = second = bpy.data.scenes.new("Second")
        second.chandelier.distance_scaling = "none"
        self.add_ring("Second", (4, 0, 1), lamps=3)
        second.collection.objects.link(lamps[0])  # shared
        for _ in range(2):
            self.assertEqual(self.in_scene(first).bill.lights, 8)
            self.assertEqual(self.in_scene(second).bill.lights, 4)
        lamps[0].data.energy = 0
        self.assertEqual(self.in_scene(second).bill.lights, 3)
        self.assertEqual(self.in_scene(first).bill.lights, 7)
        layer = first.view_layers.new("Few")
        layer.layer_collection.exclude = False
        inner = bpy.data.collections.new("Inner")
        first.collection.children.link(inner)
        self.scene = first
        self.add_light("Inner", collection=inner, energy=20)
        first.view_layers["Few"].layer_collection.children["Inner"].exclude = True
        self.assertEqual(self.update().bill.lights, 8)
        bpy.context.window.view_layer = first.view_layers["Few"]
        self.assertEqual(self.update().bill.lights, 7)

    def test_another_scenes_changes_change_nothing(self):
        self.add_ring("First", (-4, 0, 1))
        other = bpy.data.scenes.new("Second")
        data = bpy.data.lights.new("Alone", "POINT")
        lamp = bpy.data.objects.new("Alone", data)
        other.collection.objects.link(lamp)
        self.update()
        version = preview.PREVIEW.version
        lamp.location.x = 3
        other.view_layers[0].update()
        preview.note(other, other.view_layers[0].depsgraph)
        self.assertFalse(preview.PREVIEW.is_stale)
        self.assertEqual(preview.PREVIEW.update(bpy.context).bill.lights, 8)
        self.assertEqual(preview.PREVIEW.version, version)

    def test_the_panel_needs_no_overlay_to_be_right(self):
        lamps = self.add_ring("Left", (-4, 0, 1))
        bpy.context.view_layer.update()
        self.assertEqual(preview.bill_lines(bpy.context)[0][0], "8 lights → 1 shadow map, 6 MiB")
        bpy.data.objects.remove(lamps[0])
        bpy.context.view_layer.update()
        self.assertEqual(preview.bill_lines(bpy.context)[0][0], "7 lights → 1 shadow map, 6 MiB")

    def test_the_engine_is_found_again_in_another_folder(self):
        self.add_ring("Left", (-4, 0, 1))
        self.update()
        engine, settings = preview.PREVIEW.engine, bpy.context.preferences.addons[ADDON].preferences
        self.scene.chandelier.d_init = 0
        self.update()
        self.assertIs(preview.PREVIEW.engine, engine)
        self.addCleanup(setattr, settings, "tools_folder", "")
        settings.tools_folder = str(self.folder)
        self.update()
        self.assertIsNot(preview.PREVIEW.engine, engine)

    def test_two_thousand_lights(self):
        for ring in range(250):
            self.add_ring(f"Ring {ring}", (ring % 16 * 3, ring // 16 * 3, 1))
        self.assertEqual(self.update().bill.lights, 2000)
        lamp = bpy.data.objects["Ring 100 3"]
        for d_init, maps in ((1, 0), (1, 100), (0, 1000)):
            self.scene.chandelier.d_init, self.scene.chandelier.budget_maps = d_init, maps
            times = []
            for step in range(10):
                lamp.location.x += 0.5
                bpy.context.view_layer.update()
                began = time.perf_counter()
                selection = preview.PREVIEW.update(bpy.context)
                times.append(1000 * (time.perf_counter() - began))
            if maps:
                self.assertIn(selection.bill.shadow_maps, range(maps // 2 + 1, maps + 1))  # a budget is there to be used
            else:
                self.assertEqual(selection.bill.shadow_maps, 251)
            self.assertEqual(selection.bill.over_budget, maps > 0)
            print(f"2,000 lights, budget of {maps or 'no'} maps, one moved: {sorted(times)[5]:.1f} ms an update, median of 10")
