"""Segmentation of both views into objects (thesis 3.7.2, steps 1 to 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product

import numpy as np

from stereo_pick.core.arrays import Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ImageError, ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects.background_files import load_background
from stereo_pick.core.objects.beside import with_others, without_shadows
from stereo_pick.core.objects.blob import MAX_CONCAVITY, Blob, Blobs
from stereo_pick.core.objects.energy import contrast_energy, seen_by_both
from stereo_pick.core.objects.exposure import view_fault, with_saturation
from stereo_pick.core.objects.focus import is_out_of_focus
from stereo_pick.core.objects.foreground import Contrast, contrast_with, foreground, measure_contrast
from stereo_pick.core.objects.learned import LearnedBackground
from stereo_pick.core.objects.outline import outlines
from stereo_pick.core.objects.shadow import Shadows
from stereo_pick.core.objects.silhouette import trace_silhouettes
from stereo_pick.core.objects.surfaces import surfaces, without_others
from stereo_pick.core.objects.view import View
from stereo_pick.core.params import Configurable, parameter, path_of

_MIN_EDGE_SIGMA = 3.0  # noise by which both sides of an edge must differ for its place to be refined
_SAFE_LEAD = 4.0  # holes are filled and gaps closed: objects may have more energy than their pixels


@dataclass(frozen=True)
class Detector(Configurable):
    """Finds the objects in each view of a rectified pair."""

    threshold: str = parameter(
        "background",
        "How object pixels are told from the background: by a model of the empty surface and its noise, "
        "by Otsu's histogram method, or by one fixed grey level.",
        choices=("background", "otsu", "fixed"),
    )
    background_file: str = parameter(
        "",
        "The empty surface as `stereo-pick background` or the service ~/learn_background learned it, for threshold = "
        "background; empty fits an even surface to each image.",
    )
    fixed_threshold: int = parameter(128, "Grey level for threshold = fixed.", low=0, high=255)
    threshold_sigma: float = parameter(
        6.0, "Contrast, in sigmas of the background, from which a pixel may belong to an object.", low=2.0, high=50.0
    )
    polarity: str = parameter(
        "auto",
        "Whether objects are brighter or darker than their background; auto finds out.",
        choices=("auto", "bright", "dark"),
    )
    min_area_px: int = parameter(60, "Objects of fewer pixels are noise (thesis 3.7.2, step 3).", low=1, high=1000000)
    roi_x_px: int = parameter(0, "Left edge of the region of interest in the left rectified image.", low=0, high=100000)
    roi_y_px: int = parameter(0, "Its top edge, in both rectified images.", low=0, high=100000)
    roi_width_px: int = parameter(0, "Its width; 0 looks for objects everywhere (thesis 3.7.1).", low=0, high=100000)
    roi_height_px: int = parameter(0, "Its height; 0 looks for objects everywhere.", low=0, high=100000)
    min_contrast: int = parameter(
        10, "Objects that differ by fewer grey levels from their background are stains.", low=1, high=255
    )
    min_relative_contrast: float = parameter(
        0.15, "The same, as a part of the strongest object's contrast in that view.", low=0.0, high=1.0
    )
    max_concavity: float = parameter(
        MAX_CONCAVITY,
        "Depth of the deepest notch in an outline, as a part of its width, from which it is merged: the outline of one "
        "convex part has none, that of touching or half-lit parts has. 10 accepts every outline.",
        low=0.01,
        high=10.0,
    )
    closing_px: int = parameter(
        3, "Gaps up to this width are closed (step 4), wider ones in a pattern; 0 closes none.", low=0, high=99
    )
    subpixel: bool = parameter(True, "Place each outline to a part of a pixel; false is the thesis's pixel mask.")

    def __post_init__(self) -> None:
        """Read the background file, if it is there already; a node may still have to learn it.

        Raises ParameterError on a value out of its range, and on a region of interest without size.
        """
        super().__post_init__()
        for begin, size in (("roi_x_px", "roi_width_px"), ("roi_y_px", "roi_height_px")):
            if getattr(self, begin) and not getattr(self, size):
                raise ParameterError(f"{begin} = {getattr(self, begin)} needs {size}, which is 0: objects everywhere")
        if self.background_file and path_of(self.background_file).exists():
            self._read_background()

    @cached_property
    def _learned(self) -> LearnedBackground | None:
        return load_background(path_of(self.background_file)) if self.background_file else None

    def _read_background(self) -> LearnedBackground | None:
        try:
            return self._learned
        except ImageError as error:
            raise ParameterError(f"background_file: {error}") from None

    def detect(self, pair: RectifiedPair) -> Blobs:
        """Return the objects of both views, left to right.

        With polarity = auto the way of reading them with more contrast energy (area x contrast²) wins, for both
        views together: a shadow is a weaker mark than its object. What the other way may show besides is in `others`.
        Raises ParameterError on a region of interest outside of the images.
        """
        self._check_region(pair.left)
        views = self._view(pair.left, pair.rig.left), self._view(pair.right, pair.rig.right)
        background = self._learned if self.threshold == "background" else None
        learned = background.adjusted(views, pair.rig) if background else []
        moved_px = max((each.moved_px for each in learned), default=0.0)
        if learned and np.isfinite(moved_px):
            left, right = (contrast_with(*each, self.threshold_sigma) for each in zip(learned, views))
            best = self._best(left, right)
        elif self.threshold == "background":
            left, right, best = self._on_the_table(*(self._contrast(view) for view in views))
        else:
            left, right = (self._contrast(view) for view in views)
            best = self._best(left, right)
        found = Blobs(
            self._finished(best.left, left, best.polarity),
            self._finished(best.right, right, best.polarity),
            best.polarity,
            max_concavity=self.max_concavity,
            moved_px=moved_px,
        )
        faults = self._view_fault(found.left, left), self._view_fault(found.right, right)
        found = replace(found, view_faults=faults)
        others = self._others(found, left, right)
        return found if others is None else with_others(found, others)

    def _check_region(self, image: Image) -> None:
        height, width = image.shape
        for name, begin, end in (("roi_x_px", self.roi_x_px, width), ("roi_y_px", self.roi_y_px, height)):
            if begin >= end:
                raise ParameterError(
                    f"segmentation.{name} = {begin} is outside of the image, which is {width} x {height}"
                )

    def _others(self, found: Blobs, left: Contrast, right: Contrast) -> Blobs | None:
        """What may be objects of the other polarity, where it was not chosen; None where a view shows nothing."""
        if self.polarity != "auto" or self.threshold != "background":
            return None
        polarity = "dark" if found.polarity == "bright" else "bright"
        sides = (found.left, left), (found.right, right)
        least = self.min_area_px * self.min_contrast**2
        if any(contrast.energies()[polarity] < least for _, contrast in sides):
            return None
        read = self._read(left, right, polarity)
        one, other = (self._other_side(blobs, polarity, *side) for blobs, side in zip((read.left, read.right), sides))
        return Blobs(one, other, polarity, max_concavity=self.max_concavity) if one and other else None

    def _other_side(
        self, blobs: tuple[Blob, ...], polarity: str, objects: tuple[Blob, ...], contrast: Contrast
    ) -> tuple[Blob, ...]:
        if polarity == "dark":
            blobs = without_shadows(blobs, objects, contrast)
        strongest = max((blob.contrast for blob in objects), default=0.0)
        finished = self._finished(blobs, contrast, polarity, strongest)
        return tuple(blob for blob in finished if blob.fault in ("", "merged"))

    def _view(self, image: Image, camera: Camera) -> View:
        return View.of(image, camera, None if self.subpixel and self.threshold == "background" else 1)

    def _contrast(self, view: View) -> Contrast:
        return measure_contrast(view, self.threshold, self.fixed_threshold, self.threshold_sigma)

    def _view_fault(self, blobs: tuple[Blob, ...], contrast: Contrast) -> str:
        least = max(float(self.min_contrast), self.threshold_sigma * contrast.background.sigma)
        return view_fault(contrast.view, blobs, least)

    def _best(self, left: Contrast, right: Contrast) -> Blobs:
        return self._read(left, right, self.polarity) if self.polarity != "auto" else self._clearer(left, right)

    def _on_the_table(self, left: Contrast, right: Contrast) -> tuple[Contrast, Contrast, Blobs]:
        """What stands on the background of each view; or, where another surface covers much of a view, on that one if
        clearly more does. Objects are seen in both views, and convex, as a rule."""
        sides = [surfaces(side, self.threshold_sigma) for side in (left, right)]
        if all(len(side) == 1 for side in sides):
            return left, right, self._best(left, right)
        ways = list(product(*sides))
        seen = [seen_by_both(self._best(*way), self.max_concavity) for way in ways]
        most = int(np.argmax(seen))
        table = ways[most] if seen[most] > _SAFE_LEAD * seen[0] else ways[0]
        one, other = (without_others(chosen, side) for chosen, side in zip(table, sides))
        return one, other, self._best(one, other)

    def _clearer(self, left: Contrast, right: Contrast) -> Blobs:
        """The reading of more contrast energy; the one that promises less is left out where it can't win."""
        one, other = left.energies(), right.energies()
        promise = {polarity: one[polarity] + other[polarity] for polarity in one}
        likely, unlikely = sorted(promise, key=lambda polarity: -promise[polarity])
        readings = {likely: self._read(left, right, likely)}
        if contrast_energy(readings[likely]) <= _SAFE_LEAD * promise[unlikely]:
            readings[unlikely] = self._read(left, right, unlikely)
        return max((readings[polarity] for polarity in sorted(readings)), key=contrast_energy)

    def _read(self, left: Contrast, right: Contrast, polarity: str) -> Blobs:
        return Blobs(self._within_columns(self._find(left, polarity)), self._find(right, polarity), polarity)

    def _find(self, contrast: Contrast, polarity: str) -> tuple[Blob, ...]:
        found = outlines(foreground(contrast, polarity), self.min_area_px, self.closing_px)
        ordered = sorted(found, key=lambda blob: float(blob.centroid_px[0]))
        return tuple(b for b in ordered if _within(b.centroid_px[1], self.roi_y_px, self.roi_height_px))

    def _within_columns(self, blobs: tuple[Blob, ...]) -> tuple[Blob, ...]:
        """The left view's objects in the region of interest; the right view shows it at unknown columns."""
        return tuple(b for b in blobs if _within(b.centroid_px[0], self.roi_x_px, self.roi_width_px))

    def _finished(
        self, blobs: tuple[Blob, ...], contrast: Contrast, polarity: str, strongest: float = 0.0
    ) -> tuple[Blob, ...]:
        """The objects with refined outlines, without shadows, and with their faults."""
        strongest = max([strongest, *(blob.contrast for blob in blobs)])
        least = max(float(self.min_contrast), self.min_relative_contrast * strongest)
        faint = [replace(blob, fault="faint") for blob in blobs if blob.peak < least]
        clear = self._refined([blob for blob in blobs if blob.peak >= least], contrast)
        if polarity == "dark":
            clear = self._without_shadows(clear, contrast)
        soft = self.subpixel and is_out_of_focus([blob for blob in clear if not blob.cut], contrast.view.image)
        found = [self._checked(blob, soft) for blob in with_saturation(clear, contrast.view.image)] + faint
        return tuple(sorted(found, key=lambda blob: float(blob.centroid_px[0])))

    def _without_shadows(self, blobs: list[Blob], contrast: Contrast) -> list[Blob]:
        if not self.subpixel or not blobs:
            return blobs
        refine = partial(self._refined, contrast=contrast)
        return Shadows.of(blobs, contrast).cut_off(blobs, refine, self.min_area_px)

    def _refined(self, blobs: list[Blob], contrast: Contrast) -> list[Blob]:
        if not self.subpixel or not blobs:
            return blobs
        least = _MIN_EDGE_SIGMA * contrast.background.sigma
        traced = trace_silhouettes(contrast.view.image, [blob.contour_px for blob in blobs], least)
        return [
            replace(blob, contour_px=silhouette.points_px, sharpness=np.abs(silhouette.sharpness))
            for blob, silhouette in zip(blobs, traced)
        ]

    def _checked(self, blob: Blob, out_of_focus: bool) -> Blob:
        if blob.cut:
            return replace(blob, fault="cut_by_border")
        if blob.fault:
            return blob
        if out_of_focus:
            return replace(blob, fault="out_of_focus")
        return replace(blob, fault="merged") if blob.concavity > self.max_concavity else blob


def _within(place_px: float, first_px: int, size_px: int) -> bool:
    return size_px == 0 or first_px <= place_px < first_px + size_px
