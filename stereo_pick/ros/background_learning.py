"""The service ~/learn_background of the correspondence node: the next pairs show the work surface empty."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from std_srvs.srv import Trigger

from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.learned_parts import parts_learned
from stereo_pick.core.objects.background_files import save_background
from stereo_pick.core.objects.learned import PAIRS_TO_LEARN, BackgroundLearner
from stereo_pick.core.params import check_folder
from stereo_pick.ros.node import StepNode


class BackgroundLearning:
    """Takes pairs in from a call of the service until it has enough, then saves what it learned.

    path: where to, None where nobody said; saved: called when the file is there.
    """

    def __init__(self, node: StepNode, path: Callable[[], Path | None], saved: Callable[[], None]) -> None:
        self._node = node
        self._path = path
        self._saved = saved
        self._learner: BackgroundLearner | None = None
        self._promised = Path()
        self._warnings: dict[Path, str] = {}  # by the file that was learned
        node.create_service(Trigger, "~/learn_background", self._on_call)

    @property
    def progress(self) -> str:
        """How far it is, for people; empty while nothing is being learned."""
        if self._learner is None:
            return ""
        return f"learning the background: {self._learner.pairs} of {PAIRS_TO_LEARN} pairs; keep the surface empty"

    @property
    def warning(self) -> str:
        """What is wrong with the background in use, where it was learned here; empty where nothing is."""
        path = self._path()
        return self._warnings.get(path, "") if path is not None else ""

    def takes(self, pair: RectifiedPair) -> bool:
        """Whether this pair was for learning; raises StereoPickError where learning it failed, and ends it."""
        learner = self._learner
        if learner is None:
            return False
        self._learner = None
        learner.add(pair)
        if learner.pairs < PAIRS_TO_LEARN:
            self._learner = learner
        else:
            save_background(self._promised, learner.finished())
            self._saved()
            with self._node.abandonable():
                self._warnings[self._promised] = parts_learned(learner.mean_pair())
        return True

    def _on_call(self, _request: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        path = self._path()
        answer.success = path is not None
        if path is None:
            answer.message = "set segmentation.background_file to where the background is to be saved, and call again"
            return answer
        try:
            _check_writable(path)
        except ParameterError as error:
            answer.success, answer.message = False, str(error)
            return answer
        self._learner, self._promised = BackgroundLearner(), path
        answer.message = f"learning from the next {PAIRS_TO_LEARN} pairs, then saved as {path}; keep the surface empty"
        return answer


def _check_writable(path: Path) -> None:
    """Raise ParameterError where no background can be saved there."""
    what = f"segmentation.background_file = {path}"
    if path.is_dir():
        raise ParameterError(f"{what} is a folder: name a file in it")
    check_folder(f"the folder of {what}", path.parent)
