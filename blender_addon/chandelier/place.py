# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that place lights. Each can be adjusted in the redo panel, and undone as one step."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .core import photometry, placement

DOWN = Vector((0, 0, -1))
WITHOUT_BOUNDS = {"EMPTY", "LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE"}  # their bound_box says -1 everywhere
LIGHT_FIELDS = ("kind", "aim", "power", "temperature", "range", "radius", "share")


class Placing:
    """What all of them ask, and how their lights are made."""
    bl_options = {"REGISTER", "UNDO"}

    jitter: FloatProperty(
        name="Jitter", description="Each light is moved at random by up to this", default=0, min=0, unit="LENGTH")
    seed: IntProperty(name="Seed", description="Another seed gives other random places", default=0, min=0)
    kind: EnumProperty(name="Type", default="POINT", items=(
        ("POINT", "Point", "Shines everywhere"), ("SPOT", "Spot", "Shines into a cone")))
    aim: EnumProperty(name="Aim", default="WAY", items=(
        ("WAY", "By Place", "Along the curve, towards the object, along the surface's normal, or in the object's own direction"),
        ("DOWN", "Down", "Straight down")))
    power: FloatProperty(name="Power", description="Power of each light", default=40, min=0, soft_max=1000, unit="POWER")
    temperature: FloatProperty(
        name="Temperature", description="Temperature of a black body with the lights' colour, kelvin", default=4000, min=800,
        max=20000, step=10000, precision=0)
    range: FloatProperty(
        name="Range", description="Distance at which the lights end (their Custom Distance); 0: not set, the baker derives it", default=8,
        min=0, soft_max=100, unit="LENGTH")
    radius: FloatProperty(name="Radius", description="Radius of each light; it softens the shadow", default=0.05, min=0, soft_max=1, unit="LENGTH")
    share: BoolProperty(
        name="Share Data", description="All lights use one data-block, so one edit changes all", default=False)

    wanted = "an object that is not a light"  # what `sources` takes

    @classmethod
    def poll(cls, context):
        """Must not test the selection: Blender calls this again before it adjusts the operator in the redo panel, while the lights
        that it placed still exist and are selected."""
        return context.mode == "OBJECT"

    @classmethod
    def sources(cls, context):
        """The objects that lights are placed along, around, on or at: not those that were just placed."""
        return [thing for thing in context.selected_objects if thing.type != "LIGHT"]

    def execute(self, context):
        rng = np.random.default_rng(self.seed)
        sources = self.sources(context)
        if not sources:
            self.report({"WARNING"}, f"No light was placed: select {self.wanted} first")
            return {"CANCELLED"}
        context.view_layer.update()  # adjusted in the redo panel: right after an undo Blender 4.3 knows no place of anything
        made = []
        for source in sources:
            points, ways = self.places(context, source, rng)
            points = placement.jittered(points, self.jitter, rng) if self.jitter > 0 else points
            made += self._make(context, source.name, points, ways, made[0].data if made and self.share else None)
        if not made:
            self.report({"WARNING"}, "No light was placed: the selected objects have no place for one")
            return {"CANCELLED"}
        select_only(context, made)
        self.report({"INFO"}, f"{len(made)} lights")
        return {"FINISHED"}

    def _make(self, context, source, points, ways, data):
        """Lights at points; spots shine along `ways`. `data`: what they share."""
        made = []
        for point, way in zip(points.tolist(), np.asarray(ways).tolist()):
            if data is None or not self.share:
                data = self._make_data(f"{source} Light")
            light = bpy.data.objects.new(data.name, data)
            light.location = point
            if self.kind == "SPOT":
                light.rotation_euler = (DOWN if self.aim == "DOWN" else Vector(way)).to_track_quat("-Z", "Y").to_euler()
            context.collection.objects.link(light)
            made.append(light)
        return made

    def _make_data(self, name):
        data = bpy.data.lights.new(name, self.kind)
        data.energy, data.shadow_soft_size = self.power, self.radius
        data.color = photometry.colour_of_temperature(self.temperature)
        if self.range > 0:
            data.use_custom_distance, data.cutoff_distance = True, self.range
        return data

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        for name in (*self.shown(), "jitter", "seed"):
            layout.prop(self, name)
        layout.separator()
        for name in LIGHT_FIELDS:
            if name != "aim" or self.kind == "SPOT":
                layout.prop(self, name)

    def shown(self):
        """Names of the operator's own properties that its panel shows."""
        return ()


