# SPDX-License-Identifier: Apache-2.0
"""Inside a Blender with a window: starts each operator that has something to adjust, and turns the mouse wheel twice over a value in
its redo panel (Adjust Last Operation). What the lights are after each step goes into log.json in the folder in CHANDELIER_SHOTS."""

import json
import os
import pathlib
import subprocess
import sys
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + "/in_blender")
import blender_case  # noqa: E402

SHOTS = pathlib.Path(os.environ["CHANDELIER_SHOTS"])
STEP_S = 0.1
HEADER_PX, FIRST_ROW_PX, ROW_PX = 12, 44, 23  # from the panel's upper edge, and from row to row
AWAY = (8, 0, 1)  # from the origin, where lights come out that take an object's place before it is known again
OPEN_PX = 30  # a panel that is less high is closed
log = {}


def window():
    return bpy.context.window_manager.windows[0]


def region(kind):
    area = next(area for area in window().screen.areas if area.type == "VIEW_3D")
    return area, next(region for region in area.regions if region.type == kind)


def start(operator, values):
    """As from a button."""
    area, where = region("WINDOW")
    with bpy.context.temp_override(window=window(), area=area, region=where):
        getattr(bpy.ops.chandelier, operator)("EXEC_DEFAULT", True, **values)


def mouse(kind, value, across, below, **keys):
    """At so much of the panel's width and so many pixels below its upper edge."""
    _, panel = region("HUD")
    window().event_simulate(type=kind, value=value, x=panel.x + int(panel.width * across), y=panel.y + panel.height - below, **keys)


def turn_wheel(row, across):
    where = across, FIRST_ROW_PX + row * ROW_PX
    mouse("MOUSEMOVE", "NOTHING", *where)
    mouse("WHEELUPMOUSE", "PRESS", *where, ctrl=True)


def note(name, step):
    lights = [thing for thing in bpy.context.scene.objects if thing.type == "LIGHT"]
    panel = region("HUD")[1]
    log.setdefault(name, {})[step] = {
        "lights": len(lights), "selected": len(bpy.context.selected_objects), "panel_px": panel.height,
        "places": sorted(tuple(round(part, 4) for part in light.location) for light in lights),
        "kinds": sorted(light.data.type for light in lights), "watts": [light.data.energy for light in lights],
        "ranges": [light.data.cutoff_distance for light in lights]}


def clear():
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)


def make_curve():
    bpy.ops.curve.primitive_bezier_circle_add(radius=2, location=AWAY)


def make_cube():
    bpy.ops.mesh.primitive_cube_add(size=2, location=AWAY)
    for corner in bpy.context.object.data.vertices:
        corner.co.z += 0.5  # its middle is above its origin


def make_light(kind):
    bpy.ops.object.light_add(type=kind, location=(0, 0, 2))
    bpy.context.object.data.energy = 100
    bpy.ops.chandelier.find_surprises()


def make_lamp():
    make_light("POINT")


def make_area():
    make_light("AREA")


MIDDLE, RIGHT = 0.75, 0.9  # of the panel's width
CASES = (  # operator, its values, what there is before, the row in which something is changed, and where
    ("place_along_curve", {"count": 8}, make_curve, 1, MIDDLE),
    ("place_around", {"count": 8}, make_cube, 1, MIDDLE),
    ("place_on_mesh", {"count": 3, "spacing": 0}, make_cube, 2, MIDDLE),
    ("scatter", {"count": 5, "spacing": 0}, make_cube, 1, MIDDLE),
    ("place_at_selected", {}, make_cube, 0, MIDDLE),
    ("edit_lights", {"use_power": True, "factor": 2}, make_lamp, 0, RIGHT),
    ("strength", {"factor": 2}, make_lamp, 0, MIDDLE),
    ("set_range", {"rule": "no_range"}, make_lamp, 0, MIDDLE),
    ("convert_area", {"rule": "area", "kind": "SPOT"}, make_area, 0, MIDDLE),
)


def adjustable():
    """Names of the add-on's operators whose redo panel has something to adjust."""
    kinds = {name: getattr(bpy.ops.chandelier, name).get_rna_type() for name in dir(bpy.ops.chandelier)}
    flags = {name: getattr(getattr(bpy.types, kind.identifier), "bl_options", set()) for name, kind in kinds.items()}
    return sorted(name for name, kind in kinds.items() if {"REGISTER", "UNDO"} <= flags[name]
                  and any(not field.is_hidden for field in kind.properties if field.identifier != "rna_type"))


def history(step):
    area, where = region("WINDOW")
    with bpy.context.temp_override(window=window(), area=area, region=where):
        getattr(bpy.ops.ed, step)()


def open_panel():
    """A click on its header, unless it is open from the one before."""
    if region("HUD")[1].height < OPEN_PX:
        for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
            mouse(kind, value, 0.3, HEADER_PX)


def case_steps(operator, values, make, row, across):
    yield clear
    yield make
    yield lambda: bpy.ops.ed.undo_push(message="Made")
    yield lambda: start(operator, values)
    yield lambda: None
    yield open_panel
    yield lambda: None
    yield lambda: note(operator, "made")
    for step in ("adjusted", "again"):
        yield lambda: turn_wheel(row, across)
        yield lambda: None
        yield lambda step=step: note(operator, step)
    yield lambda: subprocess.run(["import", "-window", "root", str(SHOTS / f"{operator}.png")], check=True)
    yield lambda: history("undo")
    yield lambda: note(operator, "undone")


def steps():
    for case in CASES:
        yield from case_steps(*case)
    yield lambda: (SHOTS / "log.json").write_text(json.dumps({"adjustable": adjustable(), "cases": log}))


def run(remaining):
    try:
        step = next(remaining, None)
        if step is None:
            bpy.ops.wm.quit_blender()
            return None
        step()
        return STEP_S
    except Exception:
        traceback.print_exc()
        os._exit(3)


bpy.context.preferences.view.show_splash = False
blender_case.enable_addon()
remaining_steps = steps()
bpy.app.timers.register(lambda: run(remaining_steps), first_interval=1.0)
