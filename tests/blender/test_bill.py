# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from core import bill

PAPER = bill.Bill(lights=80, lights_in_view=80, shadowless_in_view=0, shadow_maps=26, shadow_views=156, shadow_bytes=26 * 6 * bill.MIB,
                  wanted_shadow_bytes=26 * 6 * bill.MIB, wanted_shadow_maps=26, lights_over_budget=0, d_init_m=0.5,
                  reference_path=False, over_budget=False, misses_budget=False)
OVER = replace(PAPER, shadow_maps=10, shadow_bytes=60 * bill.MIB, wanted_shadow_maps=26, lights_over_budget=16, d_init_m=1.25,
               over_budget=True)


def test_header_says_lights_maps_and_bytes_of_their_budgets():
    assert bill.header(PAPER) == "80 lights → 26 shadow maps, 156 MiB"
    assert bill.header(PAPER, budget_mib=200) == "80 lights → 26 shadow maps, 156 MiB of 200"
    assert bill.header(PAPER, budget_maps=40, budget_mib=200) == "80 lights → 26 shadow maps of 40, 156 MiB of 200"


def test_header_names_lights_out_of_view_and_knows_one_from_many():
    assert bill.header(replace(PAPER, lights_in_view=12)).startswith("80 lights, 12 in view → ")
    assert bill.header(replace(PAPER, shadowless_in_view=3)).startswith("80 lights, 3 without shadow → ")
    one = replace(PAPER, lights=1, lights_in_view=1, shadow_maps=1, shadow_bytes=3 * bill.MIB // 2)
    assert bill.header(one) == "1 light → 1 shadow map, 1.5 MiB"
    none = replace(PAPER, lights=0, lights_in_view=0, shadow_maps=0, shadow_bytes=0)
    assert bill.header(none) == "0 lights → 0 shadow maps, 0 MiB"


@pytest.mark.parametrize("size, text", [(0, "0"), (98304, "0.1"), (6 << 20, "6"), (int(9.5 * bill.MIB), "9.5"),
                                        (int(10.4 * bill.MIB), "10"), (2400 << 20, "2400")])
def test_mib(size, text):
    assert bill.mib(size) == text


def test_over_budget_line_names_who_loses():
    assert bill.over_budget_line(PAPER, []) == ""
    names = [f"lamp {i}" for i in range(10)]
    assert bill.over_budget_line(OVER, names[:2]) == (
        "Over budget: 26 maps, 156 MiB wanted; distance 1.25 m; without their own map: lamp 0, lamp 1")
    assert bill.over_budget_line(OVER, names).endswith("lamp 6, lamp 7 and 2 more")
    missed = replace(OVER, misses_budget=True)
    assert bill.over_budget_line(missed, names) == "Over budget: 26 maps, 156 MiB wanted, and no distance between lights meets the budget"


def test_over_budget_names():
    assert bill.over_budget_names(np.array([False, True, True]), ["a", "b", "c"]) == ["b", "c"]
