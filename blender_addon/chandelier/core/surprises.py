# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what will look different after a bake than in Blender."""

from dataclasses import dataclass
from typing import Callable

from . import photometry

UNTOUCHED_POWERS_W = (10, 1000)  # of a new light in Blender, and of the light in its default scene


@dataclass(frozen=True)
class Light:
    """A light as the artist has set it."""
    name: str
    kind: str = "POINT"  # Blender's: POINT, SPOT, SUN, AREA
    power_w: float = 60
    white: bool = False
    has_range: bool = True
    users: int = 1  # objects that share its data
    scale: tuple = (1, 1, 1)  # in the world
    sheared: bool = False
    own_nodes: bool = False  # its shader nodes are more than an emission
    inside: str = ""  # the shadow-casting meshes that contain it
    hidden: bool = False  # hidden in the viewport, but not in renders
    lost_motion: str = ""  # the animation that is not exported
    dynamic: bool = False


@dataclass(frozen=True)
class Scene:
    name: str
    metres_per_unit: float = 1  # Blender's unit scale


@dataclass(frozen=True)
class Rule:
    id: str
    title: str
    applies: Callable
    text: Callable  # the text after the name of the light or scene
    fix: str = ""  # the operator that repairs it


@dataclass(frozen=True)
class Surprise:
    rule: Rule
    name: str
    text: str


def _is_scaled(light):
    return light.sheared or any(abs(part - 1) > 1e-3 for part in light.scale)


def _scaled_text(light):
    if light.sheared:
        return "is sheared by a parent, which glTF cannot express: it may end up elsewhere"
    scale = " × ".join(f"{part:.3g}" for part in light.scale)
    return f"is scaled by {scale}: glTF's lights have no scale, and a spot's cone will be different"


def _range_text(light):
    metres = photometry.range_of(photometry.intensity_of(photometry.POINT, light.power_w), photometry.RANGE_THRESHOLD_LX)
    return f"has no range: the baker will end it at {metres:.0f} m, and its shadow map holds everything nearer"


SCENE_RULES = (
    Rule("unit_scale", "Unit scale", lambda scene: abs(scene.metres_per_unit - 1) > 1e-6,
         lambda scene: f"has a unit scale of {scene.metres_per_unit:g}, which is not exported: what is "
         f"{scene.metres_per_unit:g} m here will be 1 m, while the numbers of distances and watts stay the same"),
)
LIGHT_RULES = (
    Rule("area", "Area lights", lambda light: light.kind == "AREA",
         lambda light: "is an area light, which glTF does not have: it will be missing", "chandelier.convert_area"),
    Rule("dark", "Without power", lambda light: light.power_w <= 0,
         lambda light: f"has {light.power_w:g} W: it will be missing"),
    Rule("hidden", "Hidden, but rendered", lambda light: light.hidden,
         lambda light: "is hidden in the viewport but not in renders: it will be in the pack, but the preview does not count it"),
    Rule("scaled", "Scaled", _is_scaled, _scaled_text, "chandelier.unscale_lights"),
    Rule("no_range", "Without range", lambda light: not light.has_range and light.kind in ("POINT", "SPOT") and light.power_w > 0,
         _range_text, "chandelier.set_range"),
    Rule("shared", "Shared data", lambda light: light.users > 1,
         lambda light: f"shares its data with {light.users - 1} more: a change of one changes all",
         "chandelier.make_single_user"),
    Rule("default_power", "Untouched power",
         lambda light: light.white and light.kind in ("POINT", "SPOT") and light.power_w in UNTOUCHED_POWERS_W,
         lambda light: f"is white with {light.power_w:g} W, as Blender made it: was it ever set?"),
    Rule("inside", "Inside a mesh", lambda light: bool(light.inside),
         lambda light: f"is inside {light.inside}, which will block its light", "chandelier.let_light_out"),
    Rule("lost_motion", "Motion that is not exported", lambda light: bool(light.lost_motion) and not light.dynamic,
         lambda light: f"is {light.lost_motion}, which is not exported: the light stays as it is at this frame, and counts as static",
         "chandelier.mark_dynamic"),
    Rule("nodes", "Nodes", lambda light: light.own_nodes,
         lambda light: "has nodes: only its power and colour, and those of an emission node, are exported"),
)
RULES = SCENE_RULES + LIGHT_RULES
RULE_OF_ID = {rule.id: rule for rule in RULES}


def surprises(lights, scenes=()):
    """Sorted by rules, then by scenes and lights."""
    return [Surprise(rule, thing.name, rule.text(thing)) for rules, things in ((SCENE_RULES, scenes), (LIGHT_RULES, lights))
            for rule in rules for thing in things if rule.applies(thing)]
