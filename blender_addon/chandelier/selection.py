# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's lights, camera and settings, as the runtime's own selection takes them; and which lights it put together."""

import math

import bpy
import numpy as np

from . import handover, scene_lights
from .core import clusters


def settings_of(scene):
    settings = scene.chandelier
    return clusters.Settings(
        filter=settings.filter, distance_scaling=settings.distance_scaling, face_size_px=settings.face_size,
        d_init_m=settings.d_init, z_far_m=settings.z_far, budget_maps=settings.budget_maps, budget_mib=settings.budget_mib)


def camera_of(context, table):
    """Whom the distances are measured from. Where nobody looks, all lights are in view of their own middle."""
    scene = context.scene
    if scene.chandelier.view == "viewport":
        view = viewport_camera(context)
        if view:
            return view
    elif scene.camera and scene.camera.data.type == "PERSP":
        return scene_camera(context, scene.camera)
    return clusters.Camera(eye=tuple(table.position.mean(axis=0).tolist()) if len(table) else (0.0, 0.0, 0.0))


def looking(matrix):
    """Eye, forward and up of a matrix that a camera has in the world."""
    return {"eye": tuple(matrix.translation), "forward": tuple(-matrix.col[2].xyz.normalized()),
            "up": tuple(matrix.col[1].xyz.normalized())}


def scene_camera(context, camera):
    """With the vertical angle that the glTF exporter gives it."""
    render, data = context.scene.render, camera.data
    width, height = render.pixel_aspect_x * render.resolution_x, render.pixel_aspect_y * render.resolution_y
    fits_height = data.sensor_fit == "VERTICAL" or (data.sensor_fit == "AUTO" and height > width)
    yfov = data.angle if fits_height else 2 * math.atan(math.tan(data.angle / 2) * height / width)
    place = camera.evaluated_get(context.evaluated_depsgraph_get()).matrix_world
    return clusters.Camera(**looking(place), yfov_rad=yfov, znear_m=data.clip_start,
                           size_px=(render.resolution_x, render.resolution_y))


def viewport_camera(context):
    """The 3D view that is drawn, else the largest one; None where there is none. One without perspective sees everything."""
    if getattr(context, "region_data", None):
        space, region, view = context.space_data, context.region, context.region_data
    else:
        areas = [area for window in context.window_manager.windows for area in window.screen.areas if area.type == "VIEW_3D"]
        if not areas:
            return None
        area = max(areas, key=lambda area: area.width * area.height)
        space, view = area.spaces.active, area.spaces.active.region_3d
        region = next(region for region in area.regions if region.type == "WINDOW")
    place = looking(view.view_matrix.inverted())
    if not view.is_perspective:
        return clusters.Camera(eye=place["eye"])
    return clusters.Camera(**place, yfov_rad=2 * math.atan(1 / view.window_matrix[1][1]), znear_m=space.clip_start,
                           size_px=(max(region.width, 1), max(region.height, 1)))


def find():
    """What computes selections: a library, else a program. Raises PreviewError."""
    return clusters.find(handover.tool_folders())


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
