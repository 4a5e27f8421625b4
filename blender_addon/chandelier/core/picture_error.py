# SPDX-License-Identifier: GPL-3.0-or-later
"""The difference of a picture from its reference, in numbers and as a picture. Pictures are linear, f4 (height, width, 3), the
top row first."""

import re
from dataclasses import dataclass

import numpy as np

APART = 0.1  # relative difference above which two pixels count as different
DARK = 0.05  # times the mean: differences of darker pixels are divided by this


@dataclass(frozen=True)
class Error:
    mean: float  # of the whole picture against the reference's: 0.02 is 2 % too bright
    mean_absolute: float  # of each pixel's difference, over the reference's mean
    rmse: float  # over the reference's mean
    apart: float  # share of the pixels that differ by more than APART

    def line(self):
        return (f"mean {100 * self.mean:+.1f} %, mean difference {100 * self.mean_absolute:.1f} %, RMSE {100 * self.rmse:.1f} %, "
                f"{100 * self.apart:.1f} % of the pixels apart")


def read_pfm(path):
    """Reads a colour PFM. Raises ValueError if the file is none."""
    data = open(path, "rb").read()
    head = re.match(rb"PF\s+(\d+)\s+(\d+)\s+(-?[\d.]+)\s", data)
    if not head:
        raise ValueError(f"{path}: is not a colour PFM")
    width, height = int(head[1]), int(head[2])
    order = "<" if float(head[3]) < 0 else ">"
    values = np.frombuffer(data, f"{order}f4", offset=head.end())
    if len(values) != width * height * 3:
        raise ValueError(f"{path}: has {len(values)} numbers instead of {width}x{height}x3")
    return values.reshape(height, width, 3)[::-1].astype(np.float32)


def relative(reference, ours):
    """(height, width): the largest difference among a pixel's channels, divided by its brightness, but at least by DARK times the
    mean."""
    floor = DARK * reference.mean()
    return np.abs(ours - reference).max(2) / np.maximum(np.maximum(reference.max(2), ours.max(2)), max(floor, 1e-30))


def error_of(reference, ours):
    if reference.shape != ours.shape:
        raise ValueError(f"the pictures differ in size: {reference.shape[1]}x{reference.shape[0]} and {ours.shape[1]}x{ours.shape[0]} pixels")
    mean = max(float(reference.mean(dtype=np.float64)), 1e-30)
    difference = ours.astype(np.float64) - reference
    return Error(float(difference.mean()) / mean, float(np.abs(difference).mean()) / mean,
                 float(np.sqrt((difference ** 2).mean())) / mean, float((relative(reference, ours) > APART).mean()))


def mean_and_noise(one, other):
    """For two renders that differ only by noise: their mean, and the mean difference of a pixel due to noise, divided by the mean
    brightness."""
    mean = (one + other) / 2
    return mean, float(np.abs(one - other).mean(dtype=np.float64)) / 2 / max(float(mean.mean(dtype=np.float64)), 1e-30)


def shown(picture, white):
    """Encodes as sRGB, 0 to 1; `white` becomes 1."""
    linear = np.clip(picture / white, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def heat(values):
    """A colour scale: 0 is black, then blue, red and yellow, and 1 is white."""
    stops = np.array(((0, 0, 0), (0.1, 0.1, 0.7), (0.8, 0.1, 0.3), (1, 0.7, 0.1), (1, 1, 1)))
    place = np.clip(values, 0, 1) * (len(stops) - 1)
    low = np.minimum(place.astype(int), len(stops) - 2)
    part = (place - low)[..., None]
    return stops[low] * (1 - part) + stops[low + 1] * part


def sheet(reference, ours):
    """The reference, our picture and the error of each pixel (white: 2 * APART), side by side; f4, sRGB."""
    white = max(float(np.percentile(reference.max(2), 99)), 1e-30)
    gap = np.ones((reference.shape[0], 4, 3))
    error = heat(relative(reference, ours) / (2 * APART))
    return np.concatenate([shown(reference, white), gap, shown(ours, white), gap, error], axis=1).astype(np.float32)
