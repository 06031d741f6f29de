"""Left and right image files, found by patterns and paired by order."""

from __future__ import annotations

import glob
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from stereo_pick.core.errors import CalibrationError

Numbers = tuple[int, ...]


@dataclass(frozen=True)
class FilePair:
    """A left and a right image file, and a short name for the pair in messages."""

    name: str
    left: Path
    right: Path


def find_files(patterns: Sequence[str], option: str) -> list[Path]:
    """The files that match the patterns, left2 before left10; raises CalibrationError naming the option.

    Several patterns are what the shell makes of one that was not quoted.
    """
    return sorted({file for pattern in patterns for file in _matching(pattern, option)}, key=_natural)


def pair_files(left: Sequence[Path], right: Sequence[Path]) -> list[FilePair]:
    """Pair left and right by order; raises CalibrationError where there are more of one than of the other."""
    if len(left) != len(right):
        raise CalibrationError(
            f"{len(left)} left and {len(right)} right images do not pair{_partnerless(left, right)}: "
            "each left image needs the right one taken at the same moment"
        )
    by_folder = len({file.name for file in left}) < len(left)
    return [FilePair(a.parent.name if by_folder else f"{a.name} + {b.name}", a, b) for a, b in zip(left, right)]


def disagreement(pairs: Sequence[FilePair]) -> str | None:
    """What to say where the numbers in the paired names differ; None where they agree or say nothing."""
    left, right = _numbers([pair.left for pair in pairs], [pair.right for pair in pairs])
    differing = [pair for pair, a, b in zip(pairs, left, right) if a != b]
    if not differing:
        return None
    return (
        f"the numbers in {len(differing)} of {len(pairs)} pairs' names disagree, first {differing[0].left.name} with "
        f"{differing[0].right.name}: files are paired by order; is one missing?"
    )


def _matching(pattern: str, option: str) -> list[Path]:
    if Path(pattern).is_file():  # its name may hold brackets
        return [Path(pattern)]
    files = [Path(match) for match in glob.glob(str(Path(pattern).expanduser()), recursive=True)]
    files = [file for file in files if file.is_file()]
    if not files:
        raise CalibrationError(f"{option} {pattern!r} matches no file: check the path")
    return files


def _partnerless(left: Sequence[Path], right: Sequence[Path]) -> str:
    of_left, of_right = _numbers(left, right)
    alone = [file.name for file, number in zip(left, of_left) if number not in of_right]
    alone += [file.name for file, number in zip(right, of_right) if number not in of_left]
    if not alone or len(alone) > 10:
        return ""
    return f" (without a partner: {', '.join(alone)})"


def _numbers(left: Sequence[Path], right: Sequence[Path]) -> tuple[list[Numbers], list[Numbers]]:
    """The numbers in the files' names, or in their folders' where those have none.

    A number that is the same on a whole side names the camera, not the pair, and is left out.
    """
    for by_folder in (False, True):
        of_left, of_right = ([_digits(file, by_folder) for file in files] for files in (left, right))
        lengths = {len(numbers) for numbers in of_left + of_right}
        if len(lengths) == 1 and lengths != {0}:
            varying = [k for k in range(lengths.pop()) if len({numbers[k] for numbers in of_left}) > 1]
            return [_pick(numbers, varying) for numbers in of_left], [_pick(numbers, varying) for numbers in of_right]
    return [()] * len(left), [()] * len(right)


def _digits(file: Path, of_folder: bool) -> Numbers:
    return tuple(int(digits) for digits in re.findall(r"\d+", file.parent.name if of_folder else file.stem))


def _pick(numbers: Numbers, positions: Sequence[int]) -> Numbers:
    return tuple(numbers[k] for k in positions)


def _natural(file: Path) -> list[tuple[int, str]]:
    """Sorts digits as numbers: left2 before left10."""
    parts = re.split(r"(\d+)", str(file))
    return [(int(part), "") if k % 2 else (-1, part) for k, part in enumerate(parts)]
