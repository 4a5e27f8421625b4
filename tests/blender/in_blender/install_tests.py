# SPDX-License-Identifier: Apache-2.0
"""The zip as a user installs it, and what a .blend keeps."""

import importlib.util
import pathlib
import shutil
import sys
import tomllib
import zipfile

import addon_utils
import bpy

from blender_case import ADDON, SOURCE, BlenderCase, part


def make_zip(target, *bundled):
    spec = importlib.util.spec_from_file_location("make_zip", SOURCE / "blender_addon" / "make_zip.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.write(target, bundled)


def classes():
    """All of Blender's types that the add-on has registered."""
    return sorted(kind.__name__ for kind in (*bpy.types.PropertyGroup.__subclasses__(), *bpy.types.Operator.__subclasses__(),
                                             *bpy.types.Panel.__subclasses__())
                  if kind.__module__.startswith(ADDON) and kind.is_registered)


IS_EXTENSION = ADDON.startswith("bl_ext.")


def add_ons():
    """The folder that Blender installs it into."""
    if IS_EXTENSION:
        return pathlib.Path(bpy.utils.user_resource("EXTENSIONS", path="user_default"))
    return pathlib.Path(bpy.utils.user_resource("SCRIPTS", path="addons"))


def install(path):
    if IS_EXTENSION:
        bpy.ops.extensions.package_install_files(filepath=str(path), repo="user_default", enable_on_install=False)
    else:
        bpy.ops.preferences.addon_install(filepath=str(path))


class Installed(BlenderCase):
    def tearDown(self):
        addon_utils.enable(ADDON, default_set=True)

    def test_the_zip_is_whole_and_always_the_same(self):
        first, second = self.folder / "a.zip", self.folder / "b.zip"
        tool = self.folder / "libtool.so"
        tool.write_bytes(b"\x7fELF\x02\x01 tool")
        make_zip(first, tool)
        make_zip(second, tool)
        self.assertEqual(first.read_bytes(), second.read_bytes())
        with zipfile.ZipFile(first) as archive:
            names = archive.namelist()
            manifest = tomllib.loads(archive.read("chandelier/blender_manifest.toml").decode())
            modes = {name: archive.getinfo(f"chandelier/bin/{name}").external_attr >> 16 for name in ("libtool.so", "NOTICE")}
        self.assertEqual(manifest["platforms"], ["linux-x64"])
        self.assertEqual(modes, {"libtool.so": 0o755, "NOTICE": 0o644})
        for name in ("__init__.py", "blender_manifest.toml", "LICENSE", "core/__init__.py", "bin/libtool.so", "bin/LICENSE",
                     "bin/LICENSE-GLM"):
            self.assertIn(f"chandelier/{name}", names)
        self.assertFalse([name for name in names if not name.startswith("chandelier/") or "__pycache__" in name])

    def test_without_programs_it_is_for_every_platform(self):
        make_zip(self.folder / "plain.zip")
        with zipfile.ZipFile(self.folder / "plain.zip") as archive:
            self.assertNotIn("platforms", tomllib.loads(archive.read("chandelier/blender_manifest.toml").decode()))
            self.assertFalse([name for name in archive.namelist() if "/bin/" in name])

    def test_installs_and_can_be_switched_off_and_on(self):
        addon_utils.disable(ADDON, default_set=True)
        self.assertFalse(hasattr(bpy.types.Light, "chandelier"))
        source = add_ons() / "chandelier"
        source.unlink()  # the link to the source, so that the zip is what is installed
        for name in [name for name in sys.modules if name == ADDON or name.startswith(f"{ADDON}.")]:
            del sys.modules[name]
        program = self.folder / "chandelier-bake"
        program.write_text("#!/bin/sh\n")
        make_zip(self.folder / "chandelier.zip", program)
        install(self.folder / "chandelier.zip")
        self.assertTrue((source / "LICENSE").is_file())
        before = classes()
        for _ in range(2):
            self.assertEqual(bpy.ops.preferences.addon_enable(module=ADDON), {"FINISHED"})
            module = sys.modules[ADDON]
            self.assertEqual(pathlib.Path(module.__file__).parent, source)
            self.assertIn("LightSettings", classes())
            self.assertEqual(part("core.tools").find("chandelier-bake", part("preferences").tool_folders()),
                             str(source / "bin" / "chandelier-bake"))
            self.assertEqual(self.add_light().data.chandelier.priority, 128)
            bpy.ops.preferences.addon_disable(module=ADDON)
            self.assertFalse(hasattr(bpy.types.Light, "chandelier"))
            self.assertEqual(classes(), before)
        shutil.rmtree(source)
        source.symlink_to(SOURCE / "blender_addon" / "chandelier")


class Kept(BlenderCase):
    def set_up_light(self):
        light = self.add_light("Kept")
        settings = light.data.chandelier
        settings.priority, settings.dynamic, settings.cluster, settings.group = 7, True, False, "chandelier"
        return light

    def assert_kept(self, data):
        settings = data.chandelier
        self.assertEqual((settings.priority, settings.dynamic, settings.cluster, settings.group),
                         (7, True, False, "chandelier"))

    def save(self):
        path = str(self.folder / "kept.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        return path

    def test_by_saving_and_reading(self):
        self.set_up_light()
        self.scene.chandelier.d_init = 1.25
        self.scene.chandelier.distance_scaling = "none"
        path = self.save()
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.wm.open_mainfile(filepath=path)
        self.assert_kept(bpy.data.lights["Kept"])
        self.assertEqual(bpy.context.scene.chandelier.d_init, 1.25)
        self.assertEqual(bpy.context.scene.chandelier.distance_scaling, "none")

    def test_by_append_and_link(self):
        self.set_up_light()
        path = self.save()
        for link in (False, True):
            bpy.ops.wm.read_homefile(use_empty=True)
            with bpy.data.libraries.load(path, link=link) as (source, target):
                target.objects = source.objects
            (light,) = target.objects
            self.assert_kept(light.data)
            self.assertEqual(light.data.library is not None, link)

    def test_by_undo(self):
        light = self.set_up_light()
        bpy.ops.ed.undo_push(message="before")
        light.data.chandelier.priority = 99
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
        self.assert_kept(bpy.data.lights["Kept"])
        bpy.ops.ed.redo()
        self.assertEqual(bpy.data.lights["Kept"].chandelier.priority, 99)

    def test_by_copies(self):
        self.assert_kept(self.set_up_light().data.copy())
