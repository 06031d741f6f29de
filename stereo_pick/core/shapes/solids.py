"""Solids of one kind: where they are, how they are turned and how large they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.shapes.kinds import SPHERE, Kind


@dataclass(frozen=True, eq=False)
class Solids:
    """S solids of one kind.

    centre_m: (S, 3), rotation: (S, 3, 3) with their axes as columns, both in the rectified left frame; half_m:
    (S, sizes); turns: (S, 3, Q), the axes in the solid's own frame about which each may be turned.
    """

    kind: Kind
    centre_m: Floats
    rotation: Floats
    half_m: Floats
    turns: Floats

    def only(self, chosen: Ints) -> Solids:
        """These of them."""
        return Solids(self.kind, self.centre_m[chosen], self.rotation[chosen], self.half_m[chosen], self.turns[chosen])

    @staticmethod
    def joined(several: Sequence[Solids]) -> Solids:
        """Solids of one kind, with as many turns each, as one."""
        centre, rotation, half, turns = (
            np.concatenate([getattr(each, name) for each in several])
            for name in ("centre_m", "rotation", "half_m", "turns")
        )
        return Solids(several[0].kind, centre, rotation, half, turns)

    @property
    def is_ball(self) -> Bools:
        """Which (S,) are balls: all, or none."""
        return np.full(len(self.centre_m), self.kind is SPHERE)

    def replaced(self, rows: Ints, others: Solids) -> Solids:
        """The same with others in these rows."""
        centre, rotation, half = self.centre_m.copy(), self.rotation.copy(), self.half_m.copy()
        centre[rows], rotation[rows], half[rows] = others.centre_m, others.rotation, others.half_m
        return Solids(self.kind, centre, rotation, half, self.turns)

    def turning_freely(self) -> Solids:
        """The same, to be turned about every axis that matters."""
        turns = np.eye(3)[:, list(self.kind.turns)]
        return replace(self, turns=np.broadcast_to(turns, (len(self.centre_m), *turns.shape)))

    def turning_about(self, axis: Floats) -> Solids:
        """The same, to be turned about one axis (3,) of the rectified left frame, if any turn matters."""
        if not self.kind.turns:
            return self.turning_freely()
        return replace(self, turns=np.asarray(axis @ self.rotation)[..., None])

    def size_m(self) -> Floats:
        """Full sizes (S, 3) along the axes."""
        return 2 * self.half_m[:, self.kind.axes] * self.kind.spans

    def seen_from(self, eyes_m: Floats) -> Floats:
        """The centres (S, E, 1, 3) [m] as seen from eyes (E, 3)."""
        return np.asarray((self.centre_m[:, None] - eyes_m)[:, :, None])
