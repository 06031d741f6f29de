"""Solids on a known table, of every kind, that most edges around a place in both images agree on.

Random sample consensus (Fischler and Bolles 1981): as many edges, drawn at random, as a solid of a given orientation
has unknowns, make one. A plane through a camera and an edge of its silhouette touches it, which is linear in its place
and its half sizes, as is that it touches the table: each guess is one small linear system.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.edgels import PER_RAY, RAYS, edgels_around
from stereo_pick.core.edges.linear_systems import solutions
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import BOX, KINDS, Kind, dot
from stereo_pick.core.shapes.sight import normalized, tangent_planes
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.starts import orientations
from stereo_pick.core.shapes.table import Table

_GUESSES = 1200  # of each orientation
_AT_ONCE = 4  # orientations: more do not fit into a processor's cache
_FINER = 3  # orientations than for a search that turns them ...
_FINEST = 12  # ... where what is found is not turned either: the ends of what is 100 px long are off by half a pixel
_BETTERED, _ROUNDS = 150, 2  # the best guesses, by all the edges that they agree with
_KEPT = 40  # solids of each kind: where half of a part shows, high lights and shadows often have more edges
_ON_EDGE_PX = 1.2  # as far as the orientation may be off, and the edge's normal
_LEAST_SEEN = 1 / 4  # of the rays, in both views, that cross an edge of it exactly
_LEAST_EDGES = 20  # of both views together
_LEAST_SIZE, _MOST_AWAY = 0.08, 1.5  # by the reach of the rays
_ANOTHER = 0.05  # of that reach
_TINY = 1e-12
_LOOSE = 1e-6  # weight by which unknowns stay where no edge holds them

Covered = Callable[[Floats, int], Bools]
"""Which places (N, 2), normalized, of a view show something else (N,)."""


class _Edges(NamedTuple):
    """E edges of both views, those of each ray one after the other: planes (E, 3), the normals of those through camera
    and edge; offsets_m (E,), of their camera along it; rays (E,), which they lie on, those of the right view last."""

    planes: Floats
    offsets_m: Floats
    rays: Ints


class _Around(NamedTuple):
    """A frame on the table: its axes as columns (3, 3), the table's normal last, and its origin (3,) [m]; reach_m: how
    large solids may be, and about how far away; m_per_px: at its origin."""

    axes: Floats
    origin_m: Floats
    reach_m: float
    m_per_px: float


class _Problem(NamedTuple):
    """What solids of G orientations must satisfy, unknowns (S, 2 + sizes) being their place along the table and their
    half sizes [m]: rows (G, E, 2 + sizes) @ unknowns = right_m (E,), for each edge that is theirs; rays (E,): of
    the edges; rises (G, sizes): how high their centres are, by half sizes; within_m: what is near enough to an edge;
    high (G, E): which edges would be of the upper half, where only these speak."""

    rows: Floats
    right_m: Floats
    rays: Ints
    rises: Floats
    within_m: float
    high: Bools | None = None


def solids_around(
    views: Sequence[EdgeMap],
    rig: StereoRig,
    table: Table,
    places_px: Sequence[Floats],
    reach_px: float,
    covered: Covered | None = None,
    in_shadow: bool = False,
) -> list[Solids]:
    """The solids (S = 1 each) on a table on which most edges around the places (2,) [px] of an object agree.

    reach_px: how far from its places its edges may be; covered: where they are another's; in_shadow: whether they stand
    in their own shadow, the edges of which look like theirs, so that only those speak that are none of its foot.
    """
    edges = _edges(views, rig, places_px, reach_px, covered)
    around = _around(rig, table, places_px, reach_px)
    if len(edges.rays) < _LEAST_EDGES or around is None:
        return []
    draw = np.random.default_rng(0)  # the same for the same images
    return [solid for kind in KINDS.values() for solid in _of_kind(kind, edges, around, table, draw, in_shadow)]


def _edges(
    views: Sequence[EdgeMap], rig: StereoRig, places_px: Sequence[Floats], reach_px: float, covered: Covered | None
) -> _Edges:
    several = []
    for i, (view, place_px) in enumerate(zip(views, places_px)):
        edgels = edgels_around(view, place_px, reach_px)
        points = normalized(edgels.points.reshape(-1, 2), view.camera)
        planes = tangent_planes(points, edgels.normals.reshape(-1, 2))
        is_its = edgels.found.ravel()
        found = np.flatnonzero(is_its & ~covered(points, i) if covered else is_its)
        several.append(_Edges(planes[found], planes[found] @ rig.eyes_m[i], i * RAYS + found // PER_RAY))
    return _Edges(*(np.concatenate(each) for each in zip(*several)))


def _around(rig: StereoRig, table: Table, places_px: Sequence[Floats], reach_px: float) -> _Around | None:
    """The table around the place in the left view; None where that lies beyond its horizon."""
    ray = np.append(normalized(places_px[0], rig.left), 1.0)
    sinks = float(-table.normal @ ray)
    if sinks <= 0:
        return None
    depth_m = table.offset_m / sinks
    m_per_px = depth_m / rig.focal_px
    return _Around(orientations(BOX, table)[0][0], ray * depth_m, reach_px * m_per_px, m_per_px)


def _of_kind(
    kind: Kind, edges: _Edges, around: _Around, table: Table, draw: np.random.Generator, in_shadow: bool
) -> Iterator[Solids]:
    """The few of a kind, each clearly another one, that have the most edges."""
    rotations, turns = orientations(kind, table, _FINEST if in_shadow else _FINER)
    problem = _problem(kind, rotations, edges, around, in_shadow)
    which, unknowns = _guesses(problem, around.reach_m, draw)
    if not len(which):
        return
    on_edge = _on_edge(problem, which, unknowns)
    best = np.sort(np.argsort(-_seen(problem, on_edge), kind="stable")[:_BETTERED])
    which, unknowns, on_edge = which[best], unknowns[best], on_edge[:, best]
    for _ in range(_ROUNDS):
        unknowns = _bettered(problem, which, unknowns, on_edge)
        on_edge = _on_edge(problem, which, unknowns)
    seen, half_m = _seen(problem, on_edge), unknowns[:, 2:]
    in_frame = np.concatenate([unknowns[:, :2], dot(problem.rises[which], half_m)[:, None]], axis=1)
    centre_m = around.origin_m + in_frame @ around.axes.T
    seen = np.where(_possible(unknowns, around.reach_m), seen, 0.0)
    for i in _different(np.concatenate([centre_m, half_m], axis=1), seen, _ANOTHER * around.reach_m):
        at = which[i]
        yield Solids(kind, centre_m[i, None], rotations[at, None], half_m[i, None], turns[at, None])


def _problem(kind: Kind, rotations: Floats, edges: _Edges, around: _Around, in_shadow: bool) -> _Problem:
    up, planes = around.axes[:, 2], edges.planes
    rises = _support(kind, (-up @ rotations)[:, None])[:, 0]
    along = np.broadcast_to(planes @ around.axes[:, :2], (len(rotations), len(planes), 2))
    by_sizes = (planes @ up)[:, None] * rises[:, None] + _support(kind, planes @ rotations)
    rows = np.concatenate([along, by_sizes], axis=2)
    right_m = edges.offsets_m - planes @ around.origin_m
    high = _is_high(kind, planes @ rotations, up @ rotations) if in_shadow else None
    return _Problem(rows, right_m, edges.rays, rises, _ON_EDGE_PX * around.m_per_px, high)


def _is_high(kind: Kind, planes: Floats, up: Floats) -> Bools:
    """Which planes (G, E, 3), in the solids' own axes, touch them in the upper half; up: (G, 3), the table's normal."""
    half = np.ones((len(up), kind.sizes))
    return np.asarray(dot(kind.touch(planes, half), up[:, None]) >= 0)


def _support(kind: Kind, directions: Floats) -> Floats:
    """How far (G, N, sizes) solids reach in directions (G, N, 3) of their own axes, by half sizes."""
    touched = kind.touch(directions, np.ones((len(directions), kind.sizes)))
    return np.asarray((touched * directions) @ kind.shares)


def _guesses(problem: _Problem, reach_m: float, draw: np.random.Generator) -> tuple[Ints, Floats]:
    """The orientations (S,) and the unknowns (S, 2 + sizes) of those guesses that are possible."""
    chosen = _drawn(problem, draw)
    solved = np.concatenate([_solved(problem, first, chosen) for first in range(0, len(chosen), _AT_ONCE)])
    possible = np.flatnonzero(_possible(solved, reach_m))
    return possible // _GUESSES, solved[possible]


def _solved(problem: _Problem, first: int, chosen: Ints) -> Floats:
    """The unknowns (S, 2 + sizes) of all guesses of the few orientations from the first on, by their chosen edges."""
    rows, edges = problem.rows[first : first + _AT_ONCE], chosen[first : first + _AT_ONCE]
    grid, count, unknowns = rows.shape
    equations = np.append(rows, np.broadcast_to(problem.right_m[:, None], (grid, count, 1)), axis=2)
    columns = equations.reshape(-1, unknowns + 1).T
    each = (edges + np.arange(0, grid * count, count)[:, None, None]).reshape(-1, unknowns)
    return solutions(columns.take(each.T, axis=1).transpose(1, 0, 2))


def _drawn(problem: _Problem, draw: np.random.Generator) -> Ints:
    """Edges (G, guesses, unknowns) drawn for each orientation, of those that speak."""
    grid, edges, unknowns = problem.rows.shape
    shape = (grid, _GUESSES, unknowns)
    if problem.high is None:
        return draw.integers(0, edges, shape)
    count = np.maximum(problem.high.sum(axis=1), 1)
    drawn = draw.integers(0, count[:, None, None], shape).reshape(grid, -1)
    high_first = np.argsort(~problem.high, axis=1, kind="stable")
    return np.asarray(np.take_along_axis(high_first, drawn, axis=1).reshape(shape))


def _possible(unknowns: Floats, reach_m: float) -> Bools:
    """Whether (S,) solids are so large and so near that they may be what is looked for."""
    along_m, half_m = unknowns[:, :2], unknowns[:, 2:]
    is_size = ((half_m > _LEAST_SIZE * reach_m) & (half_m < reach_m)).all(axis=1)
    return np.asarray(is_size & (np.sqrt(dot(along_m, along_m)) < _MOST_AWAY * reach_m))


def _on_edge(problem: _Problem, which: Ints, unknowns: Floats) -> Floats:
    """How exactly at each edge solids of sorted orientations end (E, S): 1, and 0 where they do not."""
    on_edge = np.empty((len(problem.right_m), len(which)))
    there, first = np.unique(which, return_index=True)
    for each, one, end in zip(there, first, (*first[1:], len(which))):
        off = (problem.rows[each] @ unknowns[one:end].T - problem.right_m[:, None]) / problem.within_m
        on_edge[:, one:end] = np.maximum(1 - off * off, 0)
        if problem.high is not None:
            on_edge[~problem.high[each], one:end] = 0.0
    return on_edge


def _seen(problem: _Problem, on_edge: Floats) -> Floats:
    """The part (S,) of the rays, the least of both views, that cross one of these edges (E, S), the less the less
    exactly (MSAC: Torr and Zisserman 2000)."""
    clearest = np.zeros((2 * RAYS, on_edge.shape[1]))
    for ray, each in zip(problem.rays, on_edge):
        np.maximum(clearest[ray], each, out=clearest[ray])
    return np.asarray(clearest.reshape(2, RAYS, -1).mean(axis=1).min(axis=0))


def _bettered(problem: _Problem, which: Ints, unknowns: Floats, on_edge: Floats) -> Floats:
    """The unknowns by least squares of all edges (E, S) that solids end at."""
    rows = problem.rows[which]
    weighted = (rows * (on_edge.T > 0)[..., None]).transpose(0, 2, 1)
    normal, off_m = weighted @ rows, problem.right_m[:, None] - rows @ unknowns[..., None]
    loose = _LOOSE * np.einsum("sii->s", normal) + _TINY
    normal = normal + loose[:, None, None] * np.eye(normal.shape[1])
    return np.asarray(unknowns + np.linalg.solve(normal, weighted @ off_m)[..., 0])


def _different(solids_m: Floats, seen: Floats, by_m: float) -> list[int]:
    """The few rows of solids (S, K) [m] that are seen most, no two alike."""
    kept: list[int] = []
    left = np.where(seen < _LEAST_SEEN, 0.0, seen)
    while left.any() and len(kept) < _KEPT:
        kept.append(int(left.argmax()))
        left[np.abs(solids_m - solids_m[kept[-1]]).max(axis=1) <= by_m] = 0.0
    return kept
