"""Exact outlines of convex solids in both rectified views, and outlines with the errors that real edges have."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from rigs import rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import Outline
from stereo_pick.core.shapes.kinds import KINDS

_STEP_PX = 0.5
_RIM = 1440
_ANGLE = np.arange(_RIM) * 2 * np.pi / _RIM
_CIRCLE = np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=1)


@dataclass(frozen=True)
class Part:
    """A solid in the rectified left frame [m]: half sizes (radius), (radius, half length), (half across flats, half
    length) or three."""

    kind: str
    centre_m: Floats
    rotation: Floats
    half_m: Floats

    def seen_from(self, eye_m: Floats) -> Floats:
        """Points (N, 3) [m], relative to an eye (3,), whose hull has the part's silhouette."""
        towards = self.centre_m - eye_m
        if self.kind == "sphere":
            return self._horizon(towards)
        rim = _CIRCLE * self.half_m[0]
        if self.kind == "cylinder":
            points = np.concatenate([np.c_[rim, np.full(_RIM, end * self.half_m[1])] for end in (-1, 1)])
        elif self.kind == "hexprism":
            rim = _CIRCLE[:: _RIM // 6] * self.half_m[0] * 2 / np.sqrt(3)
            points = np.concatenate([np.c_[rim, np.full(6, end * self.half_m[1])] for end in (-1, 1)])
        else:
            points = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 3) * self.half_m
        return points @ self.rotation.T + towards

    def _horizon(self, towards: Floats) -> Floats:
        distance = np.linalg.norm(towards)
        z = towards / distance
        x = np.cross(z, (0, 1, 0))
        x /= np.linalg.norm(x)
        sine = self.half_m[0] / distance
        ring = np.sqrt(1 - sine**2) * _CIRCLE @ np.array([x, np.cross(z, x)]) - sine * z
        return np.asarray(towards + self.half_m[0] * ring)


def contour_px(points_m: Floats, camera: Camera) -> Floats:
    """The hull (N, 2) [px], closely sampled, of points (M, 3) [m] relative to a rectified camera."""
    image = points_m[:, :2] / points_m[:, 2:] * camera.P[0, 0] + camera.P[:2, 2]
    hull = image[cv2.convexHull((image - image.mean(axis=0)).astype(np.float32), returnPoints=False)[:, 0]]
    side = np.roll(hull, -1, axis=0) - hull
    counts = (np.linalg.norm(side, axis=1) / _STEP_PX).astype(int) + 1
    which = np.repeat(np.arange(len(hull)), counts)
    part = (np.arange(len(which)) - np.repeat(counts.cumsum() - counts, counts)) / counts[which]
    return np.asarray(hull[which] + part[:, None] * side[which])


def contours_px(part: Part, rig: StereoRig) -> tuple[Floats, Floats]:
    eyes = np.array([[0.0, 0.0, 0.0], [rig.baseline_m, 0.0, 0.0]])
    left, right = (contour_px(part.seen_from(eye), lens) for eye, lens in zip(eyes, (rig.left, rig.right)))
    return left, right


def side_contours_px(cylinder: Part, rig: StereoRig, points: int = 150) -> tuple[Floats, Floats]:
    """What both views show of a cylinder's round side alone, without its ends: closed contours (N, 2) [px]."""
    radius_m, half_m = cylinder.half_m
    contours = []
    for eye_m, camera in zip(rig.eyes_m, (rig.left, rig.right)):
        towards = (eye_m - cylinder.centre_m) @ cylinder.rotation
        reach = np.arccos(radius_m / np.hypot(*towards[:2]))
        angle = np.arctan2(towards[1], towards[0]) + np.linspace(-reach, reach, points)
        rim = radius_m * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        ring = np.concatenate([np.c_[rim, np.full(points, -half_m)], np.c_[rim[::-1], np.full(points, half_m)]])
        seen = ring @ cylinder.rotation.T + cylinder.centre_m - eye_m
        contours.append(seen[:, :2] / seen[:, 2:] * camera.P[0, 0] + camera.P[:2, 2])
    return contours[0], contours[1]


def distances_px(points: Floats, contour: Floats) -> Floats:
    """Of points (N, 2) from a closed contour, inside positive."""
    line = contour.astype(np.float32)
    return np.array([cv2.pointPolygonTest(line, (float(x), float(y)), True) for x, y in points])


def outlines_of(part: Part, rig: StereoRig) -> tuple[Outline, Outline]:
    left, right = contours_px(part, rig)
    return Outline.from_contour(left), Outline.from_contour(right)


def disturbed(contour: Floats, sigma_px: float, rng: np.random.Generator, arcs: int = 9) -> Floats:
    """The contour moved along its normals by smooth noise that has as many independent values around it."""
    dense = Outline.from_contour(contour, points=200)
    waves = np.zeros(101, complex)
    waves[0], waves[1 : arcs // 2 + 1] = rng.normal(), rng.normal(size=(arcs // 2, 2)) @ (1, 1j) / np.sqrt(2)
    noise = np.fft.irfft(waves, 200) * 200 / np.sqrt(arcs)
    return np.asarray(dense.points_px + sigma_px * noise[:, None] * dense.normals)


def any_part(kind: str, rig: StereoRig, rng: np.random.Generator) -> Part:
    """At 0.4 to 1.5 m, 30 to 90 px across, turned in any way."""
    x, y, depth = rng.uniform(-0.12, 0.12), rng.uniform(-0.12, 0.12), rng.uniform(0.4, 1.5)
    centre = np.array([rig.baseline_m / 2 + x * depth, y * depth, depth])
    half = rng.uniform(15, 45, 3) * depth / rig.focal_px
    return Part(kind, centre, rotation(rng.normal(size=3) * 2), half[: KINDS[kind].sizes])
