"""Prints what the package finds where ordinary cameras do to the pictures what they do, as Markdown.

python benchmark/evaluate_cameras.py [--family NAME ...] [--seeds N] [--cache DIR] [--jobs N]
python benchmark/evaluate_cameras.py --write docs/ordinary_cameras.md
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from statistics import fmean, median

import cv2
import numpy as np
from accuracy import replace_generated
from family_cache import taken
from family_scoring import SceneScore, score
from formatting import decimals, markdown_table, percent
from mahalanobis import CHI2_3
from processes import each, scene_parser
from rendering.rigs import BENCH_RIGS

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.configuration import steps
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline

Random = np.random.Generator
_FAMILIES = ("mixed_shapes", "light_differences", "low_contrast", "elevation_30_to_90", "dark_on_light", "tubes")
Job = tuple[str, str, int]


def as_rendered(image: Image, random: Random) -> Image:
    """As in the other tables: grey levels go with the light, noise of about 1 grey level."""
    return image


def gamma(image: Image, random: Random) -> Image:
    """Grey levels go with the light to the power of 1/2.2, as for a screen."""
    return _grey(255 * (image / 255.0) ** (1 / 2.2))


def sharpened(image: Image, random: Random) -> Image:
    """By 0.8 of what differs from the mean around a pixel (Gaussian, 1 px): bright and dark seams along edges."""
    grey = image.astype(np.float64)
    return _grey(grey + 0.8 * (grey - cv2.GaussianBlur(grey, (0, 0), 1.0)))


def jpeg(image: Image, random: Random) -> Image:
    """Compressed as JPEG of quality 75."""
    return _compressed(image, 75)


def webcam(image: Image, random: Random) -> Image:
    """Gamma, sharpened, and JPEG of quality 80."""
    return _compressed(sharpened(gamma(image, random), random), 80)


def soft(image: Image, random: Random) -> Image:
    """Out of focus by 1.2 px (Gaussian)."""
    return _grey(cv2.GaussianBlur(image.astype(np.float64), (0, 0), 1.2))


def dim(image: Image, random: Random) -> Image:
    """A third of the light, and the noise of 1 grey level for that."""
    return _grey(image / 3 + random.normal(0, 1, image.shape))


def overexposed(image: Image, random: Random) -> Image:
    """Half as much light again: what is bright saturates."""
    return _grey(1.5 * image.astype(np.float64))


def noisy(image: Image, random: Random) -> Image:
    """Noise of 4 grey levels more."""
    return _grey(image + random.normal(0, 4, image.shape))


def very_noisy(image: Image, random: Random) -> Image:
    """Noise of 8 grey levels more."""
    return _grey(image + random.normal(0, 8, image.shape))


CAMERAS: dict[str, Callable[[Image, Random], Image]] = {
    camera.__name__: camera
    for camera in (as_rendered, gamma, sharpened, jpeg, webcam, soft, dim, overexposed, noisy, very_noisy)
}


def _grey(levels: Floats) -> Image:
    return np.clip(np.round(levels), 0, 255).astype(np.uint8)


def _compressed(image: Image, quality: int) -> Image:
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_GRAYSCALE), np.uint8)


def main() -> None:
    """Print the table, or put it into a page."""
    options = scene_parser(__doc__, default=list(_FAMILIES), seeds=15).parse_args()
    jobs = [(camera, family, seed) for camera in CAMERAS for family in options.family for seed in range(options.seeds)]
    scores = each(jobs, partial(_scored, options.cache), options.jobs)
    several = {name: [one for job, one in zip(jobs, scores) if job[0] == name] for name in CAMERAS}
    text = _report(several, options.family, options.seeds)
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


def _scored(folder: Path | None, job: Job) -> SceneScore:
    camera, family, seed = job
    rig_name, frame, truth = taken(family, seed, folder)
    random = np.random.default_rng(seed)
    left, right = (CAMERAS[camera](image, random) for image in (frame.left, frame.right))
    return score(family, seed, Pipeline(BENCH_RIGS[rig_name], steps({})), StereoFrame(left, right), truth)


def _report(several: dict[str, list[SceneScore]], families: Sequence[str], seeds: int) -> str:
    header = (
        "camera", "found / required", "ghosts", "> 5 mm wrong", "of these not admitted", "median mm", "d² < 7.81",
        "refused most often",
    )  # fmt: skip
    what = [(name.replace("_", " "), (camera.__doc__ or "").strip()) for name, camera in CAMERAS.items()]
    named = ", ".join(f"`{family}`" for family in families)
    return "\n\n".join(
        [
            f"{seeds} scenes each of {named}. OpenCV {cv2.__version__}, NumPy {np.__version__}.",
            markdown_table(("camera", "what it does"), what, words=True),
            markdown_table(header, [_row(name, scores) for name, scores in several.items()]),
        ]
    )


def _row(name: str, scores: Sequence[SceneScore]) -> tuple[str, ...]:
    required, missed = (sum(several) for several in zip(*((one.required, len(one.missed)) for one in scores)))
    refused = sum((one.refused for one in scores), Counter[str]())
    off_m, surprise = ([value for one in scores for value in getattr(one, of)] for of in ("off_m", "mahalanobis2"))
    return (
        name.replace("_", " "),
        f"{required - missed} / {required}",
        str(sum(len(one.ghosts_m) for one in scores)),
        str(sum(one.wrong for one in scores)),
        str(sum(one.unadmitted for one in scores)),
        decimals(1000 * median(off_m), 2),
        percent(fmean(value < CHI2_3[95] for value in surprise)),
        ", ".join(f"{count} {reason}" for reason, count in refused.most_common(3)),
    )


if __name__ == "__main__":
    main()
