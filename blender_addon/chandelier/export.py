# SPDX-License-Identifier: GPL-3.0-or-later
"""Export through Blender's own glTF exporter, and a check of the file that it wrote."""

import contextlib
import math
import os
import pathlib

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from . import scene_lights, shadows, shape_keys
from .core import gltf_check

WANTED = {
    "export_format": "GLB", "export_lights": True, "export_cameras": True, "export_yup": True, "export_apply": True,
    "export_current_frame": True,  # else lights are written where they are at frame 0
    "use_active_scene": True, "use_renderable": True, "check_existing": False,
    "convert_lighting_mode": "SPEC",  # 3.4's name
    "export_import_convert_lighting_mode": "SPEC",  # the later ones'
}


def export(context, path):
    """Writes a .glb and returns the Check of it. RuntimeError or ValueError say what went wrong."""
    if not hasattr(bpy.types, "EXPORT_SCENE_OT_gltf"):
        raise RuntimeError("the add-on 'glTF 2.0 format' is switched off")
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    written = os.path.splitext(path)[0] + ".writing.glb"  # whatever happens, the older file is whole
    with writing(path):
        pathlib.Path(written).write_bytes(b"")  # the exporter takes many words to say why it cannot
        os.unlink(written)  # else it would pass for what was written now
    unkeyed = put_back(context)
    try:
        with shape_keys.exported_as_seen(context.evaluated_depsgraph_get()) as odd:
            run_exporter(context, path, filepath=written, **{name: value for name, value in WANTED.items() if name in known})
        if not os.path.exists(written):
            raise RuntimeError(f"{path}: the exporter wrote nothing")
        depsgraph = context.evaluated_depsgraph_get()
        check = gltf_check.check(written, scene_lights.read(depsgraph), *shadows.meant(depsgraph))
        check.errors += [f"{name}: was moved without a keyframe, so its animation moved it back, and that place is exported"
                         for name in unkeyed]
        check.errors += [f"{name}: belongs to another file, and the exporter writes its shape keys differently than Blender shows them"
                         for name in odd]
        with writing(path):
            os.replace(written, path)
        return check
    finally:
        pathlib.Path(written).unlink(missing_ok=True)


def put_back(context):
    """Sets the frame anew, as the exporter does, so that it, the file and the check see one scene. The names of lights that were
    elsewhere, as a change without a keyframe lasts until the next frame."""
    scene = context.scene
    before = scene_lights.read(context.evaluated_depsgraph_get())
    scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)
    after = scene_lights.read(context.evaluated_depsgraph_get())
    places = dict(zip(after.names, after.position.tolist()))
    return [name for name, place in zip(before.names, before.position.tolist())
            if math.dist(place, places.get(name, place)) > gltf_check.NEAR_M]


@contextlib.contextmanager
def writing(path):
    try:
        yield
    except OSError as error:
        raise RuntimeError(f"{path}: cannot be written ({error.strerror})") from None


def run_exporter(context, path, **options):
    scene, active = context.scene, context.view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        bpy.ops.export_scene.gltf(**options)
    except RuntimeError as error:
        raise RuntimeError(f"{path}: the glTF exporter failed: {reason(error)}") from None
    finally:
        if active and active.mode != mode:
            bpy.ops.object.mode_set(mode=mode)  # the exporter leaves it
        if (scene.frame_current, scene.frame_subframe) != (frame, subframe):
            scene.frame_set(frame, subframe=subframe)  # where there are animations it ends at their last one


def reason(error):
    """The one line that says something, of the traceback that Blender makes of an operator's exception."""
    lines = [line for line in str(error).splitlines() if line.strip() and not line.startswith((" ", "Location:"))]
    return lines[-1] if lines else "it does not say why"


class CHANDELIER_OT_export(bpy.types.Operator, ExportHelper):
    """Export the scene as .glb with everything that Chandelier knows about its lights, and check the written file"""
    bl_idname = "chandelier.export"
    bl_label = "Export for Chandelier"

    filename_ext = ".glb"
    filter_glob: StringProperty(default="*.glb", options={"HIDDEN"})

    def execute(self, context):
        try:
            check = export(context, self.filepath)
        except (RuntimeError, ValueError, OSError) as error:
            self.report({"ERROR"}, str(error).strip())
            return {"CANCELLED"}
        for line in check.errors:
            self.report({"ERROR"}, line)
        for name in check.extra:
            self.report({"WARNING"}, f"{name}: is in the file, although Blender does not show or render it")
        self.report({"INFO"}, f"{check.lights} lights in {self.filepath}")
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((CHANDELIER_OT_export,))
