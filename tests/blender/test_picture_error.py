# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from core import picture_error


def picture(value=1.0, height=8, width=6):
    return np.full((height, width, 3), value, np.float32)


def test_the_same_has_no_error():
    error = picture_error.error_of(picture(), picture())
    assert (error.mean, error.mean_absolute, error.rmse, error.apart) == (0, 0, 0, 0)


def test_brighter_by_a_part():
    error = picture_error.error_of(picture(2.0), picture(2.04))
    assert error.mean == pytest.approx(0.02, rel=1e-4)
    assert error.mean_absolute == pytest.approx(0.02, rel=1e-4)
    assert error.rmse == pytest.approx(0.02, rel=1e-4)
    assert error.apart == 0


def test_a_lost_shadow_is_apart():
    reference, ours = picture(), picture()
    reference[:4] = 0
    error = picture_error.error_of(reference, ours)
    assert error.apart == 0.5
    assert error.mean == pytest.approx(1.0)


def test_noise_in_the_dark_is_not():
    reference, ours = picture(), picture()
    reference[0, 0], ours[0, 0] = 1e-6, 3e-6
    assert picture_error.error_of(reference, ours).apart == 0


def test_noise_is_what_two_renders_differ_by():
    random = np.random.default_rng(3)
    one, other = (picture(height=64, width=64) + random.normal(0, 0.1, (64, 64, 3)).astype(np.float32) for _ in range(2))
    mean, noise = picture_error.mean_and_noise(one, other)
    error = picture_error.error_of(picture(height=64, width=64), mean)
    assert noise == pytest.approx(error.mean_absolute, rel=0.05)
    assert picture_error.mean_and_noise(one, one)[1] == 0


def test_sizes_must_agree():
    with pytest.raises(ValueError, match="6x8 and 6x7"):
        picture_error.error_of(picture(), picture(height=7))


@pytest.mark.parametrize("order", ["<", ">"])
def test_pfm_of_either_byte_order_is_turned_upright(tmp_path, order):
    values = np.arange(2 * 3 * 3, dtype=f"{order}f4").reshape(2, 3, 3)
    path = tmp_path / "a.pfm"
    path.write_bytes(f"PF\n3 2\n{'-1.0' if order == '<' else '1.0'}\n".encode() + values.tobytes())
    assert (picture_error.read_pfm(path) == values[::-1]).all()


@pytest.mark.parametrize("content", [b"", b"Pf\n1 1\n-1\n0000", b"PF\n2 2\n-1.0\n0000"])
def test_what_is_no_pfm_is_named(tmp_path, content):
    path = tmp_path / "a.pfm"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="a.pfm"):
        picture_error.read_pfm(path)


def test_sheet_shows_three_pictures_side_by_side():
    reference, ours = picture(), picture()
    ours[0] = 0
    sheet = picture_error.sheet(reference, ours)
    assert sheet.shape == (8, 3 * 6 + 2 * 4, 3)
    assert (sheet[0, 10:16] == 0).all() and (sheet[1, 10:16] > 0.999).all()
    assert (sheet[0, -6:] == 1).all() and (sheet[1, -6:] == 0).all()
