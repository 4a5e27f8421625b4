# SPDX-License-Identifier: Apache-2.0
import colorsys

import numpy as np
import pytest

import core.light_table as light_table
import core.shapes as shapes

POSITION = np.array([(0, 0, 0), (1, 0, 0), (0, 2, 0), (5, 5, 5)], np.float32)
CENTER = np.array([0, 0, 2, -1])
NAMES = ["a", "b", "c", "d"]
PLAIN = np.zeros(4, np.uint8)  # flags


def test_members_have_their_centres_colour_and_others_another():
    colours = shapes.light_colours(CENTER, np.zeros(4, bool), NAMES, PLAIN)
    assert (colours[0] == colours[1]).all()
    assert (colours[0] != colours[2]).any()
    assert colours[3] == pytest.approx(shapes.OUT_OF_VIEW)


def test_over_budget_is_red_whatever_the_cluster():
    colours = shapes.light_colours(CENTER, np.array([False, True, False, False]), NAMES, PLAIN)
    assert colours[1] == pytest.approx(shapes.OVER_BUDGET)


def test_without_a_shadow_is_another_colour_than_out_of_view_and_than_any_cluster():
    flags = np.array([0, 0, light_table.NO_SHADOW, light_table.NO_SHADOW | light_table.DYNAMIC], np.uint8)
    colours = shapes.light_colours(np.array([0, -1, -1, -1]), np.zeros(4, bool), NAMES, flags)
    assert colours[0] == pytest.approx(shapes.colour_of("a"))
    assert colours[1] == pytest.approx(shapes.OUT_OF_VIEW)
    for light in (2, 3):
        assert colours[light] == pytest.approx(shapes.WITHOUT_SHADOW)
    pale = colorsys.rgb_to_hsv(*shapes.WITHOUT_SHADOW[:3])[1]
    assert all(colorsys.rgb_to_hsv(*shapes.colour_of(f"lamp {number}")[:3])[1] > pale + 0.15 for number in range(500))


def test_no_cluster_is_as_red_as_what_is_over_budget():
    for number in range(2000):
        red, green, blue, _ = shapes.colour_of(f"lamp {number}")
        assert max(green, blue) > 0.3 * red


def test_names_that_differ_in_a_digit_differ_in_colour():
    hues = {tuple(round(part, 3) for part in shapes.colour_of(f"Ring {ring} lamp 0")) for ring in range(50)}
    assert len(hues) >= 48


def test_links_go_from_members_to_centres_only():
    colours = shapes.light_colours(CENTER, np.zeros(4, bool), NAMES, PLAIN)
    lines = shapes.links(POSITION, CENTER, colours)
    assert lines.ends.tolist() == [[1, 0, 0], [0, 0, 0]]
    assert lines.colours.shape == (2, 4)


def test_spheres_are_circles_of_their_radius():
    lines = shapes.spheres(POSITION[:2], [2.0, 3.0], np.ones((2, 4), np.float32))
    each = lines.ends.reshape(2, -1, 3)
    for ends, center, radius in zip(each, POSITION, (2.0, 3.0)):
        assert np.linalg.norm(ends - center, axis=1) == pytest.approx(radius, rel=1e-5)
    assert len(lines.colours) == len(lines.ends)
    begin, end = lines.ends[0::2], lines.ends[1::2]
    assert np.linalg.norm(begin - end, axis=1).max() < 3.0 * 2 * np.pi / shapes.CIRCLE_SEGMENTS * 1.01


def test_many_spheres_are_rounder_than_nothing_and_no_more_than_they_need():
    def segments(count):
        lines = shapes.spheres(np.zeros((count, 3), np.float32), np.ones(count), np.ones((count, 4), np.float32))
        assert np.linalg.norm(lines.ends, axis=1) == pytest.approx(1, rel=1e-5)
        return len(lines.ends) // 2

    assert segments(250) == 250 * 3 * shapes.CIRCLE_SEGMENTS
    assert segments(500) == segments(250)
    assert segments(2000) == 2000 * 3 * shapes.LEAST_SEGMENTS


def test_each_light_has_its_own_centres_colour():
    rng = np.random.default_rng(1)
    center = rng.integers(-1, 40, 300)
    names = [f"lamp {i}" for i in range(300)]
    colours = shapes.light_colours(center, np.zeros(300, bool), names, np.zeros(300, np.uint8))
    for light, number in enumerate(center):
        expected = shapes.colour_of(names[number]) if number >= 0 else shapes.OUT_OF_VIEW
        assert colours[light] == pytest.approx(expected)


def test_nothing_gives_nothing():
    empty = np.zeros((0, 3), np.float32)
    assert len(shapes.links(empty, np.zeros(0, int), np.zeros((0, 4), np.float32)).ends) == 0
    assert len(shapes.spheres(empty, [], np.zeros((0, 4), np.float32)).ends) == 0


def test_places_fall_where_the_view_has_them():
    places = np.array([(0, 0, -2), (1, 0.5, -2), (0, 0, 2), (5, 0, -2), (0, 0, 0)], np.float32)
    perspective = np.array(((1, 0, 0, 0), (0, 2, 0, 0), (0, 0, -1, -0.2), (0, 0, -1, 0)))  # along -z, 90 by 53 degrees
    assert list(shapes.seen_at(places, perspective, 200, 100)) == [(0, 100, 50), (1, 150, 75)]
    assert list(shapes.seen_at(places[:0], perspective, 200, 100)) == []
