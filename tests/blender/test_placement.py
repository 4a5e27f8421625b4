# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from core import placement


def rng(seed=1):
    return np.random.default_rng(seed)


def least_distance(points):
    return min(math.dist(a, b) for i, a in enumerate(points) for b in points[:i])


CORNER = np.array([(0, 0, 0), (3, 0, 0), (3, 0, 0), (3, 1, 0)])  # with a repeated point


def test_by_count_the_ends_are_among_them():
    points, ways = placement.along(CORNER, count=5)
    assert points == pytest.approx(np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (3, 1, 0)]))
    assert ways[0] == pytest.approx((1, 0, 0)) and ways[-1] == pytest.approx((0, 1, 0))


def test_by_count_on_a_closed_line_none_is_twice():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    points, _ = placement.along(square, closed=True, count=8)
    assert len(points) == 8 and least_distance(points) == pytest.approx(0.5)


def test_by_spacing():
    points, _ = placement.along(CORNER, spacing=1.5)
    assert points == pytest.approx(np.array([(0, 0, 0), (1.5, 0, 0), (3, 0, 0)]))
    assert len(placement.along(CORNER, spacing=1)[0]) == 5  # the end too
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    assert len(placement.along(square, closed=True, spacing=1)[0]) == 4


def test_one_light_stands_in_the_middle():
    assert placement.along(CORNER, count=1)[0] == pytest.approx(np.array([(2, 0, 0)]))


def test_lines_without_length():
    assert len(placement.along(np.zeros((3, 3)), count=4)[0]) == 1
    assert len(placement.along(np.zeros((0, 3)), count=4)[0]) == 0


def test_polylines_follow_edges():
    chains = placement.polylines([(2, 1), (0, 1), (2, 3), (4, 5), (5, 6), (6, 4)], 8)
    assert chains == [([0, 1, 2, 3], False), ([4, 5, 6], True)]


def test_rings():
    points, outwards = placement.ring((1, 2, 3), 2, count=4)
    assert np.linalg.norm(points - (1, 2, 3), axis=1) == pytest.approx(2)
    assert (points[:, 2] == 3).all() and outwards[0] == pytest.approx((1, 0, 0))
    assert len(placement.ring((0, 0, 0), 1, spacing=1)[0]) == 6
    assert len(placement.ring((0, 0, 0), 0.1, spacing=5)[0]) == 1


def test_thinned_points_are_apart_and_nothing_else_fits():
    points = rng().random((500, 3)) * 4
    chosen = placement.thinned(points, 0.7, 0, rng())
    kept = points[chosen]
    assert chosen == sorted(set(chosen)) and least_distance(kept) >= 0.7
    for point in points:
        assert min(math.dist(point, other) for other in kept) < 0.7
    assert len(placement.thinned(points, 0.7, 5, rng())) == 5
    assert len(placement.thinned(points, 0, 0, rng())) == 500


def test_scattered_points_are_inside_and_apart():
    points = placement.scattered((-1, 0, 2), (1, 5, 4), 0.5, 60, rng())
    assert len(points) == 60 and least_distance(points) >= 0.5
    assert (points >= (-1, 0, 2)).all() and (points <= (1, 5, 4)).all()
    ball = placement.scattered((-1, -1, -1), (1, 1, 1), 0.1, 50, rng(), lambda p: np.linalg.norm(p, axis=1) < 1)
    assert len(ball) == 50 and (np.linalg.norm(ball, axis=1) < 1).all()


def test_a_full_volume_holds_fewer():
    points = placement.scattered((0, 0, 0), (1, 1, 1), 0.9, 100, rng())
    assert 1 <= len(points) < 20
    assert placement.scattered((0, 0, 0), (1, 1, 1), 0.1, 10, rng(), lambda p: np.zeros(len(p), bool)).shape == (0, 3)


def test_without_a_count_a_volume_is_filled():
    points = placement.scattered((0, 0, 0), (4, 4, 4), 1, 0, rng())
    assert least_distance(points) >= 1
    room = sum(min(math.dist(point, other) for other in points) >= 1 for point in rng(2).random((2000, 3)) * 4)
    assert room < 40  # one in fifty places
    assert placement.scattered((0, 0, 0), (1, 1, 1), 0.1, 0, rng(), lambda p: np.zeros(len(p), bool)).shape == (0, 3)
    assert len(placement.scattered((0, 0, 0), (1, 1, 1), 0, 0, rng())) == placement.MOST


def test_jitter_stays_within_its_ball():
    moved = placement.jittered(np.zeros((1000, 3)), 0.3, rng())
    lengths = np.linalg.norm(moved, axis=1)
    assert lengths.max() <= 0.3 and lengths.max() > 0.28
    assert np.median(lengths) == pytest.approx(0.3 * 0.5 ** (1 / 3), abs=0.02)  # uniform in the ball


def test_seeds_decide():
    for make in (lambda r: placement.jittered(CORNER, 1, r), lambda r: placement.scattered((0, 0, 0), (1, 1, 1), 0, 9, r),
                 lambda r: np.array(placement.thinned(np.arange(300.0).reshape(-1, 3), 0, 9, r))):
        assert (make(rng(5)) == make(rng(5))).all()
        assert (make(rng(5)) != make(rng(6))).any()
