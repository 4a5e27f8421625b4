# SPDX-License-Identifier: Apache-2.0
import pytest

from core import surprises
from core.surprises import Light, Scene


def found(*lights):
    return [(surprise.rule.id, surprise.name) for surprise in surprises.surprises(lights)]


@pytest.mark.parametrize("rule, fields", [
    ("area", {"kind": "AREA"}), ("dark", {"power_w": 0}), ("dark", {"power_w": -5}), ("hidden", {"hidden": True}),
    ("scaled", {"scale": (1, 2, 1)}), ("scaled", {"sheared": True}), ("no_range", {"has_range": False}), ("shared", {"users": 3}),
    ("default_power", {"white": True, "power_w": 1000}), ("inside", {"inside": "Shade"}),
    ("nodes", {"own_nodes": True}), ("lost_motion", {"lost_motion": "moved by a driver"})])
def test_each_rule_names_its_light_and_no_other_rule_does(rule, fields):
    assert found(Light("good"), Light("bad", **fields)) == [(rule, "bad")]


@pytest.mark.parametrize("fields", [
    {}, {"scale": (1.0001, 1, 0.9999)}, {"kind": "SUN", "has_range": False}, {"white": True, "power_w": 37},
    {"power_w": 1000, "white": False}, {"lost_motion": "moved by a driver", "dynamic": True}])
def test_false_alarms(fields):
    assert found(Light("good", **fields)) == []


def test_texts_say_how_much():
    texts = {surprise.rule.id: surprise.text for surprise in surprises.surprises(
        [Light("a", power_w=100, has_range=False, users=4, scale=(2, 2, 0.5), inside="Shade")])}
    assert "330 m" in texts["no_range"]  # sqrt(5435 cd / 0.05 lx)
    assert "3 more" in texts["shared"]
    assert "2 × 2 × 0.5" in texts["scaled"]
    assert "Shade" in texts["inside"]


def test_a_scene_in_other_units():
    (surprise,) = surprises.surprises([Light("good")], [Scene("Metres"), Scene("Centimetres", 0.01)])
    assert (surprise.rule.id, surprise.name) == ("unit_scale", "Centimetres") and "unit scale of 0.01" in surprise.text


def test_order_is_that_of_the_rules():
    assert found(Light("a", users=2), Light("b", kind="AREA"), Light("c", kind="AREA")) == \
        [("area", "b"), ("area", "c"), ("shared", "a")]


def test_every_fix_is_an_operator_by_name():
    assert all(rule.fix == "" or rule.fix.startswith("chandelier.") for rule in surprises.RULES)
    assert len(surprises.RULE_OF_ID) == len(surprises.RULES)
