# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves or changes a light here, in a pack too or not: the exporter writes the keyframes of objects' places and of bones, and
nothing else that changes with time.

`still`, which the questions about followed objects share, grows by the links of which nothing moves: a rig is walked once."""

from typing import NamedTuple

import bpy

# How the paths of properties begin that place an object or a bone.
KEYED = ("location", "rotation", "scale", "delta_")
PLACE = (*KEYED, "constraints[")
# Of which the exporter samples an object's place: later ones do so of any ("" begins all paths), and all of any that a bone's armature has.
SAMPLED = KEYED if bpy.app.version < (4, 2) else ("",)


class Link(NamedTuple):
    """An element of a chain of parents."""
    thing: bpy.types.Object
    bone: str = ""  # of an armature; empty: the object itself


def is_exported(thing, still):
    """Whether the exported file moves an object."""
    return any(is_sampled(link) and (link.bone or is_keyed(link) or cause_of(link, still)) for link in chain(thing))


def lost(light, instancers, still):
    """How a light changes with time though its export will not, in words that follow "is"; or nothing."""
    if any(block and is_animated(block) for block in (light.data, light.data.node_tree)):
        return "changed by an animation of its light data"
    for root in (light, *instancers):
        for link in chain(root):
            cause = "" if is_sampled(link) else cause_of(link, still)
            if cause:
                return f"moved by {cause}" + above(link.thing, light)
        if any(curve.data_path == "hide_render" for curve in timed(root)):
            return "shown and hidden by an animation" + above(root, light)
    return ""


def cause_of(link, still):
    if moves_itself(link):
        return "a driver or an animated property"
    if rides(link):
        return f"the animated path {link.thing.parent.name_full}"
    return "a constraint" if is_led(link, still) else ""


def above(thing, light):
    return "" if thing == light else f" of {thing.name_full}"


def chain(thing):
    """An object and all that carries it."""
    link = Link(thing) if thing else None
    while link:
        yield link
        link = carrier(link)


def carrier(link):
    """The parent; of a bone without one its armature."""
    thing, bone = link
    if bone:
        parent = thing.pose.bones[bone].parent
        return Link(thing, parent.name if parent else "")
    return link_to(thing.parent, thing.parent_bone if thing.parent_type == "BONE" else "")


def link_to(thing, bone):
    """To an object, or to a bone that it has; None of nothing."""
    return Link(thing, bone if thing.pose and bone in thing.pose.bones else "") if thing else None


def timed(block):
    """The curves of its actions that are not level, and its drivers."""
    yield from filter(varies, curves_of(block))
    if block.animation_data:
        yield from block.animation_data.drivers


def curves_of(block):
    animation = block.animation_data
    if not animation:
        return
    strips = [strip for track in animation.nla_tracks if not track.mute for strip in track.strips]
    for action in (animation.action, *(strip.action for strip in strips)):
        yield from action.fcurves if action else ()


def varies(curve):
    values = {point.co[1] for point in curve.keyframe_points}
    return len(values) > 1 or len(curve.modifiers) > 0


def is_animated(block):
    return next(timed(block), None) is not None


def is_sampled(link):
    """Whether the exporter writes where it is at each frame; level keyframes suffice."""
    starts = "" if link.bone else SAMPLED
    return any(curve.data_path.startswith(starts) for curve in curves_of(link.thing))


def is_keyed(link):
    """Whether its place has keyframes, which are written level or not."""
    return any(curve.data_path.startswith(KEYED) for curve in curves_of(link.thing))


def moves_itself(link):
    before = f'pose.bones["{bpy.utils.escape_identifier(link.bone)}"].' if link.bone else ""
    starts = tuple(before + name for name in PLACE)
    return any(curve.data_path.startswith(starts) for curve in timed(link.thing))


def rides(link):
    """Whether it is the child of an animated path."""
    parent = link.thing.parent
    is_on_path = not link.bone and parent and parent.type == "CURVE" and link.thing.parent_type == "OBJECT" and parent.data.use_path
    return bool(is_on_path) and is_animated(parent.data)


def is_led(link, still):
    """Whether a constraint follows something that moves."""
    return any(moves(leader, still) for leader in leaders(link))


def leaders(link):
    """The objects that its constraints follow."""
    thing, bone = link
    constraints = thing.pose.bones[bone].constraints if bone else thing.constraints
    chains = [constraint for other in thing.pose.bones for constraint in other.constraints
              if constraint.type in ("IK", "SPLINE_IK")] if bone else ()  # which move more bones than their own
    return [target for constraint in (*constraints, *chains) if not constraint.mute and constraint.influence > 0
            for target in targets_of(constraint)]


def targets_of(constraint):
    several = getattr(constraint, "targets", ())  # of an Armature constraint
    found = [link_to(entry.target, entry.subtarget) for entry in several]
    for name in ("target", "pole_target"):
        found.append(link_to(getattr(constraint, name, None), getattr(constraint, name.replace("target", "subtarget"), "")))
    return [link for link in found if link]


def moves(link, still):
    """Whether it moves, or anything that it follows or that carries it."""
    seen, waiting = {link}, [link]
    while waiting:
        link = waiting.pop()
        if link in still:
            continue
        is_path = link.thing.type == "CURVE" and not link.bone
        if moves_itself(link) or rides(link) or (is_path and is_animated(link.thing.data)):
            return True
        others = {*leaders(link), carrier(link)} - {None} - seen
        seen |= others
        waiting += others
    still |= seen
    return False
