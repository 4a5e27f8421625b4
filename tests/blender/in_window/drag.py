# SPDX-License-Identifier: Apache-2.0
"""Inside a Blender with a window: two rings of lamps, of which one is dragged away by mouse. Pictures and what the preview
says go into the folder in CHANDELIER_SHOTS."""

import json
import math
import os
import pathlib
import subprocess
import sys
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.dirname(__file__)) + "/in_blender")
import blender_case  # noqa: E402

SHOTS = pathlib.Path(os.environ["CHANDELIER_SHOTS"])
DRAG_STEPS = 12
log = []


def make_scene():
    scene = bpy.context.scene
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    bpy.ops.mesh.primitive_plane_add(size=12)
    for ring in range(2):
        for number in range(8):
            angle = number * math.pi / 4
            data = bpy.data.lights.new(f"Ring {ring} lamp {number}", "POINT")
            data.energy, data.use_custom_distance, data.cutoff_distance = 20, True, 3
            lamp = bpy.data.objects.new(data.name, data)
            lamp.location = (5 * ring - 2.5 + 0.3 * math.cos(angle), 0.3 * math.sin(angle), 1.5)
            scene.collection.objects.link(lamp)
    scene.chandelier.view = "viewport"
    scene.chandelier.d_init, scene.chandelier.distance_scaling = 1.0, "none"
    scene.chandelier_overlay.show = True
    scene.chandelier_overlay.d_min = True


def view_3d():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return window, area, next(region for region in area.regions if region.type == "WINDOW")


def look():
    window, area, region = view_3d()
    view = area.spaces.active.region_3d
    view.view_rotation = (0.87, 0.49, 0.0, 0.0)
    view.view_location, view.view_distance = (0, 0, 0.8), 9
    area.spaces.active.overlay.show_floor = False
    area.tag_redraw()


def select_one():
    for thing in bpy.context.selected_objects:
        thing.select_set(False)
    lamp = bpy.data.objects["Ring 1 lamp 0"]
    bpy.context.view_layer.objects.active = lamp
    lamp.select_set(True)
    bpy.ops.ed.undo_push(message="Made")


def note(name):
    preview = blender_case.part("preview").PREVIEW
    selection = preview.selection
    log.append({"name": name, "maps": int(selection.bill.shadow_maps), "lights": int(selection.bill.lights),
                "over_budget": int(selection.over_budget.sum()), "update_ms": preview.update_ms,
                "place": list(bpy.data.objects["Ring 1 lamp 0"].location)})


def shoot(name):
    note(name)
    subprocess.run(["import", "-window", "root", str(SHOTS / f"{name}.png")], check=True)


def event(kind, value, step=0):
    window, area, region = view_3d()
    x, y = region.x + region.width // 2 + 14 * step, region.y + region.height // 2 + 12 * step
    window.event_simulate(type=kind, value=value, x=x, y=y)


def drag_steps():
    yield lambda: event("MOUSEMOVE", "NOTHING")
    yield lambda: event("G", "PRESS")
    yield lambda: event("G", "RELEASE")
    for step in range(1, DRAG_STEPS + 1):
        yield lambda step=step: event("MOUSEMOVE", "NOTHING", step)
        yield lambda step=step: note(f"drag {step}")
    yield lambda: shoot("dragging")
    yield lambda: event("LEFTMOUSE", "PRESS", DRAG_STEPS)
    yield lambda: event("LEFTMOUSE", "RELEASE", DRAG_STEPS)


def set_budget():
    bpy.context.scene.chandelier.budget_maps = 1


def history(step):
    window, area, region = view_3d()
    with bpy.context.temp_override(window=window, area=area, region=region):
        getattr(bpy.ops.ed, step)()


def history_steps():
    """What is drawn after each is of as many lights and maps, read anew, as something drawn before."""
    for number in range(2):
        for step in ("undo", "redo"):
            yield lambda step=step: history(step)
            yield lambda: None
            yield lambda name=f"{step} {number}": shoot(name)


def steps():
    yield make_scene
    yield look
    yield select_one
    yield lambda: None
    yield lambda: shoot("before")
    yield from drag_steps()
    yield lambda: shoot("after")
    yield from history_steps()
    yield set_budget
    yield lambda: None
    yield lambda: shoot("over_budget")
    yield lambda: (SHOTS / "log.json").write_text(json.dumps(log))


def run(remaining):
    try:
        step = next(remaining, None)
        if step is None:
            bpy.ops.wm.quit_blender()
            return None
        step()
        return 0.3
    except Exception:
        traceback.print_exc()
        os._exit(3)


bpy.context.preferences.view.show_splash = False
blender_case.enable_addon()
todo = steps()
bpy.app.timers.register(lambda: run(todo), first_interval=1.0)
