# SPDX-License-Identifier: Apache-2.0
"""Blender's evaluated lights as a table."""

import math

import bpy

from blender_case import BlenderCase, part

scene_lights = part("scene_lights")
photometry = part("core.photometry")


class Read(BlenderCase):
    def table(self):
        return scene_lights.read(bpy.context.evaluated_depsgraph_get())

    def row(self, name):
        table = self.table()
        return table, table.names.index(name)

    def test_kinds_and_their_fields(self):
        self.add_light("Point", energy=10, color=(1, 0.5, 0), use_custom_distance=True, cutoff_distance=4, shadow_soft_size=0.125)
        spot = self.add_light("Spot", "SPOT", (1, 2, 3), energy=20, spot_size=math.radians(80))
        spot.rotation_euler = (math.radians(90), 0, 0)
        spot.data.chandelier.priority, spot.data.chandelier.cluster = 9, False
        self.add_light("Sun", "SUN", energy=3, angle=math.radians(2), use_custom_distance=True, cutoff_distance=5)
        self.add_light("Area", "AREA", energy=50)
        self.add_light("Dark", energy=0)
        table = self.table()
        self.assertEqual(table.names, ["Point", "Spot", "Sun"])
        self.assertEqual(table.type.tolist(), [photometry.POINT, photometry.SPOT, photometry.DIRECTIONAL])
        self.assertClose(table.intensity, (543.514, 1087.03, 2049), 0.01)
        self.assertClose(table.range_m, (4, 0, 0))
        self.assertClose(table.radius_m, (0.125, spot.data.shadow_soft_size, math.tan(math.radians(1))))
        self.assertClose(table.colour[0], (1, 0.5, 0))
        self.assertClose(table.position[1], (1, 2, 3))
        self.assertClose(table.direction[1], (0, 1, 0))  # turned up from straight down
        self.assertAlmostEqual(table.spot_outer_rad[1], math.radians(40), places=5)
        self.assertEqual((table.priority[1], table.flags[1]), (9, part("core.light_table").OWN_MAP))

    def test_shadow_is_off_where_either_renderer_has_it_off(self):
        self.add_light("On")
        self.add_light("Off", use_shadow=False)
        cycles = self.add_light("Off in Cycles").data.cycles
        has_switch = hasattr(cycles, "cast_shadow")  # from some version on there is one for both
        if has_switch:
            cycles.cast_shadow = False
        table = self.table()
        off = {name: bool(table.flags[table.names.index(name)] & part("core.light_table").NO_SHADOW) for name in table.names}
        self.assertEqual(off, {"On": False, "Off": True, "Off in Cycles": has_switch})

    def test_a_switched_shadow_is_one_for_both(self):
        data = self.add_light().data
        for shadow in (False, True):
            scene_lights.set_shadow(data, shadow)
            self.assertEqual((scene_lights.casts_shadow(data), data.use_shadow), (shadow, shadow))
            self.assertEqual(getattr(data.cycles, "cast_shadow", shadow), shadow)

    def test_the_widest_sun_has_a_radius_yet(self):
        self.add_light("Sun", "SUN", energy=3, angle=math.pi)
        self.assertClose(self.table().radius_m, (math.tan(math.radians(89.5)),), 1e-3)

    def test_groups_are_numbers(self):
        for name, group in (("A", "bar"), ("B", ""), ("C", "hall"), ("D", "bar")):
            self.add_light(name).data.chandelier.group = group
        table = self.table()
        a, b, c, d = (table.group[table.names.index(name)] for name in "ABCD")
        self.assertEqual((a, b), (d, part("core.light_table").NO_GROUP))
        self.assertNotIn(c, (a, b))

    def test_parents_move_lights(self):
        parent = self.add("Parent", location=(10, 0, 0))
        parent.scale = (2, 2, 2)
        light = self.add_light(location=(1, 1, 0))
        light.parent = parent
        table, row = self.row("Lamp")
        self.assertClose(table.position[row], (12, 2, 0))

    def test_collection_instances(self):
        collection = bpy.data.collections.new("Candles")
        self.add_light("Candle", location=(0, 0, 1), collection=collection)
        for i in range(3):
            instancer = self.add(f"Table {i}", location=(5 * i, 0, 0))
            instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        table = self.table()
        self.assertEqual(sorted(table.names), ["Table 0/Candle", "Table 1/Candle", "Table 2/Candle"])
        self.assertEqual(sorted(table.owners), ["Table 0", "Table 1", "Table 2"])
        self.assertClose(table.position[table.names.index("Table 2/Candle")], (10, 0, 1))

    def test_linked_libraries(self):
        light = self.add_light("Linked", location=(0, 0, 2), energy=7)
        light.data.chandelier.priority = 200
        self.add_instance(self.link_library(light), (3, 0, 0))
        table = self.table()
        self.assertEqual(len(table), 1)
        self.assertTrue(table.names[0].startswith("Here/Linked"), table.names)
        self.assertClose(table.position[0], (3, 0, 2))
        self.assertEqual((table.priority[0], table.power_w[0]), (200, 7))

    def test_what_is_not_rendered_does_not_count(self):
        self.add_light("Shown")
        self.add_light("Hidden").hide_render = True
        outer, inner = bpy.data.collections.new("Outer"), bpy.data.collections.new("Inner")
        self.scene.collection.children.link(outer)
        outer.children.link(inner)
        outer.hide_render = True
        self.add_light("Within", collection=inner)
        both = self.add_light("Both", collection=inner)
        self.scene.collection.objects.link(both)
        instancer = self.add("Instancer")
        instancer.instance_type, instancer.instance_collection, instancer.hide_render = "COLLECTION", inner, True
        self.assertEqual(sorted(self.table().names), ["Both", "Shown"])

    def test_emission_nodes_count(self):
        light = self.add_light("Nodes", energy=10, color=(1, 0.5, 1))
        light.data.use_nodes = True
        emission = scene_lights.emission_node(light.data)
        emission.inputs["Strength"].default_value = 3
        emission.inputs["Color"].default_value = (1, 1, 0, 1)
        table, row = self.row("Nodes")
        self.assertAlmostEqual(table.power_w[row], 30)
        self.assertClose(table.colour[row], (1, 0.5, 0))

    def test_two_thousand(self):
        for i in range(2000):
            self.add_light(f"L{i}", location=(i, 0, 0), energy=i + 1)
        table = self.table()
        self.assertEqual(len(table), 2000)
        self.assertEqual(sorted(table.position[:, 0].tolist()), list(range(2000)))
        for row in (0, 999, 1999):  # rows belong together
            number = int(table.names[row][1:])
            self.assertEqual((table.position[row, 0], table.power_w[row]), (number, number + 1))


