"""What is compared: the package's methods, the thesis's own, and OpenCV's dense stereo with the package's outlines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.correspondence import Correspondences, Method
from stereo_pick.core.correspondence.correspondences import Match, collect
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.frames import RectifiedPair, StereoFrame
from stereo_pick.core.matches.left_over import left_over
from stereo_pick.core.objects import Blob, Blobs, Detector
from stereo_pick.core.params import parameter
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Triangulator

FEATURE, SSD = "`feature`", "`ssd`"
THESIS_FEATURE, THESIS_SSD = "thesis: area, Otsu", "thesis: SSD 3 × 3, whole image"
WORKING_DEPTH_M = (0.6, 1.5)  # granted to the dense methods, whose time and errors grow with the range
_BM_WINDOW_PX, _SGBM_WINDOW_PX = 21, 5
_SIGMA_PX = 0.5

THESIS_DETECTOR = Detector(
    threshold="otsu", subpixel=False, max_concavity=10.0, min_contrast=1, min_relative_contrast=0.0
)


Meant = Literal["centre of volume", "surface at the centroid", "mean of visible surface"]


@dataclass(frozen=True)
class Contender:
    """A way from a raw pair to positions; meant: which point of an object they are."""

    name: str
    meant: Meant
    locate: Callable[[StereoFrame], ObjectPoses]


@dataclass(frozen=True)
class DenseStereo(Method):
    """The median disparity that OpenCV finds inside each outline of the left view."""

    matcher: str = parameter(
        "bm", "OpenCV's block matching or semi-global matching.", choices=("bm", "sgbm", "sgbm_3way")
    )

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return left centroids, and the right points at the objects' median disparity."""
        least, most = self.disparities_px(pair.rig)
        disparity_px = self._disparity(pair, int(np.floor(least)), int(np.ceil(most)))
        left, right = blobs.sound()
        matches, refused = [], left_over(blobs, [*left, *right], Feature().similarity(pair.rig))
        for blob in left:
            seen = disparity_px[_mask(blob, disparity_px.shape)]
            seen = seen[np.isfinite(seen)]
            if len(seen) == 0:
                refused.append(Refusal("no_texture", blob.centroid_px, None))
                continue
            length, width, direction = blob.rectangle
            right_px = blob.centroid_px - (float(np.median(seen)), 0.0)
            matches.append(Match(blob.centroid_px, right_px, (_SIGMA_PX, _SIGMA_PX), (length, width), direction))
        return collect(matches, refused)

    def _disparity(self, pair: RectifiedPair, least_px: int, most_px: int) -> NDArray[np.float32]:
        """Disparity (H, W) of the left view, NaN where none was found.

        The rectified cameras have different cx, so the disparities are negative, where OpenCV silently drops
        columns: both views are put on a canvas on which they run from 0, with room for the widest search.
        """
        search_px = -(-(most_px - least_px) // 16) * 16
        margin_px = max(search_px, -least_px)
        canvas_px = pair.left.shape[1] + margin_px + max(0, least_px)
        left, right = (
            cv2.copyMakeBorder(
                np.array(view), 0, 0, start, canvas_px - start - view.shape[1], cv2.BORDER_CONSTANT, value=[0]
            )
            for view, start in ((pair.left, margin_px), (pair.right, margin_px + least_px))
        )
        found = self._opencv(search_px).compute(left, right)[:, margin_px : margin_px + pair.left.shape[1]]
        return np.where(found < 0, np.nan, found / 16 + least_px).astype(np.float32)

    def _opencv(self, search_px: int) -> cv2.StereoMatcher:
        if self.matcher == "bm":
            return cv2.StereoBM.create(search_px, _BM_WINDOW_PX)
        area = _SGBM_WINDOW_PX**2
        mode = cv2.STEREO_SGBM_MODE_SGBM if self.matcher == "sgbm" else cv2.STEREO_SGBM_MODE_SGBM_3WAY
        return cv2.StereoSGBM.create(
            0, search_px, _SGBM_WINDOW_PX, P1=8 * area, P2=32 * area, disp12MaxDiff=1, uniquenessRatio=10, mode=mode
        )


def contenders(rig: StereoRig) -> list[Contender]:
    """Everything that is compared, the package's default first."""
    near, far = WORKING_DEPTH_M
    bm, sgbm = (DenseStereo(min_depth_m=near, max_depth_m=far, matcher=name) for name in ("bm", "sgbm"))
    volume: Meant = "centre of volume"
    point: Meant = "surface at the centroid"
    surface: Meant = "mean of visible surface"
    return [
        Contender(FEATURE, volume, _package(rig, Steps())),
        Contender(SSD, point, _package(rig, Steps(method=Ssd()))),
        Contender(THESIS_FEATURE, volume, _thesis(rig, Feature(assignment="area"))),
        Contender(THESIS_SSD, point, _thesis(rig, Ssd(search="full"))),
        Contender("OpenCV StereoBM", surface, _package(rig, Steps(method=bm))),
        Contender("OpenCV StereoSGBM", surface, _package(rig, Steps(method=sgbm))),
    ]


def _package(rig: StereoRig, steps: Steps) -> Callable[[StereoFrame], ObjectPoses]:
    pipeline = Pipeline(rig, steps)
    return lambda frame: pipeline.run(frame).poses


def _thesis(rig: StereoRig, method: Method) -> Callable[[StereoFrame], ObjectPoses]:
    """The thesis's way: whatever is matched is triangulated, and nothing asks whether the rays meet."""
    steps = Steps(THESIS_DETECTOR, method, Triangulator(max_ray_gap_m=1.0))
    rectifier = Rectifier(rig)

    def locate(frame: StereoFrame) -> ObjectPoses:
        pair = rectifier.rectify(frame)
        return steps.locate(method.match(pair, steps.detector.detect(pair)), rig, frame.stamp_ns)

    return locate


def _mask(blob: Blob, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    filled = np.zeros(shape, np.uint8)
    cv2.drawContours(filled, [np.round(blob.contour_px).astype(np.int32)], -1, 1, cv2.FILLED)
    return filled.astype(np.bool_)