class Spaced(Placing):
    """By number or by distance."""
    by: EnumProperty(name="By", default="COUNT", items=(
        ("COUNT", "Count", "A number of lights"), ("SPACING", "Spacing", "A distance between lights")))
    count: IntProperty(name="Count", description="Number of lights on each object", default=10, min=1, max=20000, soft_max=500)
    spacing: FloatProperty(
        name="Spacing", description="Distance from light to light", default=1, min=0.01, soft_max=20, unit="LENGTH")

    def shown(self):
        return ("by", "count" if self.by == "COUNT" else "spacing")

    def spaced(self):
        return {"count": self.count} if self.by == "COUNT" else {"spacing": self.spacing}


class Sparse(Placing):
    """At random, apart from each other."""
    count: IntProperty(name="Count", description="Largest number of lights on each object; 0: no limit", default=50, min=0, max=20000, soft_max=500)
    spacing: FloatProperty(
        name="Least Distance", description="Two lights are never closer than this", default=0.5, min=0, soft_max=20, unit="LENGTH")

    def shown(self):
        return ("count", "spacing")


class CHANDELIER_OT_place_along_curve(Spaced, bpy.types.Operator):
    """Place lights along the selected curves"""
    bl_idname = "chandelier.place_along_curve"
    bl_label = "Along Curves"
    wanted = "a curve"

    @classmethod
    def sources(cls, context):
        return [thing for thing in context.selected_objects if thing.type == "CURVE"]

    def places(self, context, source, rng):
        vertices, lines = lines_of(source)
        found = [placement.along(vertices[line], closed, **self.spaced()) for line, closed in lines]
        return joined(found)


class CHANDELIER_OT_place_around(Spaced, bpy.types.Operator):
    """Place lights in level circles around the selected objects"""
    bl_idname = "chandelier.place_around"
    bl_label = "Around Objects"

    distance: FloatProperty(
        name="Distance", description="From the object's bounding cylinder to the circle", default=0.5, soft_max=20, unit="LENGTH")
    rings: IntProperty(name="Circles", description="Number of circles, one above the other", default=1, min=1, soft_max=20)
    step: FloatProperty(name="Step", description="Height from circle to circle", default=1, unit="LENGTH")
    height: FloatProperty(
        name="Height", description="Height of the lowest circle above the object's middle", default=0, unit="LENGTH")

    def shown(self):
        return (*super().shown(), "distance", "rings", "step", "height")

    def places(self, context, source, rng):
        lower, upper = bounds_of(source)
        radius = max(0.01, np.linalg.norm((upper - lower)[:2]) / 2 + self.distance)
        centre = (lower + upper) / 2 + (0, 0, self.height)
        found = [placement.ring(centre + (0, 0, i * self.step), radius, **self.spaced()) for i in range(self.rings)]
        points, outwards = joined(found)
        return points, -outwards


class CHANDELIER_OT_place_on_mesh(Sparse, bpy.types.Operator):
    """Place lights on the faces or vertices of the selected meshes"""
    bl_idname = "chandelier.place_on_mesh"
    bl_label = "On Meshes"
    wanted = "a mesh"

    on: EnumProperty(name="On", default="FACES", items=(
        ("FACES", "Faces", "At the middles of faces"), ("VERTICES", "Vertices", "At vertices")))
    offset: FloatProperty(
        name="Offset", description="Distance from the surface, along its normal", default=0.1, soft_min=-5, soft_max=5,
        unit="LENGTH")

    @classmethod
    def sources(cls, context):
        return [thing for thing in context.selected_objects if thing.type == "MESH"]

    def shown(self):
        return ("on", "offset", *super().shown())

    def places(self, context, source, rng):
        points, normals = surface_of(context, source, self.on)
        chosen = placement.thinned(points, self.spacing, self.count, rng)
        return points[chosen] + self.offset * normals[chosen], normals[chosen]


class CHANDELIER_OT_scatter(Sparse, bpy.types.Operator):
    """Scatter lights in the volume of the selected objects"""
    bl_idname = "chandelier.scatter"
    bl_label = "In Volumes"

    volume: EnumProperty(name="Volume", default="BOX", items=(
        ("BOX", "Box", "The object's bounding box in the world"), ("MESH", "Mesh", "Inside the mesh, which must be closed")))

    def shown(self):
        return ("volume", *super().shown())

    def places(self, context, source, rng):
        if self.count == 0 and self.spacing == 0:
            self.report({"WARNING"}, f"{source.name}: without a least distance there is room for any number of lights: give a count "
                        "or a least distance")
            return np.empty((0, 3)), np.empty((0, 3))
        lower, upper = bounds_of(source)
        inside = inside_of(context, source) if self.volume == "MESH" and source.type == "MESH" else None
        points = placement.scattered(lower, upper, self.spacing, self.count, rng, inside)
        if len(points) < self.count:
            self.report({"WARNING"}, f"{source.name}: only {len(points)} of {self.count} lights fit, {self.spacing:g} m apart")
        return points, np.tile(DOWN, (len(points), 1))


