# SPDX-License-Identifier: Apache-2.0
"""Bake, Play and Bake on Save, without a display."""

import json
import os
import pathlib
import random
import stat
import subprocess
import time

import addon_utils
import bpy

from blender_case import ADDON, SOURCE, BlenderCase, part

BIN = pathlib.Path(os.environ.get("CHANDELIER_BIN", SOURCE / "build" / "bin"))


class HandoverCase(BlenderCase):
    def setUp(self):
        super().setUp()
        if not (BIN / "chandelier-bake").exists():
            self.skipTest(f"no chandelier-bake in {BIN}")
        self.module = part("handover")
        self.handover = self.module.handover
        self.handover.__init__()
        self.use_tools(BIN)
        self.addCleanup(self.use_tools, "")
        bpy.ops.mesh.primitive_plane_add(size=9)
        self.lamp = self.add_light("Lamp", location=(0, 0, 2), energy=33, use_custom_distance=True, cutoff_distance=5)
        self.blend = self.folder / "hall.blend"
        self.pack = self.folder / "hall.chandelier"
        bpy.ops.wm.save_as_mainfile(filepath=str(self.blend))

    def use_tools(self, folder):
        bpy.context.preferences.addons[ADDON].preferences.tools_folder = str(folder)

    def refused(self, name, says):
        with self.assertRaises(RuntimeError) as raised:
            getattr(bpy.ops.chandelier, name)()
        self.assertIn(says, str(raised.exception))
        self.assertIn(says, self.handover.error)
        self.assertNotIn("\n", self.handover.error)


