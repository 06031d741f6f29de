"""What was found, for people and as JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.camera import Camera
from stereo_pick.core.depth_report import depths_between
from stereo_pick.core.pipeline import Result
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import REASONS, Refusal
from stereo_pick.core.rig import StereoRig

_MAX_DEPTHS = 15  # of six objects; a longer list is for the JSON's reader

FRAME = "left camera optical frame (raw, not rectified): x right, y down, z forward"


def result_mapping(result: Result, method: str) -> dict[str, Any]:
    """The JSON of one pair: positions in metres in `frame`, raw pixels."""
    poses, rig = result.poses, result.pair.rig
    return {
        "frame": poses.frame_id or FRAME,
        "stamp_ns": poses.stamp_ns,
        "method": method,
        "polarity": result.blobs.polarity,
        "calibration_hash": calibration_hash(rig),
        "covariance_of": list(poses.covariance_of),
        "tolerance_m": poses.tolerance_m,
        "turned_px": result.correspondences.turned_px,
        "objects": [_object(poses, index) for index in range(len(poses))],
        "refused": [_refused(refusal, rig) for refusal in poses.refused],
    }


def result_text(result: Result) -> str:
    """A table of the objects, the depths between them, and what was refused."""
    poses = result.poses
    lines = [pose_table(poses)]
    if len(poses) and (poses.frame_id or len(poses.covariance_of) > 1):
        frame = poses.frame_id or "the left camera's optical frame"
        lines.append(f"in {frame}; uncertainty of: {', '.join(poses.covariance_of)}")
    between = [] if poses.frame_id else depths_between(poses.xyz)
    if 0 < len(between) <= _MAX_DEPTHS:
        lines += ["", "depth between objects, Z(b) - Z(a):"]
        lines += [f"  {pair.first} - {pair.second}  {pair.depth_m * 1000:9.2f} mm" for pair in between]
    if result.correspondences.notice:
        lines += ["", result.correspondences.notice]
    if poses.refused:
        lines += ["", "refused:"]
        lines += [f"  {_refusal_text(refusal, result.pair.rig)}" for refusal in poses.refused]
    return "\n".join(lines)


def pose_table(poses: ObjectPoses) -> str:
    """One line an object, in millimetres."""
    if len(poses) == 0:
        return "no object"
    lines = [
        f"{'#':>3} {'x mm':>9} {'y mm':>9} {'z mm':>9} {'± z mm':>7} {'confidence':>10} {'gap mm':>7} {'size mm':>20} "
        f"{'kind':>8}"
    ]
    for index, (x, y, z) in enumerate(poses.xyz * 1000):
        sigma = np.sqrt(poses.covariance[index, 2, 2]) * 1000
        kind = poses.kinds[index] or "-"
        size = " x ".join(f"{side * 1000:.1f}" for side in poses.size_m[index] if side > 0)
        gap = poses.ray_gap[index] * 1000
        lines.append(
            f"{index + 1:>3} {x:>9.2f} {y:>9.2f} {z:>9.2f} {sigma:>7.2f} {poses.confidence[index]:>10.4f} {gap:>7.2f} "
            f"{size:>20} {kind:>8}"
        )
    return "\n".join(lines)


def _object(poses: ObjectPoses, index: int) -> dict[str, Any]:
    return {
        "position_m": poses.xyz[index].tolist(),
        "covariance_m2": poses.covariance[index].tolist(),
        "confidence": float(poses.confidence[index]),
        "ray_gap_m": float(poses.ray_gap[index]),
        "size_m": poses.size_m[index].tolist(),
        "kind": poses.kinds[index],
        "orientation_xyzw": poses.quaternions()[index].tolist(),
        "yaw_rad": float(poses.heading_rad[index]),
        "left_px": poses.left_px[index].tolist(),
        "right_px": poses.right_px[index].tolist(),
    }


def _refused(refusal: Refusal, rig: StereoRig) -> dict[str, Any]:
    return {
        "reason": refusal.reason,
        "meaning": REASONS[refusal.reason],
        "detail": refusal.detail,
        "left_px": _raw(refusal.left_px, rig.left),
        "right_px": _raw(refusal.right_px, rig.right),
    }


def _refusal_text(refusal: Refusal, rig: StereoRig) -> str:
    places = [
        f"{side} ({raw[0]:.0f}, {raw[1]:.0f})"
        for side, raw in (("left", _raw(refusal.left_px, rig.left)), ("right", _raw(refusal.right_px, rig.right)))
        if raw is not None
    ]
    detail = f" ({refusal.detail})" if refusal.detail else ""
    return f"{refusal.reason} at {', '.join(places)}: {REASONS[refusal.reason]}{detail}"


def _raw(rectified_px: Floats | None, camera: Camera) -> list[float] | None:
    if rectified_px is None:
        return None
    raw: list[float] = camera.unrectified(rectified_px)[0].tolist()
    return raw
