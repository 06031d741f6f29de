"""A thread that looks for the board, so that the node's executor never waits for it."""

from __future__ import annotations

import ctypes
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from rclpy.task import Future

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.collecting import Collector
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.calibration_run import CalibrationRun
from stereo_pick.core.errors import StereoPickError


@dataclass(frozen=True, eq=False)
class Progress:
    """How far the watch is: pairs looked at and with a board, the views kept, the last pair and the board in it.

    error: why the last pair was of no use; empty where it was.
    """

    looked_at: int = 0
    shown: int = 0
    kept: tuple[BoardView, ...] = ()
    last: BoardImages | None = None
    seen: BoardView | None = None
    error: str = ""


class _Closed(BaseException):
    """Ends the thread of a watch that is closed."""


class BoardWatch:
    """Takes pairs one after the other; of more than `max_waiting` that wait, the oldest are counted and left out, but
    those that a calibration waits for.

    `progress` is replaced, never changed: it can be read from any thread. failure: an error that ended the thread.
    """

    def __init__(self, board: Board, max_waiting: int) -> None:
        self.progress = Progress()
        self.not_looked_at = 0
        self.failure: BaseException | None = None
        self._collector = Collector(board)
        self._max_waiting = max_waiting
        self._tasks: deque[Callable[[], None]] = deque()
        self._owed = 0  # tasks up to the last calibration
        self._calibration: Future | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._work, name="board watch", daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """How many pairs have not been looked at yet."""
        return len(self._tasks)

    @property
    def calibrating(self) -> bool:
        """Whether a calibration waits for its pairs, or is being made."""
        return self._calibration is not None and not self._calibration.done()

    def offer(self, read: Callable[[], BoardImages]) -> None:
        """Have the pair read and looked at, in its turn."""
        with self._changed:
            if self.waiting >= self._max_waiting:
                self.not_looked_at += 1
                if self._owed == self.waiting:
                    return
                del self._tasks[self._owed]
            self._put(partial(self._look, read))

    def calibrate(self, job: Callable[[tuple[BoardImages, ...]], CalibrationRun]) -> Future:
        """Call `job` with the images kept, once all pairs that wait have been looked at; the future has its outcome."""
        future = Future()
        with self._changed:
            self._put(partial(self._calibrate, job, future))
            self._owed = self.waiting
            self._calibration = future
        return future

    def close(self) -> None:
        """End the thread, whatever it is doing: one that outlives the interpreter would crash the process."""
        if not self._thread.is_alive():
            return
        # Reaches it between two calls of OpenCV: a calibration takes up to a minute, but each of its calls seconds.
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self._thread.ident or 0), ctypes.py_object(_Closed))
        with self._changed:
            self._changed.notify()
        self._thread.join()

    def _put(self, task: Callable[[], None]) -> None:
        with self._changed:
            self._tasks.append(task)
            self._changed.notify()

    def _work(self) -> None:
        try:
            while True:
                self._next()()
        except _Closed:
            return
        except BaseException as error:
            self.failure = error

    def _next(self) -> Callable[[], None]:
        with self._changed:
            self._changed.wait_for(lambda: self._tasks)
            self._owed = max(self._owed - 1, 0)
            return self._tasks.popleft()

    def _look(self, read: Callable[[], BoardImages]) -> None:
        error, pair, seen = "", None, None
        try:
            pair = read()
            seen = self._collector.look(pair)
        except StereoPickError as refusal:
            error = str(refusal)
        collector = self._collector
        self.progress = Progress(collector.looked_at, collector.shown, collector.views, pair, seen, error)

    def _calibrate(self, job: Callable[[tuple[BoardImages, ...]], CalibrationRun], future: Future) -> None:
        try:
            future.set_result(job(self._collector.images()))
        except StereoPickError as refusal:
            future.set_exception(refusal)
