"""What surrounds parts is what its name says, and none of what must be found."""

from __future__ import annotations

import numpy as np
import pytest
from evaluate_surroundings import taken
from rendering.printed import Board, Holes, Lines, Marker, Slots, Spot, Text
from rendering.tabletop import Paint
from surroundings import SURROUNDINGS, staged

ROWS = np.linspace(-0.3, 0.3, 601)
EVERYWHERE = np.stack(np.meshgrid(ROWS, ROWS), axis=-1).reshape(-1, 2)


def printed(paint: Paint, albedo: float = 0.4) -> np.ndarray:
    """The albedo (601, 601) of the table, a millimetre apart."""
    return paint.over(EVERYWHERE, np.full(len(EVERYWHERE), albedo)).reshape(601, 601)


@pytest.mark.parametrize(
    ("paint", "share"),
    [
        (Holes(0.025, 0.01, 0.3, 0.5), np.pi / 4 * (0.01 / 0.025) ** 2),
        (Lines(0.01, 0.001, 0.3, 2.0), 1 - 0.9**2),
        (Slots(0.05, 0.012, 0.3, 0.5), 0.012 / 0.05),
        (Text(0.004, 0.3, 0.5, 0), 0.45 * 5 / 8),
    ],
    ids=["holes", "lines", "slots", "text"],
)
def test_what_repeats_covers_its_share_of_the_table(paint: Paint, share: float) -> None:
    assert (printed(paint) != 0.4).mean() == pytest.approx(share, rel=0.1)


def test_a_board_has_as_many_black_squares_as_white_ones_and_a_white_margin() -> None:
    seen = printed(Board(0.0, 0.0, 0.2, 0.03))
    sheet, black = (seen != 0.4).mean() * 0.6**2, (seen < 0.1).mean() * 0.6**2
    assert sheet == pytest.approx(12 * 9 * 0.03**2, rel=0.02)
    assert black == pytest.approx(35 * 0.03**2, rel=0.02)


def test_markers_differ_and_have_a_black_rim() -> None:
    one, same, other = (printed(Marker(0.0, 0.0, 0.0, 0.08, seed)) for seed in (0, 0, 1))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
    rim = one[np.round((0.3 + 0.035 * np.array([-1, 1])) * 1000).astype(int)][:, 265:335]
    assert (rim < 0.1).all()


@pytest.mark.parametrize("soft_m", [0.0005, 0.015])
def test_a_spot_is_as_soft_as_it_is_asked_to_be(soft_m: float) -> None:
    seen = printed(Spot(0.0, 0.0, 0.03, 0.5, soft_m, 0))
    assert seen[300, 300] == pytest.approx(0.2, rel=0.02) and seen[0, 0] == pytest.approx(0.4)
    between = (seen > 0.22) & (seen < 0.38)
    assert between.sum() * 1e-6 == pytest.approx(2 * np.pi * 0.03 * soft_m * 1.1, rel=0.5)


@pytest.mark.parametrize("family", SURROUNDINGS)
def test_a_seed_makes_one_scene_with_its_parts_first(family: str) -> None:
    (scene, parts), (again, _) = staged(family, 0), staged(family, 0)
    assert scene.scene.solids == again.scene.solids and scene.noise_seed == again.noise_seed
    assert 3 <= parts <= (20 if family == "crowd" else 6)
    assert all(part.base_m == 0 for part in scene.scene.solids[:parts])


def test_parts_alone_must_be_found() -> None:
    _, _, truth = taken(None, ("gripper", 0))
    _, parts = staged("gripper", 0)
    assert 0 < sum(each.required for each in truth.objects) <= parts
    assert not any(each.required for each in truth.objects[parts:])


@pytest.mark.parametrize("family", ["leaning", "propped"])
def test_what_is_aslant_touches_the_table(family: str) -> None:
    scene, parts = staged(family, 0)
    slanted = [each for each in scene.scene.solids[parts:] if each.tilt_rad]
    assert slanted
    for each in slanted:
        assert each.hull_m()[:, 2].min() == pytest.approx(0, abs=1e-9)
