# SPDX-License-Identifier: GPL-3.0-or-later
"""The selection of shadow maps of the present scene, computed again only when something changed."""

import time

import bpy

from . import cameras, preferences, scene_lights, selection
from .core import bill, clusters


class Preview:
    """Reads the lights and selects lazily: handlers only note that something may have changed."""

    def __init__(self):
        self.engine, self.folders, self.error = None, None, ""
        self.version = 0  # grows with every new selection, and never comes again
        self.forget()

    def forget(self):
        """Call after undo, redo and loading, when Blender's pointers are no longer valid."""
        self.reader, self.table, self.selection, self.asked = scene_lights.LightReader(), None, None, None
        self.place = None  # the scene and view layer that all this is of
        self.is_stale = True  # the table; it stays the selection's until that is made again
        self.update_ms = 0.0

    def note(self, depsgraph):
        if place_of(depsgraph) == self.place:
            self.is_stale |= self.reader.note(depsgraph)

    def update(self, context):
        """The selection, or None where there is an error or no light. A 3D view's context is needed to see from it."""
        began = time.perf_counter()
        if place_of(context) != self.place:
            self.forget()
            self.place = place_of(context)
        if self.is_stale:
            self.table = self.reader.read(context.evaluated_depsgraph_get())
            self.is_stale, self.asked = False, None
        asked = selection.settings_of(context.scene), cameras.camera_of(context, self.table), preferences.tool_folders()
        if asked != self.asked:
            self.asked = asked
            self._select(*asked)
            self.update_ms = 1000 * (time.perf_counter() - began)
        return self.selection

    def _select(self, settings, camera, folders):
        self.selection, self.error = None, ""
        self.version += 1
        if not len(self.table):
            return
        try:
            if self.engine is None or folders != self.folders:
                self.engine, self.folders = selection.find(), folders
            self.selection = self.engine.select(self.table, settings, camera)
        except clusters.PreviewError as error:
            self.error = str(error)


def place_of(owner):
    """Of a context or depsgraph."""
    return owner.scene.name_full, owner.view_layer.name


# What handlers, which Blender calls, overlay and panels share.
PREVIEW = Preview()


def bill_lines(context):
    """The lines of the bill: texts, and whether each is a warning."""
    found = PREVIEW.update(context)
    if PREVIEW.error:
        return [(PREVIEW.error, True)]
    if found is None:
        return [("No lights", False)]
    chosen = context.scene.chandelier
    lost = bill.over_budget_line(found.bill, bill.over_budget_names(found.over_budget, PREVIEW.table.names))
    return [(bill.header(found.bill, chosen.budget_maps, chosen.budget_mib), False),
            *((part, True) for part in lost.split("; ") if part)]


@bpy.app.handlers.persistent
def note(scene, depsgraph):
    PREVIEW.note(depsgraph)


@bpy.app.handlers.persistent
def forget(*_):
    PREVIEW.forget()


# The depsgraph of a change of frame says what its animation moved, as that of an edit does.
HANDLERS = (("depsgraph_update_post", note), ("frame_change_post", note), ("undo_post", forget), ("redo_post", forget),
            ("load_post", forget))


def register():
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    PREVIEW.forget()
