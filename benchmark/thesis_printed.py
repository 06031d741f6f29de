"""The figures that the thesis prints, as they stand there, and whether they agree with one another."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from formatting import Row, decimals, markdown_table

from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.feature import least_area_difference
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import check_baseline
from stereo_pick.core.transform import Transform

FOCAL_MM, PIXEL_MM = 8.5, 0.0074  # table 3.1
WORK_M = 0.9  # where the thesis's parts stand from its cameras (3.9)

# Table 3.2 and, beside it, 3.5: mm and pixels of the image, error in pixels, error in mm; across and down.
TABLE_3_2 = ((150.0, 640, 0.21298, 0.05), (110.0, 480, 0.44828, 0.1))
TABLE_3_5 = ((150.0, 640, 1.4854, 0.1), (110.0, 480, 2.7246, 0.62))
# Areas (left, right) of tables 3.6, 3.9 and 3.11, and their differences in 3.7, 3.10 and 3.12. Of the right areas in
# 3.11 only the first could be read.
AREAS_PX2: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
    "3.6, 3.7": ((1677, 1319), (1830, 1399)),
    "3.9, 3.10": ((1078, 1341, 898), (1023, 1334, 948)),
    "3.11, 3.12": ((1688, 953, 1453, 2004), (1479,)),
}
DIFFERENCES_PX2: dict[str, tuple[tuple[int, ...], ...]] = {
    "3.6, 3.7": ((135, 278), (511, 80)),
    "3.9, 3.10": ((55, 256, 130), (318, 7, 393), (125, 436, 50)),
    "3.11, 3.12": ((199, 782, 255, 380), (536, 47, 480, 1115), (36, 547, 20, 615), (515, 1098, 571, 64)),
}
# Actual and calculated depth [cm], error [cm] and percentage; 3.13 has no case 4.
TABLE_3_13 = (
    (1, 19.0, 16.0, 3.0, 15.79), (2, 11.0, 10.1, 0.9, 8.18), (3, 13.0, 15.96, 2.96, 22.77),
    (5, 14.0, 16.2, 2.2, 15.71), (6, 13.0, 14.6, 1.6, 12.3), (7, 6.5, 7.4, 0.9, 13.85), (8, 1.0, 1.7, 0.7, 70.0),
)  # fmt: skip
TABLE_3_14 = (
    (1, 10.0, 10.1, 0.1, 1.0), (2, 6.5, 6.43, 0.07, 1.08), (3, 19.0, 18.83, 0.17, 0.89), (4, 15.5, 15.43, 0.07, 0.45),
    (5, 12.5, 12.37, 0.13, 1.04), (6, 3.5, 3.21, 0.29, 8.29), (7, 24.0, 23.96, 0.04, 0.17),
)  # fmt: skip
# Centroids [px] of the four objects in the left and in the right view.
TABLE_3_15_LEFT_PX = np.array([(62.37, 410.94), (176.12, 438.88), (303.98, 395.26), (422.89, 420.57)])
TABLE_3_15_RIGHT_PX = np.array([(143.80, 286.43), (195.9, 316.56), (375.615, 276.477), (443.94, 306.36)])
# Calculated and actual depth [cm] between two objects.
TABLE_3_16_CM = {(1, 2): (12.18, 12.0), (1, 3): (4.76, 5.0), (2, 3): (16.88, 17.0), (1, 4): (7.57, 7.5)}


def agreement_table(left: Camera, right_T_left: Transform) -> str:
    """What of the printed figures follows from the others, and what does not; the cameras are those of 3.4."""
    rows: list[Row] = [*_lengths(left), *_areas(), *_depths(), *_directions(right_T_left)]
    return markdown_table(["printed", "follows from the other printed figures as", "agrees"], rows, words=True)


def paired_by_area(name: str) -> list[tuple[int, int]]:
    """What eq. 3.11 makes of the printed areas: pairs of objects, counted from 1.

    The areas in the right view of 3.11 are those that all of 3.12 agrees on.
    """
    left, right = AREAS_PX2[name]
    if len(right) < len(left):
        right = right_areas_of_3_12()
    pairs = least_area_difference([_square(area) for area in left], [_square(area) for area in right])
    return [(i + 1, j + 1) for i, j in pairs]


def right_areas_of_3_12() -> tuple[int, ...]:
    """The areas that give every difference of table 3.12 with the left areas of 3.11."""
    left, _ = AREAS_PX2["3.11, 3.12"]
    found = []
    for column in zip(*DIFFERENCES_PX2["3.11, 3.12"]):
        (area,) = set.intersection(*({one - gap, one + gap} for one, gap in zip(left, column)))
        found.append(area)
    return tuple(found)


def _square(area_px2: float) -> Blob:
    return Blob(np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * np.sqrt(area_px2), contrast=1.0)


def _lengths(left: Camera) -> Iterator[Row]:
    focal_px = FOCAL_MM / PIXEL_MM
    yield _row(
        f"table 3.1: a lens of {FOCAL_MM} mm, pixels of {PIXEL_MM * 1000:g} µm",
        f"a focal length of {focal_px:.0f} px; calibrated (3.4.1): {left.K[0, 0]:.0f} px",
        abs(focal_px / left.K[0, 0] - 1) < 0.05,
    )
    for table, lines in (("3.2", TABLE_3_2), ("3.5", TABLE_3_5)):
        for axis, (image_mm, image_px, error_px, error_mm) in zip("xy", lines):
            follows_mm = error_px * image_mm / image_px
            yield _row(
                f"table {table}: {error_px:g} px in {axis} are {error_mm:g} mm",
                f"{follows_mm:.2f} mm",
                abs(follows_mm - error_mm) <= 0.006,
            )
    image_mm, image_px, *_ = TABLE_3_2[0]
    distance_m = left.K[0, 0] * image_mm / image_px / 1000
    yield _row(
        f"table 3.2: {image_px} px show {image_mm:g} mm, parts {WORK_M * 100:.0f} cm away",
        f"that far away is {distance_m * 100:.0f} cm; at {WORK_M * 100:.0f} cm they show "
        f"{WORK_M * image_px / left.K[0, 0] * 1000:.0f} mm",
        False,
    )


def _areas() -> Iterator[Row]:
    for name, lines in DIFFERENCES_PX2.items():
        left, right = AREAS_PX2[name]
        for i, line in enumerate(lines):
            for j, gap in enumerate(line[: len(right)]):
                if abs(left[i] - right[j]) != gap and len(right) == len(left):
                    yield _row(f"tables {name}: objects {i + 1} and {j + 1} differ by {gap} px²",
                               f"{left[i]} and {right[j]} differ by {abs(left[i] - right[j])}", False)  # fmt: skip
    printed, follows = AREAS_PX2["3.11, 3.12"][1][0], right_areas_of_3_12()[0]
    yield _row(f"table 3.11: object 1 has {printed} px² in the right view", f"table 3.12 takes it as {follows}", False)


def _depths() -> Iterator[Row]:
    for name, lines, mean_cm in (("3.13", TABLE_3_13, 1.75), ("3.14", TABLE_3_14, 0.12)):
        numbers, actual, calculated, error, percent = (np.array(column) for column in zip(*lines))
        consistent = np.allclose(np.abs(actual - calculated), error, atol=0.006)
        consistent &= bool(np.allclose(100 * error / actual, percent, atol=0.011))
        yield _row(f"table {name}: {len(lines)} errors and percentages", "the same", consistent)
        yield _row(
            f"table {name}: {mean_cm:g} cm on average", f"{error.mean():.2f} cm", abs(error.mean() - mean_cm) <= 0.006
        )
        if numbers.max() > len(lines):
            yield _row(f"table {name}: {numbers.max()} experiments", f"{len(lines)} are printed", False)
    one_two, one_three, two_three = (TABLE_3_16_CM[pair][0] for pair in ((1, 2), (1, 3), (2, 3)))
    yield _row(
        f"table 3.16: {two_three} cm between objects 2 and 3",
        f"{one_two} + {one_three} = {one_two + one_three:.2f} cm, object 1 lies between them",
        abs(one_two + one_three - two_three) <= 0.011,
    )


def _directions(right_T_left: Transform) -> Iterator[Row]:
    for text, transform in (
        ("eq. 3.14: P_L = R P_R + T, with the R and T of 3.4.2", right_T_left.inverse()),
        ("the reverse, P_R = R P_L + T", right_T_left),
    ):
        try:
            check_baseline(transform)
        except CalibrationError as error:
            yield _row(text, f"`{str(error).split(':')[0]}`", False)
        else:
            x_mm = transform.inverse().translation[0] * 1000
            yield _row(text, f"the right camera stands {decimals(x_mm, 0)} mm to the right", True)


def _row(printed: str, follows: str, agrees: bool) -> Row:
    return [printed, follows, "yes" if agrees else "**no**"]
