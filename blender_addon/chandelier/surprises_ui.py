# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks for surprises in the scene, and mends those that can be."""

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, StringProperty
from mathutils import Matrix, Vector

from . import edit, light_list, motion, scene_lights, shadows
from .core import photometry, surprises

FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
WAYS = [Vector(way).normalized() for way in (*FACES, *CORNERS)]  # of a cube
LAMP_M = 0.3  # of a double-sided mesh, only what is this near is taken for a lamp or wall that the light is stuck in


def placed_lights(context, depsgraph):
    """Each light object once, with the matrix of where it is first seen and all that instances it."""
    found = {}
    for instance in depsgraph.object_instances:
        if instance.object.type == "LIGHT":
            _, instancers = found.setdefault(instance.object.original, (instance.matrix_world.copy(), {}))
            if instance.is_instance:
                instancers[instance.parent.original] = True
    for thing in context.scene.objects:
        if thing.type == "LIGHT":
            found.setdefault(thing, (thing.matrix_world.copy(), {}))
    return {light: place for light, place in found.items() if not light.hide_render}


def records_of(context):
    depsgraph = context.evaluated_depsgraph_get()
    lights = placed_lights(context, depsgraph)
    users = {}
    for light in lights:
        users[light.data] = users.get(light.data, 0) + 1
    expected, meshes, still = set(context.scene.objects) - set(light_list.hidden_by_solo(context)), Meshes(depsgraph), set()
    return [record_of(meshes, light, matrix, users[light.data], light in expected and not light.visible_get(),
                      motion.lost(light, instancers, still))
            for light, (matrix, instancers) in lights.items()]


def record_of(meshes, light, matrix, users, hidden, lost_motion):
    data = light.data
    axes = np.array(matrix.to_3x3()).T
    scale = tuple(float(length) for length in np.linalg.norm(axes, axis=1))
    unit = axes / np.maximum(np.array(scale), 1e-12)[:, None]
    leaves = scene_lights.emission_node(data) if data.use_nodes else None
    return surprises.Light(
        name=light.name_full, kind=data.type, power_w=scene_lights.emission_of(data)[0], white=tuple(data.color) == (1, 1, 1),
        has_range=data.use_custom_distance, users=users, scale=scale,
        sheared=bool(abs(unit @ unit.T - np.eye(3)).max() > 1e-3),
        own_nodes=data.use_nodes and (leaves is None or any(socket.is_linked for socket in leaves.inputs)),
        inside="" if data.type == "SUN" else " and ".join(thing.name for thing in meshes.around(matrix.translation)),
        hidden=hidden, lost_motion=lost_motion, dynamic=data.chandelier.dynamic)


class Meshes:
    """Meshes that cast shadows and that a light may be stuck in. Boxes in the world limit the tests to those around a light."""

    def __init__(self, depsgraph):
        self.depsgraph, self.placed, boxes = depsgraph, [], []
        for instance in depsgraph.object_instances:
            thing = instance.object
            if thing.type == "MESH" and not thing.hide_render and len(thing.data.polygons) and shadows.placement_throws(instance):
                matrix = instance.matrix_world.copy()
                corners = np.array([matrix @ Vector(corner) for corner in thing.bound_box])
                boxes.append((corners.min(axis=0), corners.max(axis=0)))
                self.placed.append((thing.original, matrix))
        self.boxes = np.array(boxes, float).reshape(-1, 2, 3)

    def around(self, point):
        """The objects that a point is inside of, each once."""
        near = (self.boxes[:, 0] <= point).all(axis=1) & (self.boxes[:, 1] >= point).all(axis=1)
        return list(dict.fromkeys(self.placed[number][0] for number in np.flatnonzero(near) if self.is_around(number, point)))

    def is_around(self, number, point):
        """Whether most rays from the point meet the mesh's back first, where light does not pass; in a room, they meet fronts."""
        thing, matrix = self.placed[number]
        evaluated, to_local = thing.evaluated_get(self.depsgraph), matrix.inverted_safe()
        origin, single_sided = to_local @ point, is_single_sided(thing)
        backs = 0
        for way in WAYS:
            way = (to_local.to_3x3() @ way).normalized()
            hit, place, normal, face = evaluated.ray_cast(origin, way)
            backs += (hit and normal.dot(way) > 0 and (single_sided or (matrix @ place - point).length < LAMP_M)
                      and not shadows.is_see_through(material_of(evaluated, face)))
        return backs > len(WAYS) / 2


