# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: the sidebar's tab of the 3D view, and a light's and a scene's own in the Properties editor."""

import textwrap

import bpy

from . import place, scene_lights, shadows
from .core import surprises
from .handover import handover, pack_path
from .preview import bill_lines

NAMES_SHOWN = 6  # of lights with the same surprise
CHARACTER_PX = 7  # about, of a label at the scale 1
PLACES = ((place.CHANDELIER_OT_place_along_curve, "CURVE_DATA"), (place.CHANDELIER_OT_place_around, "MESH_CIRCLE"),
          (place.CHANDELIER_OT_place_on_mesh, "MESH_DATA"), (place.CHANDELIER_OT_scatter, "STICKY_UVS_DISABLE"),
          (place.CHANDELIER_OT_place_at_selected, "EMPTY_AXIS"))


def wrapped(layout, context, text, icon="NONE"):
    """A text in as many lines as the region needs: a label of Blender's ends where there is no more room."""
    scale = context.preferences.system.ui_scale
    width = max(16, int((context.region.width / scale - 60) / CHARACTER_PX))
    column = layout.column(align=True)
    column.scale_y = 0.8
    for number, line in enumerate(textwrap.wrap(text, width)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1" if icon != "NONE" else "NONE")


def draw_shadow_settings(layout, settings):
    layout.use_property_split = True
    layout.use_property_decorate = False
    budgeted = settings.budget_maps > 0 or settings.budget_mib > 0
    column = layout.column()
    column.prop(settings, "d_init", text="Distance at Least" if budgeted else "Distance")
    column.prop(settings, "distance_scaling")
    row = column.row()
    row.active = settings.distance_scaling != "none"
    row.prop(settings, "z_far")
    column.prop(settings, "view")
    column.prop(settings, "dynamic_lights")
    column = layout.column()
    column.prop(settings, "face_size")
    column.prop(settings, "filter")
    if settings.filter == "hard" and (settings.d_init > 0 or budgeted):
        column.label(text="Hard needs distance 0", icon="ERROR")
    column = layout.column(heading="Budget")
    column.prop(settings, "budget_maps")
    column.prop(settings, "budget_mib")


class Sidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Chandelier"


class CHANDELIER_PT_handover(Sidebar, bpy.types.Panel):
    bl_label = "Bake and Play"

    def draw(self, context):
        layout, settings = self.layout, context.scene.chandelier
        if handover.bake:
            row = layout.row()
            row.label(text=handover.status, icon="SORTTIME")
            row.operator("chandelier.cancel", text="", icon="CANCEL")
        else:
            row = layout.row(align=True)
            row.operator("chandelier.bake", icon="RENDER_STILL")
            row.operator("chandelier.play", icon="PLAY")
        if handover.error:
            box = layout.box()
            box.alert = True
            wrapped(box, context, handover.error, "ERROR")
        elif handover.done and not handover.bake:
            layout.label(text=f"{handover.done}: {pack_path(context.scene).name}", icon="CHECKMARK")
        if handover.notes:
            box = layout.box()
            for note in handover.notes:
                wrapped(box, context, note, "INFO")
        layout.prop(settings, "bake_on_save")
        layout.prop(settings, "pack_path", text="")
        layout.operator("chandelier.export", icon="EXPORT")
        layout.operator("chandelier.compare", icon="IMAGE_REFERENCE")


class CHANDELIER_PT_place(Sidebar, bpy.types.Panel):
    bl_label = "Place"

    def draw(self, context):
        column = self.layout.column(align=True)
        for operator, icon in PLACES:
            row = column.row(align=True)
            row.enabled = bool(operator.sources(context))
            row.operator(operator.bl_idname, icon=icon)


class CHANDELIER_PT_lights(Sidebar, bpy.types.Panel):
    bl_label = "Lights"

    def draw(self, context):
        layout, scene = self.layout, context.scene
        layout.template_list("CHANDELIER_UL_lights", "", scene, "objects", scene.chandelier, "active_light", rows=6)
        row = layout.row(align=True)
        row.operator("chandelier.edit_lights", text="Edit", icon="MODIFIER")
        row.operator("chandelier.solo", text="Solo", icon="SOLO_ON")
        for factor, icon in ((0.8, "REMOVE"), (1.25, "ADD")):
            row.operator("chandelier.strength", text="", icon=icon).factor = factor


class CHANDELIER_PT_surprises(Sidebar, bpy.types.Panel):
    bl_label = "Surprises"

    def draw(self, context):
        layout, session = self.layout, context.window_manager.chandelier
        layout.operator("chandelier.find_surprises", icon="VIEWZOOM")
        if session.has_looked and not session.surprises:
            layout.label(text="None", icon="CHECKMARK")
        for rule in surprises.RULES:
            found = [item for item in session.surprises if item.rule == rule.id]
            if found:
                self.draw_rule(context, rule, found)

    def draw_rule(self, context, rule, found):
        box = self.layout.box()
        row = box.row(align=True)
        row.label(text=f"{rule.title}: {len(found)}", icon="ERROR")
        if rule in surprises.LIGHT_RULES:
            row.operator("chandelier.select_surprised", text="", icon="RESTRICT_SELECT_OFF").rule = rule.id
        for item in found[:NAMES_SHOWN]:
            wrapped(box, context, f"{item.name} {item.text}")
        if len(found) > NAMES_SHOWN:
            box.label(text=f"and {len(found) - NAMES_SHOWN} more")
        if rule.fix == "chandelier.convert_area":
            box.operator_menu_enum(rule.fix, "kind", text="Convert to").rule = rule.id
        elif rule.fix:
            box.operator(rule.fix).rule = rule.id


class CHANDELIER_PT_clusters(Sidebar, bpy.types.Panel):
    bl_label = "Light Clusters"

    def draw_header(self, context):
        self.layout.prop(context.scene.chandelier_overlay, "show", text="")

    def draw(self, context):
        layout, shown = self.layout, context.scene.chandelier_overlay
        for text, is_bad in bill_lines(context) if shown.show else ():
            box = layout.column()
            box.alert = is_bad
            wrapped(box, context, text)
        column = layout.column(align=True)
        column.active = shown.show
        row = column.row(align=True)
        row.prop(shown, "links", toggle=True)
        row.prop(shown, "labels", toggle=True)
        row = column.row(align=True)
        row.prop(shown, "d_min", toggle=True)
        row.prop(shown, "ranges", toggle=True)
        row = layout.row(align=True)
        row.operator("chandelier.select_cluster")
        row.operator("chandelier.select_over_budget", text="Over-Budget")


class CHANDELIER_PT_shadows(Sidebar, bpy.types.Panel):
    bl_label = "Shadow Maps"

    def draw(self, context):
        draw_shadow_settings(self.layout, context.scene.chandelier)


class Properties:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_label = "Chandelier"


class CHANDELIER_PT_light(Properties, bpy.types.Panel):
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return context.light is not None

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.use_property_split = True
        layout.use_property_decorate = False
        if light.type == "AREA":
            layout.label(text="glTF has no area lights: it will be missing", icon="ERROR")
            layout.operator_menu_enum("chandelier.convert_area", "kind", text="Convert Selected to")
        column = layout.column()
        column.prop(light.chandelier, "priority")
        column.prop(light.chandelier, "dynamic")
        column.prop(light.chandelier, "cluster")
        column.prop(light.chandelier, "group")
        if light.type in ("POINT", "SPOT"):
            column = layout.column(heading="Range")
            row = column.row(align=True)
            row.prop(light, "use_custom_distance", text="")
            distance = row.row()
            distance.active = light.use_custom_distance
            distance.prop(light, "cutoff_distance", text="")
            layout.prop(light, "shadow_soft_size", text="Radius")
        if light.type == "SUN":
            layout.prop(light, "angle")
        cycles = scene_lights.cycles_switch(light)
        column = layout.column(heading="Shadow" if cycles else "")
        column.prop(light, "use_shadow", text="EEVEE" if cycles else "Shadow")
        if cycles:
            column.prop(cycles, "cast_shadow", text="Cycles")


class CHANDELIER_PT_object(Properties, bpy.types.Panel):
    """Blender shows its own switch only where Cycles renders, and until 4.1 it is Cycles' alone."""
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and (context.object.type in shadows.WITH_SURFACE or context.object.is_instancer)

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(context.object, "visible_shadow", text="Shadow")


class CHANDELIER_PT_scene(Properties, bpy.types.Panel):
    bl_context = "scene"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        draw_shadow_settings(self.layout, context.scene.chandelier)


CLASSES = (CHANDELIER_PT_handover, CHANDELIER_PT_place, CHANDELIER_PT_lights, CHANDELIER_PT_clusters, CHANDELIER_PT_shadows, CHANDELIER_PT_surprises,
           CHANDELIER_PT_light, CHANDELIER_PT_object, CHANDELIER_PT_scene)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
