from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.errors import ParameterError
from stereo_pick.core.pairing import Pair, Side, StampPairer

MS = 1_000_000
Stamps = list[int]

stamps = st.lists(st.integers(0, 60), max_size=25).map(sorted)
offsets = st.integers(0, 12)


def interleaved(left: Stamps, right: Stamps, order: list[bool]) -> list[tuple[Side, int, int]]:
    """The two sides' items (side, stamp, index), each in its own order, mixed as `order` says."""
    waiting: dict[Side, list[tuple[Side, int, int]]] = {
        "left": [("left", stamp, i) for i, stamp in enumerate(left)],
        "right": [("right", stamp, i) for i, stamp in enumerate(right)],
    }
    mixed = []
    for take_left in order:
        side: Side = "left" if take_left else "right"
        if waiting[side]:
            mixed.append(waiting[side].pop(0))
    return mixed + waiting["left"] + waiting["right"]


def paired(events: list[tuple[Side, int, int]], max_offset: int, queue_length: int = 50) -> list[Pair[int]]:
    pairer: StampPairer[int] = StampPairer(max_offset, queue_length)
    pairs = [pair for side, stamp, index in events for pair in pairer.add(side, stamp, index)]
    pairs += pairer.flush()
    counts = pairer.counts
    assert counts.pairs == len(pairs)
    assert counts.left == len(pairs) + counts.dropped_left
    assert counts.right == len(pairs) + counts.dropped_right
    return pairs


@given(stamps, stamps, st.lists(st.booleans()), offsets, st.integers(1, 6))
def test_no_item_pairs_twice_or_too_far_away_and_the_order_stays(
    left: Stamps, right: Stamps, order: list[bool], max_offset: int, queue_length: int
) -> None:
    pairs = paired(interleaved(left, right, order), max_offset, queue_length)
    for indices in ([pair.left for pair in pairs], [pair.right for pair in pairs]):
        assert indices == sorted(set(indices))
    for pair in pairs:
        assert (pair.left_stamp_ns, pair.right_stamp_ns) == (left[pair.left], right[pair.right])
        assert abs(pair.offset_ns) <= max_offset


@given(stamps.map(set), stamps.map(set), st.lists(st.booleans()), offsets)
def test_equal_stamps_always_pair(left: set[int], right: set[int], order: list[bool], max_offset: int) -> None:
    pairs = paired(interleaved(sorted(left), sorted(right), order), max_offset)
    assert {pair.left_stamp_ns for pair in pairs if pair.offset_ns == 0} == left & right


@given(stamps, stamps, st.lists(st.booleans()), st.lists(st.booleans()), offsets)
def test_the_pairs_do_not_depend_on_how_the_sides_interleave(
    left: Stamps, right: Stamps, order: list[bool], other_order: list[bool], max_offset: int
) -> None:
    pairs = paired(interleaved(left, right, order), max_offset)
    assert paired(interleaved(left, right, other_order), max_offset) == pairs


@given(stamps, stamps, st.lists(st.booleans()), offsets)
def test_left_and_right_are_treated_alike(left: Stamps, right: Stamps, order: list[bool], max_offset: int) -> None:
    pairs = paired(interleaved(left, right, order), max_offset)
    mirrored = paired(interleaved(right, left, [not take_left for take_left in order]), max_offset)
    assert [(pair.left, pair.right) for pair in pairs] == [(pair.right, pair.left) for pair in mirrored]


@given(st.integers(1, 30), st.integers(-16, 16), st.lists(st.booleans()), st.sets(st.integers(0, 59)))
def test_cameras_half_a_period_apart_at_most_pair_frame_by_frame(
    count: int, offset: int, order: list[bool], lost: set[int]
) -> None:
    left = [33 * i for i in range(count) if i not in lost]
    right = [33 * i + offset for i in range(count) if i + 30 not in lost]
    pairs = paired(interleaved(left, right, order), abs(offset))
    both = [i for i in range(count) if i not in lost and i + 30 not in lost]
    assert [pair.left_stamp_ns for pair in pairs] == [33 * i for i in both]
    assert {pair.offset_ns for pair in pairs} <= {offset}


@given(st.lists(st.integers(20, 50), max_size=20), stamps, st.lists(st.booleans()), st.integers(0, 10))
def test_a_known_period_changes_no_pair(
    steps: list[int], order_right: Stamps, order: list[bool], max_offset: int
) -> None:
    left = [sum(steps[: i + 1]) for i in range(len(steps))]
    right = [stamp + i % 3 for i, stamp in enumerate(left) if i not in order_right]
    events = interleaved(left, right, order)
    pairer: StampPairer[int] = StampPairer(max_offset, 50, min_period_ns=18)
    pairs = [pair for side, stamp, index in events for pair in pairer.add(side, stamp, index)]
    assert pairs + pairer.flush() == paired(events, max_offset)


