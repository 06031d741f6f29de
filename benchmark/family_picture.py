"""One scene as a picture: both raw views side by side, with what is true and what was found."""

from __future__ import annotations

import cv2
import numpy as np
from rendering import Truth

from stereo_pick.core.arrays import Image
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline, Result

_TRUE, _OPTIONAL, _FOUND, _REFUSED = (80, 220, 80), (200, 160, 60), (60, 60, 255), (0, 200, 255)  # BGR


def picture(pipeline: Pipeline, frame: StereoFrame, truth: Truth) -> Image:
    """Circles: centres of parts, green where they must be found; red crosses: poses; yellow: refusals with reason."""
    result = pipeline.run(frame)
    views = [cv2.cvtColor(view, cv2.COLOR_GRAY2BGR) for view in (frame.left, frame.right)]
    for view, centres in zip(views, pipeline.rig.project(truth.centres_m)):
        for number, (each, at) in enumerate(zip(truth.objects, centres)):
            colour = _TRUE if each.required else _OPTIONAL
            cv2.circle(view, _rounded(at), 7, colour, 1, cv2.LINE_AA)
            cv2.putText(view, str(number), _rounded(at + (9, -5)), cv2.FONT_HERSHEY_PLAIN, 0.9, colour, 1, cv2.LINE_AA)
    for view, poses in zip(views, pipeline.rig.project(result.poses.xyz)):
        for at in poses:
            cv2.drawMarker(view, _rounded(at), _FOUND, cv2.MARKER_CROSS, 9, 1)
    _draw_refusals(views, pipeline, result)
    return np.hstack(views)


def _draw_refusals(views: list[Image], pipeline: Pipeline, result: Result) -> None:
    for refusal in result.poses.refused:
        sides = ((views[0], pipeline.rig.left, refusal.left_px), (views[1], pipeline.rig.right, refusal.right_px))
        for view, camera, rectified_px in sides:
            if rectified_px is None:
                continue
            at = camera.unrectified(rectified_px)[0]
            cv2.drawMarker(view, _rounded(at), _REFUSED, cv2.MARKER_TILTED_CROSS, 8, 1)
            cv2.putText(view, refusal.reason, _rounded(at + (6, 12)), cv2.FONT_HERSHEY_PLAIN, 0.8, _REFUSED, 1)


def _rounded(at: np.ndarray) -> tuple[int, int]:
    return int(np.round(at[0])), int(np.round(at[1]))
