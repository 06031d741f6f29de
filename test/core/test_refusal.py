"""Refusals name a known reason."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.refusal import REASONS, Refusal, count_reasons


def test_an_unknown_reason_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown reason 'bad luck'"):
        Refusal("bad luck", None, None)


def test_every_reason_says_what_it_means() -> None:
    assert all(len(meaning.split()) >= 4 for meaning in REASONS.values())


def test_the_places_of_a_refusal_are_read_only() -> None:
    refusal = Refusal("faint", np.array([1.0, 2.0]), None)
    assert refusal.left_px is not None and not refusal.left_px.flags.writeable


def test_reasons_are_counted() -> None:
    refused = [Refusal(reason, None, None) for reason in ("faint", "merged", "faint")]
    assert count_reasons(refused) == {"faint": 2, "merged": 1}