def test_a_known_period_saves_the_wait_for_the_next_image() -> None:
    patient: StampPairer[str] = StampPairer(5)
    assert patient.add("left", 0, "a") == []
    assert patient.add("right", 3, "b") == []
    assert patient.add("left", 33, "c") == [Pair("a", "b", 0, 3)]

    quick: StampPairer[str] = StampPairer(5, min_period_ns=16)
    assert quick.add("left", 0, "a") == []
    assert quick.add("right", 3, "b") == [Pair("a", "b", 0, 3)]


def test_equal_stamps_pair_at_once_even_late_and_out_of_order() -> None:
    pairer: StampPairer[str] = StampPairer(0, queue_length=3)
    for stamp in (3, 1, 2):
        assert pairer.add("left", stamp, f"left {stamp}") == []
    for stamp in (1, 2, 3):
        assert pairer.add("right", stamp, "right") == [Pair(f"left {stamp}", "right", stamp, stamp)]


def test_a_queue_that_is_full_drops_the_oldest() -> None:
    pairer: StampPairer[int] = StampPairer(0, queue_length=3)
    for stamp in range(5):
        pairer.add("left", stamp, stamp)
    assert pairer.counts.dropped_left == 2
    assert [pair.left for stamp in range(5) for pair in pairer.add("right", stamp, stamp)] == [2, 3, 4]


def test_a_clock_that_jumps_back_does_not_end_the_pairing() -> None:
    pairer: StampPairer[int] = StampPairer(0)
    pairer.add("left", 1000, 0)
    pairs = [pair for stamp in range(20) for side in ("left", "right") for pair in pairer.add(side, stamp, stamp)]  # type: ignore[arg-type]
    assert len(pairs) == 20


@pytest.mark.parametrize(
    ("left", "right", "sentence"),
    [
        ([], [], "no images, neither left nor right: are the cameras running?"),
        (range(120), [], "left has 120 images, right none: is the right camera running?"),
        ([], [7], "right has 1 image, left none: is the left camera running?"),
        (
            [0, 33 * MS, 66 * MS],
            [16_700_000, 49_700_000],
            "nearest left and right stamps differ by 16.3 ms, more than max_stamp_offset_s = 0.005: "
            "are the cameras synchronised?",
        ),
        (
            [0],
            [3600 * 1000 * MS],
            "nearest left and right stamps differ by 3600.0 s, more than max_stamp_offset_s = 0.005: "
            "do both cameras' hosts have the same time, and do both drivers set header.stamp?",
        ),
        (
            [0],
            [2 * MS],
            "nearest left and right stamps differ by 2 ms: they pair as soon as the next image shows "
            "that there is no nearer one",
        ),
        ([1, 2], [2], "1 of 2 images left and 1 right are paired, 1 left and 0 right found no partner"),
    ],
)
def test_one_sentence_says_why_nothing_pairs(left: Stamps, right: Stamps, sentence: str) -> None:
    pairer: StampPairer[None] = StampPairer(5 * MS if max([0, *left, *right]) > 1000 else 0)
    for side, stamp, _ in interleaved(left, right, []):
        pairer.add(side, stamp, None)
    assert pairer.explain() == sentence


@pytest.mark.parametrize(
    "options",
    [{"max_offset_ns": -1}, {"max_offset_ns": 0, "queue_length": 0}, {"max_offset_ns": 0, "min_period_ns": -1}],
)
def test_impossible_settings_are_refused(options: dict[str, int]) -> None:
    name = list(options)[-1]
    with pytest.raises(ParameterError, match=f"{name} = {options[name]} must be at least"):
        StampPairer(**options)


def test_what_waits_for_a_nearer_one_says_nothing_of_those_that_come_after() -> None:
    """One camera's driver ended, and came back with a time of its own: the gap of its last image was kept."""
    pairer: StampPairer[int] = StampPairer(10)
    pairer.add("left", 1000, 0)
    pairer.add("right", 1003, 0)
    assert "pair as soon as" in pairer.explain_offset()
    for stamp_ns in range(1100, 3000, 100):
        pairer.add("right", stamp_ns + 3, 0)
        pairer.add("left", stamp_ns - 950, 0)
    assert pairer.is_apart
