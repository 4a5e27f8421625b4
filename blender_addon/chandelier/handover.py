# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake and Play: export, chandelier-bake in the background, then chandelier-play, which shows each new pack by itself."""

import os
import pathlib

import bpy
from bpy.props import BoolProperty

from . import export, surprises_ui
from .cameras import perspective_camera
from .core import tools
from .preferences import tool_folders

POLL_S = 0.1


class Handover:
    """The running programs and their results. A plain class, since Blender's own types cannot hold a process; nothing is saved."""

    def __init__(self):
        self.bake, self.player, self.play_command = None, None, []
        self.play_after = False
        self.error, self.notes = "", []  # what the panel shows
        self.done = ""

    @property
    def status(self):
        if self.bake is None:
            return ""
        return f"Baking {self.bake.doing.replace('_', ' ')} {self.bake.progress:.0%}" if self.bake.doing else "Baking"

    def start(self, context, play_after=False):
        """Exports and starts the bake. False if that fails: `error` says why."""
        self.stop()
        self.error, self.notes, self.done, self.play_after = "", [], "", play_after
        surprises_ui.find(context)
        pack = pack_path(context.scene)
        try:
            program = tools.find("chandelier-bake", tool_folders())
            check = export.export(context, str(pack) + ".glb")
            self.notes = [*check.errors, *(f"{name}: is in the pack, although Blender does not show or render it" for name in check.extra)]
            cache = pathlib.Path(bpy.app.tempdir) / "chandelier-cache"
            self.bake = tools.Job(tools.bake_command(program, str(pack) + ".glb", pack, cache))
        except (tools.ToolError, RuntimeError, ValueError, OSError) as error:
            self.error = str(error).strip()
            return False
        self.play_command = play_command(context.scene)  # for a player that is open too
        return True

    def poll(self):
        """Collects the results of programs that have ended. True while one is still running."""
        if self.bake and not self.bake.is_running():
            job, self.bake = self.bake, None
            self.error = job.error
            self.notes += job.warnings
            if not job.error:
                self.done = "Baked"
                if self.play_after or self.player:
                    self.play(self.play_command, anew=False)
        elif self.player:
            has_ended = not self.player.is_running()
            self._take_warnings()
            if has_ended:
                self.error, self.player = self.player.error or self.error, None
        return self.bake is not None or self.player is not None

    def _take_warnings(self):
        """Adds the player's new warnings to the notes."""
        said, self.player.warnings = self.player.warnings, []
        self.notes += [note for note in dict.fromkeys(said) if note not in self.notes]

    def play(self, command, anew=True):
        """Starts the player. An open player with the same command stays: it shows a replaced pack by itself."""
        try:
            command = [tools.find("chandelier-play", tool_folders()), *command]
            if self.player and self.player.command == command and not anew and self.player.is_running():
                return
            self.close_player()
            self.player = tools.Job(command)
        except tools.ToolError as error:
            self.error = str(error)

    def stop(self):
        """Ends the bake; the older pack stays as it was."""
        if self.bake:
            self.bake.cancel()
            self.error, self.bake = self.bake.error, None

    def end(self):
        """Of the bake and the player."""
        self.stop()
        self.close_player()

    def close_player(self):
        if self.player:
            self.player.cancel()
        self.player = None


# One object for timers, handlers, panels and operators, which Blender creates again for each call.
handover = Handover()


def pack_path(scene):
    if scene.chandelier.pack_path:
        return pathlib.Path(bpy.path.abspath(scene.chandelier.pack_path))
    if bpy.data.filepath:
        return pathlib.Path(bpy.data.filepath).with_suffix(".chandelier")
    return pathlib.Path(bpy.app.tempdir) / "untitled.chandelier"


def play_command(scene):
    """Arguments only: the program is searched for when it starts."""
    settings, camera = scene.chandelier, perspective_camera(scene)
    names = tools.Shown.__dataclass_fields__.keys() - {"camera"}
    shown = tools.Shown(camera=camera.name if camera else "", **{name: getattr(settings, name) for name in names})
    return tools.play_command("", pack_path(scene), shown)[1:]


def tick():
    """Blender's timer: returns the seconds to the next call, or None to stop."""
    running = handover.poll()
    show_status()
    return POLL_S if running else None


def watch():
    if not bpy.app.background and not bpy.app.timers.is_registered(tick):
        bpy.app.timers.register(tick, first_interval=POLL_S, persistent=True)


def wait():
    """Waits until the bake has ended. Without windows Blender runs no timers."""
    while handover.bake:
        handover.bake.process.wait()
        handover.poll()


def draw_status(header, context):
    header.layout.label(text=f"Chandelier: {handover.status}", icon="LIGHT")
    header.layout.operator("chandelier.cancel", text="Cancel", icon="CANCEL")


def show_status():
    """In the status bar while a bake runs, and in the panels of all windows."""
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(draw_status if handover.bake else None)
        for area in window.screen.areas:
            if area.type in ("VIEW_3D", "PROPERTIES"):
                area.tag_redraw()


def bake(operator, context, play):
    """For an operator. In a window it returns at once, and the timer does the rest."""
    if handover.start(context, play):
        watch()
        if bpy.app.background:
            wait()
    if handover.error:
        operator.report({"ERROR"}, handover.error)
        return {"CANCELLED"}
    operator.report({"INFO"}, f"{'baked' if handover.done else 'baking'} {pack_path(context.scene)}")
    return {"FINISHED"}


class CHANDELIER_OT_bake(bpy.types.Operator):
    """Export the scene and bake its pack"""
    bl_idname = "chandelier.bake"
    bl_label = "Bake"

    play: BoolProperty(name="Play", description="Show the pack when it is baked", default=False, options={"SKIP_SAVE"})

    def execute(self, context):
        return bake(self, context, self.play)


class CHANDELIER_OT_play(bpy.types.Operator):
    """Show the pack in chandelier-play; without one, bake it first"""
    bl_idname = "chandelier.play"
    bl_label = "Play"

    def execute(self, context):
        if not os.path.exists(pack_path(context.scene)):
            return bake(self, context, play=True)
        handover.error = ""
        handover.play(play_command(context.scene))
        if handover.error:
            self.report({"ERROR"}, handover.error)
            return {"CANCELLED"}
        watch()
        return {"FINISHED"}


class CHANDELIER_OT_cancel(bpy.types.Operator):
    """Stop the bake; the older pack stays as it was"""
    bl_idname = "chandelier.cancel"
    bl_label = "Cancel Bake"

    @classmethod
    def poll(cls, context):
        return handover.bake is not None

    def execute(self, context):
        handover.stop()
        show_status()
        return {"FINISHED"}


@bpy.app.handlers.persistent
def bake_on_save(*_):
    context = bpy.context
    if context.scene.chandelier.bake_on_save and handover.start(context):
        watch()
        if bpy.app.background:
            wait()


CLASSES = (CHANDELIER_OT_bake, CHANDELIER_OT_play, CHANDELIER_OT_cancel)
register_classes, unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def register():
    register_classes()
    bpy.app.handlers.save_post.append(bake_on_save)


def unregister():
    handover.end()
    show_status()
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
    bpy.app.handlers.save_post.remove(bake_on_save)
    unregister_classes()
