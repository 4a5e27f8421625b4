# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' picture of the scene's camera, direct light only, beside Chandelier's, with the error of each pixel."""

import contextlib
import pathlib
import subprocess

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, IntProperty

from . import export, handover, scene_lights
from .cameras import perspective_camera
from .core import photometry, picture_error, tools
from .preferences import tool_folders

SHEET = "Chandelier against Cycles"
DIRECT_ONLY = {"max_bounces": 0, "use_denoising": False, "use_adaptive_sampling": False, "film_exposure": 1.0,
               "sample_clamp_direct": 0.0, "light_sampling_threshold": 0.0}  # the last leaves weak light to chance


@contextlib.contextmanager
def changed(*changes):
    """Sets (owner, values) pairs, and restores them afterwards. Skips what an owner does not have."""
    before = []
    try:
        for owner, values in changes:
            for name, value in values.items():
                if hasattr(owner, name):
                    before.append((owner, name, getattr(owner, name)))
                    setattr(owner, name, value)
        yield
    finally:
        for owner, name, value in reversed(before):
            setattr(owner, name, value)


def cycles_picture(scene, path, samples, size, **cycles):
    """Linear, as Cycles has it: a watt is a watt. World and compositor are left out; writes an .exr."""
    render, image = scene.render, scene.render.image_settings
    changes = [(render, {"engine": "CYCLES", "filepath": str(path), "resolution_x": size[0], "resolution_y": size[1],
                         "resolution_percentage": 100, "use_compositing": False, "use_sequencer": False, "use_border": False,
                         "film_transparent": False, "use_file_extension": False}),
               (image, {"file_format": "OPEN_EXR", "color_mode": "RGB", "color_depth": "32"}), (scene, {"world": None})]
    changes += [(light.cycles, {"cast_shadow": scene_lights.casts_shadow(light)}) for light in bpy.data.lights if hasattr(light, "cycles")]
    with changed(*changes):  # Cycles has its settings once it is the engine
        with changed((scene.cycles, {**DIRECT_ONLY, "samples": samples, **cycles})):
            bpy.ops.render.render(write_still=True, scene=scene.name)
    return read_exr(path)


def read_exr(path):
    image = bpy.data.images.load(str(path), check_existing=False)
    try:
        width, height = image.size
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(height, width, image.channels)[::-1, :, :3].copy()
    finally:
        bpy.data.images.remove(image)


def tool(name):
    return tools.find(name, tool_folders())


def chandelier_picture(scene, pack, path, size, preset, *options):
    """The same in Cycles' units; writes a .pfm. ToolError says in one line why there is none."""
    command = [tool("chandelier-play"), str(pack), "--output", str(path), "--camera", scene.camera.name, "--size",
               f"{size[0]}x{size[1]}", "--preset", preset, "--exposure", "0", "--headlight", "off", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise tools.ToolError(next(reversed(done.stderr.strip().splitlines()), "chandelier-play failed"))
    return picture_error.read_pfm(path) / photometry.LUMENS_PER_WATT


def bake_now(context, folder):
    """A pack of the scene as it is, made while one waits."""
    glb, pack = folder / "compared.glb", folder / "compared.chandelier"
    export.export(context, str(glb))
    job = tools.Job(tools.bake_command(tool("chandelier-bake"), glb, pack))
    job.process.wait()
    job.is_running()
    if job.error:
        raise tools.ToolError(job.error)
    return pack


def show(sheet):
    """In Blender's images, and in an image editor where one is open."""
    old = bpy.data.images.get(SHEET)
    if old:
        bpy.data.images.remove(old)
    height, width = sheet.shape[:2]
    image = bpy.data.images.new(SHEET, width, height, float_buffer=False)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = sheet[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
    return image


class CHANDELIER_OT_compare(bpy.types.Operator):
    """Render the scene's camera with Cycles, direct light only, and with Chandelier, and show both and where they differ. Cycles has
    no range, so Chandelier is darker where lights end"""
    bl_idname = "chandelier.compare"
    bl_label = "Compare with Cycles"
    bl_options = {"REGISTER"}

    samples: IntProperty(name="Samples", description="Samples of Cycles per pixel", default=128, min=2, soft_max=4096)
    scale: FloatProperty(name="Size", description="Part of the render resolution", default=50, min=1, max=100, subtype="PERCENTAGE")
    preset: EnumProperty(name="Preset", default="lightcluster", items=(
        ("lightcluster", "Light Clusters", "With the scene's shadow settings"),
        ("truth", "Rays", "Shadows by rays to each light; the remaining difference does not come from shadow maps"),
        ("reference", "Reference", "A hard shadow map for each light")))

    @classmethod
    def poll(cls, context):
        return perspective_camera(context.scene) is not None

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        scene = context.scene
        render = scene.render
        size = [max(16, round(side * self.scale / 100)) for side in (render.resolution_x, render.resolution_y)]
        folder = pathlib.Path(bpy.app.tempdir)
        shown = handover.play_command(scene)[1:] if self.preset == "lightcluster" else []
        if not hasattr(scene, "cycles"):
            self.report({"ERROR"}, "the add-on 'Cycles Render Engine' is switched off")
            return {"CANCELLED"}
        try:
            pack = bake_now(context, folder)
            ours = chandelier_picture(scene, pack, folder / "compared.pfm", size, self.preset, *without(shown, "--preset", "--camera"))
            halves = [cycles_picture(scene, folder / "compared.exr", (self.samples + seed) // 2, size, seed=seed) for seed in (0, 1)]
        except (tools.ToolError, RuntimeError, ValueError, OSError) as error:
            self.report({"ERROR"}, str(error).strip())
            return {"CANCELLED"}
        cycles, noise = picture_error.mean_and_noise(*halves)
        show(picture_error.sheet(cycles, ours))
        error = picture_error.error_of(cycles, ours).line()
        self.report({"INFO"}, f"Against Cycles: {error}; {100 * noise:.1f} % is Cycles' noise; see the image '{SHEET}'")
        return {"FINISHED"}


def without(options, *names):
    """A list of options and their values, less some of them."""
    pairs = zip(options[::2], options[1::2])
    return [word for pair in pairs if pair[0] not in names for word in pair]


register, unregister = bpy.utils.register_classes_factory((CHANDELIER_OT_compare,))
