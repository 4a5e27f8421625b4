# SPDX-License-Identifier: Apache-2.0
"""What window_test.py lets Blender do in a window: one step after another, so that Blender draws between them. Each thing
that was seen is a line on stdout."""

import pathlib
import re
import subprocess
import sys
import time
import traceback

import bpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from blender_case import ADDON, enable_addon, part  # noqa: E402

FOLDER, BIN = map(pathlib.Path, sys.argv[sys.argv.index("--") + 1:])
STEP_S = 0.3
TAB_BELOW_TOP_PX = 180  # the Chandelier tab in 3.4's sidebar


def area_of(kind):
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == kind)


def screenshot(name):
    subprocess.run(["import", "-window", "root", FOLDER / f"{name}.png"], check=True)


def make_scene():
    bpy.context.preferences.addons[ADDON].preferences.tools_folder = str(BIN)
    cube = bpy.data.objects["Cube"]
    bpy.context.view_layer.objects.active = cube
    cube.select_set(True)
    bpy.ops.chandelier.place_around(count=8, distance=1)
    area = bpy.data.objects.new("Panel light", bpy.data.lights.new("Panel light", "AREA"))
    area.location = (2, 2, 3)
    bpy.context.scene.collection.objects.link(area)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "hall.blend"))
    area_of("PROPERTIES").spaces.active.context = "DATA"
    area_of("VIEW_3D").spaces.active.show_region_ui = True


drawn = []


def press_escape():
    for value in ("PRESS", "RELEASE"):
        bpy.context.window_manager.windows[0].event_simulate(type="ESC", value=value)


def tab_is_open():
    """Clicks on it until its panels are drawn: Python cannot choose a tab in 3.4."""
    if drawn:
        return True
    region = next(region for region in area_of("VIEW_3D").regions if region.type == "UI")
    if bpy.app.version >= (4, 2):
        region.active_panel_category = "Chandelier"
        region.tag_redraw()
        return False
    x, y = region.x + region.width - 10, region.y + region.height - TAB_BELOW_TOP_PX
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        bpy.context.window_manager.windows[0].event_simulate(type=kind, value=value, x=x, y=y)
    return False


def show_redo(operator, **values):
    """The operator as from a button, and its redo panel as from F9."""
    area = area_of("VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region):
        getattr(bpy.ops.chandelier, operator)("EXEC_DEFAULT", True, **values)
        bpy.ops.screen.redo_last("INVOKE_DEFAULT")


def bake():
    bpy.ops.chandelier.bake(play=True)
    print("seen: baking", handover().bake is not None)


def handover():
    return part("handover").handover


def wait_for(condition, what, patience_s=60):
    """A step that is done again until it is so."""
    start = []

    def step():
        start.append(time.monotonic())
        if start[-1] - start[0] > patience_s:
            raise AssertionError(f"waited in vain for {what}")
        if not condition():
            return False
        print("seen:", what)
        return True
    return step


first_player, lights = [], []


def lights_shown():
    """As the player's title has it; 0 before there is one."""
    windows = subprocess.run(["xwininfo", "-root", "-tree"], check=True, capture_output=True, text=True).stdout
    title = re.search(r'"hall\.chandelier.*?, (\d+) lights,', windows)
    return int(title[1]) if title else 0


def take_a_light_away():
    first_player.append(handover().player)
    bpy.context.scene.chandelier.bake_on_save = True
    bpy.data.objects.remove(bpy.data.objects["Cube Light"])
    bpy.ops.wm.save_mainfile()


def close_player():
    handover().player.cancel()


def fail_bake():
    bpy.context.preferences.addons[ADDON].preferences.tools_folder = str(BIN)
    pack = FOLDER / "folder.chandelier"
    pack.mkdir()
    bpy.context.scene.chandelier.pack_path = str(pack)
    bpy.ops.chandelier.bake()


def slow_bake():
    bpy.context.preferences.addons[ADDON].preferences.tools_folder = str(FOLDER / "slow")
    bpy.context.scene.chandelier.pack_path = ""
    bpy.ops.chandelier.bake()


STEPS = [
    make_scene, lambda: None, wait_for(tab_is_open, "the tab"), lambda: screenshot("panel"),
    lambda: show_redo("edit_lights", use_power=True, factor=1), lambda: None, lambda: screenshot("redo_edit"), press_escape,
    lambda: bpy.data.objects["Cube"].select_set(True),
    lambda: show_redo("scatter", count=3), lambda: None, lambda: screenshot("redo_place"), press_escape, bake,
    wait_for(lambda: handover().done == "Baked", "baked"), wait_for(lambda: handover().player is not None, "player"),
    wait_for(lambda: lights_shown() > 1, "its lights"), lambda: lights.append(lights_shown()), take_a_light_away,
    wait_for(lambda: lights_shown() == lights[0] - 1, "a light less after saving"),
    wait_for(lambda: first_player == [handover().player], "the same player"), close_player,
    wait_for(lambda: handover().player is None, "player closed"), fail_bake,
    wait_for(lambda: "the output is a folder" in handover().error, "error"), lambda: None, lambda: screenshot("error"), slow_bake,
    wait_for(lambda: handover().bake and handover().bake.passed == 1, "progress"), lambda: None,
    lambda: screenshot("progress"), lambda: bpy.ops.chandelier.cancel(),
    wait_for(lambda: handover().bake is None and "cancelled" in handover().error, "cancelled"), lambda: print("seen: the end"),
    lambda: bpy.ops.wm.quit_blender()]
waiting = iter(STEPS)
current = [next(waiting)]


def run():
    try:
        if current[0]() is not False:
            current[0] = next(waiting)
        return STEP_S
    except StopIteration:
        return None
    except Exception:
        traceback.print_exc()
        bpy.ops.wm.quit_blender()


bpy.context.preferences.view.show_splash = False
enable_addon()
part("panels").CHANDELIER_PT_handover.append(lambda *_: drawn.append(True))
bpy.app.timers.register(run, first_interval=1.5)
