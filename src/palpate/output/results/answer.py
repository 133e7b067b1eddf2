"""The answer of one set of recordings: what report, MLflow, console and ``report.json`` show first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

from palpate.base.rounding import interval_with_unit, percent, rounded, share_in_words
from palpate.inference.calibration_result import rmse
from palpate.materials import law_of
from palpate.mechanisms import MECHANISMS, quantity_in_words
from palpate.output.results.bulk_errors import bulk_facts, without_curves
from palpate.output.results.calibration import Calibration
from palpate.output.results.diagnosis import SETTLED, Diagnosis, effect_sentence
from palpate.output.results.imprint_errors import imprint_facts
from palpate.output.saved_set import SavedSet
from palpate.output.tip_words import tips_in_words

MOST_FACTS = 2  # that the first screen names
WITHIN = {True: "within the tolerance of", False: "beyond the tolerance of", "undecided": "undecided, the tolerance is"}


@dataclass(frozen=True, eq=False)
class Answer:
    """What is answered on one set of recordings.

    Parameters
    ----------
    saved
        The results of the set.
    """

    saved: SavedSet

    @property
    def calibration(self) -> Calibration:
        """The calibration of the base model on all conditions."""
        return Calibration(self.saved)

    @property
    def diagnosis(self) -> Diagnosis | None:
        """The diagnosis, where the recordings were diagnosed."""
        return Diagnosis(self.saved) if self.saved.diagnosis else None

    @property
    def law(self) -> str:
        """The base model's law in words."""
        return law_of(self.saved.study.model).title

    @property
    def tip(self) -> str:
        """The tips in words."""
        return tips_in_words(self.saved.study)

    @property
    def tests(self) -> dict[str, int]:
        """Number of tests, of conditions of each role, and of the fewest and most replicates of a condition."""
        counts = {name: len(tests) for name, tests in self.saved.tests.items()}
        roles = [condition.role for condition in self.saved.study.conditions]
        return {
            "tests": sum(counts.values()),
            "calibrate": roles.count("calibrate"),
            "validate": roles.count("validate"),
            "fewest": min(counts.values(), default=0),
            "most": max(counts.values(), default=0),
        }

    @property
    def tests_in_words(self) -> str:
        """Tests, conditions and replicates."""
        n = self.tests
        each = f"{n['fewest']}" if n["fewest"] == n["most"] else f"{n['fewest']} to {n['most']}"
        conditions = f"{n['calibrate']} fitted" + (f" and {n['validate']} held-out" if n["validate"] else "")
        total = n["calibrate"] + n["validate"]
        replicates = "no replicates" if each == "1" else f"{each} replicates each"
        tests = f"{n['tests']} test{'' if n['tests'] == 1 else 's'}"
        return f"{tests} under {conditions} condition{'' if total == 1 else 's'}, {replicates}"

    @property
    def verdict(self) -> str | None:
        """The verdict of the diagnosis; None without one."""
        return self.diagnosis.verdict if self.diagnosis else None

    @property
    def headline(self) -> str:
        """The verdict in a few words."""
        return self.diagnosis.headline if self.diagnosis else "Calibrated, not diagnosed"

    @property
    def sentence(self) -> str:
        """The summary of the diagnosis, or how far the base model fits."""
        if self.diagnosis:
            return str(self.diagnosis.content["sentence"])
        return f"{self.calibration.error_sentence()} {self.calibration.misfit_sentence()}"

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Amplitudes of the best accepted explanation, see `palpate.output.results.diagnosis.Diagnosis.effects`."""
        return self.diagnosis.effects if self.diagnosis else []

    @property
    def effect_sentences(self) -> list[str]:
        """Each effect with its interval and probability in words; of several explanations those of the best."""
        best = "best explanation: " if self.verdict == "ambiguous" else ""
        return [best + effect_sentence(effect) for effect in self.effects]

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Free parameters of the accepted model in the law's order.

        Keys are name, unit, estimate, lower, upper, identified, before, the entry of the base model, and over_all_sets,
        the entry whichever effects act; None where that is not known.
        """
        accepted = self.diagnosis.parameters if self.diagnosis else self.calibration.parameters
        whichever = self.diagnosis.over_all_sets if self.diagnosis else {}
        base = self.calibration.parameters
        return [
            {"name": name, "unit": self.saved.quantity(name).unit}
            | {key: entry[key] for key in ("estimate", "lower", "upper", "identified")}
            | {"before": {key: base[name][key] for key in ("estimate", "lower", "upper")}}
            | {"over_all_sets": whichever.get(name)}
            for name, entry in accepted.items()
            if not base[name]["held"]
        ]

    @property
    def constants(self) -> dict[str, float]:
        """Material parameters that were held constant, by name."""
        held = {name: entry["estimate"] for name, entry in self.calibration.parameters.items() if entry["held"]}
        return {**held, **self.saved.study.fixed}

    @property
    def held_out(self) -> dict[str, Any]:
        """Errors [nm] before and after, noise, and the role of the tests that they are of."""
        if self.diagnosis:
            return self.diagnosis.held_out
        content = self.calibration.content
        role = "validate" if rmse(content, "validate") is not None else "calibrate"
        return {"role": role, "before_nm": rmse(content, role), "after_nm": None, "noise_nm": None}

    @property
    def discrepancy(self) -> Mapping[str, Any] | None:
        """The law's discrepancy as a share of the depth, where it is known."""
        return self.diagnosis.discrepancy if self.diagnosis else self.calibration.discrepancy

    @property
    def nothing_further(self) -> Mapping[str, Any] | None:
        """How probable it is that nothing further acts, where it is known."""
        return self.diagnosis.nothing_further if self.diagnosis else None

    @property
    def next_test(self) -> Mapping[str, Any] | None:
        """The test that would settle best what is open."""
        return self.diagnosis.next_test if self.diagnosis else None

    def facts(self) -> list[tuple[str, str]]:
        """Return the rows beside the parameters as pairs of words: errors, discrepancy, what is open.

        A row whose entry the results lack is left out.
        """
        rows = [(f"Error of the {self._tests_of_error}", self._error)]
        if self.diagnosis and (facts := self.diagnosis.model_free):
            rows.append(("Without a model", _without_model(facts)))
        if (found := self.discrepancy) is not None:
            rows.append(("Discrepancy of the law", self._discrepancy(found)))
        if tests := self.calibration.uniaxial:
            rows.append(("Uniaxial tests of the bulk", bulk_facts(tests)))
        if profiles := self.calibration.imprint:
            rows.append(("Imprints", imprint_facts(profiles)))
        if (further := self.nothing_further) is not None:
            rows.append(("Nothing further acts", _further(further)))
        if (test := self.next_test) is not None:
            power = f"expected power {percent(test['expected_power'])}"
            rows.append(("Test that would settle it", f"{test['test']} ({power})"))
        rows.append(("What is open", self._open))
        return rows

    @property
    def _tests_of_error(self) -> str:
        return "held-out tests" if self.held_out["role"] == "validate" else "fitted tests"

    @property
    def _error(self) -> str:
        found = self.held_out
        if found["before_nm"] is None:
            return "not known"
        before = f"{rounded(found['before_nm'], 2)} nm"
        if found["after_nm"] is None:
            return before
        noise = f"noise and scatter {rounded(found['noise_nm'], 2)} nm"
        if not self.saved.accepted:
            return f"{before}; {noise}"
        return f"{before} without the effects, {rounded(found['after_nm'], 2)} nm with them; {noise}"

    def _discrepancy(self, found: Mapping[str, Any]) -> str:
        text = share_in_words(found)
        if (kind := found.get("class")) and kind not in ("none", "undetermined"):
            text += f", of the class {kind}"
        if parts := found.get("parts"):
            worst = max(parts, key=lambda part: part["share"])
            part = "" if worst["part"] == "whole" else f"{worst['part']} "
            text += f", most {part}in the {worst['segment']} of {self.saved.labels[worst['condition']]}"
        if (within := self.diagnosis.law_within_tolerance if self.diagnosis else None) is not None:
            text += f"; {WITHIN[within]} {100.0 * self.saved.study.diagnosis.tolerance:g} %"
        return text

    @property
    def _open(self) -> str:
        """Return what the recordings leave open, in one line."""
        if not self.diagnosis:
            return "whether the law is enough: the recordings were not diagnosed"
        unknown = [quantity_in_words(entry["name"]) for entry in self.parameters if not entry["identified"]]
        open_ = [f"not identified: {', '.join(unknown)}"] if unknown else []
        if self.verdict == "ambiguous":
            open_.append("which of the explanations acts")
        elif self.verdict == "suspected":
            open_.append("whether the effect acts")
        elif self.verdict == "unexplained":
            open_.append("what the model lacks")
        within, further = self.diagnosis.law_within_tolerance, self.nothing_further
        if within is False:
            open_.append("what the law lacks")
        elif within == "undecided":
            open_.append("whether the law is within the tolerance")
        if further and further["probability"] < SETTLED:
            open_.append("whether something further acts")
        return "; ".join(dict.fromkeys(open_)) or "nothing that these recordings could show"

    def lines(self) -> list[str]:
        """Return law, verdict with effects, parameters, and error, a line each, for a terminal."""
        effects = "; ".join(self.effect_sentences)
        values = "; ".join(
            f"{quantity_in_words(entry['name'])} {interval_with_unit(entry)}"
            + ("" if entry["identified"] else " (not identified)")
            for entry in self.parameters
        )
        return [
            f"law         {self.law}, {self.tip}; {self.tests_in_words}",
            f"verdict     {self.headline}" + (f": {effects}" if effects else ""),
            f"parameters  {values}",
            f"error       {self._tests_of_error}: {self._error}",
            *([f"bulk        {bulk_facts(tests)}"] if (tests := self.calibration.uniaxial) else []),
            *([f"imprints    {imprint_facts(profiles)}"] if (profiles := self.calibration.imprint) else []),
        ]

    def to_mapping(self) -> dict[str, Any]:
        """Return the entry of ``report.json``."""
        tests = self.tests
        return {
            "name": self.saved.name,
            "law": self.saved.study.model,
            "tip": self.tip,
            "tests": tests["tests"],
            "replicates": [tests["fewest"], tests["most"]],
            "verdict": self.verdict,
            "mechanisms": self.diagnosis.mechanisms if self.diagnosis else [],
            "effects": self.effects,
            "parameters": self.parameters,
            "held_out": {key: self.held_out[key] for key in ("before_nm", "after_nm", "noise_nm")},
            "discrepancy": self.discrepancy,
            "nothing_further": self.nothing_further,
            "next_test": self.next_test,
            "uniaxial": without_curves(self.calibration.uniaxial),
            "imprint": without_curves(self.calibration.imprint),
            "sentence": self.sentence,
            "lines": self.lines(),
        }


def _without_model(facts: Sequence[Mapping[str, Any]]) -> str:
    """Return the facts that suggest an effect, with the effects; else that none does."""
    telling = [found for found in facts if found["suggests"]]
    texts = (f"{_fact(found)} ({', '.join(MECHANISMS[key].title for key in found['suggests'])})" for found in telling)
    more = f"; {len(telling) - MOST_FACTS} more" if len(telling) > MOST_FACTS else ""
    none = "the one fact suggests no effect" if len(facts) == 1 else f"none of {len(facts)} facts suggests an effect"
    return "; ".join(islice(texts, MOST_FACTS)) + more or none


def _further(found: Mapping[str, Any]) -> str:
    """Return how probable it is that nothing further acts, and what is likeliest to act unseen."""
    hidden = [f"{MECHANISMS[each['mechanism']].title} {percent(each['probability'])}" for each in found["hidden"]]
    return f"with a probability of {percent(found['probability'])}" + (
        f"; may act: {', '.join(hidden)}" if hidden else ""
    )


def _fact(found: Mapping[str, Any]) -> str:
    return f"{found['fact'].replace('_', ' ')} {interval_with_unit(found)}"
