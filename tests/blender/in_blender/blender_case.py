# SPDX-License-Identifier: Apache-2.0
"""What the tests inside Blender share: an empty scene for each, and makers of objects."""

import importlib
import os
import pathlib
import tempfile
import unittest

import addon_utils
import bpy

SOURCE = pathlib.Path(os.environ["CHANDELIER_SOURCE"])
ADDON = os.environ.get("CHANDELIER_ADDON", "chandelier")  # an extension's is bl_ext.….chandelier


def enable_addon():
    failures = []
    addon_utils.enable(ADDON, default_set=True, handle_error=failures.append)
    if failures:
        raise failures[0]


def part(name):
    """A module of the add-on."""
    return importlib.import_module(f"{ADDON}.{name}")


class BlenderCase(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_homefile(use_empty=True)
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.scene = bpy.context.scene

    def add(self, name, data=None, location=(0, 0, 0), collection=None):
        made = bpy.data.objects.new(name, data)
        made.location = location
        (collection or self.scene.collection).objects.link(made)
        return made

    def add_light(self, name="Lamp", kind="POINT", location=(0, 0, 0), collection=None, **values):
        data = bpy.data.lights.new(name, kind)
        for key, value in values.items():
            setattr(data, key, value)
        return self.add(name, data, location, collection)

    def leave_as_library(self):
        """Saves everything, and begins an empty scene. The file."""
        path = str(self.folder / "library.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.read_homefile(use_empty=True)
        self.scene = bpy.context.scene
        return path

    def link_library(self, *lights):
        """Saves these lights as a library's collection, and links it into an empty scene."""
        collection = bpy.data.collections.new("Library")
        self.scene.collection.children.link(collection)
        for light in lights:
            self.scene.collection.objects.unlink(light)
            collection.objects.link(light)
        path = self.leave_as_library()  # first: it makes bpy.data anew
        with bpy.data.libraries.load(path, link=True) as (_, target):
            target.collections = ["Library"]
        return target.collections[0]

    def add_instance(self, collection, location=(0, 0, 0)):
        instancer = self.add("Here", location=location)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        return instancer

    def select(self, *objects, active=None):
        bpy.context.view_layer.update()
        for other in bpy.context.view_layer.objects:
            other.select_set(other in objects)
        bpy.context.view_layer.objects.active = active or (objects[0] if objects else None)

    def assertClose(self, a, b, tolerance=1e-5):
        self.assertEqual(len(a), len(b))
        for x, y in zip(a, b):
            self.assertAlmostEqual(x, y, delta=tolerance, msg=f"{tuple(a)} is not {tuple(b)}")
