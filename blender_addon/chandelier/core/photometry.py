# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's watts into glTF's candela and lux, and the colour of a temperature."""

import math

import numpy as np

RANGE_THRESHOLD_LX = 0.05  # chandelier-bake's --range-threshold: the illuminance at which a light without a range ends
LUMENS_PER_WATT = 683.0  # used by glTF exporters: the value for light of 555 nm
POINT, SPOT, DIRECTIONAL = range(3)


def intensity_of(kind, power_w):
    """Candela of a point or spot light, whose watts Blender spreads over the whole sphere; lux of a sun, whose power is in W/m²."""
    luminous = LUMENS_PER_WATT * power_w
    return luminous if kind == DIRECTIONAL else luminous / (4 * math.pi)


def range_of(intensity_cd, illuminance_lx):
    """The distance in metres at which a light's illuminance has fallen to `illuminance_lx`."""
    return math.sqrt(intensity_cd / illuminance_lx)


def _lobe(wavelengths_nm, peak, below, above):
    """A Gaussian with its own width on each side."""
    width = np.where(wavelengths_nm < peak, below, above)
    return np.exp(-0.5 * ((wavelengths_nm - peak) * width) ** 2)


def _observer(nm):
    """CIE 1931's colour matching functions as sums of lobes (Wyman, Sloan, Shirley 2013, "Simple Analytic Approximations")."""
    x = (1.056 * _lobe(nm, 599.8, 1 / 37.9, 1 / 31.0) + 0.362 * _lobe(nm, 442.0, 1 / 16.0, 1 / 26.7)
         - 0.065 * _lobe(nm, 501.1, 1 / 20.4, 1 / 26.2))
    y = 0.821 * _lobe(nm, 568.8, 1 / 46.9, 1 / 40.5) + 0.286 * _lobe(nm, 530.9, 1 / 16.3, 1 / 31.1)
    z = 1.217 * _lobe(nm, 437.0, 1 / 11.8, 1 / 36.0) + 0.681 * _lobe(nm, 459.0, 1 / 26.0, 1 / 13.8)
    return np.stack((x, y, z))


RGB_OF_XYZ = np.array(((3.2404542, -1.5371385, -0.4985314),  # linear, Rec. 709's primaries, white D65
                       (-0.9692660, 1.8760108, 0.0415560),
                       (0.0556434, -0.2040259, 1.0572252)))


def xyz_of_temperature(kelvin):
    """A black body's colour, Y = 1."""
    nm = np.arange(360.0, 831.0, 5.0)
    with np.errstate(over="ignore"):  # a cold body sends no blue
        spectrum = nm ** -5 / np.expm1(1.438777e7 / (nm * kelvin))  # Planck; second radiation constant in nm K
    xyz = _observer(nm) @ spectrum
    return xyz / xyz[1]


def colour_of_temperature(kelvin):
    """Linear RGB whose largest component is 1; negative components become 0."""
    rgb = np.maximum(RGB_OF_XYZ @ xyz_of_temperature(kelvin), 0)
    return tuple(float(part) for part in rgb / rgb.max())
