# SPDX-License-Identifier: GPL-3.0-or-later
"""Chandelier's settings in a .blend: of lights, those of schemas/light_extras.schema.json; of scenes, how the pack is played.
Range, radius and power are Blender's own fields."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from . import light_list

# A linked light's data can be changed here where it is overridden.
OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}


def tag(settings, context):
    """Blender raises no event for changes of a script's properties, so mark the light's data as changed."""
    settings.id_data.update_tag()


def redraw(settings, context):
    """The 3D views."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class LightSettings(bpy.types.PropertyGroup):
    priority: IntProperty(
        name="Priority", description="Lights with a higher priority keep a shadow map of their own when the budget is short",
        default=128, min=0, max=255, override=OVERRIDABLE, update=tag)
    dynamic: BoolProperty(
        name="Dynamic", description="Something other than this file's animation will move or change the light",
        default=False, override=OVERRIDABLE, update=tag)
    cluster: BoolProperty(
        name="Cluster", description="Let the light share a shadow map; off: it gets one of its own",
        default=True, override=OVERRIDABLE, update=tag)
    group: StringProperty(
        name="Group", description="Lights of one group share one shadow map with each other and with no other light. Empty: no group",
        default="", override=OVERRIDABLE, update=tag)


class HiddenBySolo(bpy.types.PropertyGroup):
    """A light that solo has hidden in a view layer, and shows again when solo ends."""
    light: PointerProperty(type=bpy.types.Object)
    view_layer: StringProperty()


class SceneSettings(bpy.types.PropertyGroup):
    """Names and limits are chandelier-play's."""
    d_init: FloatProperty(
        name="Distance", description="Lights closer to a cluster's centre than this share its shadow map; valid at the camera. "
        "0: each light has its own map. A budget may enlarge it", default=0.5, min=0, soft_max=10, unit="LENGTH", update=redraw)
    distance_scaling: EnumProperty(
        name="Farther Away", update=redraw, description="How the sharing distance changes with the distance from the camera", default="grow", items=(
            ("grow", "Grows", "Lights that are far from the camera share more maps: times 1 + |C| / z_far"),
            ("paper-formula", "Shrinks", "As in LightCluster's printed formula: times 1 - |C| / z_far"),
            ("none", "Stays", "The same everywhere, so nothing changes when the camera moves")))
    z_far: FloatProperty(
        name="Far Distance", description="Distance from the camera (z_far) at which the sharing distance has doubled, or has shrunk to 0", default=30, min=0.001, soft_max=1000,
        unit="LENGTH", update=redraw)
    dynamic_lights: EnumProperty(
        name="Moving Lights", update=redraw, description="Lights that are dynamic, or that the exported file moves", default="cluster", items=(
            ("cluster", "Share", "They share shadow maps like others"),
            ("own", "Own Maps", "Each has a shadow map of its own, so the maps of other lights can stay unchanged")))
    face_size: IntProperty(
        name="Face Size", description="Width of one face of a cube shadow map, texels", default=512, min=16, max=16384,
        update=redraw)
    filter: EnumProperty(name="Filter", update=redraw, description="How shadow maps are read", default="pcss", items=(
        ("pcss", "Soft (PCSS)", "Shadows soften with distance; a cluster stands for an area light"),
        ("pcf", "Smoothed (PCF)", "Edges are smoothed with the same width everywhere"),
        ("hard", "Hard", "One comparison. Only for lights that share no shadow map: set the distance to 0")))
    budget_maps: IntProperty(
        name="Maps", description="Largest number of shadow maps in a frame; if there are more, the distance is enlarged. 0: no limit", default=0, min=0,
        update=redraw)
    budget_mib: IntProperty(
        name="MiB", description="Largest size of all shadow maps of a frame, MiB; if they need more, the distance is enlarged. 0: no limit",
        default=0, min=0, update=redraw)
    view: EnumProperty(name="Seen From", update=redraw, description="The camera whose distance to the lights counts", default="camera", items=(
        ("camera", "Scene Camera", "The scene's camera, as chandelier-play starts"),
        ("viewport", "Viewport", "The 3D view itself")))
    active_light: IntProperty(
        name="Light", description="The active light of the list", default=-1, update=light_list.take_active,
        options={"SKIP_SAVE"})
    pack_path: StringProperty(
        name="Pack", description="The pack to write. Empty: beside the .blend, with the same name", default="", subtype="FILE_PATH")
    bake_on_save: BoolProperty(
        name="Bake on Save", description="Export and bake whenever the .blend is saved", default=False)
    hidden_by_solo: CollectionProperty(type=HiddenBySolo)


class Surprise(bpy.types.PropertyGroup):
    """`name` is the light's full one."""
    rule: StringProperty()
    text: StringProperty()


class SessionSettings(bpy.types.PropertyGroup):
    """State of the running Blender; it is saved in no file."""
    surprises: CollectionProperty(type=Surprise)
    has_looked: BoolProperty(description="The search for surprises has run")


PARTS = (HiddenBySolo, Surprise)
OWNERS = ((bpy.types.Light, LightSettings), (bpy.types.Scene, SceneSettings), (bpy.types.WindowManager, SessionSettings))


def register():
    for part in PARTS:
        bpy.utils.register_class(part)
    for owner, settings in OWNERS:
        bpy.utils.register_class(settings)
        overridable = OVERRIDABLE if owner is bpy.types.Light else set()
        owner.chandelier = PointerProperty(type=settings, override=overridable)


def unregister():
    for owner, settings in reversed(OWNERS):
        del owner.chandelier
        bpy.utils.unregister_class(settings)
    for part in PARTS:
        bpy.utils.unregister_class(part)
