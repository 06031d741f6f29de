"""A new file with a correspondence method is all that it takes."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest
from recordings import DEMO_RIG, demo_pairs, write_images
from ros_tools import ROOT, running_system, stereo_pick

METHOD = '''\
"""Takes nothing for certain."""

from __future__ import annotations

from dataclasses import dataclass

from stereo_pick.core.correspondence.correspondences import Correspondences, collect
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.params import parameter
from stereo_pick.core.refusal import Refusal


@dataclass(frozen=True)
class Doubter(Method):
    """Refuses whatever it sees."""

    doubt: float = parameter(0.5, "How much it doubts.", low=0.0, high=1.0)

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return no match."""
        return collect([], [Refusal("ambiguous", blob.centroid_px, None) for blob in blobs.left])
'''


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with one more file in it."""
    folder = tmp_path_factory.mktemp("checkout")
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "stereo_pick", folder / "stereo_pick", ignore=ignore)
    (folder / "stereo_pick" / "core" / "correspondence" / "doubter.py").write_text(METHOD)
    return folder


def test_a_new_file_is_a_method_of_the_command(checkout: Path, tmp_path: Path) -> None:
    images = write_images(tmp_path / "images", demo_pairs(1))
    files = [images / f"{side}00.png" for side in ("left", "right")]
    arguments = ("--calibration", DEMO_RIG, "--method", "doubter", "--param", "doubter.doubt=0.9", "--json")
    done = stereo_pick("locate", *files, *arguments, cwd=checkout, env=_environment(checkout))
    assert done.status == 0, done.stderr
    content = json.loads(done.stdout)
    assert content["method"] == "doubter"
    assert content["objects"] == []
    assert {each["reason"] for each in content["refused"]} == {"ambiguous"}
    assert "doubter" not in stereo_pick("locate", "--help").stdout, "only the copy has it"


def test_a_new_file_is_documented(checkout: Path) -> None:
    done = stereo_pick("parameters", cwd=checkout, env=_environment(checkout))
    assert "## correspondence: doubter" in done.stdout
    assert "| `doubter.doubt` | `0.5` | 0 .. 1 | How much it doubts. |" in done.stdout
    assert "| `doubter.min_depth_m` |" in done.stdout
    done = stereo_pick("parameters", "--format", "yaml", cwd=checkout, env=_environment(checkout))
    assert "    doubter:\n      min_depth_m: 0.1\n" in done.stdout


def test_a_new_file_is_a_method_of_the_node(checkout: Path, tmp_path: Path) -> None:
    with running_system(tmp_path) as system:
        node = [sys.executable, "-m", "stereo_pick.ros.nodes.correspondence"]
        child = system.start(*node, cwd=checkout, **_environment(checkout))
        assert system.graph.set_parameter("correspondence", "method", "doubter").successful
        assert system.graph.get_parameter("correspondence", "method") == "doubter"
        assert system.graph.set_parameter("correspondence", "doubter.doubt", 0.25).successful
        refused = system.graph.set_parameter("correspondence", "doubter.doubt", 1.5)
        assert not refused.successful
        assert "doubter.doubt" in refused.reason
        assert child.end()[0] == 0


def _environment(checkout: Path) -> dict[str, str]:
    import os

    return {**os.environ, "PYTHONPATH": str(checkout)}