def material_of(thing, face):
    """Of an evaluated mesh's face."""
    number = thing.data.polygons[face].material_index
    return thing.material_slots[number].material if number < len(thing.material_slots) else None


def is_single_sided(thing):
    materials = [slot.material for slot in thing.material_slots if slot.material]
    return bool(materials) and all(material.use_backface_culling for material in materials)


def find(context):
    """Looks again and keeps what it finds for the panel."""
    session = context.window_manager.chandelier
    session.surprises.clear()
    scene = surprises.Scene(context.scene.name_full, context.scene.unit_settings.scale_length)
    for surprise in surprises.surprises(records_of(context), [scene]):
        item = session.surprises.add()
        item.rule, item.name, item.text = surprise.rule.id, surprise.name, surprise.text
    session.has_looked = True


class CHANDELIER_OT_find_surprises(bpy.types.Operator):
    """Look for lights that will come out of a bake differently than they look here"""
    bl_idname = "chandelier.find_surprises"
    bl_label = "Look for Surprises"

    def execute(self, context):
        find(context)
        self.report({"INFO"}, f"{len(context.window_manager.chandelier.surprises)} surprises")
        return {"FINISHED"}


class OfRule:
    """Works on the lights that a rule named, or on the selected ones."""
    bl_options = {"REGISTER", "UNDO"}

    rule: StringProperty(name="Rule", options={"HIDDEN", "SKIP_SAVE"})

    def lights(self, context):
        if not self.rule:
            return edit.selected_lights(context)
        named = {item.name for item in context.window_manager.chandelier.surprises if item.rule == self.rule}
        return [thing for thing in context.scene.objects if thing.name_full in named and thing.type == "LIGHT"]

    def execute(self, context):
        if self.rule:
            find(context)  # adjusted in the redo panel, it works on the scene before it, of which what was found is no more
        lights = [light for light in self.lights(context) if edit.is_editable(light) and edit.is_editable(light.data)]
        self.mend(context, lights)
        find(context)
        self.report({"INFO"}, f"{len(lights)} lights")
        return {"FINISHED"} if lights else {"CANCELLED"}


class CHANDELIER_OT_select_surprised(OfRule, bpy.types.Operator):
    """Select these lights"""
    bl_idname = "chandelier.select_surprised"
    bl_label = "Select"

    def execute(self, context):
        here = set(context.view_layer.objects)
        lights = [light for light in self.lights(context) if light in here]
        for other in context.selected_objects:
            other.select_set(False)
        for light in lights:
            light.select_set(True)
        context.view_layer.objects.active = lights[0] if lights else None
        return {"FINISHED"}


class CHANDELIER_OT_convert_area(OfRule, bpy.types.Operator):
    """Turn area lights into lights that glTF has, with the same power: a spot, which is a quarter as bright straight ahead, or a
    point light, which shines backwards too"""
    bl_idname = "chandelier.convert_area"
    bl_label = "Convert Area Lights"

    kind: EnumProperty(name="To", default="SPOT", items=(
        ("SPOT", "Spot", "Shines into the half space that the area did"), ("POINT", "Point", "Shines everywhere")))

    def mend(self, context, lights):
        for data in edit.data_of([light for light in lights if light.data.type == "AREA"]):
            width, height = data.size, data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size
            data.type = self.kind
            data = bpy.data.lights[data.name, None]  # this file's, now of another Python type
            data.shadow_soft_size = (width + height) / 4
            if self.kind == "SPOT":
                data.spot_size, data.spot_blend = np.pi * 160 / 180, 1


