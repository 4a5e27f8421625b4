# SPDX-License-Identifier: Apache-2.0
"""Lights that move here: which of them move in the pack too, and which are named, since they will not."""

import bpy

from blender_case import part
from gltf_tests import GltfCase


class Motion(GltfCase):
    def setUp(self):
        super().setUp()
        self.scene.frame_end = 20
        self.place = 0

    def light(self, name):
        self.place += 2
        return self.lamp(name, location=(0, self.place, 0))

    def key(self, thing, path="location", first=(0, 0, 0), last=(3, 0, 0)):
        for frame, value in ((1, first), (20, last)):
            setattr(thing, path, value)
            thing.keyframe_insert(path, frame=frame)

    def drive(self, thing, path, *index):
        driver = thing.driver_add(path, *index).driver
        driver.type, driver.expression = "SCRIPTED", "frame / 10"

    def lead(self, thing, kind, target, **values):
        constraint = thing.constraints.new(kind)
        constraint.target = target
        for name, value in values.items():
            setattr(constraint, name, value)
        return constraint

    def found(self):
        self.scene.frame_set(1)
        bpy.ops.chandelier.find_surprises()
        return {item.name: item.text for item in bpy.context.window_manager.chandelier.surprises if item.rule == "lost_motion"}

    def moving(self):
        """The names of the lights that are dynamic in the pack, as the preview has to know too."""
        self.export()
        dynamic = {name for name, lights in self.baked().items() if all(light["dynamic"] for light in lights)}
        table = part("scene_lights").read(bpy.context.evaluated_depsgraph_get())
        flags = part("core.light_table").DYNAMIC | part("core.light_table").MOVES
        self.assertEqual({name for name, flag in zip(table.names, table.flags) if flag & flags}, dynamic)
        return dynamic

    def test_keyframes_of_places_are_exported(self):
        self.key(self.light("Keyed"))
        parent = self.add("Parent")
        self.key(parent)
        self.light("Child").parent = parent
        strip = self.light("Strip")
        self.key(strip)
        action, strip.animation_data.action = strip.animation_data.action, None
        strip.animation_data.nla_tracks.new().strips.new("Moves", 1, action)
        self.light("Still")
        self.assertEqual(self.found(), {})
        self.assertEqual(self.moving(), {"Keyed", "Child", "Strip"})

    def test_what_is_lost_is_named(self):
        target, still = self.add("Target"), self.add("Still target")
        self.key(target)
        self.drive(self.light("Driven"), "location", 0)
        self.lead(self.light("Held"), "COPY_LOCATION", target)
        self.lead(self.light("Follower"), "COPY_LOCATION", bpy.data.objects["Held"])
        path = self.add("Path", bpy.data.curves.new("Path", "CURVE"))
        path.data.splines.new("POLY").points.add(1)
        path.data.splines[0].points[1].co = (5, 0, 0, 1)
        self.key(self.lead(self.light("On a path"), "FOLLOW_PATH", path, use_fixed_location=True), "offset_factor", 0, 1)
        parent = self.add("Parent")
        self.drive(parent, "location", 2)
        self.light("Child").parent = parent
        self.key(self.light("Flickers").data, "energy", 5, 50)
        self.drive(self.light("Driven power").data, "energy")
        self.lead(self.light("Looks at what stands"), "TRACK_TO", still)
        self.lead(self.light("Muted"), "COPY_LOCATION", target, mute=True)
        self.key(self.light("Level").data, "energy", 5, 5)
        found = self.found()
        moving = self.moving()
        self.assertEqual(moving, set() if bpy.app.version < (4, 2) else {"On a path"})
        self.assertEqual(set(found), {"Driven", "Held", "Follower", "On a path", "Child", "Flickers", "Driven power"} - moving)
        self.assertIn("is moved by a driver or an animated property, which", found["Driven"])
        self.assertIn("is moved by a constraint, which", found["Held"])
        self.assertIn("of Parent, which", found["Child"])
        self.assertIn("is changed by an animation of its light data, which", found["Flickers"])

    def test_who_says_so_is_not_told(self):
        light = self.light("Driven")
        self.drive(light, "location", 0)
        self.assertEqual(set(self.found()), {"Driven"})
        bpy.ops.chandelier.mark_dynamic(rule="lost_motion")
        self.assertEqual(self.found(), {})
        self.assertEqual(self.moving(), {"Driven"})
