# SPDX-License-Identifier: Apache-2.0
"""Bulk edit, the list of lights, and surprises with their remedies."""

import contextlib
import io
import math

import bpy

from blender_case import BlenderCase, part


class LightsCase(BlenderCase):
    def setUp(self):
        super().setUp()
        self.one = self.add_light("One", energy=10)
        self.two = self.add_light("Two", "SPOT", energy=20)
        self.three = self.add_light("Three", energy=30)

    def energies(self):
        return [bpy.data.lights[name].energy for name in ("One", "Two", "Three")]

    def library(self):
        """An object of this scene whose light another file owns."""
        path = self.leave_as_library()  # first: it makes bpy.data anew
        with bpy.data.libraries.load(path, link=True) as (_, target):
            target.lights = ["One"]
        return self.add("Local", target.lights[0])


class Edit(LightsCase):
    def test_only_what_is_ticked_on_what_is_selected(self):
        self.select(self.one, self.two)
        bpy.ops.chandelier.edit_lights(use_power=True, factor=3, use_range=True, range=7, use_priority=True, priority=250, group="not")
        self.assertEqual(self.energies(), [30, 60, 30])
        self.assertEqual([light.data.cutoff_distance == 7 and light.data.use_custom_distance
                          for light in (self.one, self.two, self.three)], [True, True, False])
        self.assertEqual([light.data.chandelier.priority for light in (self.one, self.two, self.three)], [250, 250, 128])
        self.assertEqual(self.one.data.chandelier.group, "")

    def test_the_other_fields(self):
        self.select(self.one)
        bpy.ops.chandelier.edit_lights(
            use_power=True, power_by="WATTS", power=5, use_temperature=True, temperature=2000, use_radius=True, radius=0.3, use_shadow=True,
            shadow=False, use_dynamic=True, dynamic=True, use_cluster=True, cluster=False, use_group=True, group="bar")
        data, settings = self.one.data, self.one.data.chandelier
        self.assertEqual((data.energy, round(data.shadow_soft_size, 5), data.use_shadow), (5, 0.3, False))
        self.assertClose(data.color, part("core.photometry").colour_of_temperature(2000))
        self.assertEqual((settings.dynamic, settings.cluster, settings.group), (True, False, "bar"))
        bpy.ops.chandelier.edit_lights(use_range=True, range=0)
        self.assertFalse(data.use_custom_distance)

    def test_shadow_is_on_again_wherever_it_was_off(self):
        casts_shadow = part("scene_lights").casts_shadow
        self.one.data.use_shadow = False
        if hasattr(self.two.data.cycles, "cast_shadow"):  # from some version on there is one switch for both
            self.two.data.cycles.cast_shadow = False
        self.select(self.one, self.two)
        for shadow in (True, False):
            bpy.ops.chandelier.edit_lights(use_shadow=True, shadow=shadow)
            self.assertEqual([casts_shadow(light.data) for light in (self.one, self.two, self.three)], [shadow, shadow, True])

    def test_suns_have_no_radius_to_set(self):
        sun = self.add_light("Sun", "SUN", angle=0.1)
        before = sun.data.shadow_soft_size, sun.data.angle
        self.select(self.one, sun)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            bpy.ops.chandelier.edit_lights(use_radius=True, radius=0.3)
        self.assertIn("1 sun has an angle instead of a radius", said.getvalue())
        self.assertEqual((sun.data.shadow_soft_size, sun.data.angle), before)
        self.assertAlmostEqual(self.one.data.shadow_soft_size, 0.3, places=6)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            bpy.ops.chandelier.edit_lights(use_priority=True, priority=3)
        self.assertNotIn("sun", said.getvalue())

    def test_shared_data_is_edited_once(self):
        self.three.data = self.one.data
        self.select(self.one, self.three)
        bpy.ops.chandelier.edit_lights(use_power=True, factor=2)
        self.assertEqual(self.one.data.energy, 20)

    def test_linked_data_stays(self):
        light = self.library()
        self.select(light)
        bpy.ops.chandelier.edit_lights(use_power=True, factor=2)
        self.assertEqual(light.data.energy, 10)

    def test_undo(self):
        self.select(self.one)
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.chandelier.edit_lights("EXEC_DEFAULT", True, use_power=True, factor=2, use_priority=True, priority=1)
        self.assertEqual(self.energies(), [20, 20, 30])
        bpy.ops.ed.undo()
        self.assertEqual(self.energies(), [10, 20, 30])
        self.assertEqual(bpy.data.lights["One"].chandelier.priority, 128)

    def test_strength_of_one_and_of_the_selected(self):
        bpy.ops.chandelier.strength(light="Two", factor=2)
        self.assertEqual(self.energies(), [10, 40, 30])
        self.select(self.one, self.three)
        bpy.ops.chandelier.strength(factor=0.5)
        self.assertEqual(self.energies(), [5, 40, 15])


    def test_strength_of_a_light_that_is_no_more(self):
        self.assertEqual(bpy.ops.chandelier.strength(light="Gone", factor=2), {"CANCELLED"})


