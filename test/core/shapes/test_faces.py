"""How large the flat faces of a solid look: against its silhouette, and in exact geometry."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS
from solid_outlines import Part, any_part, contour_px

from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.faces import face_areas_px2
from stereo_pick.core.shapes.kinds import KINDS

RIG = RIGS["verged"]
CAMERAS = (RIG.left, RIG.right)


def fit_of(part: Part) -> SolidFit:
    kind = KINDS[part.kind]
    size_m = 2 * np.array([part.half_m[i] for i in kind.axes]) * kind.spans
    return SolidFit(part.kind, part.centre_m, part.rotation, size_m, 0.0, np.zeros((3, 3)))


@given(st.sampled_from(["box", "hexprism"]), st.integers(0, 2**32 - 1))
def test_the_faces_that_are_seen_of_a_prism_make_up_its_silhouette(kind: str, seed: int) -> None:
    part = any_part(kind, RIG, np.random.default_rng(seed))
    for camera, eye_m in zip(CAMERAS, RIG.eyes_m):
        silhouette_px2 = cv2.contourArea(contour_px(part.seen_from(eye_m), camera).astype(np.float32))
        assert face_areas_px2(fit_of(part), camera).sum() == pytest.approx(silhouette_px2, rel=1e-3)


def test_the_end_of_a_cylinder_that_faces_the_camera_is_a_disc() -> None:
    part = Part("cylinder", np.array([0.0, 0.0, 0.83]), np.eye(3), np.array([0.02, 0.03]))
    radius_px = RIG.focal_px * 0.02 / 0.8
    assert face_areas_px2(fit_of(part), RIG.left) == pytest.approx([np.pi * radius_px**2], rel=0.005)


def test_a_ball_has_no_flat_face() -> None:
    part = Part("sphere", np.array([0.0, 0.0, 0.8]), np.eye(3), np.array([0.02]))
    assert len(face_areas_px2(fit_of(part), RIG.left)) == 0
