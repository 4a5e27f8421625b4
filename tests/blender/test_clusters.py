# SPDX-License-Identifier: Apache-2.0
"""The add-on's way to the runtime's selection. That it is the runtime's own is tests/preview/parity_test.py's affair."""

import os
import types

import numpy as np
import pytest

from core import clusters


def core_or_skip(kind):
    for folder in clusters.default_folders():
        path = folder / (clusters.library_name() if kind is clusters.Library else clusters.program_name())
        if path.is_file():
            return kind(path)
    pytest.skip(f"{kind.__name__.lower()} is not built")


@pytest.fixture(params=[clusters.Library, clusters.Program], ids=["library", "program"])
def core(request):
    return core_or_skip(request.param)


def table_of(positions, **columns):
    return types.SimpleNamespace(position=np.array(positions, np.float32).reshape(-1, 3), **columns)


def many_lights(count, seed=1):
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=(count, 3)).astype("f4")
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return table_of(rng.uniform(-6, 6, (count, 3)), direction=direction, type=rng.choice(3, count, p=(0.6, 0.3, 0.1)).astype("u1"),
                    intensity=rng.uniform(1, 9, count).astype("f4"), colour=rng.uniform(0.1, 1, (count, 3)).astype("f4"),
                    range_m=np.where(rng.random(count) < 0.5, 0, 4).astype("f4"), spot_outer_rad=np.full(count, 0.6, "f4"),
                    flags=rng.choice(4, count, p=(0.8, 0.1, 0.05, 0.05)).astype("u1"), priority=np.full(count, 128, "u1"),
                    group=np.where(rng.random(count) < 0.2, 3, -1).astype("i4"), names=[f"lamp {i}" for i in range(count)])


FROM_AFAR = clusters.Camera(eye=(0, -20, 1), forward=(0, 1, 0))


def test_lights_near_each_other_share_a_map(core):
    table = table_of([(0, 0, 0), (0.2, 0, 0), (9, 0, 0)], range_m=np.array([2, 3, 1], "f4"))
    selection = core.select(table, clusters.Settings(distance_scaling="none", reference_share=2), clusters.Camera((0, 0, 0)))
    assert selection.center.tolist() == [1, 1, 2] and selection.center.dtype == np.int32
    assert selection.range_m.tolist() == [2, 3, 1]
    assert selection.over_budget.tolist() == [False, False, False]
    assert selection.clusters["center"].tolist() == [1, 2]
    assert selection.clusters["light_count"].tolist() == [2, 1]
    assert selection.clusters["d_min_m"] == pytest.approx([0.5, 0.5])
    assert selection.clusters["range_m"] == pytest.approx([3, 1])
    assert selection.clusters["spread_m"] == pytest.approx([0.2, 0])
    bill = selection.bill
    assert (bill.lights, bill.lights_in_view, bill.shadow_maps, bill.shadow_views) == (3, 3, 2, 12)
    assert bill.shadow_bytes == 2 * 6 * 4 * 512 * 512
    assert bill.over_budget is False and bill.reference_path is False


def test_a_budget_takes_maps_from_lights_by_name(core):
    table = table_of([(0, 0, 0), (1, 0, 0), (9, 0, 0)], range_m=np.array([2, 3, 1], "f4"))
    settings = clusters.Settings(distance_scaling="none", budget_maps=2)
    selection = core.select(table, settings, clusters.Camera((0, 0, 0)))
    assert selection.over_budget.tolist() == [True, False, False]
    assert selection.center.tolist() == [1, 1, 2]
    assert selection.bill.over_budget and not selection.bill.misses_budget
    assert (selection.bill.wanted_shadow_maps, selection.bill.shadow_maps, selection.bill.lights_over_budget) == (3, 2, 1)
    assert 0.9 < selection.bill.d_init_m < 1.3
    by_bytes = core.select(table, clusters.Settings(distance_scaling="none", budget_mib=12), clusters.Camera((0, 0, 0)))
    assert by_bytes.bill == selection.bill


def test_lights_behind_the_camera_have_no_centre(core):
    table = table_of([(0, 5, 0), (0, -5, 0)], range_m=np.array([1, 1], "f4"))
    camera = clusters.Camera(eye=(0, 0, 0), forward=(0, 1, 0))
    assert core.select(table, clusters.Settings(), camera).center.tolist() == [0, -1]
    assert core.select(table, clusters.Settings(), clusters.Camera((0, 0, 0))).center.tolist() == [0, 1]


def test_no_lights_at_all(core):
    selection = core.select(table_of([]), clusters.Settings(), FROM_AFAR)
    assert len(selection.center) == len(selection.over_budget) == len(selection.clusters) == 0
    assert selection.bill.shadow_maps == 0


