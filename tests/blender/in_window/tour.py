# SPDX-License-Identifier: Apache-2.0
"""Inside a Blender with a window: from an empty scene to a played pack, one picture for each of the README's ten steps, into
the folder in CHANDELIER_SHOTS. CHANDELIER_BIN has the programs."""

import math
import os
import pathlib
import subprocess
import sys
import time
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + "/in_blender")
import blender_case  # noqa: E402

SHOTS, BIN = pathlib.Path(os.environ["CHANDELIER_SHOTS"]), pathlib.Path(os.environ["CHANDELIER_BIN"])
PATIENCE_S = 180
TAB_BELOW_TOP_PX = 180  # the Chandelier tab in 3.4's sidebar
COLUMNS = [(x, y) for x in (-4.5, -1.5, 1.5, 4.5) for y in (-2.2, 2.2)]


def window():
    return bpy.context.window_manager.windows[0]


def area_of(kind):
    return next(area for area in window().screen.areas if area.type == kind)


def in_view(action):
    area = area_of("VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window(), area=area, region=region):
        return action()


def shoot(name, crop=""):
    crop = ["-crop", f"{crop}+0+0"] if crop else []
    subprocess.run(["import", "-window", "root", *crop, str(SHOTS / f"{name}.png")], check=True)


def material(name, colour):
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*colour, 1)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = 0.8
    return made


def coloured(made):
    bpy.context.object.data.materials.append(made)


def build_hall():
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    stone, brick = material("Stone", (0.55, 0.52, 0.46)), material("Brick", (0.45, 0.2, 0.13))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, -0.1), scale=(14, 8, 0.2))
    coloured(stone)
    for y in (-4, 4):
        bpy.ops.mesh.primitive_cube_add(size=1, location=(0, y, 2), scale=(14, 0.2, 4))
        coloured(brick)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(7, 0, 2), scale=(0.2, 8, 4))
    coloured(brick)
    for number, (x, y) in enumerate(COLUMNS):
        bpy.ops.mesh.primitive_cylinder_add(radius=0.28, depth=4, location=(x, y, 2))
        bpy.context.object.name = f"Column {number}"
        bpy.ops.object.shade_smooth(use_auto_smooth=True)
        coloured(stone)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.75), scale=(4, 1, 0.08))
    coloured(brick)
    for x in (-1.7, 1.7):
        bpy.ops.mesh.primitive_cube_add(size=1, location=(x, 0, 0.36), scale=(0.12, 0.8, 0.7))
        coloured(brick)
    bpy.ops.curve.primitive_bezier_circle_add(radius=1, location=(0, 0, 2.6), scale=(2, 0.7, 1))
    bpy.context.object.name = "Ring of candles"
    camera = bpy.data.objects.new("Hall", bpy.data.cameras.new("Hall"))
    camera.location, camera.rotation_euler = (-8.2, 0, 1.9), (math.radians(86), 0, math.radians(-90))
    camera.data.lens = 24
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 960, 540
    bpy.context.scene.world = None


def look():
    bpy.context.preferences.addons[blender_case.ADDON].preferences.tools_folder = str(BIN)
    bpy.ops.wm.save_as_mainfile(filepath=str(SHOTS / "hall.blend"))
    space = area_of("VIEW_3D").spaces.active
    space.show_region_ui = True
    space.shading.color_type = "MATERIAL"
    space.overlay.show_floor = space.overlay.show_axis_x = space.overlay.show_axis_y = space.overlay.show_cursor = False
    space.region_3d.view_rotation = (0.78, 0.36, -0.2, -0.46)
    space.region_3d.view_location, space.region_3d.view_distance = (0.4, 0.3, 0.9), 15
    area_of("PROPERTIES").spaces.active.context = "SCENE"


drawn = []


def tab_is_open():
    """Clicks on it until its panels are drawn: Python cannot choose a tab in 3.4."""
    if drawn:
        return True
    region = next(region for region in area_of("VIEW_3D").regions if region.type == "UI")
    x, y = region.x + region.width - 10, region.y + region.height - TAB_BELOW_TOP_PX
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        window().event_simulate(type=kind, value=value, x=x, y=y)
    return False


