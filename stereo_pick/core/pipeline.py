"""The way of a frame: five calls, in order. The ROS nodes make one of them each; offline, all are made here."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from stereo_pick.core.correspondence import Correspondences, Method
from stereo_pick.core.correspondence.correspondences import collect
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.correspondence.levelling import Turn, turn_of
from stereo_pick.core.correspondence.rig_check import rig_fault
from stereo_pick.core.errors import ImageError
from stereo_pick.core.frames import RectifiedPair, StereoFrame
from stereo_pick.core.matches.unseen import unseen
from stereo_pick.core.objects import Blobs, Detector
from stereo_pick.core.poses import ObjectPoses, estimate_poses
from stereo_pick.core.positioning import Positioning
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Triangulator


@dataclass(frozen=True)
class Result:
    """What became of one frame."""

    pair: RectifiedPair
    blobs: Blobs
    correspondences: Correspondences
    poses: ObjectPoses


@dataclass(frozen=True)
class Steps:
    """The configured steps of the pipeline."""

    detector: Detector = field(default_factory=Detector)
    method: Method = field(default_factory=Feature)
    triangulator: Triangulator = field(default_factory=Triangulator)

    def correspond(self, pair: RectifiedPair) -> tuple[Blobs, Correspondences]:
        """Find the objects and match them."""
        blobs = self.detector.detect(pair)
        return blobs, self.matched(pair, blobs)

    def matched(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Match the objects found; refuses all where a view cannot show them or misfits the calibration.

        Raises ImageError where the arithmetic fails.
        """
        return replace(self._matched(pair, blobs), moved_px=blobs.moved_px)

    def _matched(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        if any(blobs.view_faults):
            return collect([], unseen(blobs, pair))
        if fault := rig_fault(blobs, pair.rig):
            return _none_of(blobs, fault)
        turn = turn_of(blobs, pair.rig)
        return self._match(pair, blobs) if turn is None else self._turned(turn, pair, blobs)

    def _turned(self, turn: Turn, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """What is found where a camera has turned; what is found without that, if solids explain more of it: then
        shadows and high lights, which begin and end elsewhere in each view, looked like a turn."""
        undone = self._match(*turn.undone(pair, blobs))
        if undone.explained < len(undone) + len(undone.refused):
            found = self._match(pair, blobs)
            if found.explained > undone.explained:
                return found
        if turn.is_too_far:
            return _none_of(blobs, "misaligned", f"turned by {np.rad2deg(turn.angle_rad):.2f} deg")
        return turn.told(undone)

    def _match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        try:
            return self.method.match(pair, blobs)
        except np.linalg.LinAlgError as error:  # a fault of ours, but one pair must not end a node beside a robot
            raise ImageError(
                f"this pair cannot be computed ({error}), and nothing of it is published: take another one, and report "
                "the fault with both images and the calibration"
            ) from error

    def locate(self, correspondences: Correspondences, rig: StereoRig, stamp_ns: int) -> ObjectPoses:
        """Triangulate what was matched."""
        points = self.triangulator.triangulate(correspondences, rig)
        return estimate_poses(points, correspondences, rig, stamp_ns)


class Pipeline:
    """Raw pairs to object poses, for one rig."""

    def __init__(self, rig: StereoRig, steps: Steps, positioning: Positioning | None = None) -> None:
        self.rig = rig
        self.steps = steps
        self.positioning = positioning or Positioning()
        self.positioning.check(rig)
        self._rectifier = Rectifier(rig)

    def run(self, frame: StereoFrame) -> Result:
        """Return the poses of one raw pair and all that led to them.

        Raises ImageError on a wrong image size, and on one image for both cameras.
        """
        _check_two_cameras(frame)
        pair = self._rectifier.rectify(frame)
        blobs, correspondences = self.steps.correspond(pair)
        poses = self.positioning.place(self.steps.locate(correspondences, self.rig, frame.stamp_ns), self.rig)
        return Result(pair, blobs, correspondences, poses)


def _check_two_cameras(frame: StereoFrame) -> None:
    if np.array_equal(frame.left, frame.right) and frame.left.min() < frame.left.max():
        raise ImageError(
            "left and right image are the same to the last bit, which two cameras never are: one camera's image is "
            "given for both"
        )


def _none_of(blobs: Blobs, fault: str, detail: str = "") -> Correspondences:
    asked = blobs.sound()[0] or blobs.left
    return collect([], [Refusal(fault, blob.centroid_px, None, detail) for blob in asked])
