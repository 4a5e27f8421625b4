# SPDX-License-Identifier: GPL-3.0-or-later
"""Hooks of Blender's glTF exporter: write each light's watts, range and extras.chandelier, and which objects cast no shadow.

The exporter swallows exceptions of a hook and reports FINISHED, so export.py checks the written file.
There is no hook for lights. All nodes with the same light share one dict, which is filled again for each of them."""

import bpy

from . import scene_lights, shadows
from .core import photometry

EXTENSION = "KHR_lights_punctual"


class glTF2ExportUserExtension:
    """Found by this name in the add-on's module."""

    def __init__(self):
        self.objects = {}  # Blender's, of each node that has one

    def gather_node_hook(self, node, blender_object, export_settings):
        if not isinstance(blender_object, bpy.types.Object):
            return  # none, or a collection
        self.objects[node] = blender_object
        if blender_object.type == "LIGHT" and EXTENSION in (node.extensions or {}):
            light = node.extensions[EXTENSION].extension["light"].extension
            write_light(light, blender_object.data, export_settings["gltf_lighting_mode"] == "SPEC")

    def gather_material_hook(self, material, blender_material, export_settings):
        if blender_material is not None and not shadows.material_throws(blender_material):
            material.extras = without_shadow(material.extras)

    def gather_scene_hook(self, scene, blender_scene, export_settings):
        """Once all nodes are there. With custom properties exported, our own come along as Blender stores them, which nobody reads."""
        for node in scene.nodes:
            self.write_no_shadow(node, None)
        if isinstance(scene.extras, dict):
            for name in ("chandelier", "chandelier_overlay"):
                scene.extras.pop(name, None)
            scene.extras = scene.extras or None

    def write_no_shadow(self, node, instancer):
        """On a node and what is below it; `instancer`: the outermost object that instances it, or None."""
        thing = self.objects.get(node)
        if node.mesh is not None and not shadows.throws(thing, instancer):
            node.extras = without_shadow(node.extras)
        for child in node.children or ():
            self.write_no_shadow(child, instancer or (thing if instances(thing, self.objects.get(child)) else None))


def instances(thing, child):
    """Whether `thing` instances what the exporter hangs below it, beside which a collection's instancer may have children of its
    own. Those of other instancers are what is instanced."""
    if thing is None or not thing.is_instancer:
        return False
    return thing.instance_type != "COLLECTION" or child is None or child.parent != thing


def without_shadow(extras):
    """schemas/shadow_extras.schema.json"""
    return {**(extras or {}), "chandelier": {"shadow": False}}


def write_light(light, data, is_spec):
    """`light`: as KHR_lights_punctual has it; `is_spec`: its intensity is in the extension's units. Exporters differ in what
    they make of a light's nodes, exposure and temperature: here it is what the preview takes too."""
    power_w, colour = scene_lights.emission_of(data)
    power_w = max(power_w, 0.0)
    kind = scene_lights.KINDS[data.type]
    if is_spec:
        brightest = max(1.0, *colour)  # glTF's colours end at 1
        light["intensity"] = photometry.intensity_of(kind, power_w) * brightest
        light["color"] = [max(part, 0.0) / brightest for part in colour]
    extras = extras_of(data, power_w)
    light.pop("range", None)
    if "range_m" in extras:
        light["range"] = extras["range_m"]
    light["extras"] = {**(light.get("extras") or {}), "chandelier": extras}


def extras_of(data, power_w):
    """schemas/light_extras.schema.json; what has its default is left out."""
    settings = data.chandelier
    extras = {"power_w": power_w}
    range_m = scene_lights.range_of(data)
    if range_m > 0:
        extras["range_m"] = range_m
    radius_m = scene_lights.radius_of(data)
    if radius_m > 0:
        extras["radius_m"] = radius_m
    if settings.priority != 128:
        extras["priority"] = settings.priority
    if settings.dynamic:
        extras["dynamic"] = True
    if not settings.cluster:
        extras["cluster"] = False
    if not scene_lights.casts_shadow(data):
        extras["shadow"] = False
    if settings.group:
        extras["group"] = settings.group
    return extras