def test_library_and_program_say_the_same():
    library, program = core_or_skip(clusters.Library), core_or_skip(clusters.Program)
    table = many_lights(150)
    for settings in (clusters.Settings(), clusters.Settings(d_init_m=3, budget_maps=5, dynamic_lights="own"),
                     clusters.Settings(select="per-light", filter="hard", budget_mib=100)):
        one, other = library.select(table, settings, FROM_AFAR), program.select(table, settings, FROM_AFAR)
        for name in ("center", "range_m", "over_budget", "clusters"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
        assert one.bill == other.bill


def test_columns_are_read_where_they_lie_and_copied_only_where_they_cannot_be():
    library = core_or_skip(clusters.Library)
    table = many_lights(60)
    expected = library.select(table, clusters.Settings(d_init_m=2), FROM_AFAR)
    rows = np.zeros(60, [("pad", "u1"), ("position", "f4", 3), ("type", "u1"), ("range_m", "f4")])  # unaligned, interleaved
    for name in ("position", "type", "range_m"):
        rows[name] = getattr(table, name)
        setattr(table, name, rows[name])
    table.priority = np.broadcast_to(np.uint8(128), 60)
    table.intensity = table.intensity.astype("f8")  # of another type: copied
    table.colour = np.asfortranarray(table.colour)  # of another order: copied
    table.group = table.group[::-1].copy()[::-1]  # backwards in memory: copied
    _, columns = clusters._columns(table)
    for name, owner in (("position", rows), ("type", rows), ("priority", table.priority)):
        assert np.shares_memory(columns[name], owner), name
    again = library.select(table, clusters.Settings(d_init_m=2), FROM_AFAR)
    np.testing.assert_array_equal(again.center, expected.center)
    assert again.bill == expected.bill


@pytest.mark.parametrize("settings, text", [
    (clusters.Settings(filter="soft"), "filter: is none of hard, pcf, pcss (soft)"),
    (clusters.Settings(d_init_m=-1), "d-init must be from 0 to 1000000 m"),
    (clusters.Settings(filter="hard"), "select light-clusters with filter hard"),
    (clusters.Settings(face_size_px=7), "face-size must be from 16 to 16384 texels")])
def test_bad_settings_are_named(core, settings, text):
    if isinstance(core, clusters.Program) and settings.filter == "soft":
        text = "settings.filter: is none of hard, pcf, pcss"
    with pytest.raises(clusters.PreviewError) as error:
        core.select(table_of([(0, 0, 0)]), settings, FROM_AFAR)
    assert str(error.value).startswith(text) and "\n" not in str(error.value)


def test_bad_lights_are_named(core):
    with pytest.raises(clusters.PreviewError, match="light 1, intensity: is not from 0 to 1e[+]12 [(]-4[)]"):
        core.select(table_of([(0, 0, 0)] * 2, intensity=np.array([1, -4], "f4")), clusters.Settings(), FROM_AFAR)
    with pytest.raises(clusters.PreviewError, match="intensity: has shape"):
        core.select(table_of([(0, 0, 0)] * 2, intensity=np.ones(3, "f4")), clusters.Settings(), FROM_AFAR)
    with pytest.raises(clusters.PreviewError, match="finite|nan"):
        core.select(table_of([(0, np.nan, 0)]), clusters.Settings(), FROM_AFAR)


def test_a_library_that_is_none_is_passed_over(tmp_path, monkeypatch):
    program = core_or_skip(clusters.Program)
    (tmp_path / clusters.library_name()).write_bytes(b"not a library")
    with pytest.raises(clusters.PreviewError, match="cannot be loaded"):
        clusters.Library(tmp_path / clusters.library_name())
    monkeypatch.setattr(clusters, "default_folders", lambda: [])
    os.symlink(program.path, tmp_path / clusters.program_name())
    assert isinstance(clusters.find([tmp_path]), clusters.Program)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(clusters.PreviewError, match="cannot be loaded"):
        (tmp_path / clusters.program_name()).unlink()
        clusters.find([tmp_path])
    (tmp_path / clusters.library_name()).unlink()
    with pytest.raises(clusters.PreviewError, match="neither .* nor .* was found"):
        clusters.find([tmp_path])


def test_a_library_of_another_version_is_refused(monkeypatch):
    library = core_or_skip(clusters.Library)
    monkeypatch.setattr(clusters, "ABI", 99)
    with pytest.raises(clusters.PreviewError, match="has interface version 2, but the add-on needs 99"):
        clusters.Library(library.path)
