"""Prints what the package and its rivals find in rendered scenes with exact truth, as Markdown.

python benchmark/accuracy.py [--data DIR] [--write docs/accuracy.md]
"""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

import cv2
import numpy as np
from rivals import WORKING_DEPTH_M, contenders
from scenes import GROUPS, Scene, find_bench_rig, load_scenes
from scoring import GATE_MM, ROUNDS, score_all
from search import search_table
from tables import group_table, refusal_table, summary_table, uncertainty_table
from thesis import table_3_14, table_3_15, table_3_16

from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.rig import StereoRig

BEGIN, END = "<!-- begin generated -->", "<!-- end generated -->"


def main() -> None:
    """Print the tables, or put them into a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder that holds bench_rig")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    arguments = parser.parse_args()
    bench_rig = find_bench_rig(arguments.data)
    cv2.setNumThreads(1)
    text = report(load_rig(bench_rig / "calibration" / "truth"), load_scenes(bench_rig))
    if arguments.write:
        replace_generated(arguments.write, text)
    else:
        print(text)


def report(rig: StereoRig, scenes: list[Scene]) -> str:
    """All tables."""
    rivals = contenders(rig)
    scores = score_all(rig, scenes, rivals)
    near, far = WORKING_DEPTH_M
    return "\n\n".join(
        [
            f"{len(scenes)} pairs of {rig.left.width_px} × {rig.left.height_px} pixels, "
            f"{sum(item.required for scene in scenes for item in scene.objects)} objects that must be found; baseline "
            f"{rig.baseline_m * 1000:.1f} mm. Errors are mean, max over the required objects that a method found: "
            "methods that refuse more are averaged over fewer. An estimate counts as an object within "
            f"{GATE_MM:g} mm, one to one; what is left over is a ghost. Times are CPU times on one thread from the raw "
            f"pair to positions, medians of {ROUNDS} rounds in which each method has its turn; × is the median ratio "
            f"to `feature` on the same pair. The dense methods look from {near:g} to {far:g} m only. OpenCV "
            f"{cv2.__version__}, NumPy {np.__version__}, Python {platform.python_version()}, {platform.machine()}.",
            "### All scenes",
            summary_table(scores, rivals),
            "### The thesis's tables",
            "Depth between two cylinders (table 3.14):",
            table_3_14(scores).text,
            "Depths between four cylinders (table 3.16):",
            table_3_16(scores).text,
            "The centroids that the thesis prints, triangulated with the calibration that it prints (table 3.15):",
            table_3_15(rig),
            "### Correlation: where the search ends",
            search_table(rig, scenes),
            "### What the package finds and what it refuses",
            refusal_table(scores),
            "### Systematic shift, and the stated uncertainty",
            uncertainty_table(scores),
            "### Group by group",
            *(group_table(scores, rivals, group) for group in GROUPS),
        ]
    )


def replace_generated(page: Path, text: str) -> None:
    """Put `text` between the page's two markers."""
    before, begin, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise SystemExit(f"{page}: the markers {BEGIN} and {END} are not there")
    page.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
