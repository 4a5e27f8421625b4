# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of a scene's lights, and solo: one light alone in the viewport."""

import bpy
from bpy.props import StringProperty

from . import edit


class CHANDELIER_UL_lights(bpy.types.UIList):
    """Blender's list of the scene's objects, of which the lights are shown."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flt_flag=0):
        split = layout.split(factor=0.5, align=True)
        split.prop(item, "name", text="", emboss=False, icon=f"LIGHT_{item.data.type}")
        row = split.row(align=True)
        power = row.row(align=True)
        power.enabled = edit.is_editable(item.data)
        power.prop(item.data, "energy", text="")
        row.operator("chandelier.solo", text="", emboss=False,
                     icon="SOLO_ON" if is_soloed(context, item) else "SOLO_OFF").light = item.name_full

    def filter_items(self, context, data, property_name):
        objects = getattr(data, property_name)
        flags = [self.bitflag_filter_item if thing.type == "LIGHT" else 0 for thing in objects]
        if self.filter_name:
            named = bpy.types.UI_UL_list.filter_items_by_name(self.filter_name, self.bitflag_filter_item, objects, "name")
            flags = [a & b for a, b in zip(flags, named)]
        order = bpy.types.UI_UL_list.sort_items_by_name(objects, "name") if self.use_filter_sort_alpha else []
        return flags, order


def take_active(settings, context):
    """The light that was clicked in the list becomes the only selected one."""
    objects = settings.id_data.objects
    if not 0 <= settings.active_light < len(objects):
        return
    light = objects[settings.active_light]
    if light not in context.view_layer.objects.values():
        return
    for other in context.selected_objects:
        other.select_set(False)
    light.select_set(True)
    context.view_layer.objects.active = light


def lights_of(view_layer):
    return [thing for thing in view_layer.objects if thing.type == "LIGHT"]


def hidden_by_solo(context):
    """The view layer's lights that solo has hidden. The scene keeps them: a linked light keeps nothing of its own."""
    kept = {item.light for item in context.scene.chandelier.hidden_by_solo if item.view_layer == context.view_layer.name}
    return [light for light in lights_of(context.view_layer) if light in kept]


def forget_hidden(context):
    """Those of the view layer, and of view layers that no longer exist."""
    kept, layers = context.scene.chandelier.hidden_by_solo, context.scene.view_layers
    for number in reversed(range(len(kept))):
        if kept[number].view_layer == context.view_layer.name or kept[number].view_layer not in layers:
            kept.remove(number)


def is_soloed(context, light):
    """Whether others are hidden for it."""
    return light in lights_of(context.view_layer) and not light.hide_get() and bool(hidden_by_solo(context))


class CHANDELIER_OT_solo(bpy.types.Operator):
    """Hide all other lights in the viewport, or show again those that were hidden so"""
    bl_idname = "chandelier.solo"
    bl_label = "Solo"
    bl_options = {"REGISTER", "UNDO"}

    light: StringProperty(name="Light", description="Its full name; empty: all selected lights", options={"HIDDEN", "SKIP_SAVE"})

    def execute(self, context):
        lights = lights_of(context.view_layer)
        chosen = [light for light in lights if light.name_full == self.light] if self.light else edit.selected_lights(context)
        alone = [light for light in lights if not light.hide_get()]
        hidden = hidden_by_solo(context)
        for light in hidden:
            light.hide_set(False)
        forget_hidden(context)
        if not chosen or (hidden and set(alone) == set(chosen)):
            return {"FINISHED"}
        for light in lights:
            if light in chosen:
                light.hide_set(False)
            elif not light.hide_get():
                light.hide_set(True)
                item = context.scene.chandelier.hidden_by_solo.add()
                item.light, item.view_layer = light, context.view_layer.name
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((CHANDELIER_UL_lights, CHANDELIER_OT_solo))
