"""All solids of a scene, and the table they stand on, adjusted together to the edges of both views.

Each solid by itself is known as well as its outline shows it. Together they say how the table lies, and that says what
an outline alone does not: how deep an object is, and how it is turned. They also say by how much the right camera has
turned about its x and z axes since its calibration. All are unknowns of one least squares problem (a bundle adjustment,
Triggs and others 1999); since solids have the table and the camera in common only, each is solved for by itself but for
these five.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.arcs import arc_sigmas_px, usual_sigma_px
from stereo_pick.core.edges.edge_evidence import EdgeEvidence, Seen, edges_seen
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.flush import touching
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.occluders import Hide, Occluders
from stereo_pick.core.shapes.refinement import moved
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_ROUNDS = 4
_FARTHEST = 0.005  # of its distance, by which a solid moves in a round
_LEAST_HALF = 0.02  # of its size
_HARDLY = 3e-5  # ... and less than which is nothing
_DOUBTED = 10.0  # sigmas from which on it is doubted that a solid touches the table as it should
_UNKNOWN = 1000.0  # sigma
_TURN_RAD = 0.0003  # sigma of the right camera's turns that the ends of outlines do not tell ...
_TURN_ASKED_RAD = 0.001  # ... but exact edges: as after a bump, or an hour of warmth
_FOOT_M = 0.00008  # sigma of the middle of what stands in its own shadow: that hides where it ends
_BESIDE_M = 0.1  # from the middle of the solids, where others may stand


class _Group(NamedTuple):
    """Solids (S) of one kind: rows (S,), which they are; on_table: (S,)."""

    rows: Ints
    solids: Solids
    on_table: Bools

    def hidden_by(self, occluders: Occluders) -> Hide:
        """Which places of a view others hide."""
        return partial(occluders.hide, self.solids, own=self.rows)


class _System(NamedTuple):
    """Normal equations of the solids of a group: own (S, P, P), with what all solids have in common (S, P, 5), of that
    (5, 5), and the right-hand sides (S, P) and (5,)."""

    own: Floats
    shared: Floats
    common: Floats
    right: Floats
    common_right: Floats


class _Plane(NamedTuple):
    """A table, two directions (2, 3) across its normal, and the point (3,) where its tilts leave it."""

    table: Table
    across: Floats
    middle_m: Floats


def adjusted(
    fits: Sequence[SolidFit],
    views: Sequence[EdgeMap],
    rig: StereoRig,
    table: Table | None,
    known: bool = False,
    before: Sequence[SolidFit] = (),
    edge_radius_m: float = 0.0,
    in_shadow: bool = False,
) -> tuple[list[Adjusted], Table | None]:
    """The solids (at least one), and the table, that all edges together support best.

    known: whether the table is known without them, and is moved within its sigma only. Those that stand or lie on it
    stay there. before: others that may hide some of them, as they may each other. edge_radius_m: one sigma of how far
    their edges are rounded; in_shadow: whether their own shadows on the table may hide where they end.
    Where they leave open which way a table lies, as a few rods do, it is moved within its sigma, too.
    """
    found, better = _adjusted(fits, views, rig, table, known, before, edge_radius_m, in_shadow)
    if known or better is None or better.sigma_m < max(float(fit.size_m.max()) for fit in fits):
        return found, better
    return _adjusted(fits, views, rig, table, True, before, edge_radius_m, in_shadow)


def _adjusted(
    fits: Sequence[SolidFit],
    views: Sequence[EdgeMap],
    rig: StereoRig,
    table: Table | None,
    known: bool,
    before: Sequence[SolidFit],
    edge_radius_m: float,
    in_shadow: bool,
) -> tuple[list[Adjusted], Table | None]:
    groups = _groups(fits, table)
    occluders = Occluders.of([*fits, *before], rig)
    plane = _plane(table, fits) if table else None
    turn_rad = _TURN_ASKED_RAD if views[0].is_exact else _TURN_RAD
    prior = _prior(plane.table if plane and known else None, turn_rad)
    moved_by = np.zeros(5)  # tilts and height of the table, turns of the right camera
    for round_ in range(_ROUNDS + 1):
        hides = [group.hidden_by(occluders) for group in groups]
        shaded_on = plane.table if plane and in_shadow else None
        edges = edges_seen([group.solids for group in groups], views, rig, moved_by[3:], hides, shaded_on)
        seen = [
            each.evidence(views[0].light * usual_sigma_px(each.scale_px, each.shown), edge_radius_m) for each in edges
        ]
        systems = [_system(group, each, plane) for group, each in zip(groups, seen)]
        step, covariance = _solved(systems, prior, moved_by)
        if round_ == _ROUNDS:
            break
        steps = [_step(system, step) for system in systems]
        groups = [group._replace(solids=_moved(group.solids, each)) for group, each in zip(groups, steps)]
        moved_by = moved_by + step
        plane = _tilted(plane, step) if plane else None
        if max(_farthest(*each) for each in zip(groups, steps)) < _HARDLY:
            break
    found = _as_sure_as_scattered(groups, edges, plane, prior, views[0].light, edge_radius_m)
    by_row = {row: each for group, several in zip(groups, found) for row, each in zip(group.rows.tolist(), several)}
    return [by_row[row] for row in range(len(fits))], _as_table(plane, covariance) if plane else None


def _as_sure_as_scattered(
    groups: Sequence[_Group],
    edges: Sequence[Seen],
    plane: _Plane | None,
    prior: Floats,
    light: float,
    edge_radius_m: float,
) -> list[list[Adjusted]]:
    """The solids of each group where they are, as sure as the arcs of the scene lie on them.

    These are no weights to adjust by: they would change from round to round.
    """
    sigmas_px = arc_sigmas_px([each.arcs for each in edges], [each.shown for each in edges], light)
    seen = [each.evidence(sigma_px, edge_radius_m) for each, sigma_px in zip(edges, sigmas_px)]
    systems = [_system(group, each, plane) for group, each in zip(groups, seen)]
    _, covariance = _solved(systems, prior, np.zeros(5))
    return [_results(*each, covariance, plane) for each in zip(groups, seen, systems)]


def _groups(fits: Sequence[SolidFit], table: Table | None) -> list[_Group]:
    groups = []
    for kind in KINDS.values():
        rows = [row for row, fit in enumerate(fits) if fit.kind == kind.name]
        if rows:
            solids = Solids.joined([fits[row].solid for row in rows]).turning_freely()
            on_table = [table is not None and stands_on(table, fits[row]) for row in rows]
            groups.append(_Group(np.array(rows), solids, np.array(on_table)))
    return groups


def _plane(table: Table, fits: Sequence[SolidFit]) -> _Plane:
    middle_m = np.mean([fit.centre_m for fit in fits], axis=0)
    return _Plane(table, np.linalg.svd(table.normal[None])[2][1:], middle_m)


def _prior(table: Table | None, turn_rad: float) -> Floats:
    """What is known (5, 5) of the tilts and the height of a table, if it is known, and of the camera's turns."""
    sigma = [table.tilt_rad, table.tilt_rad, table.sigma_m] if table else [_UNKNOWN] * 3
    return np.diag(np.array([*sigma, turn_rad, turn_rad]) ** -2.0)


