# SPDX-License-Identifier: GPL-3.0-or-later
"""Chandelier in Blender: one folder for 3.4 (add-on, by bl_info) and for 4.2 and later (extension, by its manifest)."""

bl_info = {
    "name": "Chandelier",
    "author": "The Chandelier authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Chandelier",
    "description": "Place hundreds of lights, see which share a shadow map and what that costs, bake and play",
    "category": "Lighting",
}

# Blender reads bl_info without running the file.
from . import (  # noqa: E402
    cycles_compare, edit, export, handover, light_list, overlay, panels, place, preferences, preview, properties, selection,
    surprises_ui)
from .gltf_hook import glTF2ExportUserExtension  # noqa: E402, F401  (the exporter looks for it here)

MODULES = (preferences, properties, place, edit, light_list, surprises_ui, export, handover, cycles_compare, selection, preview,
           overlay, panels)


def register():
    for module in MODULES:
        module.register()


def unregister():
    for module in reversed(MODULES):
        module.unregister()
