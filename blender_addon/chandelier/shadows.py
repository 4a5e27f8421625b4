# SPDX-License-Identifier: GPL-3.0-or-later
"""What casts no shadow in Blender: objects by Ray Visibility > Shadow, their own or that of what instances them, and materials by
EEVEE's Shadow Mode, where it has one (until 4.1)."""

import bpy

WITH_SURFACE = {"MESH", "CURVE", "SURFACE", "FONT"}  # what the exporter makes meshes of
GLASS = 0.5  # the baker lets light pass what transmits so much of it: baker/README.md


def material_throws(material):
    return getattr(material, "shadow_method", "OPAQUE") != "NONE"


def throws(thing, instancer):
    """`instancer`: the outermost that instances the object, which can switch off its shadow, as in Cycles. None says nothing."""
    return all(owner.visible_shadow for owner in (thing, instancer) if owner is not None)


def placement_throws(instance):
    """Of one of the depsgraph's instances, whose parent is the outermost too."""
    return throws(instance.object.original, instance.parent.original if instance.is_instance else None)


def constant(shader, *names):
    """Value of the input that has one of these names; None where it has none or something is linked to it."""
    socket = next((shader.inputs[name] for name in names if name in shader.inputs), None)
    return None if socket is None or socket.is_linked else socket.default_value


def is_glass(material):
    """Whether the baker will treat it as glass. Textures are not read here."""
    nodes = material.node_tree.nodes if material.use_nodes and material.node_tree else ()
    shader = next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None)
    if shader is None:
        return False
    transmission = constant(shader, "Transmission", "Transmission Weight")  # the second from 4.0 on
    metallic = constant(shader, "Metallic")
    return None not in (transmission, metallic) and transmission * (1 - metallic) >= GLASS


def is_see_through(material):
    """Light passes it."""
    return material is not None and (not material_throws(material) or is_glass(material))


def meant(depsgraph):
    """(objects, materials) by name, and whether they cast a shadow; None where those of one name differ."""
    objects, materials = {}, {}
    for instance in depsgraph.object_instances:
        if instance.object.type in WITH_SURFACE:
            note(objects, instance.object.name, placement_throws(instance))
    for material in bpy.data.materials:
        note(materials, material.name, material_throws(material))
    return objects, materials


def note(found, name, throws):
    found[name] = throws if found.get(name, throws) == throws else None
