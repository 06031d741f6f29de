"""Depths between objects, as the thesis's tables print them."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.depth_report import DepthError, depth_table, depths_between

# Actual depth, calculated depth, depth error [cm], percentage error, as printed.
TABLE_3_14 = {
    "case1": (10.00, 10.10, 0.1, 1.00),
    "case2": (6.50, 6.43, 0.07, 1.08),
    "case3": (19.00, 18.83, 0.17, 0.89),
    "case4": (15.50, 15.43, 0.07, 0.45),
    "case5": (12.50, 12.37, 0.13, 1.04),
    "case6": (3.50, 3.21, 0.29, 8.29),
    "case7": (24.00, 23.96, 0.04, 0.17),
}
TABLE_3_16 = {
    "1, 2": (12.00, 12.18, 0.18),
    "1, 3": (5.00, 4.76, 0.24),
    "2, 3": (17.00, 16.88, 0.12),
    "1, 4": (7.50, 7.57, 0.07),
}


@pytest.mark.parametrize("case", TABLE_3_14)
def test_errors_and_percentages_are_the_thesiss_own(case: str) -> None:
    actual, calculated, error, percent = TABLE_3_14[case]
    row = DepthError(case, actual / 100, calculated / 100)
    assert row.error_m * 100 == pytest.approx(error, abs=1e-9)
    assert row.error_percent == pytest.approx(percent, abs=0.005)


@pytest.mark.parametrize("case", TABLE_3_16)
def test_the_errors_of_four_objects_are_the_thesiss_own(case: str) -> None:
    actual, calculated, error = TABLE_3_16[case]
    assert DepthError(case, actual / 100, calculated / 100).error_m * 100 == pytest.approx(error, abs=1e-9)


def test_the_table_ends_with_the_extremes_and_the_average() -> None:
    table = depth_table([DepthError(case, row[0] / 100, row[1] / 100) for case, row in TABLE_3_14.items()])
    lines = table.splitlines()
    assert len(lines) == 1 + 7 + 3
    assert lines[-3].split()[-1] == "2.90" and lines[-2].split()[-1] == "0.40"
    assert lines[-1].split()[-1] == "1.24"  # the thesis rounds to 0.12 cm


def test_an_empty_table_has_no_extremes() -> None:
    assert len(depth_table([]).splitlines()) == 1


def test_every_two_objects_have_a_depth_between_them() -> None:
    xyz = np.array([(0, 0, 0.884), (0, 0, 1.004), (0, 0, 0.834), (0, 0, 0.959)])
    between = {(each.first, each.second): each.depth_m for each in depths_between(xyz)}
    assert len(between) == 6
    assert between[1, 2] == pytest.approx(0.12) and between[1, 3] == pytest.approx(-0.05)
    assert between[1, 4] == pytest.approx(0.075) and between[2, 3] == pytest.approx(-0.17)
    assert depths_between(xyz[:1]) == []


def test_a_depth_in_the_wrong_direction_is_an_error_of_twice_its_size() -> None:
    assert DepthError("exchanged", 0.05, -0.05).error_m == pytest.approx(0.10)
