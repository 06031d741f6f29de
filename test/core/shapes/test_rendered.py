"""Solids from rendered pairs, found by the detector: what light, blur and pixels leave of the truth."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rendered_solids import table_of
from rendering import Box, Cylinder, HexPrism, Scene, Solid, Sphere, hex_prism_size, render
from rigs import RIGS
from solid_outlines import contour_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.shapes import Outline, SolidFit, centroid_px, common_normal, fit_solids
from stereo_pick.core.shapes.table import Table

RIG = RIGS["verged"]
PARTS: tuple[Solid, ...] = (
    Cylinder(-0.09, -0.03, (0.042, 0.042, 0.052)),
    Cylinder(0.0, 0.06, (0.03, 0.03, 0.07), yaw_rad=0.6, lying=True),
    Box(0.08, -0.02, (0.05, 0.036, 0.04), yaw_rad=0.4),
    Sphere(0.0, -0.05, (0.044, 0.044, 0.044)),
)
SCENE = Scene(PARTS)


def of(blobs: tuple[Blob, ...], place_px: Floats) -> Blob:
    return min(blobs, key=lambda blob: float(np.linalg.norm(blob.centroid_px - place_px)))


@cache
def matched() -> tuple[Floats, list[tuple[Blob, Blob]]]:
    """The parts' centres (N, 3) in the rectified left frame, and their outlines."""
    pair: RectifiedPair = Rectifier(RIG).rectify(render(RIG, SCENE))
    blobs, found = Steps().correspond(pair)
    outlines = [(of(blobs.left, left), of(blobs.right, right)) for left, right in zip(found.left_px, found.right_px)]
    truth = SCENE.positions_m() @ RIG.left.R.T
    image = truth[:, :2] / truth[:, 2:] * RIG.focal_px + RIG.left.P[:2, 2]
    order = [int(np.linalg.norm(image - left, axis=1).argmin()) for left in found.left_px]
    assert sorted(order) == list(range(len(PARTS)))
    return truth[order], outlines


def fits(table: Table | None = None) -> list[SolidFit | None]:
    pairs = [tuple(Outline.from_contour(blob.contour_px) for blob in pair) for pair in matched()[1]]
    return fit_solids([(left, right) for left, right in pairs], RIG, table, noise_px=0.15)


def error_m(truth: Floats, pair: tuple[Blob, Blob], fit: SolidFit | None) -> float:
    """Of the triangulated solid-angle centroids, moved by what perspective does to the solid's own."""
    rays = []
    for blob, lens in zip(pair, (RIG.left, RIG.right)):
        shift = fit.perspective_shift_px(lens) if fit else np.zeros(2)
        rays.append((centroid_px(blob.contour_px, lens) + shift - lens.P[:2, 2]) / lens.P[0, 0])
    depth = RIG.baseline_m / (rays[0][0] - rays[1][0])
    found = np.array([rays[0][0] * depth, (rays[0][1] + rays[1][1]) / 2 * depth, depth])
    return float(np.linalg.norm(found - truth))


def test_kinds_and_the_tables_normal_are_found() -> None:
    truth, _ = matched()
    found = fits()
    kinds = [type(part).__name__.lower() for part in PARTS]
    place = [int(np.linalg.norm(SCENE.positions_m() @ RIG.left.R.T - each, axis=1).argmin()) for each in truth]
    assert [fit and fit.kind for fit in found] == [kinds[i] for i in place]
    normal = common_normal(found)
    assert normal is not None
    assert np.rad2deg(np.arccos(normal @ (RIG.left.R @ SCENE.left_T_table.rotation[:, 2]))) < 1.5


def test_the_corrected_point_is_nearer_to_the_centre() -> None:
    truth, outlines = matched()
    plain = np.array([error_m(each, pair, None) for each, pair in zip(truth, outlines)])
    free = np.array([error_m(each, pair, fit) for each, pair, fit in zip(truth, outlines, fits())])
    standing = fits(table_of(RIG, SCENE.left_T_table))
    known = np.array([error_m(each, pair, fit) for each, pair, fit in zip(truth, outlines, standing)])
    assert free.mean() < 0.6 * plain.mean() and known.mean() < 0.6 * plain.mean()
    assert free.max() < 4e-4 and known.max() < 4e-4


def fit_to_hull(hull_m: Floats) -> SolidFit | None:
    """The solid fitted to exact outlines of the hull of points (N, 3) [m] of the table's frame."""
    hull = SCENE.left_T_table.apply(hull_m) @ RIG.left.R.T
    contours = [
        contour_px(hull - eye, lens) for eye, lens in (((0, 0, 0), RIG.left), ((RIG.baseline_m, 0, 0), RIG.right))
    ]
    left, right = (Outline.from_contour(contour) for contour in contours)
    return fit_solids([(left, right)], RIG)[0]


@pytest.mark.parametrize("lying", [False, True])
def test_a_hexagonal_prism_is_found_as_it_stands_or_lies(lying: bool) -> None:
    prism = HexPrism(0.0, 0.0, hex_prism_size(0.05, 0.04), yaw_rad=0.3, lying=lying)
    fit = fit_to_hull(prism.hull_m())
    assert fit is not None and fit.kind == "hexprism"
    truth = SCENE.left_T_table.apply(prism.centre_m[None])[0] @ RIG.left.R.T
    np.testing.assert_allclose(fit.centre_m, truth, atol=5e-5)
    np.testing.assert_allclose(fit.size_m, np.array([0.1 / np.sqrt(3), 0.05, 0.04]), rtol=5e-3)


@pytest.mark.parametrize("sides", [3, 5])
def test_prisms_with_other_numbers_of_sides_are_no_solid_that_is_known(sides: int) -> None:
    angle = 0.3 + np.arange(sides) * 2 * np.pi / sides
    rim = 0.025 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert fit_to_hull(np.concatenate([np.c_[rim, np.full(sides, z)] for z in (0.0, 0.04)])) is None
