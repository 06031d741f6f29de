"""Which camera is silent, by a clock of the test's own."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from stereo_pick.core.pairing import Side
from stereo_pick.ros.messages.diagnostics import ERROR, WARN
from stereo_pick.ros.messages.images import image_message
from stereo_pick.ros.raw_pairs import RawPairs
from stereo_pick.ros.topics import SIDES

SECOND_NS = 10**9
START_NS = 1_760_000_000 * SECOND_NS


class Driver:
    """Two cameras that send to `pairs`; now_ns: since the start."""

    def __init__(self) -> None:
        self.now_ns = 0
        clock = SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=self.now_ns))
        self.node: Any = SimpleNamespace(
            steady_clock=clock,
            resolve_topic_name=lambda name: f"/{name}",
            get_publishers_info_by_topic=lambda _topic: [],
            mixed=lambda: None,
            went_well=lambda: None,
        )
        self.pairs = RawPairs(self.node, lambda _pair: None)
        self.pairs.restart(0.01)

    def send(self, side: Side, later_ns: int = 0) -> None:
        grey = np.full((4, 4), self.now_ns % 251, np.uint8)
        self.pairs._add(side, image_message(grey, START_NS + self.now_ns + later_ns, side))

    def errors(self) -> list[str]:
        status = self.pairs.trouble()
        return [status.message] if status is not None and status.level == ERROR else []


@pytest.mark.parametrize("period_s", [0.1, 5])
@pytest.mark.parametrize("first", SIDES)
@pytest.mark.parametrize("later_ns", [0, 5_000_000])
def test_cameras_that_send_seldom_are_never_silent_between_left_and_right(
    period_s: float, first: Side, later_ns: int
) -> None:
    driver = Driver()
    for _ in range(10):
        driver.now_ns += round(period_s * SECOND_NS)
        for side in sorted(SIDES, key=lambda each: each != first):
            driver.send(side, later_ns * (side == "right"))
            if driver.pairs.counts.pairs:
                assert driver.errors() == []


@pytest.mark.parametrize(("period_s", "silent_s"), [(0.1, 2), (5, 15)])
def test_both_are_silent_after_three_times_their_longest_pause_and_two_seconds(
    period_s: float, silent_s: float
) -> None:
    """Cameras that are triggered for each pick are not called dead between picks."""
    driver = Driver()
    for _ in range(10):
        for side in SIDES:
            driver.send(side)
        driver.now_ns += round(period_s * SECOND_NS)
        assert driver.now_ns <= 5 * SECOND_NS or driver.pairs.trouble() is None
    sent_ns = driver.now_ns - round(period_s * SECOND_NS)
    driver.now_ns = sent_ns + round(silent_s * SECOND_NS)
    assert driver.pairs.trouble() is None
    driver.now_ns += 1
    status = driver.pairs.trouble()
    assert status is not None and status.level == WARN and "any more" in status.message


@pytest.mark.parametrize(("period_s", "within_s"), [(0.1, 2.5), (5, 16)])
@pytest.mark.parametrize(("alive", "dead"), [SIDES, SIDES[::-1]])
def test_one_that_has_died_is_named_alone(alive: Side, dead: Side, period_s: float, within_s: float) -> None:
    driver = Driver()
    for side in SIDES:
        driver.send(side)
    errors: list[str] = []
    while not errors and driver.now_ns < within_s * SECOND_NS:
        driver.now_ns += round(period_s * SECOND_NS)
        driver.send(alive)
        errors = driver.errors()
    (line,) = errors
    assert f"no image on /{dead}/image_raw any more" in line and f"/{alive}/" not in line


@pytest.mark.parametrize(("fast", "slow"), [SIDES, SIDES[::-1]])
def test_images_pair_where_those_of_one_camera_take_0_4_s_longer_to_come_at_60_a_second(fast: Side, slow: Side) -> None:
    """None did, and their stamps, which are equal, were said to differ."""
    driver, period_ns, late = Driver(), SECOND_NS // 60, 24
    for _ in range(60):
        driver.now_ns += period_ns
        driver.send(fast)
        driver.send(slow, -late * period_ns)
    assert driver.pairs.counts.pairs == 60 - late
    assert driver.errors() == []
