# SPDX-License-Identifier: GPL-3.0-or-later
"""The selection of shadow maps of the scene as it is now, made again only when something changed."""

import time

import bpy

from . import scene_lights, selection
from .core import bill, clusters


class Preview:
    """Reads the lights and selects, lazily: handlers only say that something may have changed."""

    def __init__(self):
        self.engine, self.error = None, ""
        self.forget()

    def forget(self):
        """After undo, redo and loading, when Blender's pointers mean something else."""
        self.reader, self.table, self.selection, self.asked = scene_lights.LightReader(), None, None, None
        self.is_stale = True  # the table; it stays the selection's until that is made again
        self.version = 0  # grows with every new selection
        self.update_ms = 0.0

    def note(self, depsgraph):
        self.is_stale |= self.reader.note(depsgraph)

    def update(self, context):
        """The selection, or None where there is an error or no light. A 3D view's context is needed to see from it."""
        began = time.perf_counter()
        if self.is_stale:
            self.table = self.reader.read(context.evaluated_depsgraph_get())
            self.is_stale, self.asked = False, None
        asked = selection.settings_of(context.scene), selection.camera_of(context, self.table)
        if asked != self.asked:
            self.asked = asked
            self._select(*asked)
            self.update_ms = 1000 * (time.perf_counter() - began)
        return self.selection

    def _select(self, settings, camera):
        self.selection, self.error = None, ""
        self.version += 1
        if not len(self.table):
            return
        try:
            self.engine = self.engine or selection.find()
            self.selection = self.engine.select(self.table, settings, camera)
        except clusters.PreviewError as error:
            self.error = str(error)


# What handlers, which Blender calls, overlay and panels share.
PREVIEW = Preview()


def bill_lines(scene):
    """What a glance must tell: texts, and whether each is bad news."""
    if PREVIEW.error:
        return [(PREVIEW.error, True)]
    found = PREVIEW.selection
    if found is None:
        return [("No lights", False)]
    chosen = scene.chandelier
    lost = bill.over_budget_line(found.bill, bill.over_budget_names(found.over_budget, PREVIEW.table.names))
    return [(bill.header(found.bill, chosen.budget_maps, chosen.budget_mib), False),
            *((part, True) for part in lost.split("; ") if part)]


@bpy.app.handlers.persistent
def note(scene, depsgraph):
    PREVIEW.note(depsgraph)


@bpy.app.handlers.persistent
def forget(*_):
    PREVIEW.forget()


FORGETTING = ("undo_post", "redo_post", "load_post", "frame_change_post")


def register():
    bpy.app.handlers.depsgraph_update_post.append(note)
    for name in FORGETTING:
        getattr(bpy.app.handlers, name).append(forget)


def unregister():
    for name in FORGETTING:
        getattr(bpy.app.handlers, name).remove(forget)
    bpy.app.handlers.depsgraph_update_post.remove(note)
    PREVIEW.forget()
