# SPDX-License-Identifier: GPL-3.0-or-later
"""What a selection of shadow maps costs: one line of figures, and the names of lights over budget."""

from dataclasses import dataclass

import numpy as np

MIB = 1 << 20
MOST_NAMES = 8  # in one sentence


@dataclass(frozen=True)
class Bill:
    """chandelier_preview.h: ChandelierPreviewBill."""
    lights: int
    lights_in_view: int
    shadowless_in_view: int
    shadow_maps: int
    shadow_views: int
    wanted_shadow_maps: int
    shadow_bytes: int
    wanted_shadow_bytes: int
    lights_over_budget: int
    d_init_m: float
    reference_path: bool
    over_budget: bool
    misses_budget: bool


def mib(size_bytes):
    """In whole MiB; with one decimal below ten, unless the number is whole."""
    value = size_bytes / MIB
    return f"{value:.0f}" if value >= 10 or value == int(value) else f"{value:.1f}"


def _counted(count, what):
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def header(bill, budget_maps=0, budget_mib=0):
    """For instance: 80 lights → 26 shadow maps, 156 MiB of 200. A budget of 0 is no budget. Lights out of view or without shadow
    are counted apart."""
    lights = _counted(bill.lights, "light")
    if bill.lights_in_view != bill.lights:
        lights += f", {bill.lights_in_view} in view"
    if bill.shadowless_in_view:
        lights += f", {bill.shadowless_in_view} without shadow"
    maps = _counted(bill.shadow_maps, "shadow map") + (f" of {budget_maps}" if budget_maps else "")
    size = mib(bill.shadow_bytes) + " MiB" + (f" of {budget_mib}" if budget_mib else "")
    return f"{lights} → {maps}, {size}"


def over_budget_line(bill, names):
    """What the budget does to the lights, or an empty text. `names`: the lights that lose their own map."""
    if not bill.over_budget:
        return ""
    wanted = f"{_counted(bill.wanted_shadow_maps, 'map')}, {mib(bill.wanted_shadow_bytes)} MiB wanted"
    if bill.misses_budget:
        return f"Over budget: {wanted}, and no distance between lights meets the budget"
    shown = ", ".join(names[:MOST_NAMES])
    more = len(names) - MOST_NAMES
    shown += f" and {more} more" if more > 0 else ""
    lost = f"; without their own map: {shown}" if names else ""
    return f"Over budget: {wanted}; distance {bill.d_init_m:.3g} m{lost}"


def over_budget_names(over_budget, names):
    """`over_budget`: a bool for each light, as clusters.Selection has it."""
    return [names[i] for i in np.flatnonzero(over_budget)]
