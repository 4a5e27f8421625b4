# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's camera and the viewport's, as the runtime's selection takes them."""

import math

from .core import clusters


def camera_of(context, table):
    """The camera from which distances are measured."""
    view = viewport_camera(context) if context.scene.chandelier.view == "viewport" else None
    return view or scene_camera_of(context, table)


def scene_camera_of(context, table):
    """The camera with which the player starts. Without a usable camera, all lights are in view, and distances are from the lights' centre."""
    camera = perspective_camera(context.scene)
    if camera:
        return scene_camera(context, camera)
    return clusters.Camera(eye=tuple(table.position.mean(axis=0).tolist()) if len(table) else (0.0, 0.0, 0.0))


def perspective_camera(scene):
    """The scene's camera, if the player can take it: any object can be one, and not every camera has perspective."""
    camera = scene.camera
    return camera if camera and camera.type == "CAMERA" and camera.data.type == "PERSP" else None


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
                           size_px=(max(1, round(width)), max(1, round(height))))


def view_area(context):
    if context.area and context.area.type == "VIEW_3D":
        return context.area  # whether its view is drawn or its sidebar
    areas = [area for window in context.window_manager.windows for area in window.screen.areas if area.type == "VIEW_3D"]
    return max(areas, key=lambda area: area.width * area.height, default=None)


def viewport_camera(context):
    """The 3D view that is drawn, else the largest one; None where there is none. One without perspective sees everything."""
    area = view_area(context)
    if area is None:
        return None
    space = area.spaces.active
    region, view = next(region for region in area.regions if region.type == "WINDOW"), space.region_3d
    if getattr(context, "region_data", None):  # one of four
        region, view = context.region, context.region_data
    place = looking(view.view_matrix.inverted())
    if not view.is_perspective:
        return clusters.Camera(eye=place["eye"])
    return clusters.Camera(**place, yfov_rad=2 * math.atan(1 / view.window_matrix[1][1]), znear_m=space.clip_start,
                           size_px=(max(region.width, 1), max(region.height, 1)))
