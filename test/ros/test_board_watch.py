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


def test_of_more_than_may_wait_the_newest_are_counted_and_left_out(pairs: Pairs) -> None:
    watch, gate, read = BoardWatch(BOARD, max_waiting=2), threading.Event(), list[int]()

    def slow(index: int) -> BoardImages:
        gate.wait(60)
        read.append(index)
        return timed_pair(index, GREY, GREY)

    watch.offer(lambda: slow(0))
    wait(lambda: watch.waiting == 0)
    for index in range(1, 6):
        watch.offer(lambda index=index: slow(index))
    assert (watch.waiting, watch.not_looked_at) == (2, 3)
    gate.set()
    wait(lambda: watch.progress.looked_at == 3)
    assert read == [0, 1, 2]
    watch.close()


def test_a_calibration_comes_after_the_pairs_that_wait(pairs: Pairs) -> None:
    watch = BoardWatch(BOARD, max_waiting=10)
    for index, pair in enumerate(pairs):
        watch.offer(reader(index, pair))
    future = watch.calibrate(lambda images: [pair.name for pair in images])  # type: ignore[arg-type,return-value]
    wait(future.done)
    assert future.result() == ["pair at 0.00 s", "pair at 1.00 s", "pair at 2.00 s"]
    watch.close()


def test_errors_are_told_and_end_nothing(pairs: Pairs) -> None:
    def damaged() -> BoardImages:
        raise ImageError("left image is damaged")

    watch = BoardWatch(BOARD, max_waiting=10)
    future = watch.calibrate(lambda images: None)  # type: ignore[arg-type,return-value]
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
    watch.offer(lambda: 1 / 0)  # type: ignore[arg-type,return-value]
    wait(lambda: watch.failure)
    assert isinstance(watch.failure, ZeroDivisionError)
