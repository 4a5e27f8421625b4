# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of many lights at once."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import scene_lights
from .core import photometry


def selected_lights(context):
    return [thing for thing in context.selected_objects if thing.type == "LIGHT"]


def named(objects, name):
    """Of objects of the same name, which different files may own, that with this full name; or nothing."""
    return next((thing for thing in objects if thing.name_full == name), None)


def is_editable(thing):
    """Whether it belongs to this file. Overridden data counts as this file's."""
    return thing.library is None


def data_of(lights):
    """Their data-blocks that can be edited, each once."""
    return list(dict.fromkeys(light.data for light in lights if is_editable(light.data)))


class CHANDELIER_OT_edit_lights(bpy.types.Operator):
    """Set the ticked values on all selected lights"""
    bl_idname = "chandelier.edit_lights"
    bl_label = "Edit Lights"
    bl_options = {"REGISTER", "UNDO"}

    use_power: BoolProperty(name="Power", options={"SKIP_SAVE"})
    power_by: EnumProperty(name="Power By", default="FACTOR", items=(
        ("FACTOR", "Factor", "Multiply each light's power"), ("WATTS", "Watts", "Give all the same power")))
    factor: FloatProperty(name="Factor", default=1, min=0, soft_max=10)
    power: FloatProperty(name="Watts", default=40, min=0, soft_max=1000, unit="POWER")
    use_temperature: BoolProperty(name="Temperature", options={"SKIP_SAVE"})
    temperature: FloatProperty(name="Kelvin", default=4000, min=800, max=20000, step=10000, precision=0)
    use_range: BoolProperty(name="Range", options={"SKIP_SAVE"})
    range: FloatProperty(name="Range", description="0: no Custom Distance", default=8, min=0, soft_max=100, unit="LENGTH")
    use_radius: BoolProperty(name="Radius", options={"SKIP_SAVE"})
    radius: FloatProperty(name="Radius", description="Of what shines: softens shadows. Suns have an angle instead", default=0.05, min=0, soft_max=1, unit="LENGTH")
    use_shadow: BoolProperty(name="Shadow", options={"SKIP_SAVE"})
    shadow: BoolProperty(name="Throws a Shadow", default=False)
    use_priority: BoolProperty(name="Priority", options={"SKIP_SAVE"})
    priority: IntProperty(name="Priority", default=128, min=0, max=255)
    use_dynamic: BoolProperty(name="Dynamic", options={"SKIP_SAVE"})
    dynamic: BoolProperty(name="Dynamic", default=True)
    use_cluster: BoolProperty(name="Cluster", options={"SKIP_SAVE"})
    cluster: BoolProperty(name="May Share a Map", default=False)
    use_group: BoolProperty(name="Group", options={"SKIP_SAVE"})
    group: StringProperty(name="Group", description="Empty: none")

    @classmethod
    def poll(cls, context):
        return bool(selected_lights(context))

    def execute(self, context):
        lights = selected_lights(context)
        datas = data_of(lights)
        for data in datas:
            self._edit(data)
        linked = sum(not is_editable(light.data) for light in lights)
        suns = sum(light.data.type == "SUN" for light in lights) if self.use_radius else 0
        others = sum(light.type == "LIGHT" and light.data in datas and light not in lights for light in context.scene.objects)
        if linked:
            self.report({"WARNING"}, f"{linked} lights belong to another file and stay as they are")
        if suns:
            self.report({"WARNING"}, f"{suns} {'sun has' if suns == 1 else 'suns have'} an angle instead of a radius, which stays as it is")
        if others:
            self.report({"WARNING"}, f"{others} lights that are not selected share this data and change too")
        return {"FINISHED"}

    def _edit(self, data):
        if self.use_power:
            data.energy = self.power if self.power_by == "WATTS" else data.energy * self.factor
        if self.use_temperature:
            data.color = photometry.colour_of_temperature(self.temperature)
        if self.use_range:
            data.use_custom_distance = self.range > 0
            data.cutoff_distance = self.range if self.range > 0 else data.cutoff_distance
        if self.use_radius and data.type != "SUN":
            data.shadow_soft_size = self.radius
        if self.use_shadow:
            scene_lights.set_shadow(data, self.shadow)
        for name in ("priority", "dynamic", "cluster", "group"):
            if getattr(self, f"use_{name}"):
                setattr(data.chandelier, name, getattr(self, name))

    def draw(self, context):
        layout = self.layout
        fields = {"power": "power" if self.power_by == "WATTS" else "factor"}
        for name in ("power", "temperature", "range", "radius", "shadow", "priority", "dynamic", "cluster", "group"):
            row = layout.row()
            row.prop(self, f"use_{name}")
            values = row.row()
            values.enabled = getattr(self, f"use_{name}")
            if name == "power":
                values.prop(self, "power_by", text="")
            values.prop(self, fields.get(name, name), text="")


class CHANDELIER_OT_strength(bpy.types.Operator):
    """Make the selected lights brighter or dimmer"""
    bl_idname = "chandelier.strength"
    bl_label = "Strength"
    bl_options = {"REGISTER", "UNDO"}

    light: StringProperty(name="Light", description="Its full name; empty: all selected lights", options={"HIDDEN", "SKIP_SAVE"})
    factor: FloatProperty(name="Factor", default=1.25, min=0, soft_max=10)

    def execute(self, context):
        light = named(context.scene.objects, self.light)
        lights = [light] if light and light.type == "LIGHT" else [] if self.light else selected_lights(context)
        datas = data_of(lights)
        for data in datas:
            data.energy *= self.factor
        return {"FINISHED"} if datas else {"CANCELLED"}


register, unregister = bpy.utils.register_classes_factory((CHANDELIER_OT_edit_lights, CHANDELIER_OT_strength))
