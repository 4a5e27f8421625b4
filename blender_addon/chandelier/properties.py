# SPDX-License-Identifier: GPL-3.0-or-later
"""What Chandelier keeps in a .blend: on lights, what schemas/light_extras.schema.json lets a glTF light carry; on scenes, how
it is going to be played. Range, radius and power are Blender's own fields."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from . import light_list

# A linked light's data can be changed here where it is overridden.
OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}


def tag(settings, context):
    """Changes of a script's properties tell nobody by themselves: the light's data counts as changed."""
    settings.id_data.update_tag()


def redraw(settings, context):
    """The 3D views."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class LightSettings(bpy.types.PropertyGroup):
    priority: IntProperty(
        name="Priority", description="Who keeps a shadow map of its own when the budget ends: higher first",
        default=128, min=0, max=255, override=OVERRIDABLE, update=tag)
    dynamic: BoolProperty(
        name="Dynamic", description="Something other than this file's animation will move the light or change it",
        default=False, override=OVERRIDABLE, update=tag)
    cluster: BoolProperty(
        name="Cluster", description="The light may share a shadow map; off: it gets one of its own",
        default=True, override=OVERRIDABLE, update=tag)
    group: StringProperty(
        name="Group", description="Lights with the same group share one shadow map, and with no other light. Empty: none",
        default="", override=OVERRIDABLE, update=tag)


class HiddenBySolo(bpy.types.PropertyGroup):
    """A light that solo hid in a view layer, and shows again when it ends."""
    light: PointerProperty(type=bpy.types.Object)
    view_layer: StringProperty()


class SceneSettings(bpy.types.PropertyGroup):
    """Names and limits are chandelier-play's."""
    d_init: FloatProperty(
        name="Distance", description="Lights closer than this to a cluster's centre share its shadow map, at the camera; "
        "0: each light has its own. A budget may widen it", default=0.5, min=0, soft_max=10, unit="LENGTH", update=redraw)
    distance_scaling: EnumProperty(
        name="Farther Away", update=redraw, description="How the distance follows the distance to the camera", default="grow", items=(
            ("grow", "Grows", "Lights that are far from the camera share more: times 1 + |C| / z_far"),
            ("paper-formula", "Shrinks", "As LightCluster's formula is printed: times 1 - |C| / z_far"),
            ("none", "Stays", "The same everywhere: nothing changes when the camera moves")))
    z_far: FloatProperty(
        name="Far Distance", description="Distance from the camera that scales it by one", default=30, min=0.001, soft_max=1000,
        unit="LENGTH", update=redraw)
    dynamic_lights: EnumProperty(
        name="Moving Lights", update=redraw, description="Lights that are dynamic, or that the exported file moves", default="cluster", items=(
            ("cluster", "Share", "They share shadow maps like others"),
            ("own", "Own Maps", "Each has a shadow map to itself, so that the others' may stay as they are")))
    face_size: IntProperty(
        name="Face Size", description="Width of one face of a cube shadow map, texels", default=512, min=16, max=16384,
        update=redraw)
    filter: EnumProperty(name="Filter", update=redraw, description="How shadow maps are read", default="pcss", items=(
        ("pcss", "Soft (PCSS)", "Shadows soften with distance; a cluster stands for an area light"),
        ("pcf", "Smoothed (PCF)", "Edges are smoothed by the same width everywhere"),
        ("hard", "Hard", "One comparison; only for lights that share no shadow map: with distance 0")))
    budget_maps: IntProperty(
        name="Maps", description="Most shadow maps of a frame; where there are more, the distance is widened. 0: no limit", default=0, min=0,
        update=redraw)
    budget_mib: IntProperty(
        name="MiB", description="Most depth of all shadow maps of a frame, MiB; where it takes more, the distance is widened. 0: no limit",
        default=0, min=0, update=redraw)
    view: EnumProperty(name="Seen From", update=redraw, description="Whose distance to the lights counts", default="camera", items=(
        ("camera", "Scene Camera", "The scene's camera, as chandelier-play starts"),
        ("viewport", "Viewport", "The 3D view that is drawn")))
    active_light: IntProperty(
        name="Light", description="The light that the list shows as active", default=-1, update=light_list.take_active,
        options={"SKIP_SAVE"})
    pack_path: StringProperty(
        name="Pack", description="The pack to bake; empty: beside the .blend, with its name", default="", subtype="FILE_PATH")
    bake_on_save: BoolProperty(
        name="Bake on Save", description="Export and bake whenever the .blend is saved", default=False)
    hidden_by_solo: CollectionProperty(type=HiddenBySolo)


class Surprise(bpy.types.PropertyGroup):
    """`name` is the light's full one."""
    rule: StringProperty()
    text: StringProperty()


class SessionSettings(bpy.types.PropertyGroup):
    """Of the running Blender; no file keeps it."""
    surprises: CollectionProperty(type=Surprise)
    has_looked: BoolProperty(description="Surprises were looked for")


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
