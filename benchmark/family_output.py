"""What programs that look at families of scenes are asked for, beside what to look at, and how they give it out."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from accuracy import replace_generated
from family_scoring import SceneScore
from family_tables import failed_scenes


def ask_for_output(parser: argparse.ArgumentParser) -> None:
    """The options of `give_out`, but for the page, and one to draw a scene."""
    parser.add_argument("--dump", type=Path, help="JSON file for the errors, object by object")
    parser.add_argument("--failures", action="store_true", help="list the scenes that are not wholly right")
    parser.add_argument("--show", nargs=3, metavar=("FAMILY", "SEED", "OUT.png"), help="draw one scene")


def give_out(options: argparse.Namespace, scores: Sequence[SceneScore], text: str) -> None:
    """Print the tables, or put them into a page; and what else was asked for."""
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)
    if options.failures:
        print(f"\n{failed_scenes(scores)}")
    if options.dump:
        options.dump.write_text(json.dumps([_record(of) for of in scores], indent=1), encoding="utf-8")


def _record(of: SceneScore) -> dict[str, object]:
    found = {each.which: each for each in of.found}
    objects = []
    for number, truth in enumerate(of.objects):
        hit = found.get(number)
        objects.append(
            {
                "shape": f"lying {truth.shape}" if truth.lying else truth.shape,
                "required": truth.required,
                "visible": truth.visible,
                "centre_mm": _mm(truth.centre_m),
                "extent_mm": _mm(np.array(truth.extent_m)),
                "error_mm": _mm(hit.position_m) if hit else None,
                "mahalanobis2": hit.mahalanobis2 if hit else None,
                "size_error_mm": _mm(hit.size_m) if hit and hit.size_m is not None else None,
                "yaw_error_deg": float(np.rad2deg(hit.yaw_rad)) if hit and hit.yaw_rad is not None else None,
            }
        )
    return {
        "family": of.family, "seed": of.seed, "right": of.right, "objects": objects,
        "ghosts_mm": _mm(of.ghosts_m), "refused": dict(of.refused), "ms": of.seconds * 1000,
    }  # fmt: skip


def _mm(metres: np.ndarray) -> list[float]:
    return np.round(1000 * metres, 4).tolist()