class Kept(BlenderCase):
    """A reader that is told of updates says the same as one that reads all anew."""

    def setUp(self):
        super().setUp()
        self.reader = scene_lights.LightReader()
        bpy.app.handlers.depsgraph_update_post.append(self.note)
        self.addCleanup(bpy.app.handlers.depsgraph_update_post.remove, self.note)
        self.noted = []
        self.one, self.two = self.add_light("One", energy=1), self.add_light("Two", "SPOT", energy=2)
        bpy.context.view_layer.update()

    def note(self, scene, depsgraph):
        self.noted.append(self.reader.note(depsgraph))

    def assert_right(self, noted=True):
        self.noted.clear()
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        kept, anew = self.reader.read(depsgraph), scene_lights.read(depsgraph)
        self.assertEqual(any(self.noted), noted)
        for column in vars(anew):
            a, b = getattr(kept, column), getattr(anew, column)
            self.assertEqual(a if isinstance(a, list) else a.tolist(), b if isinstance(b, list) else b.tolist(), column)
        return kept

    def test_a_move_reads_places_only(self):
        before = self.assert_right(noted=False)
        self.two.location.x = 5
        after = self.assert_right()
        self.assertIs(after.intensity, before.intensity)
        self.assertEqual(after.position[after.names.index("Two"), 0], 5)

    def test_changes(self):
        self.assert_right(noted=False)
        self.one.data.energy = 50
        self.assert_right()
        self.two.data.type = "SUN"
        self.assert_right()
        self.one.data.use_nodes = True
        self.assert_right()
        scene_lights.emission_node(self.one.data).inputs["Strength"].default_value = 9
        self.assert_right()
        self.add_light("Three")
        self.assert_right()
        self.one.name = "Uno"
        self.assert_right()
        self.two.hide_render = True
        self.assert_right()
        bpy.data.objects.remove(self.one)
        self.assert_right()
        self.two.hide_set(True)
        self.assert_right()

    def test_nothing_happens(self):
        self.assert_right(noted=False)
        self.assert_right(noted=False)