class CHANDELIER_OT_unscale_lights(OfRule, bpy.types.Operator):
    """Remove the scale of lights, which stay where they are; a light that a parent shears is unparented"""
    bl_idname = "chandelier.unscale_lights"
    bl_label = "Apply Scale"

    def mend(self, context, lights):
        for light in lights:
            place = light.matrix_world
            target = Matrix.LocRotScale(place.translation, place.to_quaternion(), None)
            light.matrix_world = target
            context.view_layer.update()
            if max(abs(a - b) for rows in zip(light.matrix_world, target) for a, b in zip(*rows)) > 1e-4:
                light.parent = None
                light.matrix_world = target
        context.view_layer.update()


class CHANDELIER_OT_set_range(OfRule, bpy.types.Operator):
    """Give lights a range: the distance at which their illuminance has fallen to a value"""
    bl_idname = "chandelier.set_range"
    bl_label = "Set Range"

    illuminance: FloatProperty(name="Illuminance", description="Illuminance at which the light ends, lux", default=1, min=0.001, soft_max=100)

    def mend(self, context, lights):
        for data in edit.data_of(lights):
            power_w, colour = scene_lights.emission_of(data)
            candela = photometry.intensity_of(photometry.POINT, power_w) * max(colour)
            if candela > 0 and data.type in ("POINT", "SPOT"):
                data.use_custom_distance = True
                data.cutoff_distance = photometry.range_of(candela, self.illuminance)


class CHANDELIER_OT_let_light_out(OfRule, bpy.types.Operator):
    """Switch off the shadow of the meshes that these lights are inside of (Object Properties > Visibility > Ray Visibility > Shadow):
    right for bulbs and shades"""
    bl_idname = "chandelier.let_light_out"
    bl_label = "Mesh Casts No Shadow"

    def execute(self, context):
        depsgraph = context.evaluated_depsgraph_get()
        places, meshes = placed_lights(context, depsgraph), Meshes(depsgraph)
        around = {thing: True for light in self.lights(context) if light in places
                  for thing in meshes.around(places[light][0].translation)}
        for thing in around:
            if edit.is_editable(thing):
                thing.visible_shadow = False
                self.report({"INFO"}, f"{thing.name} casts no shadow now")
            else:
                self.report({"WARNING"}, f"{thing.name} belongs to another file and keeps its shadow")
        find(context)
        return {"FINISHED"} if any(map(edit.is_editable, around)) else {"CANCELLED"}


class CHANDELIER_OT_make_single_user(OfRule, bpy.types.Operator):
    """Give each light data of its own"""
    bl_idname = "chandelier.make_single_user"
    bl_label = "Make Single User"

    def mend(self, context, lights):
        for light in lights:
            if light.data.users > 1:
                light.data = light.data.copy()


class CHANDELIER_OT_mark_dynamic(OfRule, bpy.types.Operator):
    """Mark lights as dynamic: the program that plays the pack will move them. For motion in the pack itself, bake it into keyframes
    of the object (Object > Animation > Bake Action)"""
    bl_idname = "chandelier.mark_dynamic"
    bl_label = "Mark as Dynamic"

    def mend(self, context, lights):
        for data in edit.data_of(lights):
            data.chandelier.dynamic = True


CLASSES = (CHANDELIER_OT_find_surprises, CHANDELIER_OT_select_surprised, CHANDELIER_OT_convert_area,
           CHANDELIER_OT_unscale_lights, CHANDELIER_OT_set_range, CHANDELIER_OT_let_light_out, CHANDELIER_OT_make_single_user,
           CHANDELIER_OT_mark_dynamic)
register_classes, unregister_classes = bpy.utils.register_classes_factory(CLASSES)


@bpy.app.handlers.persistent
def forget(*_):
    """Clears the results when another file is loaded."""
    session = bpy.context.window_manager.chandelier
    session.surprises.clear()
    session.has_looked = False


def register():
    register_classes()
    bpy.app.handlers.load_post.append(forget)


def unregister():
    bpy.app.handlers.load_post.remove(forget)
    unregister_classes()
