"""Prints the tables of the thesis's chapter 3 beside what this package gives, as Markdown.

python benchmark/thesis_tables.py [--data DIR] [--write docs/thesis.md]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from pathlib import Path

import cv2
from accuracy import replace_generated
from calibration import RECORDINGS, calibrated
from formatting import Section, markdown_table
from rivals import FEATURE, THESIS_FEATURE, contenders
from scenes import find_bench_rig, load_scenes
from scoring import score_all
from thesis import table_3_14, table_3_15, table_3_16
from thesis_areas import pairing_table, printed_pairs_table
from thesis_baseline import table_3_13
from thesis_calibration import parameter_table, printed_error_at_work_mm, table_3_2
from thesis_centroids import readings_table
from thesis_geometry import approximation_table
from thesis_printed import WORK_M, agreement_table
from thesis_search import table_3_3, table_3_4

from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.calibration.result import CalibrationResult

SCENES = "the rendered scenes"
_CAMERA = "[`Camera`](../stereo_pick/core/camera.py)"
_CALIBRATION = "[`table_3_2`](../benchmark/thesis_calibration.py)"
_SEARCH = "[`table_3_3`](../benchmark/thesis_search.py)"
_AREAS = "[`pairing_table`](../benchmark/thesis_areas.py)"
_BASELINE = "[`table_3_13`](../benchmark/thesis_baseline.py)"
_DEPTHS = "[`table_3_14`](../benchmark/thesis.py)"
_READINGS = "[`readings_table`](../benchmark/thesis_centroids.py)"
_CALIBRATIONS = ("bouguet_stereo", "bench_rig/calibration")


def main() -> None:
    """Print the tables, or put them into a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder that holds bench_rig and bouguet_stereo")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    arguments = parser.parse_args()
    bench_rig = find_bench_rig(arguments.data)
    cv2.setNumThreads(1)
    text = "\n\n".join(report(bench_rig))
    if arguments.write:
        replace_generated(arguments.write, text)
    else:
        print(text)


def report(bench_rig: Path) -> Iterator[str]:
    """Every table, with its heading; first of all what they come to."""
    rig, scenes = load_rig(bench_rig / "calibration" / "truth"), load_scenes(bench_rig)
    tabled = [scene for scene in scenes if scene.group in ("table_3_14", "table_3_16")]
    scores = score_all(rig, tabled, [each for each in contenders(rig) if each.name in (FEATURE, THESIS_FEATURE)])
    found = calibrations(bench_rig.parent)
    sections = {
        "3.2": table_3_2(list(found.items())),
        "3.3": table_3_3(rig, tabled),
        "3.4": table_3_4(rig, tabled, scenes),
        "3.6": pairing_table(rig, scenes),
        "3.13": table_3_13(),
        "3.14": table_3_14(scores),
        "3.15": readings_table(rig),
        "3.16": table_3_16(scores),
    }
    yield "## Tables"
    yield summary(sections)
    yield "### Triangulation without calibration (eq. 1.34 to 1.42)"
    yield approximation_table(rig)
    yield "### Calibration (table 3.2, 3.4.1, 3.4.2)"
    yield sections["3.2"].text
    x_mm, y_mm = printed_error_at_work_mm(rig)
    yield (
        f"At {WORK_M * 100:.0f} cm, where the thesis's parts stand, its errors in pixels are {x_mm:.2f} and "
        f"{y_mm:.2f} mm. The numbers of the calibration, found from `bench_rig`, which was rendered with the printed "
        "ones:"
    )
    yield parameter_table(rig, found["bench_rig/calibration"])
    yield "### Correlation (tables 3.3 to 3.5)"
    yield sections["3.3"].text
    yield sections["3.4"].text
    yield "### Pairing by area (tables 3.6 to 3.12)"
    yield printed_pairs_table()
    yield sections["3.6"].text
    yield "### Depths between objects (tables 3.13, 3.14, 3.16)"
    yield sections["3.13"].text
    yield "Table 3.14:"
    yield sections["3.14"].text
    yield "Table 3.16:"
    yield sections["3.16"].text
    yield "### The printed centroids (tables 3.15, 3.16)"
    yield table_3_15(rig)
    yield sections["3.15"].text
    yield "### Do the printed figures agree with one another?"
    yield agreement_table(rig.left, rig.right_T_left)


def calibrations(data: Path) -> dict[str, CalibrationResult]:
    """Those of the recordings that are there."""
    recordings = [each for each in RECORDINGS if each.name in _CALIBRATIONS and (data / each.name).is_dir()]
    return {recording.name: calibrated(recording, data) for recording in recordings}


def summary(sections: Mapping[str, Section]) -> str:
    """A row for every table of chapter 3; chapter 1 has none."""
    no_images = "the thesis's images are not to be had"
    rows = [
        ("3.1", "the cameras", "640 × 480 px, 8.5 mm, 7.4 µm pixels", "any size; the scenes have this one", _CAMERA),
        ("3.2", "calibration error", "0.21, 0.45 px", sections["3.2"].headline, _CALIBRATION),
        ("3.3", "SSD, 3 × 3, six points", "4 of 5 within 6 px, one without partner «found»", sections["3.3"].headline,
         _SEARCH),
        ("3.4, 3.5", "modified SSD", "2 of 2, at worst 1.49, 2.72 px", sections["3.4"].headline, _SEARCH),
        ("3.6, 3.7", "areas of two objects", "both paired rightly",
         "the printed areas give the same pairs; not the areas themselves: " + no_images, _AREAS),
        ("3.8", "their centroids", "in 1.48 s", f"not repeated: {no_images}", _AREAS),
        ("3.9, 3.10", "areas of three objects", "all paired rightly", "the printed areas give the same pairs", _AREAS),
        ("3.11, 3.12", "areas of four objects", "all paired rightly",
         f"the same pairs; in {SCENES} {sections['3.6'].headline}", _AREAS),
        ("3.13", "depths, baseline 66 cm", "mean 17.5, max 30 mm", f"`feature` {sections['3.13'].headline}", _BASELINE),
        ("3.14", "depths, baseline 20 cm", "mean 1.2, max 2.9 mm", sections["3.14"].headline, _DEPTHS),
        ("3.15", "centroids of four objects", "four positions", sections["3.15"].headline, _READINGS),
        ("3.16", "their depths", "mean 1.5, max 2.4 mm",
         f"not from table 3.15; on rendered images {sections['3.16'].headline}", _DEPTHS),
    ]  # fmt: skip
    return markdown_table(["table", "what", "thesis", "here", "made by"], rows, words=True)


if __name__ == "__main__":
    main()