def _system(group: _Group, seen: EdgeEvidence, plane: _Plane | None) -> _System:
    own = seen.normal[:, :-2, :-2] + np.eye(seen.normal.shape[1] - 2)  # nothing is off by more than 1 m or 1 rad
    right, common, common_right = seen.right[:, :-2].copy(), np.zeros((5, 5)), np.zeros(5)
    shared = np.concatenate([np.zeros((*right.shape, 3)), seen.normal[:, :-2, -2:]], axis=2)
    common[3:, 3:], common_right[3:] = seen.normal[:, -2:, -2:].sum(axis=0), seen.right[:, -2:].sum(axis=0)
    if plane is None or not group.on_table.any():
        return _System(own, shared, common, right, common_right)
    touch = touching(group.solids, *plane)
    weight = group.on_table[:, None] / (1 + (touch.off / _DOUBTED) ** 2)  # Cauchy's
    by_solid = touch.by_solid * weight[..., None]
    by_table = touch.by_table * weight[..., None]
    own += by_solid.transpose(0, 2, 1) @ touch.by_solid
    shared[..., :3] += by_solid.transpose(0, 2, 1) @ touch.by_table
    right += (by_solid * touch.off[..., None]).sum(axis=1)
    common[:3, :3] += np.einsum("ski,skj->ij", by_table, touch.by_table)
    common_right[:3] += np.einsum("ski,sk->i", by_table, touch.off)
    return _System(own, shared, common, right, common_right)


