# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the selection of shadow maps over the 3D view: links from lights to their centres, spheres, names, and the bill."""

import textwrap

import blf
import bpy
import gpu
import numpy as np
from bpy.props import BoolProperty, PointerProperty
from gpu_extras.batch import batch_for_shader

from .core import shapes
from .preview import PREVIEW, bill_lines
from .properties import redraw

POINTS = "FLAT_COLOR" if bpy.app.version >= (4, 0) else "3D_FLAT_COLOR"
LINES = "POLYLINE_FLAT_COLOR"
MOST_LABELS = 200
TEXT_PX = 12
CHARACTER_EM = 0.55  # width of a character over the text's size, about
WHITE = (1, 1, 1, 1)
NO_LABELS = np.zeros((0, 3), np.float32), [], []


class OverlaySettings(bpy.types.PropertyGroup):
    show: BoolProperty(
        name="Light Clusters", description="Show over the 3D view which lights share a shadow map", default=False, update=redraw)
    links: BoolProperty(
        name="Links", description="From each light to the centre whose map it takes", default=True, update=redraw)
    d_min: BoolProperty(
        name="d_min", description="How far a centre gathers lights", default=False, update=redraw)
    ranges: BoolProperty(
        name="Ranges", description="Where the selected lights end", default=True, update=redraw)
    labels: BoolProperty(
        name="Labels", description="Each centre's name and how many lights take its map", default=True, update=redraw)


class Overlay:
    """The last arrays, and the inputs that they were built from."""

    def __init__(self):
        self.handles, self.key, self.batches, self.labels = [], None, [], NO_LABELS

    def start(self):
        add = bpy.types.SpaceView3D.draw_handler_add
        self.handles = [add(self.draw_world, (), "WINDOW", "POST_VIEW"), add(self.draw_text, (), "WINDOW", "POST_PIXEL")]

    def stop(self):
        for handle in self.handles:
            bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
        self.__init__()

    def draw_world(self):
        context = bpy.context
        settings = context.scene.chandelier_overlay
        if not settings.show or not context.space_data.overlay.show_overlays:
            return
        selection = PREVIEW.update(context)
        if selection is None:
            self.key = None
            return
        selected = frozenset(thing.name_full for thing in context.selected_objects)
        key = (PREVIEW.version, settings.links, settings.d_min, settings.ranges, settings.labels, selected)
        if key != self.key:
            self.key = key
            self.build(PREVIEW.table, selection, settings, selected)
        self.draw_batches(context)

    def build(self, table, selection, settings, selected):
        colours = shapes.light_colours(selection.center, selection.over_budget, table.names, table.flags)
        centers = selection.clusters["center"].astype(np.int64)
        drawn = []
        if settings.links:
            drawn.append((1.5, shapes.links(table.position, selection.center, colours)))
        if settings.d_min:
            faint = colours[centers] * (1, 1, 1, 0.5)
            drawn.append((1.0, shapes.spheres(table.position[centers], selection.clusters["d_min_m"], faint)))
        chosen = [row for row, owner in enumerate(table.owners) if owner in selected and selection.range_m[row] > 0]
        if settings.ranges and chosen:
            faint = colours[chosen] * (1, 1, 1, 0.7)
            drawn.append((1.0, shapes.spheres(table.position[chosen], selection.range_m[chosen], faint)))
        self.batches = [batch_of(LINES, width, each.ends, each.colours) for width, each in drawn if len(each.ends)]
        self.batches += [batch_of(POINTS, 7.0, table.position, colours),
                         batch_of(POINTS, 12.0, table.position[centers], colours[centers])]
        self.labels = labels_of(table, selection, colours) if settings.labels else NO_LABELS

    def draw_batches(self, context):
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("NONE")  # a lamp inside its shade is seen, too
        for name, width, batch in self.batches:
            shader = gpu.shader.from_builtin(name)
            shader.bind()
            width_px = width * context.preferences.system.ui_scale
            if name == LINES:
                shader.uniform_float("viewportSize", (context.region.width, context.region.height))
                shader.uniform_float("lineWidth", width_px)
            else:
                gpu.state.point_size_set(width_px)
            batch.draw(shader)
        gpu.state.blend_set("NONE")
        gpu.state.depth_test_set("LESS_EQUAL")

    def draw_text(self):
        context = bpy.context
        if not context.scene.chandelier_overlay.show or not context.space_data.overlay.show_overlays:
            return
        scale = context.preferences.system.ui_scale
        set_size(TEXT_PX * scale)
        if PREVIEW.selection is not None:
            places, texts, colours = self.labels
            seen = shapes.seen_at(places, context.region_data.perspective_matrix, context.region.width, context.region.height)
            for row, x, y in seen:
                draw_text(texts[row], x + 10 * scale, y + 6 * scale, colours[row])
        size = 1.3 * TEXT_PX * scale
        set_size(size)
        left, right = (overlapped(context, kind) for kind in ("TOOLS", "UI"))
        most = max(20, int((context.region.width - left - right - 40 * scale) / (CHARACTER_EM * size)))
        lines = [(line, is_bad) for text, is_bad in bill_lines(context) for line in textwrap.wrap(text, most)]
        for row, (line, is_bad) in enumerate(lines):
            draw_text(line, left + 20 * scale, context.region.height - (120 + 22 * row) * scale,
                      shapes.OVER_BUDGET if is_bad else WHITE)


OVERLAY = Overlay()


def batch_of(shader, width, positions, colours):
    kind = "LINES" if shader == LINES else "POINTS"
    content = {"pos": np.ascontiguousarray(positions, np.float32), "color": np.ascontiguousarray(colours, np.float32)}
    return shader, width, batch_for_shader(gpu.shader.from_builtin(shader), kind, content)


def labels_of(table, selection, colours):
    """Places, texts and colours of the largest clusters."""
    shown = selection.clusters[np.argsort(-selection.clusters["light_count"], kind="stable")][:MOST_LABELS]
    centers = shown["center"].astype(np.int64)
    texts = [f"{table.names[center]} ({count})" for center, count in zip(centers.tolist(), shown["light_count"].tolist())]
    return table.position[centers], texts, colours[centers].tolist()


def overlapped(context, kind):
    """The width of the toolbar or sidebar, which may lie over the view."""
    bar = next((region for region in context.area.regions if region.type == kind), None)
    return bar.width if bar and context.preferences.system.use_region_overlap else 0


def set_size(pixels):
    blf.size(0, pixels) if bpy.app.version >= (4, 0) else blf.size(0, round(pixels), 72)


def draw_text(text, x, y, colour):
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 5, 0, 0, 0, 1)
    blf.color(0, *colour[:3], 1)
    blf.position(0, x, y, 0)
    blf.draw(0, text)
    blf.disable(0, blf.SHADOW)


def register():
    bpy.utils.register_class(OverlaySettings)
    bpy.types.Scene.chandelier_overlay = PointerProperty(type=OverlaySettings)
    if not bpy.app.background:  # drawing needs a window
        OVERLAY.start()


def unregister():
    OVERLAY.stop()
    del bpy.types.Scene.chandelier_overlay
    bpy.utils.unregister_class(OverlaySettings)
