"""~/learn_background of the correspondence node: what a call answers, and what becomes of the pairs that follow."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from outlines import PARALLEL, grey_image
from rendered_solids import PARTS, PLACED, RIG, rectified
from rendering import Scene
from ros_tools import Graph
from std_srvs.srv import Trigger

from stereo_pick.core.errors import ImageError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects.background_files import load_background
from stereo_pick.core.objects.learned import PAIRS_TO_LEARN
from stereo_pick.ros.background_learning import BackgroundLearning
from stereo_pick.ros.nodes.correspondence import CorrespondenceNode


class Learning:
    """The learning of a node that saves where `path` says, driven directly."""

    def __init__(self, path: Path | None) -> None:
        self.saved = 0
        self.path = path
        self.services: dict[str, Any] = {}
        node: Any = SimpleNamespace(
            create_service=lambda _kind, name, call: self.services.update({name: call}),
            abandonable=nullcontext,
        )
        self.learning = BackgroundLearning(node, lambda: self.path, self._on_saved)

    def call(self) -> Trigger.Response:
        answer: Trigger.Response = self.services["~/learn_background"](Trigger.Request(), Trigger.Response())
        return answer

    def _on_saved(self) -> None:
        self.saved += 1


def pair(seed: int, level: float = 70.0) -> RectifiedPair:
    views = [grey_image(np.full((480, 640), level), noise_dn=1.0, seed=2 * seed + side) for side in (0, 1)]
    return RectifiedPair(*views, PARALLEL)


def test_a_call_on_a_running_node_without_a_file_says_what_to_set(graph: Graph) -> None:
    graph.host(CorrespondenceNode(graph.context))
    answer = graph.ask(Trigger, "correspondence/learn_background", Trigger.Request())
    assert not answer.success
    assert "segmentation.background_file" in answer.message


def test_the_pairs_after_a_call_are_learned_and_saved(tmp_path: Path) -> None:
    file = tmp_path / "new" / "background.npz"
    node = Learning(file)
    assert not node.learning.takes(pair(0)) and node.learning.progress == ""
    answer = node.call()
    assert answer.success and str(file) in answer.message and str(PAIRS_TO_LEARN) in answer.message
    for count in range(1, PAIRS_TO_LEARN):
        assert node.learning.takes(pair(count))
        assert f"{count} of {PAIRS_TO_LEARN} pairs" in node.learning.progress
    assert not file.exists()
    assert node.learning.takes(pair(PAIRS_TO_LEARN))
    assert load_background(file).pairs == PAIRS_TO_LEARN
    assert node.saved == 1 and node.learning.progress == "" and node.learning.warning == ""
    assert not node.learning.takes(pair(0)), "the next pair is matched again"


def test_a_part_that_lies_there_meanwhile_is_warned_of_until_another_background_is_in_use(tmp_path: Path) -> None:
    node = Learning(tmp_path / "background.npz")
    node.call()
    full = rectified(RIG, Scene((PARTS["box"], PARTS["standing"]), PLACED, ambient=0.7))
    for _ in range(PAIRS_TO_LEARN):
        node.learning.takes(full)
    assert node.saved == 1
    assert node.learning.warning.startswith("2 objects are in the views")
    for node.path, warned in ((None, False), (tmp_path / "other.npz", False), (tmp_path / "background.npz", True)):
        assert bool(node.learning.warning) == warned
    node.call()
    for count in range(PAIRS_TO_LEARN):
        assert node.learning.warning, "it is in use until the new one is there"
        node.learning.takes(pair(count))
    assert node.learning.warning == ""


def test_what_cannot_be_saved_is_said_once_and_ends_the_learning(tmp_path: Path) -> None:
    node = Learning(tmp_path / "file" / "background.npz")
    assert node.call().success
    (tmp_path / "file").write_text("x")
    for count in range(1, PAIRS_TO_LEARN):
        node.learning.takes(pair(count))
    with pytest.raises(ImageError, match="cannot be written"):
        node.learning.takes(pair(0))
    assert node.saved == 0 and not node.learning.takes(pair(0))


def test_a_call_is_refused_where_nothing_could_be_saved(tmp_path: Path) -> None:
    """After the learning the reason was there for one pair only: the next one said that there is no such file."""
    (tmp_path / "file").touch()
    for path, said in ((tmp_path / "file" / "background.npz", "is a file"), (tmp_path, "is a folder: name a file")):
        node = Learning(path)
        answer = node.call()
        assert not answer.success and f"segmentation.background_file = {path} {said}" in answer.message
        assert not node.learning.takes(pair(0)) and node.learning.progress == ""


def test_what_is_learned_is_saved_where_the_answer_said(tmp_path: Path) -> None:
    node = Learning(tmp_path / "background.npz")
    node.call()
    node.path = None
    for count in range(PAIRS_TO_LEARN):
        node.learning.takes(pair(count))
    assert load_background(tmp_path / "background.npz").pairs == PAIRS_TO_LEARN and node.saved == 1


def test_nothing_is_learned_with_the_lens_caps_on(tmp_path: Path) -> None:
    file = tmp_path / "background.npz"
    node = Learning(file)
    node.call()
    for count in range(1, PAIRS_TO_LEARN):
        node.learning.takes(pair(count, level=2.0))
    with pytest.raises(ImageError, match="the left view is black all over"):
        node.learning.takes(pair(0, level=2.0))
    assert node.saved == 0 and node.learning.progress == "" and not file.exists()