class Bake(HandoverCase):
    def test_a_saved_scene(self):
        self.assertEqual(bpy.ops.chandelier.bake(), {"FINISHED"})
        self.assertTrue(self.pack.exists())
        self.assertEqual((self.handover.error, self.handover.done, self.handover.status), ("", "Baked", ""))
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()),
                         ["hall.blend", "hall.chandelier", "hall.chandelier.glb"])

    def test_a_path_of_its_own(self):
        self.scene.chandelier.pack_path = "//packs.chandelier"
        bpy.ops.chandelier.bake()
        self.assertTrue((self.folder / "packs.chandelier").exists())

    def test_a_folder_that_cannot_be_written(self):
        bpy.ops.chandelier.bake()
        before = {path.name: path.read_bytes() for path in self.folder.iterdir()}
        places = [("//hall.blend/packs.chandelier", "Not a directory"), ("//none/packs.chandelier", "No such file or directory")]
        if pathlib.Path("/sys/kernel").is_dir():  # whose modes bind root too
            places.append(("/sys/kernel/packs.chandelier", "Permission denied"))
        for path, says in places:
            with self.subTest(path):
                self.scene.chandelier.pack_path = path
                self.refused("bake", says)
                self.assertEqual(self.handover.error, f"{bpy.path.abspath(path)}.glb: cannot be written ({says})")
                self.assertEqual((self.handover.bake, self.handover.done), (None, ""))
                self.assertEqual({path.name: path.read_bytes() for path in self.folder.iterdir()}, before)
        self.scene.chandelier.pack_path = ""
        self.assertEqual(bpy.ops.chandelier.bake(), {"FINISHED"})
        self.assertEqual(self.handover.error, "")

    def test_an_unsaved_scene_goes_to_blenders_temporary_folder(self):
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.mesh.primitive_plane_add()
        bpy.ops.chandelier.bake()
        self.assertTrue((pathlib.Path(bpy.app.tempdir) / "untitled.chandelier").exists())

    def test_errors_are_one_line_and_the_older_pack_stays(self):
        bpy.ops.chandelier.bake()
        before = self.pack.read_bytes()
        self.lamp.data.chandelier.priority = 1
        self.pack.unlink()
        self.pack.mkdir()  # what no baker can replace
        self.refused("bake", "hall.chandelier: the output is a folder")
        self.pack.rmdir()
        bpy.ops.chandelier.bake()
        self.assertNotEqual(self.pack.read_bytes(), before)

    def test_without_the_program(self):
        self.use_tools(self.folder)
        path = os.environ["PATH"]
        os.environ["PATH"] = str(self.folder)
        try:
            self.refused("bake", "chandelier-bake: is neither in PATH nor in")
        finally:
            os.environ["PATH"] = path

    def test_warnings_of_the_baker_and_surprises_are_kept(self):
        self.add_light("Area", "AREA")
        self.lamp.data.energy = 10
        for i in range(2):
            self.add_light(f"Same {i}", location=(i, 0, 1), energy=10)
        self.lamp.data.use_custom_distance = False
        bpy.ops.chandelier.bake()
        self.assertTrue(any("was their strength ever set" in note for note in self.handover.notes), self.handover.notes)
        found = {(item.rule, item.name) for item in bpy.context.window_manager.chandelier.surprises}
        self.assertIn(("area", "Area"), found)

    def test_edit_mode_is_kept(self):
        bpy.context.view_layer.objects.active = bpy.data.objects["Plane"]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.chandelier.bake()
        self.assertEqual(bpy.context.object.mode, "EDIT")

    def test_cancel(self):
        slow = self.folder / "slow"
        slow.mkdir()
        program = slow / "chandelier-bake"
        program.write_text("#!/bin/sh\nexec sleep 60\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.use_tools(slow)
        self.assertFalse(bpy.ops.chandelier.cancel.poll())
        self.assertTrue(self.handover.start(bpy.context))
        self.assertTrue(self.handover.poll())
        self.assertEqual(self.handover.status, "Baking")
        bpy.ops.chandelier.cancel()
        self.assertFalse(self.handover.poll())
        self.assertEqual(self.handover.error, "chandelier-bake: cancelled")


class SwitchedOff(HandoverCase):
    def test_nothing_runs_on_and_the_status_bar_is_blenders_again(self):
        from bl_ui.space_statusbar import STATUSBAR_HT_header
        own = STATUSBAR_HT_header.draw
        program = self.folder / "chandelier-bake"
        program.write_text("#!/bin/sh\nexec sleep 60\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        (self.folder / "chandelier-play").symlink_to(program)
        self.use_tools(self.folder)
        self.handover.play([])
        self.assertTrue(self.handover.start(bpy.context))
        self.module.show_status()
        self.assertIsNot(STATUSBAR_HT_header.draw, own)
        processes = [self.handover.bake.process, self.handover.player.process]
        self.addCleanup(addon_utils.enable, ADDON, default_set=True)
        addon_utils.disable(ADDON, default_set=True)
        self.assertNotIn(None, [process.poll() for process in processes])
        self.assertIs(STATUSBAR_HT_header.draw, own)


class OnSave(HandoverCase):
    def save(self):
        bpy.ops.wm.save_mainfile()

    def test_only_where_it_is_wanted(self):
        self.save()
        self.assertFalse(self.pack.exists())
        self.scene.chandelier.bake_on_save = True
        self.save()
        self.assertTrue(self.pack.exists())
        first = self.pack.read_bytes()
        self.lamp.location.z = 3
        self.save()
        self.assertNotEqual(self.pack.read_bytes(), first)

    def test_a_failure_does_not_keep_from_saving(self):
        self.scene.chandelier.bake_on_save = True
        self.pack.mkdir()
        self.save()
        self.assertIn("the output is a folder", self.handover.error)
        bpy.ops.wm.open_mainfile(filepath=str(self.blend))
        self.assertTrue(bpy.context.scene.chandelier.bake_on_save)


class Play(HandoverCase):
    def setUp(self):
        super().setUp()
        if not (BIN / "chandelier-play").exists():
            self.skipTest(f"no chandelier-play in {BIN}")
        display = os.environ.pop("DISPLAY", None)
        if display is not None:
            self.addCleanup(os.environ.__setitem__, "DISPLAY", display)

    def ended(self):
        self.handover.player.process.wait(60)
        self.handover.poll()

    def test_the_players_error_is_shown(self):
        bpy.ops.chandelier.bake()
        self.assertEqual(bpy.ops.chandelier.play(), {"FINISHED"})
        self.ended()
        self.assertIsNone(self.handover.player)
        self.assertIn("chandelier-play: no display", self.handover.error)

    def test_without_a_pack_that_can_be_baked(self):
        self.scene.chandelier.pack_path = "//no/such/folder.chandelier"
        self.refused("play", "folder.chandelier.glb: cannot be written (No such file or directory)")

    def test_without_a_pack_it_bakes_first(self):
        bpy.ops.chandelier.play()
        self.assertTrue(self.pack.exists())
        self.ended()
        self.assertIn("no display", self.handover.error)

    def bake_and_play(self, says=""):
        """With a player that writes down how it was started, and goes on until it is ended."""
        programs = self.folder / "programs"
        programs.mkdir()
        (programs / "chandelier-bake").symlink_to(BIN / "chandelier-bake")
        self.told = self.folder / "told"
        program = programs / "chandelier-play"
        program.write_text(f'#!/bin/sh\necho "$@" >> "{self.told}"\n{says}\nexec sleep 60\n')
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.use_tools(programs)
        self.addCleanup(self.handover.close_player)
        bpy.ops.chandelier.bake(play=True)

    def starts(self, count):
        """The commands of so many players, the last of which runs."""
        for _ in range(500):
            if self.told.exists() and len(self.told.read_text().splitlines()) >= count:
                break
            time.sleep(0.01)
        self.assertTrue(self.handover.player.is_running())
        lines = self.told.read_text().splitlines()
        self.assertEqual(len(lines), count)
        return lines

    def test_an_open_player_starts_again_with_the_settings_and_the_pack_of_now(self):
        self.bake_and_play()
        self.starts(1)
        self.scene.chandelier.face_size = 64
        self.scene.chandelier.pack_path = "//other.chandelier"
        bpy.ops.chandelier.bake()
        self.assertRegex(self.starts(2)[-1], r"/other\.chandelier .*--face-size 64\b")

    def test_an_open_player_of_the_same_command_is_left_alone(self):
        """As it shows by itself what takes its pack's place; Play starts it all the same."""
        self.bake_and_play()
        self.starts(1)
        player, pack = self.handover.player, self.pack.read_bytes()
        self.lamp.location.z = 3
        bpy.ops.chandelier.bake()
        bpy.ops.chandelier.bake(play=True)
        self.assertNotEqual(self.pack.read_bytes(), pack)
        self.assertIs(self.handover.player, player)
        self.starts(1)
        bpy.ops.chandelier.play()
        self.assertIsNot(self.handover.player, player)
        self.assertFalse(player.is_running())
        self.starts(2)

    def test_a_player_that_has_just_died_is_started_again(self):
        self.bake_and_play()
        self.starts(1)
        self.handover.player.process.kill()
        self.handover.player.process.wait()
        bpy.ops.chandelier.bake()
        self.starts(2)

    def test_the_players_warnings_are_shown_as_they_come_and_once(self):
        again = self.folder / "again"
        warns = "echo 'chandelier-play: warning: the older one stays' >&2\n"
        self.bake_and_play(f'{warns}{warns}while [ ! -e "{again}" ]; do sleep 0.01; done\n{warns}')
        self.starts(1)
        notes = self.noted()
        self.assertEqual(notes.count("the older one stays"), 1, notes)
        self.assertTrue(self.handover.player.is_running())
        self.handover.notes = []  # as the next bake leaves them
        self.handover.poll()
        self.assertEqual(self.handover.notes, [])
        again.touch()
        self.assertEqual(self.noted(), ["the older one stays"])

    def noted(self):
        """What the panel shows when the player has warned."""
        for _ in range(500):
            self.handover.poll()
            if "the older one stays" in self.handover.notes:
                break
            time.sleep(0.01)
        return self.handover.notes

    def test_it_takes_the_maps_that_the_preview_says(self):
        settings, render = self.scene.chandelier, self.scene.render
        settings.d_init, settings.distance_scaling, settings.z_far, settings.face_size = 0.7, "grow", 17.3, 128
        render.resolution_x, render.resolution_y = 320, 180
        bpy.ops.object.camera_add(location=(0, -9, 2), rotation=(1.5, 0, 0))
        bpy.context.object.name = "Eye"
        self.scene.camera = bpy.context.object
        rng = random.Random(3)
        for number in range(60):
            self.add_light(f"Lamp {number}", location=[rng.uniform(-4, 4), rng.uniform(-9, 4), rng.uniform(1, 3)], energy=20,
                           use_custom_distance=True, cutoff_distance=2)
        bpy.ops.chandelier.bake()
        wanted = self.preview().bill
        self.assertLess(wanted.shadow_maps, wanted.lights_in_view - 5)
        self.assertLess(wanted.lights_in_view, wanted.lights)
        for maps, mib, over in ((0, 0, False), (wanted.shadow_maps + 3, 0, False), (7, 0, True), (0, 3, True)):
            with self.subTest(maps=maps, mib=mib):
                settings.budget_maps, settings.budget_mib = maps, mib
                bill, (counters, d_init_m) = self.preview().bill, self.predicted()
                self.assertEqual((bill.over_budget, bill.shadow_maps < wanted.shadow_maps), (over, over))
                for name in ("lights_in_view", "shadow_maps", "shadow_views", "shadow_bytes"):
                    self.assertEqual(counters[name], getattr(bill, name), name)
                self.assertEqual(d_init_m, bill.d_init_m)

    def preview(self):
        bpy.context.view_layer.update()
        part("preview").PREVIEW.update(bpy.context)
        self.assertEqual(part("preview").PREVIEW.error, "")
        return part("preview").PREVIEW.selection

    def predicted(self):
        """What chandelier-play counts when it is started as Play starts it."""
        stats = self.folder / "stats.json"
        subprocess.run([BIN / "chandelier-play", *self.module.play_command(self.scene), "--predict", "--size", "320x180",
                        "--stats", stats], check=True, stdout=subprocess.DEVNULL)
        said = json.loads(stats.read_text())
        return said["counters"], said["recipe"]["settings"]["d_init_m"]

    def test_settings_reach_the_player(self):
        """It draws what the scene says, into a picture."""
        settings = self.scene.chandelier
        settings.d_init, settings.filter, settings.distance_scaling, settings.face_size = 0.75, "pcf", "none", 128
        bpy.ops.object.camera_add(location=(0, -6, 4), rotation=(1, 0, 0))
        bpy.context.object.name = "Eye"
        self.scene.camera = bpy.context.object
        bpy.ops.chandelier.bake()
        picture = self.folder / "picture.png"
        self.handover.play([*self.module.play_command(self.scene), "--output", str(picture), "--size", "64x36"])
        self.ended()
        self.assertEqual(self.handover.error, "")
        self.assertTrue(picture.exists())
        self.handover.play([*self.module.play_command(self.scene), "--camera", "Nobody", "--output", str(picture)])
        self.ended()
        self.assertIn("chandelier-play: ", self.handover.error)
