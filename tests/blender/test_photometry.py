# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from core import photometry as light


def chromaticity(kelvin):
    xyz = light.xyz_of_temperature(kelvin)
    return xyz[:2] / xyz.sum()


def test_a_watt_is_683_lumens_over_the_sphere():
    assert light.intensity_of(light.POINT, 100) == pytest.approx(5435.14, abs=0.01)  # as Blender's exporter writes
    assert light.intensity_of(light.SPOT, 100) == light.intensity_of(light.POINT, 100)
    assert light.intensity_of(light.DIRECTIONAL, 1) == 683


def test_range_is_where_the_illuminance_has_fallen():
    candela = light.intensity_of(light.POINT, 60)
    assert candela / light.range_of(candela, 0.3) ** 2 == pytest.approx(0.3)


@pytest.mark.parametrize("kelvin, x, y", [(2856, 0.4476, 0.4074), (1500, 0.5857, 0.3931), (6500, 0.3135, 0.3237),
                                          (10000, 0.2807, 0.2884)])
def test_black_bodies_have_their_chromaticity(kelvin, x, y):
    """CIE's illuminant A, and points of the Planckian locus; the fitted observer is off by a few thousandths."""
    assert chromaticity(kelvin) == pytest.approx((x, y), abs=0.005)


def test_colours_are_warm_below_and_cold_above():
    colours = np.array([light.colour_of_temperature(kelvin) for kelvin in (1000, 2000, 3000, 4500, 6500, 9000, 12000)])
    assert (colours >= 0).all() and (colours.max(axis=1) == 1).all()
    assert (np.diff(colours[:, 2] / colours[:, 0]) > 0).all()
    assert colours[0, 2] == 0 and colours[-1, 2] == 1
    assert colours[4] == pytest.approx((1, 0.97, 0.98), abs=0.05)  # nearly white
    assert all(math.isfinite(part) for part in light.colour_of_temperature(500))
