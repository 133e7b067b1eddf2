"""The calibration of a study's law on one set of recordings, without any mechanism: what ``calibration.json`` holds."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from indentation_files.recording import Recording
from palpate.base.parameters import in_words
from palpate.base.rounding import interval_of, share_in_words
from palpate.configuration.study_file import Study
from palpate.errors import InputError
from palpate.inference.calibration_result import MOST_MISFIT
from palpate.observables import OBSERVABLES, UNITS
from palpate.output.figures import curves as curves_figure
from palpate.output.figures import uniaxial_curves
from palpate.output.figures.curve_panels import of_fit
from palpate.output.results.bulk_errors import bulk_sentences, bulk_table
from palpate.output.results.imprint_errors import imprint_sentences, imprint_table
from palpate.output.results.misfit import span
from palpate.output.saved_set import ALL, SavedSet
from palpate.output.shown import Shown, axes_for, composed

ERRORS = (*(f"rmse_{u}" for u in UNITS), "r2", *(f"mean_abs_error_{u}" for u in UNITS), "percent_error")


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Shown):
    """What a calibration of the base model found.

    Parameters
    ----------
    saved
        The results of the set of recordings.
    condition_set
        Which conditions it was calibrated on.
    """

    saved: SavedSet
    condition_set: str = ALL

    @property
    def study(self) -> Study:
        """The study."""
        return self.saved.study

    @property
    def tests(self) -> Mapping[str, Sequence[Recording]]:
        """Recordings of each condition, from contact on."""
        return self.saved.tests

    @property
    def content(self) -> Mapping[str, Any]:
        """What ``calibration.json`` holds."""
        return self.saved.calibrations[self.condition_set]

    @property
    def curves(self) -> pd.DataFrame:
        """Recorded, surrogates' and simulated curves of all conditions."""
        return self.saved.fits[self.condition_set]

    @property
    def parameters(self) -> dict[str, Mapping[str, Any]]:
        """For each parameter in the law's order its entry: estimate, lower, upper (95 % interval), identified, held."""
        found = self.content["parameters"]
        return {name: found[name] for name in self.study.declared if name in found}

    @property
    def values(self) -> dict[str, float]:
        """Estimates by the names of the parameters."""
        return {name: entry["estimate"] for name, entry in self.parameters.items()}

    @property
    def discrepancy(self) -> Mapping[str, float] | None:
        """Standard deviation of the law's discrepancy as a share of the depth, with its interval; None if unknown."""
        return self.content.get("discrepancy")

    @property
    def uniaxial(self) -> Mapping[str, Mapping[str, Any]]:
        """Errors, and the predicted curve with its 95 % band, of each uniaxial test of the bulk by its name."""
        found: Mapping[str, Mapping[str, Any]] = self.content.get("uniaxial") or {}
        return found

    @property
    def imprint(self) -> Mapping[str, Mapping[str, Any]]:
        """Errors, and the predicted residual profile, of each imprint by its name."""
        found: Mapping[str, Mapping[str, Any]] = self.content.get("imprint") or {}
        return found

    @property
    def errors(self) -> pd.DataFrame:
        """One row a condition: role, root mean square error, R^2, mean absolute error, error in per cent."""
        rows = [{"condition": name, **entry} for name, entry in self.content["conditions"].items()]
        return pd.DataFrame(rows).filter(["condition", "role", *ERRORS])

    def to_frame(self) -> pd.DataFrame:
        """Return one row a parameter.

        Returns
        -------
        DataFrame
            parameter, unit, estimate, lower and upper (95 % interval), identified (whether the data determine it),
            held, at_bound, outside (whether it lies beyond its range).
        """
        declared = self.study.declared
        return pd.DataFrame(
            {"parameter": name, "unit": declared[name].unit, **entry} for name, entry in self.parameters.items()
        )

    def to_json(self) -> str:
        """Return the content of ``calibration.json``."""
        return json.dumps(self.content, indent=2) + "\n"

    def error_sentence(self) -> str:
        """Return the root mean square errors over the conditions."""
        entries = self.content["conditions"].values()
        text = f"Root mean square misfit {span([entry['rmse_nm'] for entry in entries])} nm over the conditions."
        for each in (each for each in OBSERVABLES.values() if each.unit != "nm"):
            if errors := [entry[each.column("rmse")] for entry in entries if each.column("rmse") in entry]:
                text += (
                    f" Under {each.control} control the misfit of the {each.name} is {span(errors)} {each.unit}; "
                    "in nm it is the equivalent difference of depth under the same load."
                )
        return text

    def misfit_sentence(self) -> str:
        """Return how far the base model departs from the recordings beside their noise."""
        if all(entry["replicates"] == 1 for entry in self.content["noise"].values()):
            return (
                "There are no replicates, so the noise of the recordings is not known: it was taken from the "
                "misfit itself, which therefore cannot test the model. Look at the misfit in time: a smooth pattern, "
                "rather than noise, means that the model lacks something."
            )
        if law := self.content.get("discrepancy"):
            return (
                f"Beside noise the base model departs from the recordings by {share_in_words(law)}; the diagnosis "
                "tests whether an effect is behind that, and one that is smaller may be present, too."
            )
        ratio = self.content["misfit_ratio"]
        if ratio < MOST_MISFIT:
            return (
                "The misfit of the base model as a whole is about the noise of the recordings (chi-square per degree "
                f"of freedom: {ratio:.2f}); a small effect may still be present, which the diagnosis tests."
            )
        return (
            "The base model does not explain the recordings to their noise: chi-square per degree of freedom is "
            f"{ratio:.3g}. Something is missing from it; intervals are widened accordingly and may still be too narrow."
        )

    def bound_sentence(self) -> str:
        """Return which estimates lie outside their range, or at a limit of the law; nothing where none does."""
        at, out = ([n for n, e in self.content["parameters"].items() if e[key]] for key in ("at_bound", "outside"))
        beyond = [name for name in out if name not in at]
        limits = f"At a limit: {', '.join(map(in_words, at))}; the other estimates may compensate for it."
        ranges = (
            f"Estimates of the base model outside the plausible range: {', '.join(map(in_words, beyond))}. Check the "
            "range, and that the law suits the material."
        )
        return " ".join(text for names, text in ((at, limits), (beyond, ranges)) if names)

    def convergence_sentence(self) -> str:
        """Return what to do where the search has not converged; nothing where it has."""
        remedy = "hold parameters constant that the data cannot separate, or narrow the ranges"
        return "" if self.content["converged"] else f"The search has not converged: {remedy}."

    def sentences(self) -> list[str]:
        """Return errors, misfit, estimates outside their range, convergence, uniaxial tests and imprints in words."""
        every = (self.error_sentence(), self.misfit_sentence(), self.bound_sentence(), self.convergence_sentence())
        return [text for text in (*every, *bulk_sentences(self.uniaxial), *imprint_sentences(self.imprint)) if text]

    def tables(self) -> list[pd.DataFrame]:
        """Return the parameters with their intervals, and the errors of conditions, uniaxial tests and imprints."""
        rows = (
            {
                "parameter": in_words(name),
                "unit": self.study.declared[name].unit,
                "estimate (95 %)": interval_of(entry),
                "identified": entry["identified"],
            }
            for name, entry in self.parameters.items()
        )
        further = (bulk_table(self.uniaxial), imprint_table(self.imprint))
        return [pd.DataFrame(rows), self.errors, *(each for each in further if len(each))]

    def plot(self, ax: Axes | None = None) -> Axes | np.ndarray:
        """Draw recorded and simulated curves.

        Parameters
        ----------
        ax
            Axes on which the curves of all conditions are drawn together. When not given, a figure is made with a
            panel a condition.

        Returns
        -------
        Axes or ndarray of Axes, shape (n,)
            `ax`, or the axes of the figure.
        """
        frame = of_fit(self.curves)
        if ax is not None:
            curves_figure.together(axes_for(ax), frame)
            return ax
        return composed(curves_figure.draw, frame)

    def plot_uniaxial(self) -> np.ndarray:
        """Draw the uniaxial tests with the law's prediction and its band, and return the axes (n,).

        Raises
        ------
        InputError
            When the study has none.
        """
        if not self.uniaxial:
            remedy = "add evidence: [{kind: uniaxial, file: ..}] to the study"
            raise InputError("the study has no uniaxial test", remedy=remedy, place="evidence")
        return composed(uniaxial_curves.draw, uniaxial_curves.curves_of(self.uniaxial))

    def __repr__(self) -> str:
        known = [entry for entry in self.parameters.values() if not entry["held"]]
        fixed = sum(entry["identified"] for entry in known)
        return (
            f"<Calibration of {self.study.name!r}, recordings {self.saved.name!r}: {fixed} of {len(known)} parameters "
            "identified>"
        )
