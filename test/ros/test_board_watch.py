"""The thread that looks for the board: its order, its limit, its errors."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pytest
from board_bags import BOARD, GREY, Pairs, rendered_pairs

from stereo_pick.core.calibration.collecting import timed_pair
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.errors import CalibrationError, ImageError
from stereo_pick.ros.board_watch import BoardWatch


@pytest.fixture(scope="module")
def pairs(render_board) -> Pairs:
    return rendered_pairs(render_board)[:3]


def wait(condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def reader(index: int, pair: tuple) -> Callable[[], BoardImages]:
    return lambda: timed_pair(index, *pair)


class Gated:
    """A watch whose first pair takes until `gate` is set; `read` are the pairs that were looked at."""

    def __init__(self, max_waiting: int) -> None:
        self.watch, self.gate, self.read = BoardWatch(BOARD, max_waiting), threading.Event(), list[int]()
        self.offer(0)
        wait(lambda: self.watch.waiting == 0)

    def offer(self, *indices: int) -> None:
        for index in indices:
            self.watch.offer(lambda index=index: self._slow(index))

    def _slow(self, index: int) -> BoardImages:
        self.gate.wait(60)
        self.read.append(index)
        return timed_pair(index, GREY, GREY)


def test_of_more_than_may_wait_the_oldest_are_counted_and_left_out() -> None:
    gated = Gated(max_waiting=2)
    gated.offer(1, 2, 3, 4, 5)
    assert (gated.watch.waiting, gated.watch.not_looked_at) == (2, 3)
    gated.gate.set()
    wait(lambda: gated.watch.progress.looked_at == 3)
    assert gated.read == [0, 4, 5]
    gated.watch.close()


def test_no_pair_that_a_calibration_waits_for_is_left_out_for_a_newer_one() -> None:
    gated = Gated(max_waiting=4)
    gated.offer(1, 2)
    future = gated.watch.calibrate(lambda images: None)
    gated.offer(3, 4, 5)
    gated.gate.set()
    wait(lambda: gated.watch.progress.looked_at == 4)
    assert gated.read == [0, 1, 2, 5]
    assert future.done()
    gated.watch.close()


def test_a_calibration_comes_after_the_pairs_that_wait(pairs: Pairs) -> None:
    watch = BoardWatch(BOARD, max_waiting=10)
    for index, pair in enumerate(pairs):
        watch.offer(reader(index, pair))
    future = watch.calibrate(lambda images: [pair.name for pair in images])
    wait(future.done)
    assert future.result() == ["pair at 0.00 s", "pair at 1.00 s", "pair at 2.00 s"]
    watch.close()


def test_it_tells_that_it_calibrates_from_the_call_to_the_outcome(pairs: Pairs) -> None:
    watch, gate = BoardWatch(BOARD, max_waiting=10), threading.Event()
    assert not watch.calibrating
    watch.offer(reader(0, pairs[0]))
    watch.calibrate(lambda images: gate.wait(60))
    assert watch.calibrating
    gate.set()
    wait(lambda: not watch.calibrating)
    watch.close()


def test_errors_are_told_and_end_nothing(pairs: Pairs) -> None:
    def damaged() -> BoardImages:
        raise ImageError("left image is damaged")

    watch = BoardWatch(BOARD, max_waiting=10)
    future = watch.calibrate(lambda images: None)
    watch.offer(damaged)
    wait(future.done)
    assert isinstance(future.exception(), CalibrationError)
    wait(lambda: watch.progress.error)
    assert watch.progress.error == "left image is damaged"
    watch.offer(reader(0, pairs[0]))
    wait(lambda: watch.progress.shown == 1)
    assert watch.progress.error == ""
    assert watch.failure is None
    watch.close()


def test_closing_breaks_off_a_calibration(pairs: Pairs) -> None:
    watch, begun, broken_off = BoardWatch(BOARD, max_waiting=10), threading.Event(), threading.Event()

    def endless(_: object) -> None:
        begun.set()
        try:
            while True:
                time.sleep(0.001)
        finally:
            broken_off.set()

    watch.offer(reader(0, pairs[0]))
    future = watch.calibrate(endless)  # type: ignore[arg-type]
    assert begun.wait(60)
    watch.close()
    assert broken_off.is_set()
    assert not future.done()
    assert watch.failure is None


def test_a_fault_of_the_program_itself_is_not_swallowed() -> None:
    watch = BoardWatch(BOARD, max_waiting=10)
    watch.offer(lambda: 1 / 0)
    wait(lambda: watch.failure)
    assert isinstance(watch.failure, ZeroDivisionError)
