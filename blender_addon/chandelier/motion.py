# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves or changes a light here, in a pack too or not: the exporter writes the keyframes of objects' places, and nothing else
that changes with time."""

import bpy

# How the paths of properties begin of which the exporter samples an object's place; later ones take any ("" begins them all).
SAMPLED = ("location", "rotation", "scale", "delta_") if bpy.app.version < (4, 2) else ("",)


def is_exported(thing):
    """Will the exported file move an object?"""
    while thing:
        if any(curve.data_path.startswith(SAMPLED) for curve in curves_of(thing)):
            return True
        thing = thing.parent
    return False


def lost(light):
    """How a light changes with time though its export will not, in words that follow "is"; or nothing."""
    blocks = (light.data, light.data.node_tree)
    if any(block and (curves_of(block) or drivers_of(block)) for block in blocks):
        return "changed by an animation of its light data"
    thing = light
    while thing:
        if not any(curve.data_path.startswith(SAMPLED) for curve in curves_of(thing)):  # else all of its motion is sampled
            if drivers_of(thing) or curves_of(thing):
                return "moved by a driver or an animated property" + above(thing, light)
            if is_led(thing):
                return "moved by a constraint" + above(thing, light)
        thing = thing.parent
    return ""


def above(thing, light):
    return "" if thing == light else f" of {thing.name_full}"


def curves_of(block):
    """The curves of its actions that are not level."""
    animation = block.animation_data
    if not animation:
        return []
    strips = [strip for track in animation.nla_tracks if not track.mute for strip in track.strips]
    actions = [action for action in (animation.action, *(strip.action for strip in strips)) if action]
    return [curve for action in actions for curve in action.fcurves if varies(curve)]


def varies(curve):
    values = {point.co[1] for point in curve.keyframe_points}
    return len(values) > 1 or len(curve.modifiers) > 0


def drivers_of(block):
    return list(block.animation_data.drivers) if block.animation_data else []


def is_led(thing, seen=()):
    """Does a constraint follow something that moves?"""
    followed = [target for constraint in thing.constraints if not constraint.mute and constraint.influence > 0
                for target in targets_of(constraint)]
    return any(moves(target, (*seen, thing)) for target in followed)


def targets_of(constraint):
    several = [entry.target for entry in getattr(constraint, "targets", ())]  # of an Armature constraint
    return [target for target in (getattr(constraint, "target", None), *several) if target]


def moves(thing, seen):
    while thing and thing not in seen:
        if any(curves_of(block) or drivers_of(block) for block in (thing, thing.data) if block) or is_led(thing, seen):
            return True
        seen, thing = (*seen, thing), thing.parent
    return False
