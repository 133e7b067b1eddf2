"""Anchors: curves of an accurate and a fast model at one point, by which the fast one's are scaled elsewhere.

The accurate model's curve h at some parameters u_0 and all samples, and the fast one's f at few samples, give

    h(u, t) = h(u_0, t) f(u, t) / f(u_0, t),

where the ratio of the fast curves varies slowly in time, so that few samples suffice, and the ratio of both models
hardly changes with u (space mapping; Bakr, Bandler et al., Optim. Eng. 1 (2000) 241-276). With a pyramid as the
accurate model, the cone of equal cross-sections is the fast one.

Where derivatives of the accurate model are known at u_0, the mapping is made consistent with them: the difference of
both models' derivatives, times u - u_0, is added (N. M. Alexandrov et al., J. Aircraft 38 (2001) 1093-1101).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.base.interpolation import smooth_between
from palpate.mechanisms import Mechanism
from palpate.models.body_model import BodyModel
from palpate.models.fidelity import COARSE, FINE, MEDIUM, PYRAMID, RECORD, SEARCH, STUDY, Level, kept
from palpate.study.protocol import Protocol

NO_DEPTH = 1e-6  # of the largest depth: below it an elastic body is unloaded


@dataclass(frozen=True, eq=False)
class Anchor:
    """Curves of the body under one condition, of both models.

    Parameters
    ----------
    accurate : ndarray, shape (n_points,)
        At all samples.
    fast : ndarray, shape (n_kept,)
        At those that are kept, see `palpate.models.fidelity.kept`.
    mesh_change : ndarray, shape (n_points,)
        By how much the accurate model differs from that on the study's mesh, where known.
    slope_correction : ndarray, shape (n_points, k)
        By how much the accurate model's derivatives by the coordinates exceed those that are scaled, where known.
    richardson : ndarray, shape (n_points,)
        Part of the accurate model's curve [-] that finer meshes add to it, which is in `accurate` already.
    finer : ndarray, shape (n_kept,)
        What still finer meshes add to the fast model's curves before they are scaled.
    """

    accurate: np.ndarray
    fast: np.ndarray
    mesh_change: np.ndarray
    slope_correction: np.ndarray | None = None
    richardson: np.ndarray | float = 0.0
    finer: np.ndarray | float = 0.0

    def extrapolated(self, part: np.ndarray | float) -> Anchor:
        """Return the same with this part (n_points,) that finer meshes add, in place of what they added before."""
        accurate = self.accurate / (1.0 + self.richardson) * (1.0 + part)
        return replace(self, accurate=accurate, slope_correction=None, richardson=part)

    def scaled(self, fast: np.ndarray, protocol: Protocol) -> np.ndarray:
        """Return the fast model's values (n_kept, ...) scaled to the accurate model, at all samples (n_points, ...)."""
        divides, time = _deep(self.fast), protocol.sample_time
        ratios = (fast[divides].T / self.fast[divides]).T.reshape(int(divides.sum()), -1)
        everywhere = smooth_between(protocol.knot_time, time, time[kept(protocol)][divides], ratios)
        return (self.accurate[:, None] * everywhere).reshape(len(time), *fast.shape[1:])


@dataclass(frozen=True, eq=False)
class Anchors:
    """Anchors under each condition where both models succeed, at one point.

    Parameters
    ----------
    point : ndarray, shape (k,)
        Coordinates at which they were simulated.
    mechanisms
        That acted there.
    of : Mapping
        The anchor of each condition, by its name.
    refined
        Whether what finer meshes add was found near that point, with these mechanisms.
    """

    point: np.ndarray
    mechanisms: Sequence[Mechanism]
    of: Mapping[str, Anchor]
    refined: bool = False

    def extrapolated(self, parts: Mapping[str, np.ndarray | float], refined: bool = False) -> Anchors:
        """Return the same with the part (n_points,) that finer meshes add under each condition; none elsewhere."""
        found = {name: each.extrapolated(parts.get(name, 0.0)) for name, each in self.of.items()}
        return replace(self, of=found, refined=refined)


def anchors_at(body: BodyModel, u: np.ndarray, level: Level = SEARCH) -> dict[str, Anchor]:
    """Return anchors at coordinates u (k,) under each condition where both models succeed.

    The accurate curve is that of a finer mesh or, where that fails, of the study's; or of the pyramid in place of the
    equivalent cone, of which few samples are simulated.

    Parameters
    ----------
    body
        The body under the conditions.
    u
        Coordinates.
    level
        Of the fast model.
    """
    tips = body.study.by_tip(body.conditions).values()
    if len(tips) > 1:
        parts = [anchors_at(replace(body, conditions=conditions), u, level) for conditions in tips]
        return {name: anchor for part in parts for name, anchor in part.items()}
    coarse = body.at(COARSE).possible(u)
    fast = coarse if level == COARSE else body.at(level).possible(u)
    if of_revolution := all(body.study.tip_of(condition).of_revolution for condition in body.conditions):
        accurate = body.at(RECORD).possible(u)
        accurate |= body.under([name for name in coarse if name not in accurate]).possible(u)
    else:
        cone, pyramid = body.at(STUDY).possible(u), body.at(PYRAMID).possible(u)
        accurate = {
            name: Anchor(cone[name], coarse[name], np.zeros_like(cone[name])).scaled(
                pyramid[name], body.study.condition(name).protocol
            )
            for name in pyramid.keys() & cone.keys() & coarse.keys()
        }
    found = {}
    for condition in body.conditions:
        name, time, keep = condition.name, condition.protocol.sample_time, kept(condition.protocol)
        if name in fast and name in coarse and name in accurate:
            change = np.interp(time, time[keep], accurate[name][keep] - coarse[name])
            found[name] = Anchor(accurate[name], fast[name], float(of_revolution) * change)
    return found


def richardson_at(body: BodyModel, u: np.ndarray) -> dict[str, np.ndarray]:
    """Return the part of the curves (n_points,) at coordinates u (k,) that finer meshes add, where both succeed."""
    before, after = (body.at(level).possible(u) for level in (MEDIUM, FINE))
    return {
        condition.name: richardson(
            before[condition.name], after[condition.name] - before[condition.name], condition.protocol
        )
        for condition in body.conditions
        if condition.name in before and condition.name in after
    }


def richardson(before: np.ndarray, change: np.ndarray | float, protocol: Protocol) -> np.ndarray:
    """Return the part of a curve (n_points,) [-] that all finer meshes add; none where the body is unloaded.

    With an error of second order in the spacing, as much lies beyond the next finer mesh as that adds (L. F.
    Richardson, Phil. Trans. A 210 (1911) 307-357).

    Parameters
    ----------
    before : ndarray, shape (n_kept,)
        The curve at the samples that are kept.
    change : ndarray, shape (n_kept,)
        What the next finer mesh adds to it.
    protocol
        Of the test.
    """
    part = np.divide(2.0 * change, before, out=np.zeros_like(before), where=_deep(before))
    return np.interp(protocol.sample_time, protocol.sample_time[kept(protocol)], part)


def _deep(curve: np.ndarray) -> np.ndarray:
    """Return where a curve (n,) differs from nothing, by which it may be divided."""
    return np.abs(curve) > NO_DEPTH * np.abs(curve).max()
