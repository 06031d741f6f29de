"""A solid is where its surface is, though its outlines are drawn too wide by some pixels."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from rendered_solids import PARTS, PATTERNED, PLACED, RIG, table_of, true_fit
from rendering import Scene

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes import Outline, SolidFit
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.surface import entered
from stereo_pick.core.shapes.surface_fit import Surface, solids_onto

TABLE = table_of(RIG, PLACED)
KINDS = {**PARTS, "hexprism": PATTERNED["hexprism"]}
TOO_WIDE_PX, SIGMA_PX = 4, 0.5
every_kind = pytest.mark.parametrize("name", KINDS)


def fit_of(name: str) -> SolidFit:
    return true_fit(RIG, Scene((KINDS[name],), PLACED), KINDS[name])


def too_wide(fit: SolidFit) -> tuple[Outline, Outline]:
    left, right = (Outline.from_contour(widened(fit.silhouette_px(camera))) for camera in (RIG.left, RIG.right))
    return left, right


def widened(outline_px: Floats) -> Floats:
    covered = np.zeros((480, 640), np.uint8)
    cv2.fillPoly(covered, [np.round(outline_px).astype(np.int32)], (1,))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * TOO_WIDE_PX + 1,) * 2)
    (contour,), _ = cv2.findContours(cv2.dilate(covered, disc), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return contour[:, 0].astype(np.float64)


def surface_of(fit: SolidFit) -> Surface:
    """Places two pixels apart all over the solid."""
    columns, rows = np.meshgrid(np.arange(0.0, 640, 2), np.arange(0.0, 480, 2))
    places = normalized(np.stack([columns.ravel(), rows.ravel()], axis=1), RIG.left)
    ahead = np.c_[places, np.ones(len(places))]
    depth_m = entered(fit, RIG.eyes_m[0], ahead)
    seen = np.isfinite(depth_m)
    return Surface(ahead[seen], RIG.focal_px * RIG.baseline_m / depth_m[seen], SIGMA_PX)


def of_its_kind(fit: SolidFit, several: list[Solids]) -> Solids:
    [solid] = [each for each in several if each.kind.name == fit.kind]
    return solid


def off_mm(fit: SolidFit, solid: Solids) -> float:
    return float(1000 * np.linalg.norm(solid.centre_m[0] - fit.centre_m))


def height_off_mm(fit: SolidFit, solid: Solids) -> float:
    return float(1000 * abs(TABLE.height_m(solid.centre_m[0]) - TABLE.height_m(fit.centre_m)))


def off_surface_px(surface: Surface, solid: Solids) -> float:
    depth_m = entered(SolidFit(solid.kind.name, *_of(solid), 0.1, np.eye(3)), RIG.eyes_m[0], surface.ahead)
    return float(np.nanmedian(np.abs(RIG.focal_px * RIG.baseline_m / depth_m - surface.disparity_px)))


def _of(solid: Solids) -> tuple[Floats, Floats, Floats]:
    return solid.centre_m[0], solid.rotation[0], solid.size_m()[0]


@every_kind
def test_it_passes_through_the_surface_though_its_outlines_are_too_wide(name: str) -> None:
    """It is as high as it is; where a box ends behind, outlines alone tell."""
    fit = fit_of(name)
    surface, pair = surface_of(fit), too_wide(fit)
    nowhere = Surface(np.zeros((0, 3)), np.zeros(0), SIGMA_PX)
    without = of_its_kind(fit, solids_onto(nowhere, [pair], RIG, TABLE))
    found = of_its_kind(fit, solids_onto(surface, [pair], RIG, TABLE))
    assert off_surface_px(surface, found) < 0.05 < 0.3 < off_surface_px(surface, without)
    assert height_off_mm(fit, found) < 0.3 < 0.9 < height_off_mm(fit, without)
    assert off_mm(fit, found) < TOO_WIDE_PX * 1000 * fit.centre_m[2] / RIG.focal_px


@every_kind
def test_what_is_found_stands_on_the_table(name: str) -> None:
    fit = fit_of(name)
    for solid in solids_onto(surface_of(fit), [too_wide(fit)], RIG, TABLE):
        assert abs(TABLE.under(solid)[0][0]) < 1e-6


def test_a_few_places_that_are_something_elses_do_not_matter() -> None:
    fit = fit_of("box")
    seen = surface_of(fit)
    far = np.random.default_rng(0).random(len(seen.disparity_px)) < 0.2
    mixed = seen._replace(disparity_px=seen.disparity_px + 5.0 * far)
    found = of_its_kind(fit, solids_onto(mixed, [too_wide(fit)], RIG, TABLE))
    assert off_surface_px(seen, found) < 0.05 and height_off_mm(fit, found) < 0.3


def test_without_outlines_there_is_nothing() -> None:
    assert solids_onto(surface_of(fit_of("box")), [], RIG, TABLE) == []
