"""Learned backgrounds as files: numpy archives (.npz)."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from stereo_pick.core.drafts import drafted
from stereo_pick.core.errors import ImageError, StereoPickError
from stereo_pick.core.objects.learned import LearnedBackground, LearnedView

_FORMAT = "stereo_pick background 1"
_REMEDY = "learn it again with `stereo-pick background`"


def save_background(path: Path, background: LearnedBackground) -> None:
    """Write it, replacing the file as a whole; raises ImageError where that is not possible."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with drafted(path) as draft, draft.open("wb") as file:
            np.savez_compressed(
                file,
                format=np.array(_FORMAT),
                calibration_hash=np.array(background.calibration_hash),
                pairs=np.array(background.pairs),
                left_mean=background.left.mean,
                left_noise=background.left.noise,
                right_mean=background.right.mean,
                right_noise=background.right.noise,
            )
    except OSError as error:
        raise ImageError(f"background file {path} cannot be written: {error.strerror}") from None


def load_background(path: Path) -> LearnedBackground:
    """Read it; raises ImageError, naming the file, where it is missing, damaged or something else."""
    if not path.is_file():
        what = "it is a folder" if path.is_dir() else "no such file"
        raise ImageError(
            f"background file {path}: {what}; learn it with `stereo-pick background` or ~/learn_background"
        )
    try:
        with np.load(path, allow_pickle=False) as stored:
            if str(stored["format"]) != _FORMAT:
                raise ImageError(f"background file {path} has the format {str(stored['format'])!r}: {_REMEDY}")
            left, right = (LearnedView(stored[f"{side}_mean"], stored[f"{side}_noise"]) for side in ("left", "right"))
            return LearnedBackground(left, right, str(stored["calibration_hash"]), int(stored["pairs"]))
    except StereoPickError as error:
        raise ImageError(f"background file {path}: {error}") from None
    except (OSError, EOFError, KeyError, ValueError, TypeError, zipfile.BadZipFile):
        raise ImageError(f"background file {path} is no background, damaged or cut short: {_REMEDY}") from None
