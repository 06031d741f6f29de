"""When a solid that is found late is hardly anything else."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, rectified, solid_of
from rendering import Scene

from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.found_late import evident
from stereo_pick.core.found_late.evident import Evident
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs, Detector
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
TABLE = Table(NORMAL, -float(NORMAL @ RIG.left.R @ PLACED.translation), 5e-4)


@dataclass(frozen=True)
class Case:
    """part: which; shown, creased, denied, most_shown: as of `Evident`; off_px: how far it lies off its edges; goes_on:
    whether there is more to its outlines; stands: whether its edges alone put it on the table;
    seen, beyond: whether its surface is seen where it is, and beyond that."""

    part: str = "box"
    shown: float = 0.7
    creased: float = 0.8
    denied: float = 0.2
    most_shown: float = 0.65
    off_px: float = 0.25
    goes_on: bool = False
    stands: bool = False
    seen: bool = False
    beyond: bool = False


@cache
def seen(part: str) -> tuple[RectifiedPair, Blobs, Solids]:
    """The views of a lone part, what is found in them, and what it is."""
    scene = Scene((PARTS[part],), PLACED, ambient=0.5)
    pair = rectified(RIG, scene)
    return pair, Detector().detect(pair), solid_of(RIG, scene, PARTS[part])


@pytest.mark.parametrize(
    ("case", "is_clear"),
    [
        (Case(), True),
        (Case(off_px=0.35), False),
        (Case(most_shown=0.75), False),
        (Case(goes_on=True), False),
        (Case(shown=0.45, most_shown=0.2), False),
        (Case(creased=0.5), False),
        (Case(creased=0.5, denied=0.03), False),
        (Case(creased=0.5, denied=0.03, shown=0.8), True),
        (Case(creased=0.5, denied=0.2, shown=0.8), False),
        (Case(creased=0.5, denied=0.03, stands=True), False),
        (Case("lying", creased=0.5, denied=0.03, stands=True), True),
        (Case("lying", creased=0.5, denied=0.03, stands=False), False),
        (Case(creased=0.1, denied=0.08, off_px=0.4, seen=True), True),
        (Case(creased=0.1, denied=0.2, off_px=0.4, seen=True), True),
        (Case(creased=0.1, denied=0.2, off_px=0.4, seen=True, beyond=True), False),
        (Case(creased=0.1, denied=0.3, off_px=0.4, seen=True), False),
        (Case(creased=0.1, denied=0.08, off_px=0.6, seen=True), False),
        (Case(creased=0.1, denied=0.08, most_shown=0.8, seen=True), False),
        (Case(creased=0.1, denied=0.08, shown=0.45, most_shown=0.2, seen=True), False),
        (Case(creased=0.1, denied=0.08, goes_on=True, seen=True), False),
    ],
    ids=[
        "its creases show",
        "but it lies off its edges",
        "but another shows more",
        "but there is more to its outlines",
        "but less than half of it shows",
        "creases do not",
        "nor does anything deny it",
        "and most of it shows",
        "which something denies",
        "and it stands by itself, but as a box with its creases",
        "and as a cylinder, with ends as bright as its side",
        "which does not stand",
        "its pattern is seen",
        "with edges beside it",
        "and beyond it",
        "with too many beside it",
        "but its edges are far off",
        "but another shows more than it",
        "but its silhouette hardly shows",
        "but it goes on",
    ],
)
def test_what_is_not_exactly_on_its_edges_is_told_from_all_else(
    case: Case, is_clear: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pair, blobs, true = seen(case.part)
    fit = SolidFit(true.kind.name, true.centre_m[0], true.rotation[0], true.size_m()[0], case.off_px, 1e-8 * np.eye(3))
    there = Adjusted(fit, case.shown, case.creased, True, case.denied)
    alone = fit if case.stands else replace(fit, centre_m=fit.centre_m + 0.01 * NORMAL)
    monkeypatch.setattr(evident, "adjusted", lambda *_, **__: ([replace(there, fit=alone)], None))
    monkeypatch.setattr(evident, "is_surface_seen", lambda *_: case.seen)
    monkeypatch.setattr(evident, "is_seen_beyond", lambda *_: case.beyond)
    monkeypatch.setattr(evident, "goes_on_beyond", lambda *_: case.goes_on)
    found = Supported(fit, 0.6, case.off_px, believable=False)
    look = Evident(Images(pair), TABLE, [])
    assert look.is_clear((blobs.left[0], blobs.right[0]), found, there, case.most_shown) == is_clear


@pytest.mark.parametrize(
    ("part", "off_px", "creased", "may_be_astray", "is_clear"),
    [
        ("sphere", 0.25, 1.0, False, True),
        ("sphere", 0.55, 1.0, False, False),
        ("sphere", 0.55, 1.0, True, True),
        ("box", 0.34, 0.8, False, False),
        ("box", 0.34, 0.8, True, True),
        ("box", 0.55, 0.8, True, False),
        ("box", 0.34, 0.5, True, False),
    ],
)
def test_a_ball_or_what_shows_its_creases_with_rounded_edges_may_be_off_them_if_it_bears_no_table_out(
    part: str, off_px: float, creased: float, may_be_astray: bool, is_clear: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pair, blobs, true = seen(part)
    fit = SolidFit(true.kind.name, true.centre_m[0], true.rotation[0], true.size_m()[0], off_px, 1e-8 * np.eye(3))
    there = Adjusted(fit, 0.8, creased, part == "box", 0.03)
    monkeypatch.setattr(evident, "adjusted", lambda *_, **__: ([there], None))
    monkeypatch.setattr(evident, "is_surface_seen", lambda *_: False)
    monkeypatch.setattr(evident, "goes_on_beyond", lambda *_: False)
    look = Evident(Images(pair), TABLE, [], may_be_astray)
    assert look.is_clear((blobs.left[0], blobs.right[0]), Supported(fit, 0.8, off_px, True), there, 0.65) == is_clear