class List(LightsCase):
    def hidden(self):
        return [light.hide_get() for light in (self.one, self.two, self.three)]

    def test_a_click_selects(self):
        self.select(self.one, self.two)
        self.scene.chandelier.active_light = list(self.scene.objects).index(self.three)
        self.assertEqual(bpy.context.selected_objects, [self.three])
        self.scene.chandelier.active_light = 99
        self.assertEqual(bpy.context.selected_objects, [self.three])

    def test_solo_and_back(self):
        self.three.hide_set(True)  # by the artist, who shall find it so again
        bpy.ops.chandelier.solo(light="One")
        self.assertEqual(self.hidden(), [False, True, True])
        self.assertTrue(part("light_list").is_soloed(bpy.context, self.one))
        bpy.ops.chandelier.solo(light="Two")
        self.assertEqual(self.hidden(), [True, False, True])
        bpy.ops.chandelier.solo(light="Two")
        self.assertEqual(self.hidden(), [False, False, True])
        self.assertFalse(part("light_list").is_soloed(bpy.context, self.one))

    def test_solo_of_the_selected(self):
        self.select(self.one, self.two)
        bpy.ops.chandelier.solo()
        self.assertEqual(self.hidden(), [False, False, True])

    def test_solo_survives_saving(self):
        bpy.ops.chandelier.solo(light="One")
        path = str(self.folder / "solo.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        bpy.ops.chandelier.solo(light="One")
        self.assertFalse(any(bpy.data.objects[name].hide_get() for name in ("One", "Two", "Three")))

    def test_solo_is_of_a_view_layer(self):
        other = self.scene.view_layers.new("Other")
        bpy.ops.chandelier.solo(light="One")
        self.assertEqual([light.hide_get(view_layer=other) for light in (self.one, self.two, self.three)], [False] * 3)
        with bpy.context.temp_override(view_layer=other):
            self.assertFalse(part("light_list").is_soloed(bpy.context, self.one))
            bpy.ops.chandelier.solo(light="Two")
        bpy.ops.chandelier.solo(light="One")
        self.assertEqual(self.hidden(), [False, False, False])
        self.assertEqual([light.hide_get(view_layer=other) for light in (self.one, self.two, self.three)], [True, False, True])

    def test_a_light_that_is_renamed_meanwhile_comes_back(self):
        bpy.ops.chandelier.solo(light="One")
        self.two.name = "Second"
        bpy.ops.chandelier.solo(light="One")
        self.assertEqual(self.hidden(), [False, False, False])


class Linked(LightsCase):
    """Lights of another file with the same names as this one's."""

    def setUp(self):
        super().setUp()
        path = str(self.folder / "library.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.read_homefile(use_empty=True)
        self.scene = bpy.context.scene
        self.own = self.add_light("One", energy=1000)
        with bpy.data.libraries.load(path, link=True) as (_, target):
            target.objects = ["One", "Two"]
        self.linked = target.objects
        for light in self.linked:
            self.scene.collection.objects.link(light)
        bpy.context.view_layer.update()

    def test_solo_ends_after_saving(self):
        bpy.ops.chandelier.solo(light="One")
        self.assertEqual([light.hide_get() for light in (self.own, *self.linked)], [False, True, True])
        self.assertEqual(part("scene_lights").read(bpy.context.evaluated_depsgraph_get()).names, ["One"])
        path = str(self.folder / "solo.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        bpy.ops.chandelier.find_surprises()
        self.assertNotIn("hidden", {item.rule for item in bpy.context.window_manager.chandelier.surprises})
        bpy.ops.chandelier.solo(light="One")
        self.assertFalse(any(light.hide_get() for light in bpy.context.view_layer.objects))
        self.assertEqual(len(bpy.context.scene.chandelier.hidden_by_solo), 0)

    def test_buttons_mean_the_light_that_they_stand_beside(self):
        linked = self.linked[0]
        self.assertEqual((linked.name, self.own.name), ("One", "One"))
        bpy.ops.chandelier.solo(light=linked.name_full)
        self.assertEqual([light.hide_get() for light in (self.own, *self.linked)], [True, False, True])
        bpy.ops.chandelier.solo(light=linked.name_full)
        bpy.ops.chandelier.strength(light=self.own.name_full, factor=2)
        self.assertEqual((self.own.data.energy, linked.data.energy), (2000, 10))
        self.assertEqual(bpy.ops.chandelier.strength(light=linked.name_full), {"CANCELLED"})
        self.assertEqual(self.own.data.energy, 2000)

    def test_surprises_name_the_file(self):
        self.own.data.energy = 33  # the linked one has 10 W, as Blender makes lights
        bpy.ops.chandelier.find_surprises()
        named = {item.name for item in bpy.context.window_manager.chandelier.surprises if item.rule == "default_power"}
        self.assertEqual(named, {"One [library.blend]"})
        bpy.ops.chandelier.select_surprised(rule="default_power")
        self.assertEqual(bpy.context.selected_objects, [self.linked[0]])

    def test_a_converted_light_is_this_files(self):
        self.own.data.type = "AREA"
        bpy.ops.chandelier.find_surprises()
        radius = self.linked[0].data.shadow_soft_size
        bpy.ops.chandelier.convert_area(rule="area", kind="POINT")
        self.assertEqual(self.own.data.type, "POINT")
        self.assertAlmostEqual(self.own.data.shadow_soft_size, 0.125)
        self.assertEqual(self.linked[0].data.shadow_soft_size, radius)


class Surprises(BlenderCase):
    def good(self, name="Good", **values):
        return self.add_light(name, **{"energy": 25, "use_custom_distance": True, "cutoff_distance": 5, **values})

    def found(self):
        bpy.context.view_layer.update()
        bpy.ops.chandelier.find_surprises()
        return sorted((item.rule, item.name) for item in bpy.context.window_manager.chandelier.surprises)

    def box(self, size, location=(0, 0, 0)):
        bpy.ops.mesh.primitive_cube_add(size=size, location=location)
        return bpy.context.object

    def test_none(self):
        self.good()
        self.assertEqual(self.found(), [])
        self.assertTrue(bpy.context.window_manager.chandelier.has_looked)

    def test_each_is_found_by_name(self):
        self.good("Area", kind="AREA")
        self.good("No range", use_custom_distance=False)
        self.good("Default", energy=10)
        self.good("Hidden").hide_set(True)
        self.good("Scaled").scale = (2, 1, 1)
        shared = self.good("Shared")
        self.add("Shares", shared.data)
        nodes = self.good("Nodes").data
        nodes.use_nodes = True
        falloff = nodes.node_tree.nodes.new("ShaderNodeLightFalloff")
        nodes.node_tree.links.new(falloff.outputs[0], part("scene_lights").emission_node(nodes).inputs["Strength"])
        self.assertEqual(self.found(), sorted([
            ("area", "Area"), ("no_range", "No range"), ("default_power", "Default"), ("hidden", "Hidden"),
            ("scaled", "Scaled"), ("shared", "Shared"), ("shared", "Shares"), ("nodes", "Nodes")]))

    def test_a_scene_in_centimetres(self):
        self.good()
        self.scene.unit_settings.scale_length = 0.01
        self.assertEqual(self.found(), [("unit_scale", self.scene.name)])

    def test_scaled_and_sheared_parents(self):
        parent = self.add("Parent")
        parent.scale = (3, 1, 1)
        light = self.good(location=(1, 1, 1))
        light.parent = parent
        light.rotation_euler = (0, 0, math.radians(30))
        self.assertEqual(self.found(), [("scaled", "Good")])
        place = light.matrix_world.translation.copy()
        bpy.ops.chandelier.unscale_lights(rule="scaled")
        self.assertEqual(self.found(), [])
        self.assertClose(light.matrix_world.translation, place)
        self.assertClose(light.matrix_world.to_scale(), (1, 1, 1))

    def test_a_uniformly_scaled_parent_is_kept(self):
        parent = self.add("Parent")
        parent.scale = (2, 2, 2)
        light = self.good(location=(1, 0, 0))
        light.parent = parent
        bpy.context.view_layer.update()
        self.select(light)
        bpy.ops.chandelier.unscale_lights()
        self.assertIs(light.parent, parent)
        self.assertClose(light.matrix_world.translation, (2, 0, 0))
        self.assertClose(light.matrix_world.to_scale(), (1, 1, 1))

    def test_inside_a_lamp_but_not_in_a_room(self):
        self.box(0.2, (5, 0, 0)).name = "Bulb"
        self.box(6)  # a room, modelled from outside
        self.good("In bulb", location=(5, 0, 0.02))
        self.good("In room", location=(0.3, 0.2, 0.1))
        self.assertEqual(self.found(), [("inside", "In bulb")])
        text = bpy.context.window_manager.chandelier.surprises[0].text
        self.assertIn("Bulb", text)

    def test_a_bulb_that_throws_no_shadow_is_fine(self):
        bulb, shade = self.box(0.2), self.box(0.3)
        bulb.name, shade.name = "Bulb", "Shade"
        self.good("In both")
        self.assertEqual(self.found(), [("inside", "In both")])
        self.assertIn("is inside Bulb and Shade", bpy.context.window_manager.chandelier.surprises[0].text)
        bulb.visible_shadow = False
        self.found()
        self.assertIn("is inside Shade,", bpy.context.window_manager.chandelier.surprises[0].text)
        shade.visible_shadow = False
        self.assertEqual(self.found(), [])

    def test_a_remedy_lets_the_light_out(self):
        bulb, shade, table = self.box(0.2), self.box(0.3), self.box(0.3, (9, 0, 0))
        self.good("In both")
        self.found()
        self.assertEqual(bpy.ops.chandelier.let_light_out(rule="inside"), {"FINISHED"})
        self.assertEqual([thing.visible_shadow for thing in (bulb, shade, table)], [False, False, True])
        self.assertEqual(self.found(), [])
        self.assertEqual(bpy.ops.chandelier.let_light_out(rule="inside"), {"CANCELLED"})

    def test_materials_that_light_passes(self):
        bulb = self.box(0.2)
        self.good("In bulb")
        material = bpy.data.materials.new("Glass")
        material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        transmission = shader.inputs["Transmission" if "Transmission" in shader.inputs else "Transmission Weight"]
        bulb.data.materials.append(material)
        for value, metallic, expected in ((0.4, 0, 1), (0.6, 0, 0), (0.6, 0.5, 1)):
            transmission.default_value, shader.inputs["Metallic"].default_value = value, metallic
            self.assertEqual(len(self.found()), expected, value)
        if hasattr(material, "shadow_method"):
            material.shadow_method = "NONE"
            self.assertEqual(self.found(), [])
            bulb.data.materials.append(None)
            for face in bulb.data.polygons:
                face.material_index = 1  # of which nothing is known
            self.assertEqual(len(self.found()), 1)

    def test_a_bulb_in_an_instance_without_shadow(self):
        collection = bpy.data.collections.new("Bulbs")
        bulb = self.box(0.2)
        self.scene.collection.objects.unlink(bulb)
        collection.objects.link(bulb)
        instancer = self.add_instance(collection, (3, 0, 0))
        self.good("In", location=(3, 0.01, 0))
        self.assertEqual(self.found(), [("inside", "In")])
        instancer.visible_shadow = False
        self.assertEqual(self.found(), [])

    def test_a_bulb_of_another_file_keeps_its_shadow(self):
        library = self.link_library(self.box(0.2))
        self.scene.collection.children.link(library)
        self.good("In")
        self.found()
        with contextlib.redirect_stdout(io.StringIO()) as said:
            self.assertEqual(bpy.ops.chandelier.let_light_out(rule="inside"), {"CANCELLED"})
        self.assertIn("belongs to another file and keeps its shadow", said.getvalue())
        self.assertEqual(self.found(), [("inside", "In")])

    def test_inside_a_large_single_sided_mesh(self):
        room = self.box(6)
        material = bpy.data.materials.new("Wall")
        material.use_backface_culling = True
        room.data.materials.append(material)
        self.good()
        self.assertEqual(self.found(), [("inside", "Good")])
        room.data.flip_normals()
        self.assertEqual(self.found(), [])

    def test_inside_an_instance_that_is_turned_and_scaled(self):
        collection = bpy.data.collections.new("Bulbs")
        bulb = self.box(2)
        self.scene.collection.objects.unlink(bulb)
        collection.objects.link(bulb)
        instancer = self.add("Instancer", location=(4, 0, 0))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        instancer.scale, instancer.rotation_euler = (0.1, 0.1, -0.1), (0.5, 0.6, 0.7)
        self.good("In", location=(4, 0.02, 0))
        self.good("Beside", location=(4.2, 0, 0))
        self.assertEqual(self.found(), [("inside", "In")])

    def test_area_lights_become_spots_or_points_of_the_same_power(self):
        for kind in ("SPOT", "POINT"):
            light = self.good("Area", kind="AREA", energy=70, size=2, shape="SQUARE")
            light.data.chandelier.priority = 5
            self.found()
            bpy.ops.chandelier.convert_area(rule="area", kind=kind)
            data = light.data
            self.assertEqual((data.type, data.energy, data.shadow_soft_size, data.chandelier.priority), (kind, 70, 1, 5))
            self.assertEqual(self.found(), [])
            bpy.data.objects.remove(light)

    def test_ranges_are_set_by_illuminance(self):
        light = self.good(use_custom_distance=False, energy=100)
        self.found()
        bpy.ops.chandelier.set_range(rule="no_range", illuminance=2)
        self.assertAlmostEqual(light.data.cutoff_distance, math.sqrt(5435.14 / 2), places=3)
        self.assertEqual(self.found(), [])

    def test_single_users(self):
        first = self.good()
        others = [self.add(f"Other {i}", first.data) for i in range(3)]
        self.assertEqual(len(self.found()), 4)
        bpy.ops.chandelier.make_single_user(rule="shared")
        self.assertEqual(len({light.data for light in (first, *others)}), 4)
        self.assertEqual(self.found(), [])

    def test_select(self):
        self.good()
        bad = self.good("Bad", energy=1000)
        self.found()
        bpy.ops.chandelier.select_surprised(rule="default_power")
        self.assertEqual(bpy.context.selected_objects, [bad])

    def test_a_light_in_an_instanced_collection(self):
        collection = bpy.data.collections.new("Lamps")
        self.add_light("Inner", collection=collection, energy=25)
        instancer = self.add("Instancer")
        instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        self.assertEqual(self.found(), [("no_range", "Inner")])

    def test_another_file_has_its_own(self):
        self.good(energy=1000)
        self.assertEqual(len(self.found()), 1)
        bpy.ops.wm.read_homefile(use_empty=True)
        self.assertEqual(len(bpy.context.window_manager.chandelier.surprises), 0)
        self.assertFalse(bpy.context.window_manager.chandelier.has_looked)