def select(prefix):
    for thing in bpy.data.objects:
        thing.select_set(thing.name.startswith(prefix))
        if thing.select_get():
            bpy.context.view_layer.objects.active = thing


def around_columns():
    select("Column")
    in_view(lambda: bpy.ops.chandelier.place_around(
        "EXEC_DEFAULT", True, count=8, distance=0.2, height=2.2, power=6, temperature=2600, range=14))


def along_curve():
    select("Ring of candles")
    in_view(lambda: bpy.ops.chandelier.place_along_curve(
        "EXEC_DEFAULT", True, count=16, power=8, temperature=3200, range=14))


def overlay(**values):
    for name, value in values.items():
        setattr(bpy.context.scene.chandelier_overlay, name, value)


def settings(**values):
    for name, value in values.items():
        setattr(bpy.context.scene.chandelier, name, value)


def add_surprises():
    panel = bpy.data.objects.new("Panel", bpy.data.lights.new("Panel", "AREA"))
    panel.location = (0, 0, 3.9)
    bpy.context.scene.collection.objects.link(panel)
    lost = bpy.data.objects.new("Lamp in the table", bpy.data.lights.new("Lamp", "POINT"))
    lost.location = (0, 0, 0.75)
    bpy.context.scene.collection.objects.link(lost)
    bpy.ops.chandelier.find_surprises()


def remove_surprises():
    for name in ("Panel", "Lamp in the table"):
        bpy.data.objects.remove(bpy.data.objects[name])
    bpy.ops.chandelier.find_surprises()


def handover():
    return blender_case.part("handover").handover


def shoot_bake():
    """Before Blender's own loop goes on, which would find this small bake ended."""
    bpy.ops.chandelier.bake()
    while handover().bake and not handover().bake.passed:
        handover().poll()
    blender_case.part("handover").show_status()
    in_view(lambda: bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1))
    shoot("08_bake")


def wait_for(condition):
    begin = []

    def step():
        begin.append(time.monotonic())
        assert begin[-1] - begin[0] < PATIENCE_S, "waited in vain"
        return None if condition() else False
    return step


def pause(seconds):
    begin = []

    def step():
        begin.append(time.monotonic())
        return None if begin[-1] - begin[0] >= seconds else False
    return step


def compare():
    settings(budget_maps=0)
    in_view(lambda: bpy.ops.chandelier.compare("EXEC_DEFAULT", samples=256, scale=40))
    image = bpy.data.images["Chandelier against Cycles"]
    image.filepath_raw, image.file_format = str(SHOTS / "10_cycles.png"), "PNG"
    image.save()


STEPS = [
    build_hall, look, lambda: None, wait_for(tab_is_open), lambda: None, lambda: shoot("01_scene"),
    around_columns, lambda: None, lambda: shoot("02_around"),
    along_curve, lambda: None, lambda: shoot("03_along"),
    lambda: overlay(show=True, ranges=False), lambda: settings(d_init=0.5), lambda: select("nothing"), lambda: shoot("04_clusters"),
    lambda: settings(d_init=0.8), lambda: overlay(d_min=True), lambda: shoot("05_distance"),
    lambda: settings(budget_maps=6), lambda: overlay(d_min=False), lambda: shoot("06_budget"),
    lambda: settings(budget_maps=0), add_surprises, lambda: None, lambda: shoot("07_surprises"), remove_surprises,
    shoot_bake, wait_for(lambda: handover().bake is None),
    lambda: bpy.ops.chandelier.play(), pause(15), lambda: shoot("09_play", "1280x720"), lambda: handover().player and handover().player.cancel(),
    compare, lambda: bpy.ops.wm.quit_blender()]
waiting = iter(STEPS)
current = [next(waiting)]


def run():
    try:
        if current[0]() is not False:
            current[0] = next(waiting, None)
        return 0.5 if current[0] else None
    except Exception:
        traceback.print_exc()
        os._exit(3)


bpy.context.preferences.view.show_splash = False
blender_case.enable_addon()
blender_case.part("panels").CHANDELIER_PT_handover.append(lambda *_: drawn.append(True))
bpy.app.timers.register(run, first_interval=1.0)
