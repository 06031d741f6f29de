"""What known solids hide of others, by exact geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rendered_solids import PARTS, PLACED, rectified, solid_of
from rendered_solids import RIG as THESIS
from rendering import Scene
from rigs import RIGS

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.edge_evidence import edges_seen
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.occluders import Occluders, share_seen

RIG = RIGS["parallel"]
RADIUS_M = 0.02
BESIDE_PX = 3.0


def ball(x: float, y: float, z: float) -> SolidFit:
    return SolidFit("sphere", np.array([x, y, z]), np.eye(3), np.full(3, 2 * RADIUS_M), 0.1, np.eye(3))


def around(fit: SolidFit, view: int) -> Floats:
    """Places (1, 8, 2), normalized, around a ball as a view shows its middle."""
    middle = fit.centre_m - RIG.eyes_m[view]
    angle = np.arange(8) * (np.pi / 4)
    ring = RADIUS_M / middle[2] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.asarray(middle[:2] / middle[2] + ring)[None]


def behind_a_ball(places: Floats, fit: SolidFit, view: int, margin_rad: float) -> Floats:
    """Which places (1, N, 2) a ball covers: their rays pass its middle nearer than its limb."""
    rays = np.concatenate([places, np.ones((*places.shape[:2], 1))], axis=2)
    rays /= np.linalg.norm(rays, axis=2, keepdims=True)
    middle = fit.centre_m - RIG.eyes_m[view]
    distance = float(np.linalg.norm(middle))
    off = np.arccos(np.clip(rays @ middle / distance, -1, 1))
    return np.asarray(off < np.arcsin(RADIUS_M / distance) + margin_rad)


@given(st.floats(-0.06, 0.06), st.floats(-0.06, 0.06), st.floats(0.5, 0.65), st.sampled_from([0, 1]))
def test_a_nearer_ball_hides_what_its_limb_encloses(x: float, y: float, z: float, view: int) -> None:
    near, far = ball(x, y, z), ball(0.0, 0.0, 0.7)
    places = around(far, view)
    hidden = Occluders.of([near], RIG).hide(far.solid, places, view)
    px = 1 / RIG.focal_px
    surely, perhaps = (behind_a_ball(places, near, view, margin) for margin in (0.5 * px, (BESIDE_PX + 1) * px))
    assert (hidden >= surely).all() and (hidden <= perhaps).all()


def test_neither_a_farther_one_nor_it_itself_hides_anything() -> None:
    near, far = ball(0.0, 0.0, 0.5), ball(0.0, 0.0, 0.7)
    occluders = Occluders.of([near, far], RIG)
    assert not occluders.hide(near.solid, around(near, 0), 0).any()
    assert occluders.hide(far.solid, around(far, 0), 0, own=np.array([1])).all()
    assert not occluders.hide(far.solid, around(far, 0), 0, own=np.array([0])).any()


def test_what_is_covered_is_so_whatever_its_depth() -> None:
    near = ball(0.0, 0.0, 0.5)
    inside, outside = np.zeros((1, 2)), np.full((1, 2), 0.2)
    assert Occluders.of([near], RIG).cover(np.concatenate([inside, outside]), 0).tolist() == [True, False]


@pytest.mark.parametrize(("seen", "hidden", "share"), [(6, 0, 0.75), (6, 2, 1.0), (2, 6, 0.5), (0, 8, 0.0)])
def test_the_share_is_of_what_is_not_hidden_but_of_half_at_least(seen: int, hidden: int, share: float) -> None:
    """Of eight places; no more of them are seen than are not hidden."""
    places = np.arange(8)
    assert share_seen(places < seen, places >= 8 - hidden) == pytest.approx(share)


def test_of_what_would_not_be_there_anyway_no_share_is_asked() -> None:
    """Four of eight places are there, two of them hidden; hidden all, half of them are expected, and none is seen."""
    there, hidden = np.arange(8) < 4, np.arange(8) % 2 == 0
    assert share_seen(np.arange(8) == 1, hidden, there) == pytest.approx(0.5)
    assert share_seen(there & False, there, there) == 0.0


def test_creases_that_another_hides_are_none_that_show() -> None:
    """A box is there; behind something that hides it all nothing speaks for it."""
    scene = Scene((PARTS["box"],), PLACED, ambient=0.6)
    maps, solid = Images(rectified(THESIS, scene)).maps, solid_of(THESIS, scene, PARTS["box"])
    assert edges_seen([solid], maps, THESIS)[0].inner.shown()[0] > 0.6

    def everything(places: Floats, view: int) -> Bools:
        return np.ones(places.shape[:2], bool)

    assert edges_seen([solid], maps, THESIS, hides=[everything])[0].inner.shown()[0] == 0.0
    assert edges_seen([solid], maps, THESIS, hides=[everything])[0].shown[0] == 0.0