class CHANDELIER_OT_place_at_selected(Placing, bpy.types.Operator):
    """Place a light at each selected object or empty"""
    bl_idname = "chandelier.place_at_selected"
    bl_label = "At Objects"

    at: EnumProperty(name="At", default="ORIGIN", items=(
        ("ORIGIN", "Origin", "The object's origin"), ("MIDDLE", "Middle", "The middle of its bounding box")))

    def shown(self):
        return ("at",)

    def places(self, context, source, rng):
        way = source.matrix_world.to_quaternion() @ DOWN
        point = source.matrix_world.translation if self.at == "ORIGIN" else sum(bounds_of(source)) / 2
        return np.array((point,), float), np.array((way,), float)


def select_only(context, objects):
    for other in context.selected_objects:
        other.select_set(False)
    for thing in objects:
        thing.select_set(True)
    context.view_layer.objects.active = objects[0]


def joined(found):
    """(points, ways) of several as one."""
    if not found:
        return np.empty((0, 3)), np.empty((0, 3))
    return tuple(np.concatenate(parts) for parts in zip(*found))


def lines_of(curve):
    """World-space vertices of a curve's lines, without bevel and extrusion, and its chains."""
    data = curve.data.copy()
    data.dimensions = "3D"  # a flat one is filled, and the fill's edges would join its lines
    data.bevel_depth = data.extrude = data.offset = 0
    data.bevel_object = data.taper_object = None
    bare = bpy.data.objects.new(curve.name, data)
    mesh = bare.to_mesh()
    vertices, edges = array_of(mesh.vertices, "co", 3), array_of(mesh.edges, "vertices", 2, np.int32)
    bare.to_mesh_clear()
    bpy.data.objects.remove(bare)
    bpy.data.curves.remove(data)
    return transformed(curve.matrix_world, vertices), placement.polylines(edges.tolist(), len(vertices))


def surface_of(context, source, on):
    """World-space places and normals of an evaluated mesh's faces or vertices."""
    evaluated = source.evaluated_get(context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    parts, place = (mesh.polygons, "center") if on == "FACES" else (mesh.vertices, "co")
    points, normals = array_of(parts, place, 3), array_of(parts, "normal", 3)
    evaluated.to_mesh_clear()
    normals = normals @ np.array(source.matrix_world.to_3x3().inverted_safe())  # its transpose, and rows are vectors
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return transformed(source.matrix_world, points), normals / np.where(lengths > 0, lengths, 1)


def bounds_of(source):
    """Least and greatest corner in the world."""
    if source.type in WITHOUT_BOUNDS:
        half = source.empty_display_size if source.type == "EMPTY" else 0
        corners = half * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    else:
        corners = np.array([tuple(corner) for corner in source.bound_box])
    corners = transformed(source.matrix_world, corners)
    return corners.min(axis=0), corners.max(axis=0)


def inside_of(context, source):
    """(n, 3) -> which are inside the mesh: rays cross it an odd number of times in most of three directions."""
    tree = BVHTree.FromObject(source, context.evaluated_depsgraph_get())
    to_local = source.matrix_world.inverted_safe()
    ways = [Vector(way).normalized() for way in ((0.31, 0.17, 0.93), (-0.87, 0.41, 0.29), (0.23, -0.91, -0.37))]

    def crossings(point, way):
        count = 0
        hit = tree.ray_cast(point, way)
        while hit[0] is not None:
            count += 1
            hit = tree.ray_cast(hit[0] + way * 1e-4, way)
        return count

    def is_inside(point):
        point = to_local @ Vector(point)
        return sum(crossings(point, way) % 2 for way in ways) >= 2

    return lambda points: np.fromiter((is_inside(point) for point in points.tolist()), bool, len(points))


def array_of(collection, name, width, kind=np.float32):
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def transformed(matrix, points):
    matrix = np.array(matrix)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


CLASSES = (CHANDELIER_OT_place_along_curve, CHANDELIER_OT_place_around, CHANDELIER_OT_place_on_mesh, CHANDELIER_OT_scatter,
           CHANDELIER_OT_place_at_selected)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
