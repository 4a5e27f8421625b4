# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the installed programs are."""

import pathlib

import bpy
from bpy.props import StringProperty

from .core import tools

OWN_PROGRAMS = pathlib.Path(__file__).resolve().parent / "bin"


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    tools_folder: StringProperty(
        name="Programs", description="Folder of chandelier-bake and chandelier-play; empty: the add-on's own, else PATH",
        subtype="DIR_PATH")

    def draw(self, context):
        self.layout.prop(self, "tools_folder")


def tool_folders():
    """What the preferences name, then the add-on's own."""
    named = bpy.context.preferences.addons[__package__].preferences.tools_folder
    return [*([pathlib.Path(bpy.path.abspath(named))] if named else []), OWN_PROGRAMS]


register_classes, unregister = bpy.utils.register_classes_factory((Preferences,))


def register():
    tools.make_executable(OWN_PROGRAMS)
    register_classes()
