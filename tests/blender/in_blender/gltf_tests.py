# SPDX-License-Identifier: Apache-2.0
"""Export, as the validator, our own check, and the baker see it."""

import json
import math
import os
import pathlib
import struct
import subprocess

import bpy
import numpy as np

import gltf_validator
from blender_case import SOURCE, BlenderCase, part

BIN = pathlib.Path(os.environ.get("CHANDELIER_BIN", SOURCE / "build" / "bin"))
WATTS, RANGE_M = 12.34567, 3.4567891  # no round number of a float


def float32(value):
    return float(np.float32(value))


class GltfCase(BlenderCase):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "scene.glb"
        bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 0, -3))
        floor = bpy.context.object
        floor.data.materials.append(bpy.data.materials.new("Floor"))

    def lamp(self, name="Lamp", kind="POINT", location=(0, 0, 0), **values):
        return self.add_light(name, kind, location, **{
            "energy": WATTS, "use_custom_distance": True, "cutoff_distance": RANGE_M, "color": (1, 0.5, 0.25), **values})

    def export(self):
        bpy.context.view_layer.update()
        check = part("export").export(bpy.context, str(self.path))
        self.assertEqual(check.errors, [])
        return check

    def gltf(self):
        return part("core.gltf_check").read_json(self.path)

    def lights(self):
        return {light["name"]: light for light in self.gltf()["extensions"]["KHR_lights_punctual"]["lights"]}

    def report(self):
        """What chandelier-inspect says of the baked pack."""
        if not (BIN / "chandelier-bake").exists():
            self.skipTest(f"no chandelier-bake in {BIN}")
        pack = self.folder / "scene.chandelier"
        done = subprocess.run([BIN / "chandelier-bake", self.path, "-o", pack, "--quiet"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(subprocess.run([BIN / "chandelier-inspect", pack, "--json"], capture_output=True, check=True).stdout)

    def baked(self):
        """Its lights, by name; more of a name in a list."""
        found = {}
        for light in self.report()["lights"]:
            found.setdefault(light["name"], []).append(light)
        return found

    def assert_valid(self):
        lacking = gltf_validator.lacking()
        if lacking:
            self.skipTest(lacking)
        self.assertEqual(gltf_validator.issues(self.path), [])

    def busy_scene(self):
        """Everything that places a light otherwise than by its own position."""
        self.lamp("Plain", location=(1, 2, 3))
        parent = self.add("Parent", location=(5, 0, 0))
        parent.scale, parent.rotation_euler = (2, 2, 2), (0, 0, math.radians(90))
        spot = self.lamp("Child", "SPOT", (0, 1, 1), spot_size=math.radians(70), spot_blend=0.3)
        spot.parent, spot.rotation_euler = parent, (math.radians(30), 0, 0)
        shared = self.lamp("Shared A", location=(-4, 0, 0))
        self.add("Shared B", shared.data, (-4, 2, 0)).scale = (3, 1, 1)
        self.lamp("Sun", "SUN", energy=2.5).rotation_euler = (0.3, 0.2, 0.1)
        collection = bpy.data.collections.new("Candles")
        collection.instance_offset = (0, 0, 0.5)
        self.lamp("Candle", location=(0, 0, 1), collection=collection)
        for i in range(3):
            instancer = self.add(f"Table {i}", location=(5 * i, -5, 0))
            instancer.scale = (1 + i, 1 + i, 1 + i)
            instancer.instance_type, instancer.instance_collection = "COLLECTION", collection


class Written(GltfCase):
    def test_intensity_range_and_extras(self):
        light = self.lamp(shadow_soft_size=0.25)
        settings = light.data.chandelier
        settings.priority, settings.dynamic, settings.cluster, settings.group = 200, True, False, "bar"
        light.data.use_shadow = False
        self.export()
        written = self.lights()["Lamp"]
        self.assertAlmostEqual(written["intensity"], 683 / (4 * math.pi) * light.data.energy, places=6)
        self.assertEqual(written["range"], light.data.cutoff_distance)
        self.assertClose(written["color"], (1, 0.5, 0.25))
        self.assertEqual(written["extras"]["chandelier"], {
            "power_w": light.data.energy, "range_m": light.data.cutoff_distance, "radius_m": light.data.shadow_soft_size, "priority": 200,
            "dynamic": True, "cluster": False, "shadow": False, "group": "bar"})

    def test_defaults_are_left_out(self):
        self.lamp(use_custom_distance=False, shadow_soft_size=0)
        self.export()
        written = self.lights()["Lamp"]
        self.assertNotIn("range", written)
        self.assertEqual(written["extras"]["chandelier"], {"power_w": float32(WATTS)})

    def test_a_sun_has_lux_and_no_range(self):
        self.lamp("Sun", "SUN", energy=2, angle=math.radians(3))
        self.export()
        self.assertEqual(self.lights()["Sun"]["intensity"], 1366)
        self.assertAlmostEqual(self.lights()["Sun"]["extras"]["chandelier"]["radius_m"], math.tan(math.radians(1.5)), places=7)
        self.assertNotIn("range", self.lights()["Sun"])

    def test_the_widest_sun_is_exported_and_baked(self):
        self.lamp("Sun", "SUN", energy=2, angle=math.pi)
        self.export()
        self.assertEqual(len(self.baked()["Sun"]), 1)

    def test_a_colour_above_one_and_nodes(self):
        self.lamp("Bright", color=(4, 2, 1), energy=10)
        nodes = self.lamp("Nodes", energy=10).data
        nodes.use_nodes = True
        part("scene_lights").emission_node(nodes).inputs["Strength"].default_value = 5
        self.export()
        self.assertEqual(self.lights()["Bright"]["color"], [1, 0.5, 0.25])
        self.assertAlmostEqual(self.lights()["Bright"]["intensity"], 4 * 543.5141, places=2)
        self.assertAlmostEqual(self.lights()["Nodes"]["intensity"], 5 * 543.5141, places=2)
        self.assertEqual(self.lights()["Nodes"]["extras"]["chandelier"]["power_w"], 50)
        self.assertClose(self.lights()["Nodes"]["color"], (1, 0.5, 0.25))

    def test_a_plain_export_keeps_its_units_and_no_property_group_leaks(self):
        light = self.lamp()
        light.data.chandelier.priority = 3
        light["artist"] = "me"
        self.scene.chandelier.d_init = 2
        self.scene.chandelier_overlay.links = not self.scene.chandelier_overlay.links
        known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
        (mode,) = {"convert_lighting_mode", "export_import_convert_lighting_mode"} & set(known)  # 3.4's name, and the later ones'
        bpy.ops.export_scene.gltf(filepath=str(self.path), export_lights=True, export_extras=True, **{mode: "RAW"})
        written = self.lights()["Lamp"]
        self.assertAlmostEqual(written["intensity"], WATTS, places=4)
        self.assertEqual(written["extras"]["chandelier"]["priority"], 3)
        (node,) = [node for node in self.gltf()["nodes"] if node["name"] == "Lamp"]
        self.assertEqual(node["extras"], {"artist": "me"})
        self.assertEqual(self.gltf()["scenes"][0].get("extras", {}), {})

    def test_the_current_frame_counts(self):
        light = self.lamp()
        for frame, height in ((0, 0.0), (20, 2.0)):
            light.location.z = height
            light.keyframe_insert("location", frame=frame)
        self.scene.frame_set(20)
        self.export()

    def test_the_validator_has_nothing_to_say(self):
        self.busy_scene()
        bpy.ops.object.camera_add(location=(0, -9, 3), rotation=(1.2, 0, 0))
        self.export()
        self.assert_valid()

    def test_a_failed_export_leaves_the_older_file(self):
        self.lamp()
        self.path.write_bytes(b"older")
        (self.folder / "scene.writing.glb").mkdir()  # where the exporter wants to write
        with self.assertRaises(RuntimeError):  # what Blender makes of a reported error
            bpy.ops.chandelier.export(filepath=str(self.path))
        self.assertEqual(self.path.read_bytes(), b"older")


    def test_a_failed_export_leaves_no_file_and_the_mode(self):
        self.lamp()
        bpy.context.view_layer.objects.active = bpy.data.objects["Plane"]
        bpy.ops.object.mode_set(mode="EDIT")
        self.path.mkdir()  # what no file can replace
        (self.folder / "scene.writing.glb").write_bytes(b"of an export that was interrupted")
        for path in (self.path, self.folder / "no" / "such" / "scene.glb"):
            with self.assertRaises(RuntimeError):
                bpy.ops.chandelier.export(filepath=str(path))
            self.assertEqual(bpy.context.object.mode, "EDIT")
            self.assertEqual([thing.name for thing in self.folder.iterdir()], ["scene.glb"])


class Checked(GltfCase):
    """What the check finds when someone has been at the file."""
    settings = {}  # of the light Here

    def check_after(self, change):
        here = self.lamp("Here", location=(1, 2, 3), shadow_soft_size=0)
        for name, value in self.settings.items():
            setattr(here.data if hasattr(here.data, name) else here.data.chandelier, name, value)
        self.lamp("Spot", "SPOT")
        self.export()
        gltf = self.gltf()
        change(gltf, {node["name"]: node for node in gltf["nodes"]}, gltf["extensions"]["KHR_lights_punctual"]["lights"])
        changed = self.folder / "changed.gltf"
        changed.write_text(json.dumps(gltf))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return part("core.gltf_check").check(changed, part("scene_lights").read(depsgraph), *part("shadows").meant(depsgraph))

    def assert_told(self, change, *says):
        (error,) = self.check_after(change).errors
        for what in says:
            self.assertIn(what, error)

    def test_nothing_changed(self):
        self.assertEqual(self.check_after(lambda *_: None), part("core.gltf_check").Check(lights=2))

    def test_a_missing_light(self):
        self.assert_told(lambda gltf, nodes, lights: nodes["Here"].pop("extensions"), "Here", "the file has no light")

    def test_a_moved_light(self):
        def move(gltf, nodes, lights):
            nodes["Here"]["translation"][0] += 0.1
        check = self.check_after(move)
        self.assertEqual(len(check.errors), 1)
        self.assertEqual(check.extra, ["Here"])

    def test_other_numbers(self):
        for change, says in (({"intensity": 7}, "intensity is 7 cd"), ({"range": 9}, "range is 9 m"),
                             ({"color": [1, 0.5, 0.3]}, "blue"), ({"extras": {}}, "power_w")):
            bpy.data.batch_remove([thing for thing in self.scene.objects if thing.type == "LIGHT"])
            self.assert_told(lambda gltf, nodes, lights: lights[0].update(change), says)

    def test_lost_settings(self):
        def lose(key):
            return lambda gltf, nodes, lights: lights[0]["extras"]["chandelier"].pop(key)
        for name, value, key, says in (
                ("priority", 7, "priority", "priority is 128 in the file, but should be 7"), ("group", "bar", "group", "has lost its group"),
                ("dynamic", True, "dynamic", "dynamic is false"), ("cluster", False, "cluster", "cluster is true"),
                ("use_shadow", False, "shadow", "shadow is true"), ("shadow_soft_size", 0.5, "radius_m", "radius is 0 m")):
            bpy.data.batch_remove([thing for thing in self.scene.objects if thing.type == "LIGHT"])
            self.settings = {name: value}
            self.assert_told(lose(key), "Here", says)

    def test_settings_nobody_meant(self):
        for extras, says in (({"priority": 7}, "priority is 7"), ({"group": "bar"}, "is in a group"), ({"dynamic": True}, "dynamic"),
                             ({"cluster": False}, "cluster is false"), ({"shadow": False}, "shadow is false"),
                             ({"radius_m": 3}, "radius is 3 m")):
            bpy.data.batch_remove([thing for thing in self.scene.objects if thing.type == "LIGHT"])
            self.assert_told(lambda gltf, nodes, lights: lights[0]["extras"]["chandelier"].update(extras), "Here", says)

    def test_another_cone(self):
        def widen(gltf, nodes, lights):
            lights[1]["spot"]["outerConeAngle"] = 1
        self.assert_told(widen, "Spot", "outerConeAngle is 1 rad in the file, but should be 0.3926991 rad")

    def test_a_turned_spot(self):
        def turn(gltf, nodes, lights):
            nodes["Spot"]["rotation"] = [0, 0, 0, 1]
        self.assert_told(turn, "Spot", "shines towards (0, 0, -1) in the file, but should shine towards (0, -1, 0)")

    def test_files_that_are_none(self):
        table = part("scene_lights").read(bpy.context.evaluated_depsgraph_get())
        for data in (b"", b"{", b"glTF" + struct.pack("<II", 2, 12)):
            self.path.write_bytes(data)
            with self.assertRaises(ValueError) as raised:
                part("core.gltf_check").check(self.path, table, {}, {})
            self.assertIn(str(self.path), str(raised.exception))


class Baked(GltfCase):
    def test_watts_and_ranges_survive_exactly(self):
        self.busy_scene()
        check = self.export()
        baked = self.baked()
        self.assertEqual(check.lights, sum(map(len, baked.values())))
        table = part("scene_lights").read(bpy.context.evaluated_depsgraph_get())
        for row, name in enumerate(table.names):
            lights = baked[name.split("/")[-1].split(" 2")[0]]
            meant = part("core.gltf_check").to_gltf(table.position)[row]
            light = min(lights, key=lambda light: np.linalg.norm(np.array(light["position_ws"]) - meant))
            if light["type"] != "directional":
                self.assertClose(light["position_ws"], meant, 1e-5)
                self.assertEqual((float32(light["range_m"]), light["range_source"]), (float(table.range_m[row]), "authored"), name)
            watts = light["intensity"] / 683 * (1 if light["type"] == "directional" else 4 * math.pi)
            self.assertEqual(float32(light["intensity"]), float(table.intensity[row]), name)
            self.assertEqual(float32(light["radius_m"]), float(table.radius_m[row]), name)
            self.assertAlmostEqual(watts, float(table.power_w[row]), delta=1e-6 * watts)
            forward = part("core.gltf_check").to_gltf(table.direction)[row]
            if light["type"] != "point":
                self.assertClose(light["direction_ws"], forward, 1e-5)
            if light["type"] == "spot":
                self.assertAlmostEqual(math.acos(light["outer_cone_cos"]), float(table.spot_outer_rad[row]), places=5)

    def test_settings_survive(self):
        data = self.lamp(use_shadow=False).data
        data.chandelier.priority, data.chandelier.dynamic, data.chandelier.cluster = 9, True, False
        for i in range(2):
            self.lamp(f"Of group {i}", location=(i, 2, 0)).data.chandelier.group = "bar"
        self.lamp("Other", location=(1, 0, 0))
        self.export()
        baked = self.baked()
        (lamp,), (other,) = baked["Lamp"], baked["Other"]
        kept = ("priority", "dynamic", "unclustered", "shadowless")
        self.assertEqual([lamp[name] for name in kept], [9, True, True, True])
        self.assertEqual([other[name] for name in kept], [128, False, False, False])
        groups = [baked[f"Of group {i}"][0]["group"] for i in range(2)]
        self.assertEqual(groups[0], groups[1])
        self.assertNotEqual(groups[0], other["group"])

    def test_a_linked_library(self):
        light = self.lamp("Linked", location=(0, 0, 2))
        light.data.chandelier.priority = 77
        self.add_instance(self.link_library(light), (3, 0, 0))
        self.export()
        ((linked,),) = self.baked().values()
        self.assertClose(linked["position_ws"], (3, 2, 0))
        self.assertEqual((linked["priority"], float32(linked["range_m"])), (77, float32(RANGE_M)))

    def test_a_library_override(self):
        """A linked light with another place, power and priority here."""
        light = self.lamp("Linked", location=(0, 0, 2))
        light.data.chandelier.priority = 77
        linked = self.link_library(light).objects["Linked"]
        self.scene.collection.objects.link(linked)
        override = linked.override_create(remap_local_usages=True)
        override.data = linked.data.override_create(remap_local_usages=True)
        override.location, override.data.energy, override.data.chandelier.priority = (1, 2, 3), 2 * WATTS, 9
        bpy.context.view_layer.update()
        table = part("scene_lights").read(bpy.context.evaluated_depsgraph_get())
        self.assertEqual((len(table), table.priority[0], table.power_w[0]), (1, 9, float32(2 * WATTS)))
        self.assertClose(table.position[0], (1, 2, 3))
        self.export()
        self.assertEqual([light["extras"]["chandelier"]["priority"] for light in self.lights().values()], [9])
        ((baked,),) = self.baked().values()
        self.assertClose(baked["position_ws"], (1, 3, -2))
        self.assertEqual((baked["priority"], float32(baked["range_m"])), (9, float32(RANGE_M)))

    def test_an_animation_leaves_the_frame_as_it_was(self):
        light = self.lamp("Moving")
        self.scene.frame_end = 20
        for frame in (1, 20):
            light.location.x = frame
            light.keyframe_insert("location", frame=frame)
        self.scene.frame_set(8, subframe=0.5)
        place = light.location.x
        self.export()
        self.assertEqual((self.scene.frame_current, self.scene.frame_subframe), (8, 0.5))
        self.assertEqual(light.location.x, place)
        ((baked,),) = self.baked().values()
        self.assertTrue(baked["dynamic"])

    def test_an_unkeyed_move_of_a_keyframed_light_is_named(self):
        light, other = self.lamp("Moving"), self.lamp("Still", location=(0, 5, 0))
        self.scene.frame_end = 20
        for frame in (1, 20):
            light.location.x = frame
            light.keyframe_insert("location", frame=frame)
        self.scene.frame_set(8)
        light.location.y = 3
        other.location.y = 7
        bpy.context.view_layer.update()
        check = part("export").export(bpy.context, str(self.path))
        self.assertEqual(check.errors, [
            "Moving: was moved without a keyframe, so its animation moved it back, and that place is exported"])
        self.assertEqual((light.location.y, other.location.y), (0, 7))
        self.assertEqual(self.export().errors, [])

    def test_what_is_not_rendered_is_not_exported(self):
        self.lamp("Shown")
        self.lamp("Hidden").hide_render = True
        soloed = self.lamp("Soloed away", location=(2, 0, 0))
        soloed.hide_set(True)
        check = self.export()
        self.assertEqual(check.extra, ["Soloed away"])
        self.assertEqual(sorted(self.baked()), ["Shown", "Soloed away"])
