# SPDX-License-Identifier: GPL-3.0-or-later
"""All lights that Blender evaluates, instances and linked ones too, into a LightTable.

2,000 lights are read on each move of the mouse, so what Blender gives as a whole array is taken so, and a light's data is read
again only when it may have changed."""

import math

import bpy
import numpy as np

from . import motion
from .core import light_table, photometry

KINDS = {"POINT": photometry.POINT, "SPOT": photometry.SPOT, "SUN": photometry.DIRECTIONAL}
WIDEST_SUN_RAD = math.radians(179)  # of the 180° that Blender lets a sun have, half has no tangent
HAS_EXPOSURE = "exposure" in bpy.types.Light.bl_rna.properties
HAS_TEMPERATURE = "use_temperature" in bpy.types.Light.bl_rna.properties


def emission_of(light):
    """Watts and linear colour that Cycles gives a light: its own, times its exposure and temperature where Blender has them,
    times the emission node that its surface ends in. What other nodes make of it is not seen here: see surprises."""
    power_w, colour = light.energy, tuple(light.color)
    if HAS_EXPOSURE:
        power_w *= 2.0 ** light.exposure
    if HAS_TEMPERATURE and light.use_temperature:
        colour = tuple(a * b for a, b in zip(colour, light.temperature_color))
    emission = emission_node(light) if light.use_nodes else None
    if emission:
        if not emission.inputs["Strength"].is_linked:
            power_w *= emission.inputs["Strength"].default_value
        if not emission.inputs["Color"].is_linked:
            colour = tuple(a * b for a, b in zip(colour, emission.inputs["Color"].default_value))
    return power_w, colour


def emission_node(light):
    """The emission node at a light's active output, if it is one."""
    if not light.node_tree:
        return None
    output = next((node for node in light.node_tree.nodes if node.type == "OUTPUT_LIGHT" and node.is_active_output), None)
    links = output.inputs["Surface"].links if output else ()
    return links[0].from_node if links and links[0].from_node.type == "EMISSION" else None


def range_of(light):
    """Metres; 0 of a light without one."""
    return light.cutoff_distance if light.use_custom_distance and light.type != "SUN" else 0.0


def radius_of(light):
    """Metres; of a sun the tangent of half its angle."""
    return math.tan(min(light.angle, WIDEST_SUN_RAD) / 2) if light.type == "SUN" else light.shadow_soft_size


def cycles_switch(light):
    """Cycles' settings of a light where they have a switch for its shadow of their own; or nothing."""
    settings = getattr(light, "cycles", None)
    return settings if hasattr(settings, "cast_shadow") else None


def casts_shadow(light):
    """False if it is switched off for EEVEE, or for Cycles where that has a switch of its own."""
    cycles = cycles_switch(light)
    return light.use_shadow and (cycles is None or cycles.cast_shadow)


def set_shadow(light, shadow):
    """For both, so that casts_shadow() says the same."""
    light.use_shadow = shadow
    cycles = cycles_switch(light)
    if cycles:
        cycles.cast_shadow = shadow


def record_of(light, groups):
    """A light's row of light_table.DATA; None for a type that glTF does not have, or without power. `groups`: name -> number, grows."""
    kind = KINDS.get(light.type)
    if kind is None:
        return None
    power_w, colour = emission_of(light)
    if power_w <= 0 or max(colour) <= 0:
        return None
    settings = light.chandelier
    group = groups.setdefault(settings.group, len(groups)) if settings.group else light_table.NO_GROUP
    return light_table.record(
        kind, power_w, colour, range_m=range_of(light), radius_m=radius_of(light),
        spot_outer_rad=light.spot_size / 2 if kind == photometry.SPOT else math.pi, dynamic=settings.dynamic,
        cluster=settings.cluster, shadow=casts_shadow(light), priority=settings.priority, group=group)


def not_rendered():
    """Full names of the objects of which every collection is left out of renders."""
    hidden = set()
    for collection in bpy.data.collections:
        if collection.hide_render:
            hidden.update((collection, *collection.children_recursive))
    objects = {thing for collection in hidden for thing in collection.objects if thing.type == "LIGHT" or thing.is_instancer}
    return {thing.name_full for thing in objects if all(collection in hidden for collection in thing.users_collection)}


class LightReader:
    """Keeps what was read, so that a light that moves costs one array. Whoever keeps a reader tells it of every update of the
    depsgraph, and takes a new one after undo and after a file was read, when old pointers mean nothing."""

    def __init__(self):
        self.records, self.groups = {}, {}  # of each light's data, by its address
        self.table, self.places, self.instances = None, [], 0

    def note(self, depsgraph):
        """Notes what a depsgraph has updated. True if the last table is out of date."""
        moved = False
        for update in depsgraph.updates:
            thing = update.id
            if isinstance(thing, bpy.types.Light):
                self.records.pop(thing.as_pointer(), None)
                self.table = None
            elif isinstance(thing, bpy.types.NodeTree):
                self.records.clear()
                self.table = None
            elif isinstance(thing, bpy.types.Action):
                self.table = None
            elif isinstance(thing, bpy.types.Object) and update.is_updated_transform and not update.is_updated_geometry:
                moved = True
            elif isinstance(thing, (bpy.types.Object, bpy.types.Collection, bpy.types.Scene)):
                self.table = None
        return moved or self.table is None

    def read(self, depsgraph):
        count = len(depsgraph.object_instances)
        matrices = np.empty(count * 16, np.float32)
        depsgraph.object_instances.foreach_get("matrix_world", matrices)
        matrices = matrices.reshape(-1, 4, 4)
        if self.table is None or count != self.instances:
            self._read_all(depsgraph, matrices)
            self.instances = count
        else:
            self.table = light_table.moved(self.table, matrices[self.places])
        return self.table

    def _read_all(self, depsgraph, matrices):
        hidden, still = not_rendered(), set()
        records, names, owners, moves = [], [], [], []
        self.places = []
        for place, instance in enumerate(depsgraph.object_instances):
            thing = instance.object
            if thing.type != "LIGHT" or thing.hide_render:
                continue
            record, instancer = self._record(thing.data), None
            name = owner = thing.name_full
            if record is None or name in hidden:
                continue
            if instance.is_instance:
                instancer = instance.parent
                owner = instancer.name_full
                name = f"{owner}/{name}"
                if instancer.hide_render or owner in hidden:
                    continue
            self.places.append(place)
            records.append(record)
            names.append(name)
            owners.append(owner)
            moves.append(motion.is_exported(thing, still) or motion.is_exported(instancer, still))
        data = np.array(records, light_table.DATA)
        data["flags"] |= np.array(moves, np.uint8) * np.uint8(light_table.MOVES)
        self.table = light_table.make_table(matrices[self.places], data, names, owners)

    def _record(self, data):
        pointer = data.as_pointer()
        if pointer not in self.records:
            self.records[pointer] = record_of(data, self.groups)
        return self.records[pointer]


def read(depsgraph):
    return LightReader().read(depsgraph)
