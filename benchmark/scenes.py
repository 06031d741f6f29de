"""The rendered scenes of `bench_rig` and their exact truth, in millimetres in the left camera's optical frame."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from solids import Solid

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.images import read_image

GROUPS = ("table_3_14", "table_3_16", "light", "touching", "ambiguous", "many", "empty", "sequence")
BESIDE_THE_CHECKOUT = Path(__file__).resolve().parents[2] / "shared" / "data"


@dataclass(frozen=True, eq=False)
class TrueObject:
    """An object as it stands; required: whether it must be found.

    centre_mm: (3,), the centre of its volume; visible_mm: (3,), the mean of the surface that the left view shows.
    """

    name: str
    centre_mm: Floats
    visible_mm: Floats
    solid: Solid
    required: bool


@dataclass(frozen=True, eq=False)
class Scene:
    """One stereo pair, its objects, and which object (1, 2, ...; 0 none) each raw pixel of the two views shows."""

    name: str
    frame: StereoFrame
    objects: tuple[TrueObject, ...]
    left_labels: Image
    right_labels: Image

    @property
    def group(self) -> str:
        return self.name.split("/")[0]

    @cached_property
    def centres_mm(self) -> Floats:
        return np.array([item.centre_mm for item in self.objects]).reshape(-1, 3)

    def surface_mm(self, camera: Camera, raw_px: Floats) -> Floats | None:
        """The point (3,) of an object's surface that a raw pixel (2,) of the left view shows, if it shows one."""
        label = label_at(self.left_labels, raw_px)
        if label == 0:
            return None
        ray = np.append(camera.normalized(raw_px)[0], 1.0)
        return self.objects[label - 1].solid.first_hit_mm(ray)


def label_at(labels: Image, raw_px: Floats) -> int:
    """The label at a raw pixel (2,); 0 outside the image."""
    column, row = np.round(raw_px).astype(int)
    inside = 0 <= row < labels.shape[0] and 0 <= column < labels.shape[1]
    return int(labels[row, column]) if inside else 0


def find_bench_rig(data: Path | None) -> Path:
    """The folder `bench_rig` in `data`, else in $STEREO_PICK_DATA, else beside the checkout; exits if it is missing."""
    named = data or os.environ.get("STEREO_PICK_DATA")
    folder = (Path(named) if named else BESIDE_THE_CHECKOUT) / "bench_rig"
    if not (folder / "calibration" / "truth").is_dir():
        raise SystemExit(
            f"{folder}: the rendered scenes are not there. Name the folder that holds bench_rig with --data, "
            "or in the environment variable STEREO_PICK_DATA."
        )
    return folder


def load_scenes(bench_rig: Path) -> list[Scene]:
    """All scenes of the groups, in order."""
    return [_load(folder.parent) for group in GROUPS for folder in sorted((bench_rig / group).glob("*/truth.json"))]


def _load(folder: Path) -> Scene:
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    objects = tuple(
        TrueObject(
            name=entry["name"],
            centre_mm=np.array(entry["volumetric_centroid"]),
            visible_mm=np.array(entry["visible_surface_centroid"]),
            solid=Solid(entry["shape"], entry["dimensions_mm"], np.array(entry["pose_left_T_obj"])),
            required=entry["detectability"] == "required",
        )
        for entry in truth["objects"]
    )
    frame = StereoFrame(read_image(folder / "left.png"), read_image(folder / "right.png"))
    labels = (read_image(folder / f"labels_{side}.png") for side in ("left", "right"))
    return Scene(truth["scene_id"], frame, objects, *labels)
