"""Prints what the package finds in path-traced scenes with exact truth, as Markdown.

Needs `pip install 'mitsuba>=3.9'` and LLVM's library, 15 or later; DRJIT_LIBLLVM_PATH says where that is, if it is not
found.

python benchmark/evaluate_traced.py [--family NAME ...] [--seeds N] [--cache DIR] [--jobs N]
python benchmark/evaluate_traced.py --write docs/path_traced.md
python benchmark/evaluate_traced.py --show FAMILY SEED OUT.png
"""

from __future__ import annotations

import argparse
import hashlib
import pickle
from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

import cv2
import numpy as np
from accuracy import replace_generated
from evaluate_families import dumped
from family_picture import picture
from family_scoring import WRONG_M, SceneScore, score
from family_tables import accuracy_table, covariance_table, detection_table, failed_scenes, shape_table, size_table
from formatting import markdown_table
from processes import each
from rendering import Truth
from traced_families import TRACED, traced

from stereo_pick.core.configuration import steps
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.rig import StereoRig

Taken = tuple[StereoRig, StereoFrame, Truth]
_HERE = Path(__file__).parent


def main() -> None:
    """Print the tables, or draw one scene."""
    options = _options()
    if options.show:
        family, seed, file = options.show
        rig, frame, truth = taken(options.cache, (family, int(seed)))
        cv2.imwrite(file, picture(Pipeline(rig, steps({})), frame, truth))
        return
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    jobs = [(family, seed) for family in options.family for seed in seeds]
    scores = each(jobs, partial(_scored, options.cache), options.jobs)
    text = _report(scores)
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)
    if options.failures:
        print(f"\n{failed_scenes(scores)}")
    if options.dump:
        options.dump.write_text(dumped(scores), encoding="utf-8")


def taken(folder: Path | None, job: tuple[str, int]) -> Taken:
    """A scene's rig, raw pair and truth; traced once where a folder keeps it."""
    family, seed = job
    if folder is None:
        return _taken(family, seed)
    file = folder / f"traced_{family}_{seed}_{_digest()}.pickle"
    if not file.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        part = file.with_suffix(".part")
        rig, frame, truth = _taken(family, seed)
        part.write_bytes(pickle.dumps((rig, frame.left, frame.right, truth)))
        part.rename(file)
    rig, left, right, truth = pickle.loads(file.read_bytes())
    return rig, StereoFrame(left, right), truth


def _taken(family: str, seed: int) -> Taken:
    scene = traced(family, seed)
    return scene.rig, *scene.taken()


@cache
def _digest() -> str:
    folders = (_HERE / "rendering", _HERE / "path_tracing")
    sources = [*(file for folder in folders for file in sorted(folder.glob("*.py")))]
    sources += [_HERE / f"{name}.py" for name in ("traced_families", "parts", "placing")]
    return hashlib.sha256(b"".join(file.read_bytes() for file in sources)).hexdigest()[:12]


def _scored(folder: Path | None, job: tuple[str, int]) -> SceneScore:
    rig, frame, truth = taken(folder, job)
    return score(*job, Pipeline(rig, steps({})), frame, truth)


def _report(scores: Sequence[SceneScore]) -> str:
    required, missed = sum(one.required for one in scores), sum(len(one.missed) for one in scores)
    published, wrong = sum(one.published for one in scores), sum(one.wrong for one in scores)
    unadmitted = sum(one.unadmitted for one in scores)
    rows = [(name, (TRACED[name].__doc__ or "").strip()) for name in dict.fromkeys(one.family for one in scores)]
    return "\n\n".join(
        [
            f"{len(scores)} scenes. Of {required} parts that must be found, {required - missed} are; of {published} "
            f"positions that are published, {wrong} are more than {1000 * WRONG_M:g} mm wrong, {unadmitted} of them by "
            f"more than their covariance admits with 95 %. OpenCV {cv2.__version__}, NumPy {np.__version__}.",
            markdown_table(("family", "scene"), rows, words=True),
            "### Found, missed, refused",
            detection_table(scores),
            "### Errors",
            accuracy_table(scores),
            "### The stated covariance",
            covariance_table(scores),
            shape_table(scores),
            "### Size, orientation, time",
            size_table(scores),
        ]
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", nargs="+", choices=TRACED, default=list(TRACED))
    parser.add_argument("--seeds", type=int, default=6, help="scenes a family (default 6)")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--cache", type=Path, help="folder that keeps the traced scenes")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--dump", type=Path, help="JSON file for the errors, object by object")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    parser.add_argument("--failures", action="store_true", help="list the scenes that are not wholly right")
    parser.add_argument("--show", nargs=3, metavar=("FAMILY", "SEED", "OUT.png"), help="draw one scene")
    return parser.parse_args()


if __name__ == "__main__":
    main()
