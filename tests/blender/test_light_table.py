# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from core import light_table, photometry


def frame(position, back=(0, 0, 1)):
    matrix = np.eye(4, dtype=np.float32)
    matrix[2, :3], matrix[3, :3] = back, position
    return matrix


def table_of(*records, matrices=None, names=None):
    names = names or [f"light {i}" for i in range(len(records))]
    matrices = matrices or [frame((i, 0, 0)) for i in range(len(records))]
    return light_table.make_table(np.array(matrices), np.array(list(records), light_table.DATA), names, list(names))


def test_columns_are_what_the_records_say():
    table = table_of(
        light_table.record(photometry.POINT, 10, (1, 0.5, 0), range_m=4, radius_m=0.1),
        light_table.record(photometry.SPOT, 20, (1, 1, 1), spot_outer_rad=0.5, dynamic=True, cluster=False, priority=3, group=2))
    assert len(table) == 2
    assert table.type.tolist() == [photometry.POINT, photometry.SPOT]
    assert table.flags.tolist() == [0, light_table.DYNAMIC | light_table.OWN_MAP]
    assert table.priority.tolist() == [128, 3] and table.group.tolist() == [light_table.NO_GROUP, 2]
    assert table.range_m.tolist() == [4, 0] and table.power_w.tolist() == [10, 20]
    assert table.intensity == pytest.approx([543.514, 1087.03], rel=1e-5)
    assert table.position.tolist() == [[0, 0, 0], [1, 0, 0]]
    for column in (table.position, table.colour, table.intensity, table.flags):
        assert column.flags.c_contiguous


def test_a_colour_above_one_becomes_intensity():
    table = table_of(light_table.record(photometry.POINT, 10, (4, 2, 0)))
    assert table.colour.tolist() == [[1, 0.5, 0]]
    assert table.intensity[0] == pytest.approx(4 * 543.514, rel=1e-5)


def test_directions_are_unit_length_whatever_the_scale():
    lamp = light_table.record(photometry.SPOT, 1, (1, 1, 1))
    table = table_of(lamp, lamp, lamp, matrices=[frame((0, 0, 0), (0, 0, 3)), frame((0, 0, 0), (0.2, 0, 0)),
                                                 frame((0, 0, 0), (0, 0, 0))])
    assert table.direction == pytest.approx(np.array([(0, 0, -1), (-1, 0, 0), (0, 0, -1)]))


def test_names_are_told_apart():
    assert light_table.unique(["a", "b", "a", "a"]) == ["a", "b", "a 2", "a 3"]
    assert light_table.unique(["a", "b"]) == ["a", "b"]
    assert light_table.unique(["a", "a", "a 2", "a 2"]) == ["a", "a 3", "a 2", "a 2 2"]


def test_a_moved_table_keeps_the_rest():
    table = table_of(light_table.record(photometry.POINT, 10, (1, 1, 1)))
    there = light_table.moved(table, np.array([frame((7, 8, 9))]))
    assert there.position.tolist() == [[7, 8, 9]] and table.position.tolist() == [[0, 0, 0]]
    assert there.intensity is table.intensity and there.names is table.names


def test_an_empty_scene_is_a_table_too():
    table = light_table.make_table(np.empty((0, 4, 4)), np.empty(0, light_table.DATA), [], [])
    assert len(table) == 0 and table.position.shape == (0, 3) and table.colour.shape == (0, 3)
