"""The reasons of refusals, as the docs tell them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from stereo_pick.core.refusal import REASONS

DOCS = Path(__file__).parents[1] / "docs"
ROW = re.compile(r"^\| `(\w+)` \| ([^|]+) \|$", re.MULTILINE)


def test_the_table_of_reasons_is_the_programs_in_its_order() -> None:
    """Their order is what the column `reason` of `correspondences` counts."""
    told = [row for row in ROW.findall((DOCS / "architecture.md").read_text()) if row[0] in REASONS]
    assert told == list(REASONS.items())


@pytest.mark.parametrize("reason", REASONS)
def test_every_reason_has_a_remedy(reason: str) -> None:
    lines = (DOCS / "troubleshooting.md").read_text().splitlines()
    rows = [line for line in lines if line.startswith("| `") and f"`{reason}`" in line.split("|")[1]]
    assert len(rows) == 1
    if f"`{reason} at " in rows[0]:
        assert REASONS[reason] in rows[0]
