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

    def armature(self, name):
        """Two bones, one above the other, and one that stands aside."""
        arm = self.add(name, bpy.data.armatures.new(name))
        self.select(arm)
        bpy.ops.object.mode_set(mode="EDIT")
        for bone, place in (("Lower", (0, 0, 0)), ("Upper", (0, 0, 1)), ("Aside", (4, 0, 0))):
            made = arm.data.edit_bones.new(bone)
            made.head, made.tail = place, (place[0], 0, place[2] + 1)
        arm.data.edit_bones["Upper"].parent = arm.data.edit_bones["Lower"]
        bpy.ops.object.mode_set(mode="OBJECT")
        return arm

    def on_bone(self, thing, arm, bone):
        thing.parent, thing.parent_type, thing.parent_bone = arm, "BONE", bone

    def animated_path(self, name):
        """A curve along which its children go."""
        path = self.add(name, bpy.data.curves.new(name, "CURVE"))
        path.data.dimensions = "3D"
        path.data.splines.new("POLY").points.add(1)
        path.data.splines[0].points[1].co = (5, 0, 0, 1)
        self.key(path.data, "eval_time", 0, 100)
        path.data.use_path = True
        return path

    def instance(self, name):
        """The object that instances a collection with a light of this name."""
        collection = bpy.data.collections.new(name)
        self.lamp(name, collection=collection)
        self.place += 2
        instancer = self.add(f"{name}'s", location=(-5, self.place, 0))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        return instancer

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
        self.assertEqual({name.split("/")[-1] for name, flag in zip(table.names, table.flags) if flag & flags}, dynamic)
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

    def test_bones_are_sampled_where_their_armature_has_keyframes(self):
        keyed, led, target = self.armature("Keyed"), self.armature("Led"), self.add("Target")
        self.key(target)
        self.key(keyed.pose.bones["Lower"])
        self.lead(keyed.pose.bones["Upper"], "COPY_LOCATION", target)
        self.on_bone(self.light("On a bone"), keyed, "Lower")
        self.on_bone(self.light("On the next"), keyed, "Upper")
        self.on_bone(self.light("On one that stands"), keyed, "Aside")  # all bones have channels
        self.light("On the armature").parent = keyed
        level = self.armature("Level")
        self.key(level.pose.bones["Lower"], last=(0, 0, 0))
        self.on_bone(self.light("On a level one"), level, "Lower")
        self.lead(led.pose.bones["Lower"], "COPY_LOCATION", target)
        self.on_bone(self.light("On a led bone's child"), led, "Upper")
        self.on_bone(self.light("Beside it"), led, "Aside")
        chain = self.armature("Chain")
        self.lead(chain.pose.bones["Upper"], "IK", target, chain_count=2)
        self.on_bone(self.light("In a chain"), chain, "Lower")
        driven = self.armature("Driven")
        self.drive(driven.pose.bones["Lower"], "location", 0)
        self.on_bone(self.light("On a driven bone"), driven, "Upper")
        self.lead(self.light("Follows a bone"), "COPY_LOCATION", keyed, subtarget="Lower")
        self.lead(self.light("Follows the armature"), "COPY_LOCATION", keyed)
        self.assertEqual({name: text.split(",")[0] for name, text in self.found().items()}, {
            "On a led bone's child": "is moved by a constraint of Led", "In a chain": "is moved by a constraint of Chain",
            "On a driven bone": "is moved by a driver or an animated property of Driven",
            "Follows a bone": "is moved by a constraint"})
        bpy.data.objects.remove(bpy.data.objects["On a driven bone"])  # which the exporter leaves at another frame's place
        keyed.pose.bones["Upper"].constraints[0].mute = True
        self.assertEqual(self.moving(), {"On a bone", "On the next", "On one that stands", "On a level one"})

    def test_instancers_move_what_they_instance(self):
        target, arm = self.add("Target"), self.armature("Arm")
        self.key(target)
        self.key(arm.pose.bones["Lower"])
        self.lead(self.instance("Led"), "COPY_LOCATION", target)
        self.drive(self.instance("Driven"), "location", 0)
        carried = self.add("Carried")
        self.lead(carried, "COPY_LOCATION", target)
        self.instance("Child").parent = carried
        self.key(self.instance("Keyed"))
        self.on_bone(self.instance("On a bone"), arm, "Lower")
        self.instance("Still")
        self.assertEqual({name: text.split(",")[0] for name, text in self.found().items()}, {
            "Led": "is moved by a constraint of Led's", "Driven": "is moved by a driver or an animated property of Driven's",
            "Child": "is moved by a constraint of Carried"})
        self.assertEqual(self.moving(), {"Keyed", "On a bone"})

    def test_children_of_animated_paths(self):
        self.light("Rides").parent = self.animated_path("Path")
        follows = self.animated_path("Turning path")
        follows.data.use_path_follow = True
        self.light("Turns").parent = follows
        stands = self.animated_path("No path")
        stands.data.use_path = False
        self.light("Stands").parent = stands
        self.lead(self.light("Follows"), "COPY_LOCATION", bpy.data.objects["Rides"])
        self.assertEqual({name: text.split(",")[0] for name, text in self.found().items()}, {
            "Rides": "is moved by the animated path Path", "Turns": "is moved by the animated path Turning path",
            "Follows": "is moved by a constraint"})
        self.assertEqual(self.moving(), set())

    def test_what_is_animated_but_moves_nothing(self):
        blinks = self.light("Blinks")
        self.key(blinks, "hide_render", False, True)
        self.drive(self.light("Driven to blink"), "hide_render")
        self.key(self.light("Coloured"), "color", (0, 0, 0, 1), (1, 1, 1, 1))
        child = self.light("Its child")
        child.parent = blinks
        tagged = self.light("Tagged")
        self.key(tagged, "pass_index", 0, 3)
        self.lead(self.light("Follows"), "COPY_LOCATION", tagged)
        found = self.found()
        self.assertEqual(set(found), {"Blinks", "Driven to blink"})
        for text in found.values():
            self.assertIn("is shown and hidden by an animation, which is not exported", text)
        self.assertEqual(self.moving(), set())
        hidden = self.light("Hidden in the viewport")
        self.key(hidden, "hide_viewport", False, True)
        self.assertNotIn("Hidden in the viewport", self.found())

    def test_level_keyframes_of_a_place_are_written(self):
        light = self.light("Level")
        self.key(light, first=tuple(light.location), last=tuple(light.location))
        self.assertEqual(self.found(), {})
        self.assertEqual(self.moving(), {"Level"})

    def test_each_of_many_that_follow_each_other_is_asked_once(self):
        """Along all ways there are more than 2^100."""
        things = [self.add("Still"), self.add("Still too")]
        for number in range(200):
            things.append(self.add(f"Follower {number}"))
            for target in things[-3:-1]:
                self.lead(things[-1], "COPY_LOCATION", target)
        self.lead(self.light("Last"), "COPY_LOCATION", things[-1])
        self.assertEqual(self.found(), {})
        self.key(things[0])
        self.assertEqual(set(self.found()), {"Last"})
