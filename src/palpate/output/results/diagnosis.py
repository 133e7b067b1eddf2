"""The diagnosis of one set of recordings: which effects the base model lacks, as ``diagnosis.json`` holds it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from palpate.base.rounding import interval_of, interval_with_unit, percent
from palpate.configuration.study_file import Study
from palpate.diagnosis.summary_text import effect_is_likelier
from palpate.mechanisms import MECHANISMS, quantity_in_words
from palpate.output.figures import evidence, residuals
from palpate.output.results.calibration import Calibration
from palpate.output.saved_set import SavedSet
from palpate.output.shown import Shown, axes_for, composed

SETTLED = 0.95  # probability from which nothing further is open


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Shown):
    """What a diagnosis found.

    Entries that a later version of ``diagnosis.json`` adds are None where the file lacks them.

    Parameters
    ----------
    saved
        The results of the set of recordings.
    """

    saved: SavedSet

    @property
    def study(self) -> Study:
        """The study."""
        return self.saved.study

    @property
    def content(self) -> Mapping[str, Any]:
        """What ``diagnosis.json`` holds."""
        assert self.saved.diagnosis is not None, "the recordings were not diagnosed"
        return self.saved.diagnosis

    @property
    def curves(self) -> pd.DataFrame:
        """Recorded curves beside those of the base model (before) and of the best explanation (after)."""
        assert self.saved.explained is not None
        return self.saved.explained

    @property
    def calibration(self) -> Calibration:
        """The calibration of the base model from which the diagnosis began."""
        return Calibration(self.saved)

    @property
    def verdict(self) -> str:
        """``adequate``, ``identified``, ``suspected``, ``ambiguous`` or ``unexplained``."""
        return str(self.content["verdict"])

    @property
    def mechanisms(self) -> list[str]:
        """Keys of the identified effects; empty unless the verdict is ``identified``."""
        return list(self.content["mechanisms"])

    @property
    def explained(self) -> bool:
        """Whether a model was accepted: the base model, or one with effects."""
        return self.verdict == "adequate" or bool(self.content["candidates"])

    @property
    def parameters(self) -> dict[str, Mapping[str, Any]]:
        """For each material parameter of the accepted model its entry, in the law's order; else of the base model.

        An entry holds estimate, lower and upper (95 % interval), identified and held.
        """
        base, found = self.calibration.parameters, self.content["parameters"]["after"]
        free = {name: dict(entry) | {"held": False} for name, entry in found.items()}
        if not self.content["candidates"]:
            known = {
                name: {**entry, "identified": found[name]["identified"]}
                for name, entry in base.items()
                if name in found
            }
            return base | known
        return {name: free.get(name, entry) for name, entry in base.items()}

    @property
    def over_all_sets(self) -> Mapping[str, Mapping[str, float]]:
        """Estimate, lower and upper (95 % interval) of each free material parameter, whichever effects act."""
        found: Mapping[str, Mapping[str, float]] = self.content["parameters"].get("over_all_sets", {})
        return found

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Amplitudes of the best explanation: name (``key.parameter``), estimate, lower, upper, unit, probability.

        The probability is that the mechanism acts, over all accepted explanations.
        """
        inclusion = self.inclusion or {}
        return [
            {"name": name, **{key: entry[key] for key in ("estimate", "lower", "upper")}}
            | {"unit": self.saved.quantity(name).unit}
            | {"probability": inclusion.get(name.split(".")[0], self._probability(name.split(".")[0]))}
            for candidate in self.content["candidates"][:1]
            for name, entry in candidate["parameters"].items()
        ]

    def _probability(self, key: str) -> float:
        """Return the summed probability of the accepted explanations that hold a mechanism."""
        found = sum(c["probability"] for c in self.content["candidates"] if key in c["mechanisms"])
        return float(min(found, 1.0))

    @property
    def inclusion(self) -> Mapping[str, float] | None:
        """The probability that each mechanism acts by more than the smallest effect, over all sets."""
        return self.content.get("inclusion")

    @property
    def nothing_further(self) -> Mapping[str, Any] | None:
        """How probable it is that nothing further acts, and what may be hidden."""
        return self.content.get("nothing_further")

    @property
    def discrepancy(self) -> Mapping[str, Any] | None:
        """The law's discrepancy as a share of the depth: estimate with interval, its class and place."""
        return self.content.get("discrepancy") or self.calibration.discrepancy

    @property
    def law_within_tolerance(self) -> bool | str | None:
        """Whether the discrepancy lies within the study's tolerance: true, false or ``undecided``."""
        return self.content.get("law_within_tolerance")

    @property
    def model_free(self) -> Sequence[Mapping[str, Any]] | None:
        """What the recordings show without a model: fact, estimate, lower, upper, unit, suggests."""
        return self.content.get("model_free")

    @property
    def next_test(self) -> Mapping[str, Any] | None:
        """The feasible test that would settle best what is open."""
        return self.content["discriminating_test"]

    @property
    def held_out(self) -> dict[str, Any]:
        """Root mean square errors [nm] before and after, and noise; ``role`` names the tests that they are of."""
        fit = self.content["fit"]
        role = "validate" if fit["validate"]["before_rmse_nm"] is not None else "calibrate"
        errors = {f"{when}_nm": fit[role][f"{when}_rmse_nm"] for when in ("before", "after")}
        return {"role": role, **errors, "noise_nm": fit["noise_nm"]}

    @property
    def tried(self) -> pd.DataFrame:
        """Every explanation that was fitted, best first: mechanisms, probability, log_evidence, rmse_nm, accepted."""
        base: list[list[str]] = [[]] if self.verdict == "adequate" else []
        accepted = base + [candidate["mechanisms"] for candidate in self.content["candidates"]]
        return pd.DataFrame(
            {
                "mechanisms": " + ".join(entry["mechanisms"]) or "base model",
                **{key: entry[key] for key in ("probability", "log_evidence", "rmse_nm")},
                "accepted": entry["mechanisms"] in accepted,
            }
            for entry in self.content["tried"]
        )

    @property
    def headline(self) -> str:
        """The verdict in a few words."""
        if self.verdict in ("identified", "suspected"):
            titles = [MECHANISMS[key].title for key in self.content["candidates"][0]["mechanisms"]]
            text = f"{' and '.join(titles)} {self.verdict}"
        elif self.verdict == "ambiguous":
            text = f"ambiguous: {len(self.content['candidates'])} explanations"
        elif self.verdict == "adequate":
            text = _of_adequate(self.nothing_further)
        else:
            text = "unexplained: something else is missing"
        return text[0].upper() + text[1:]

    def to_frame(self) -> pd.DataFrame:
        """Return the accepted model, one row a quantity: its effects, then the material's parameters.

        Returns
        -------
        DataFrame
            parameter, unit, estimate, lower and upper (95 % interval), identified, and before, the estimate of the base
            model.
        """
        base = self.calibration.values
        named = self.verdict == "identified"
        rows = [{**entry, "parameter": entry["name"], "identified": named, "before": np.nan} for entry in self.effects]
        rows += [
            {"parameter": name, "unit": self.saved.quantity(name).unit, **entry, "before": base[name]}
            for name, entry in self.parameters.items()
            if not entry["held"]
        ]
        columns = ["parameter", "unit", "estimate", "lower", "upper", "identified", "before"]
        return pd.DataFrame(rows, columns=columns)

    @property
    def candidates(self) -> pd.DataFrame:
        """The accepted explanations, one row a parameter of their mechanisms, best first; empty where there is none."""
        rows = [
            {"explanation": titles_of(candidate["mechanisms"]), "probability": candidate["probability"]}
            | {"parameter": name, "unit": self.saved.quantity(name).unit, **entry}
            for candidate in self.content["candidates"]
            for name, entry in candidate["parameters"].items()
        ]
        columns = ["explanation", "probability", "parameter", "unit", "estimate", "lower", "upper"]
        return pd.DataFrame(rows, columns=columns)

    def to_json(self) -> str:
        """Return the content of ``diagnosis.json``."""
        return json.dumps(self.content, indent=2) + "\n"

    def sentences(self) -> list[str]:
        """Return the summary of the diagnosis, and what limits it."""
        return [self.content["sentence"], *self.content["limits"]]

    def tables(self) -> list[pd.DataFrame]:
        """Return the accepted model, rounded by its intervals, and every explanation that was tried."""
        rows = (
            {"quantity": quantity_in_words(row["parameter"]), "unit": row["unit"], "estimate (95 %)": interval_of(row)}
            | {"identified": row["identified"], "base model": row["before"]}
            for row in self.to_frame().to_dict("records")
        )
        return [pd.DataFrame(rows), self.tried]

    def plot(self, ax: Axes | None = None) -> Axes | np.ndarray:
        """Draw what was found.

        Parameters
        ----------
        ax
            Axes on which the evidence of each explanation is drawn. When not given, a figure is made of the residuals
            in time, before and after.

        Returns
        -------
        Axes or ndarray of Axes, shape (n,)
            `ax`, or the axes of the figure.
        """
        if ax is not None:
            evidence.bars(axes_for(ax), evidence.of_tried(self.saved))
            return ax
        return composed(residuals.draw, residuals.table(self.saved))

    def __repr__(self) -> str:
        named = f", {' + '.join(self.mechanisms)}" if self.mechanisms else ""
        return f"<Diagnosis of {self.study.name!r}, recordings {self.saved.name!r}: {self.verdict}{named}>"


def _of_adequate(further: Mapping[str, Any] | None) -> str:
    """Return an adequate verdict in a few words, with the likeliest effect where one is likelier than none."""
    if further is None or further["probability"] >= SETTLED:
        return "no effect is missing"
    if not effect_is_likelier(further):
        return "no effect is needed"
    likeliest = max(further["hidden"], key=lambda each: each["probability"])
    title, probability = MECHANISMS[likeliest["mechanism"]].title, percent(likeliest["probability"])
    return f"an effect is likelier than none, most likely {title} ({probability})"


def titles_of(mechanisms: Sequence[str]) -> str:
    """Return a set of mechanisms in words."""
    return " and ".join(MECHANISMS[key].title for key in mechanisms) or "base model"


def effect_sentence(effect: Mapping[str, Any]) -> str:
    """Return an effect with its interval and probability in words."""
    amount = interval_with_unit(effect)
    return f"{quantity_in_words(effect['name'])} {amount}, probability {percent(effect['probability'])}"
