# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's lights, camera and settings, as the runtime's own selection takes them; and which lights it put together."""

import bpy
import numpy as np

from . import scene_lights
from .cameras import camera_of
from .core import clusters
from .preferences import tool_folders


def settings_of(scene):
    settings = scene.chandelier
    return clusters.Settings(
        filter=settings.filter, distance_scaling=settings.distance_scaling, dynamic_lights=settings.dynamic_lights,
        face_size_px=settings.face_size, d_init_m=settings.d_init, z_far_m=settings.z_far, budget_maps=settings.budget_maps,
        budget_mib=settings.budget_mib)


def find():
    """The backend that computes selections: the library, or else the program. Raises PreviewError."""
    return clusters.find(tool_folders())


def select(context):
    """All lights as they are now, and which of them share shadow maps."""
    table = scene_lights.read(context.evaluated_depsgraph_get())
    return table, find().select(table, settings_of(context.scene), camera_of(context, table))


def owners_sharing(table, center, chosen):
    """Owners of all lights that share a map with a light of these owners."""
    owners = np.array(table.owners)
    theirs = np.unique(center[np.isin(owners, list(chosen))])
    return set(owners[np.isin(center, theirs[theirs >= 0])].tolist())


def owners_over_budget(table, over_budget):
    return {owner for owner, lost in zip(table.owners, over_budget) if lost}


class Selecting:
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        try:
            names = self.owners(context, *select(context))
        except clusters.PreviewError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        objects = [thing for thing in context.view_layer.objects if thing.name_full in names]
        for other in context.selected_objects:
            other.select_set(False)
        for thing in objects:
            thing.select_set(True)
        if objects and context.view_layer.objects.active not in objects:
            context.view_layer.objects.active = objects[0]
        self.report({"INFO"}, f"{len(objects)} objects")
        return {"FINISHED"}


class CHANDELIER_OT_select_cluster(Selecting, bpy.types.Operator):
    """Select all lights that share a shadow map with the selected ones"""
    bl_idname = "chandelier.select_cluster"
    bl_label = "Select Cluster"

    @classmethod
    def poll(cls, context):
        return bool(context.selected_objects)

    def owners(self, context, table, found):
        return owners_sharing(table, found.center, {thing.name_full for thing in context.selected_objects})


class CHANDELIER_OT_select_over_budget(Selecting, bpy.types.Operator):
    """Select the lights that lose their own shadow map to the budget"""
    bl_idname = "chandelier.select_over_budget"
    bl_label = "Select Over-Budget"

    def owners(self, context, table, found):
        return owners_over_budget(table, found.over_budget)


register, unregister = bpy.utils.register_classes_factory((CHANDELIER_OT_select_cluster, CHANDELIER_OT_select_over_budget))
