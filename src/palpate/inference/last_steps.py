"""The last steps of a fit, on finer meshes.

The model of record rests on a mesh that is finer by one degree than the study's. Its curves of creeping bodies err by
some 0.07 % of the depth, which moved the estimates of four cases of the blind trial by up to 1.3 standard deviations,
and left 2.4 to 4.3 standard deviations of the noise in the residual. So a fit that explains replicates ends with curves
of a mesh that is finer by two degrees, extrapolated where the fit arrived (`palpate.models.anchors.richardson`). The
same part of the depth serves other explanations meanwhile: with a film it leaves a quarter of the error, with a rounded
tip half.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.errors import PalpateError
from palpate.inference.explanation import Fit
from palpate.inference.fitting import Fitter
from palpate.inference.search_state import SearchState, StoppingCriteria
from palpate.inference.trust_region import descend, gauss_newton
from palpate.models.forward import Curves, Forward


def on_finer_meshes(fitter: Fitter, fit: Fit) -> Fit:
    """Return a fit that explains replicates after its last steps on finer meshes, where there are any."""
    if not (fitter.problem.replicated and fitter.explains(fit)):
        return fit
    if found := fit.model.extrapolated(fit.z):
        return _at_the_edge(fitter, fit, *found)
    refined, policy = with_finer_curves(fitter, fit), fitter.policy
    if refined is fit:
        return fit
    begun = SearchState(fit.z, refined.curve, fit.tangent, exact=False)
    end = descend(fitter.goal(fit), refined.model, [begun], StoppingCriteria(policy.iterations, policy.tolerance))
    return fitter.at_end(fit.explanation, refined.model, end, fit.errors)


def with_finer_curves(fitter: Fitter, fit: Fit) -> Fit:
    """Return a fit to replicates where it is, with curves of finer meshes."""
    if not fitter.problem.replicated or not (model := fit.model.refined(fit.z)):
        return fit
    (curves,) = model.curves([fit.z])
    return fit if isinstance(curves, str) else replace(fit, model=model, curve=fitter.problem.stacked(curves))


def _at_the_edge(fitter: Fitter, fit: Fit, model: Forward, curves: Curves, slopes: Curves) -> Fit:
    """Return a fit after its last steps where the edge of contact decides how a curve changes."""
    problem, policy = fitter.problem, fitter.policy
    begun = SearchState(fit.z, problem.stacked(curves), problem.stacked(slopes))
    way = gauss_newton(fitter.goal(fit), model, begun, policy.finer_steps, policy.tolerance, policy.first_order)
    try:
        record = model.consistent(way.u, problem.responses(way.curve), problem.responses(way.tangent))
    except PalpateError:
        return fit
    return fitter.at_end(fit.explanation, record, way, fit.errors)
