"""A correspondence method is one file: dropping it in is all that it takes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import stereo_pick
from stereo_pick.core.correspondence import method_named, methods
from stereo_pick.core.errors import ParameterError

PACKAGE = Path(stereo_pick.__file__).parent

NEAREST = '''\
"""Method `nearest`: the object of the nearest row."""

from __future__ import annotations

from dataclasses import dataclass

from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.params import parameter


@dataclass(frozen=True)
class Nearest(Method):
    """Matches each left object with the right one on the nearest row."""

    max_gap_px: float = parameter(2.5, "Distance of rows from which two objects are not the same.", low=0.1, high=9.0)

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return centroids."""
        left, right = blobs.sound()
        pairs = [(a, b) for a in left for b in right if abs(a.centroid_px[1] - b.centroid_px[1]) < self.max_gap_px]
        return collect([Match(a.centroid_px, b.centroid_px, (1.0, 1.0), (1.0, 1.0), 0.0) for a, b in pairs], [])
'''

ASK = """\
import json, sys
from stereo_pick.core.configuration import parsed, pipeline_parameters, steps
from stereo_pick.core.correspondence import methods

made = steps(parsed(["method=nearest", "nearest.max_gap_px=4.5"])).method
own = pipeline_parameters()["nearest.max_gap_px"]
print(json.dumps({
    "file": sys.modules[type(made).__module__].__file__,
    "methods": list(methods()),
    "choices": pipeline_parameters()["method"].choices,
    "value": made.max_gap_px,
    "parameter": [own.default, own.low, own.high, own.doc],
    "names": [name for name in pipeline_parameters() if name.startswith("nearest.")],
}))
"""


def asked(folder: Path) -> dict[str, Any]:
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run(
        [sys.executable, "-c", ASK],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


def test_a_file_dropped_in_is_a_method_with_its_parameters(tmp_path: Path) -> None:
    core = shutil.copytree(
        PACKAGE / "core", tmp_path / "stereo_pick" / "core", ignore=shutil.ignore_patterns("__pycache__")
    )
    shutil.copy(PACKAGE / "__init__.py", tmp_path / "stereo_pick")
    dropped = core / "correspondence" / "nearest.py"
    dropped.write_text(NEAREST, encoding="utf-8")
    answer = asked(tmp_path)
    assert Path(answer["file"]) == dropped
    assert sorted(answer["methods"]) == sorted([*methods(), "nearest"])
    assert sorted(answer["choices"]) == sorted(answer["methods"])
    assert answer["value"] == 4.5
    assert answer["parameter"] == [2.5, 0.1, 9.0, "Distance of rows from which two objects are not the same."]
    assert sorted(answer["names"]) == ["nearest.max_depth_m", "nearest.max_gap_px", "nearest.min_depth_m"]


def test_the_thesiss_two_methods_are_there() -> None:
    assert {"feature", "ssd"} <= set(methods())


def test_helper_files_are_no_methods() -> None:
    assert not {"method", "assignment", "ambiguity", "correspondences", "window"} & set(methods())


def test_an_unknown_method_is_refused_with_those_there_are() -> None:
    with pytest.raises(ParameterError, match=r"method = 'sgbm' must be one of: .*feature, ssd"):
        method_named("sgbm")