def _solved(systems: Sequence[_System], prior: Floats, moved_by: Floats) -> tuple[Floats, Floats]:
    """The common step (5,) and its covariance (5, 5), all solids' own unknowns eliminated (Schur)."""
    normal, right = prior.copy(), prior @ moved_by
    for each in systems:
        eliminated = np.linalg.solve(each.own, each.shared)
        normal += each.common - np.einsum("spi,spj->ij", each.shared, eliminated)
        right += each.common_right - np.einsum("spi,sp->i", eliminated, each.right)
    covariance = np.asarray(np.linalg.inv(normal), np.float64)
    return -covariance @ right, covariance


def _step(system: _System, common: Floats) -> Floats:
    """The step (S, P) of each solid, with the common one."""
    right = system.right + system.shared @ common
    return -np.asarray(np.linalg.solve(system.own, right[..., None])[..., 0])


def _farthest(group: _Group, step: Floats) -> float:
    return float((np.abs(step[:, :3]).max(axis=1) / group.solids.centre_m[:, 2]).max())


def _moved(solids: Solids, step: Floats) -> Solids:
    farthest = _FARTHEST * solids.centre_m[:, 2:]
    part = np.minimum(1.0, farthest / np.maximum(np.abs(step[:, :3]).max(axis=1, keepdims=True), 1e-12))
    return moved(solids, step * part, _LEAST_HALF * solids.half_m.max(axis=1))


def _tilted(plane: _Plane, step: Floats) -> _Plane:
    normal = plane.table.normal + step[:2] @ plane.across
    offset_m = float((plane.table.normal - normal) @ plane.middle_m) + plane.table.offset_m + float(step[2])
    length = float(np.linalg.norm(normal))
    return plane._replace(table=Table(normal / length, offset_m / length, plane.table.sigma_m))


def _as_table(plane: _Plane, covariance: Floats) -> Table:
    sigma_m = float(np.sqrt(covariance[2, 2] + covariance[:2, :2].trace() / 2 * _BESIDE_M**2))
    return Table(plane.table.normal, plane.table.offset_m, sigma_m)


def _results(
    group: _Group, seen: EdgeEvidence, system: _System, common_covariance: Floats, plane: _Plane | None
) -> list[Adjusted]:
    alone = np.linalg.inv(system.own)
    through = (alone @ system.shared)[:, :3]
    covariance = alone[:, :3, :3] + through @ common_covariance @ through.transpose(0, 2, 1)
    if plane is not None:
        covariance[group.on_table] += _FOOT_M**2 * np.outer(plane.table.normal, plane.table.normal)
    solids, size_m = group.solids, group.solids.size_m()
    return [
        Adjusted(
            SolidFit(solids.kind.name, solids.centre_m[i], solids.rotation[i], size_m[i], float(scale), covariance[i]),
            float(seen.shown[i]),
            float(seen.creased[i]),
            bool(seen.has_creases[i]),
            float(seen.denied[i]),
        )
        for i, scale in enumerate(seen.scale_px)
    ]
