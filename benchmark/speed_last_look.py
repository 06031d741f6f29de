"""What a last look at what was refused costs, and what it finds, where there is more to be seen than parts."""

from __future__ import annotations

from statistics import median

from evaluate_surroundings import taken
from family_scoring import SceneScore, score
from formatting import Row, decimals, markdown_table
from rendering.rigs import BENCH_RIGS
from surroundings import SURROUNDINGS

from stereo_pick.core.configuration import steps
from stereo_pick.core.pipeline import Pipeline

_SEED = 0
_SETTINGS = True, False


def last_look_table() -> str:
    """One scene of each of the surroundings, both settings in turn."""
    seen = [_scored(family) for family in SURROUNDINGS]
    rows = [_row(f"`{str(setting).lower()}`", scores) for setting, scores in zip(_SETTINGS, zip(*seen))]
    ratio = _spent_s([scores[0] for scores in seen]) / _spent_s([scores[1] for scores in seen])
    header = ("`feature.last_look`", "pairs", "CPU s, median", "longest", "parts found / required")
    return markdown_table(header, rows) + f"\n\nAll pairs together take {ratio:.1f} times as long with it as without."


def _scored(family: str) -> list[SceneScore]:
    rig_name, frame, truth = taken(None, (family, _SEED))
    several = (Pipeline(BENCH_RIGS[rig_name], steps({"feature.last_look": setting})) for setting in _SETTINGS)
    return [score(family, _SEED, pipeline, frame, truth) for pipeline in several]


def _row(name: str, scores: tuple[SceneScore, ...]) -> Row:
    spent_s = [one.seconds for one in scores]
    required = sum(one.required for one in scores)
    found = required - sum(len(one.missed) for one in scores)
    longest = decimals(max(spent_s), 1)
    return (name, str(len(scores)), decimals(median(spent_s), 1), longest, f"{found} / {required}")


def _spent_s(scores: list[SceneScore]) -> float:
    return sum(one.seconds for one in scores)
