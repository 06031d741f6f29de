"""What is printed on tables, drilled into them, or lies flat on them."""

from __future__ import annotations

from parts import yaw
from rendering import Label
from rendering.printed import Board, Holes, Lines, Marker, Slots, Spot, Text
from staging import Random

from surroundings.common import Surrounded, drawn, on, place, seed


def breadboard(random: Random) -> Surrounded:
    """An optical table: threaded holes every 25 mm."""
    return on(random, [Holes(0.025, drawn(random, 0.005, 0.008), yaw(random), drawn(random, 0.15, 0.5))])


def cutting_mat(random: Random) -> Surrounded:
    """A grid of lines every 10 mm."""
    return on(random, [Lines(0.01, drawn(random, 0.0004, 0.001), yaw(random), drawn(random, 1.4, 2.2))])


def chessboard(random: Random) -> Surrounded:
    """The board of the calibration was left lying."""
    return on(random, [Board(*place(random, 0.12), yaw(random), drawn(random, 0.015, 0.03))])


def markers(random: Random) -> Surrounded:
    """Three to six square markers."""
    count = random.integers(3, 7)
    return on(
        random,
        [Marker(*place(random, 0.25), yaw(random), drawn(random, 0.025, 0.06), seed(random)) for _ in range(count)],
    )


def newspaper(random: Random) -> Surrounded:
    """A table covered with print."""
    ink = Text(drawn(random, 0.003, 0.006), yaw(random), drawn(random, 0.3, 0.6), seed(random))
    return on(random, [ink], table=(0.3, 0.45), parts=(0.65, 0.95))


def stains(random: Random) -> Surrounded:
    """Spots of oil and of paint, some with soft edges."""
    softness_m = (0.0005, 0.004, 0.015)
    spots = [
        Spot(
            *place(random, 0.25),
            drawn(random, 0.01, 0.05),
            drawn(random, 0.5, 1.6),
            float(random.choice(softness_m)),
            seed(random),
        )
        for _ in range(random.integers(4, 10))
    ]
    return on(random, spots)


def sheet(random: Random) -> Surrounded:
    """One or two sheets of paper, under some of the parts."""
    papers = [
        Label(*place(random, 0.2), 0.297, 0.21, yaw(random), drawn(random, 0.7, 0.85))
        for _ in range(random.integers(1, 3))
    ]
    return on(random, papers, parts=(0.3, 0.6))


def tape(random: Random) -> Surrounded:
    """Two to four strips of tape across the table."""
    strips = [
        Label(*place(random, 0.2), 2.0, drawn(random, 0.012, 0.05), yaw(random), drawn(random, 0.05, 0.8))
        for _ in range(random.integers(2, 5))
    ]
    return on(random, strips)


def slots(random: Random) -> Surrounded:
    """The table of a machine: wide dark slots, side by side."""
    return on(
        random, [Slots(drawn(random, 0.04, 0.08), drawn(random, 0.01, 0.018), yaw(random), drawn(random, 0.15, 0.6))]
    )
