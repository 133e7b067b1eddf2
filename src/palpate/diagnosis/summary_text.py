"""The summary of a diagnosis in one paragraph."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scipy.stats import norm

from palpate.base.parameters import Parameter, in_words
from palpate.diagnosis import missing_physics
from palpate.diagnosis.locate import CERTAIN
from palpate.mechanisms import MECHANISMS, Mechanism

RISEN = 1.05  # ratio of errors from which they are reported to rise
CLEARLY = 0.01  # p-value below which a residual is called more than noise


def sentence(content: Mapping[str, Any]) -> str:
    """Return the summary of a diagnosis, from the content of `diagnosis.json`."""
    verdict, p = content["verdict"], content["p_value"]
    probability = _probability(p)
    if verdict == "adequate":
        claim = f"The base model explains the recordings to their noise ({probability}); no further effect is claimed."
        return f"{claim}{_next_test(content, _hidden(content))}"
    start = f"The base model does not explain the recordings ({probability}){_where(content)}."
    if verdict == "unexplained":
        none = "No set of known mechanisms that was tried explains it: something else is missing."
        return f"{start} {none}{_nearest(content)}{missing_physics.in_words(content['missing'])}"
    if verdict == "identified":
        claim = _claim(content["candidates"][0])
        return f"{start} {claim[0].upper()}{claim[1:]}: {_gain(content)}.{_bias(content)}{_suspected(content)}"
    if verdict == "suspected":
        best = f"The best explanation: {_claim(content['candidates'][0])}"
        uncertain = _may_be_none(content["candidates"][0])
        why = f", because the mean of the {uncertain} may be zero" if uncertain else ""
        best = f"{best}. These recordings do not suffice to identify it{why}; {_gain(content)}."
        return f"{start} {best}{_next_test(content, 'it from the base model')}"
    names = "; ".join(f"{_claim(c)} ({_percent(c['probability'])})" for c in content["candidates"])
    names = f"Each of these explains it, and these tests do not distinguish them: {names}"
    return f"{start} {names}.{_in_all(content)}{_next_test(content, 'the first two')}"


def _next_test(content: Mapping[str, Any], what: str) -> str:
    """Return the test that would distinguish `what`, with its power; nothing where none was found."""
    if not (test := content["discriminating_test"]):
        return ""
    phrase = f"{test['test'][0].upper()}{test['test'][1:]}"
    return f" {phrase} would distinguish {what} with a probability of {test['expected_power']:.0%}."


def _hidden(content: Mapping[str, Any]) -> str:
    """Return the effect that could hide beside an adequate model; nothing where there is none."""
    test = content["discriminating_test"]
    if not test:
        return ""
    ((name, value),) = test["hidden_effect"].items()
    mechanism, parameter = _amplitude(name)
    return f"a {mechanism.title} of {_amount(value, parameter, 2)}, which these do not exclude, from none"


def _amplitude(name: str) -> tuple[Mechanism, Parameter]:
    """Return the mechanism and the parameter behind ``key.name``."""
    key, own = name.split(".")
    (parameter,) = (p for p in MECHANISMS[key].parameters if p.name == own)
    return MECHANISMS[key], parameter


def _may_be_none(candidate: Mapping[str, Any]) -> str:
    """Return the titles of the effects of the instrument whose intervals contain zero."""
    found = []
    for key in candidate["mechanisms"]:
        mechanism = MECHANISMS[key]
        spans = [candidate["parameters"][f"{key}.{name}"] for name in mechanism.amplitudes]
        if not mechanism.acts_on_body and all(entry["lower"] <= 0.0 <= entry["upper"] for entry in spans):
            found.append(mechanism.title)
    return " and the ".join(found)


def _percent(probability: float) -> str:
    if 0.0 < probability < 0.005 or 0.995 < probability < 1.0:
        return "< 1%" if probability < 0.5 else "> 99%"
    return f"{probability:.0%}"


def rounded(value: float, digits: int = 3) -> str:
    """Return a number to some digits, without an exponent where it has up to six."""
    return f"{float(f'{value:.{digits}g}'):g}"


def _amount(value: float, parameter: Parameter, digits: int = 3) -> str:
    unit = "" if parameter.unit == "-" else f" {parameter.unit}"
    return f"{rounded(value, digits)}{unit}"


def _claim(candidate: Mapping[str, Any]) -> str:
    """Return the title of an explanation with its amplitudes."""
    claims = []
    for key in candidate["mechanisms"]:
        title, values = MECHANISMS[key].title, []
        for parameter in MECHANISMS[key].parameters:
            name, entry = parameter.name.replace("_", " "), candidate["parameters"][f"{key}.{parameter.name}"]
            interval = f"({rounded(entry['lower'])} to {rounded(entry['upper'])})"
            named = " of" if title.endswith(name) else f", {name}"
            values.append(f"{named} {_amount(entry['estimate'], parameter)} {interval}")
        claims.append(title + "".join(values))
    return " with ".join(claims)


def _nearest(content: Mapping[str, Any]) -> str:
    """Return the most likely explanation, where its residual is clearly more than noise."""
    best = content["tried"][0]
    if not best["mechanisms"] or best["p_value"] >= CLEARLY:
        return ""
    claims = []
    for key in best["mechanisms"]:
        mechanism = MECHANISMS[key]
        found = ((p, best["parameters"][f"{key}.{p.name}"]) for p in mechanism.parameters)
        values = (f"{p.name.replace('_', ' ')} {_amount(value, p)}" for p, value in found)
        claims.append(f"{mechanism.title} ({', '.join(values)})")
    residual = f"its residual is more than noise ({_probability(best['p_value'])})"
    return f" The closest is {' with '.join(claims)}, but {residual}."


def _probability(p: float) -> str:
    return "p < 0.002" if p < 0.0021 else f"p = {p:.2g}"


def _in_all(content: Mapping[str, Any]) -> str:
    """Return the effects that all accepted explanations have in common."""
    shared = set.intersection(*(set(candidate["mechanisms"]) for candidate in content["candidates"]))
    titles = " and ".join(MECHANISMS[key].title for key in sorted(shared))
    return f" All of them need {titles}." if shared else ""


def _suspected(content: Mapping[str, Any]) -> str:
    """Return effects that are not needed, but would differ from zero if they were added, at a family-wise 1 %.

    The intervals are wider where few replicates determine the noise; at 1 % the same factor is assumed.
    """
    suspected = []
    least = norm.isf(0.005 / max(len(content["undetected_effects"]), 1)) / norm.isf(0.025)
    for name, entry in content["undetected_effects"].items():
        mechanism, parameter = _amplitude(name)
        if abs(entry["estimate"]) > least * 0.5 * (entry["upper"] - entry["lower"]):
            interval = f"({rounded(entry['lower'], 2)} to {rounded(entry['upper'], 2)})"
            suspected.append(f"{mechanism.title}, {_amount(entry['estimate'], parameter, 2)} {interval}")
    return f" Suspected, but not needed to explain the recordings: {'; '.join(suspected)}." if suspected else ""


def _where(content: Mapping[str, Any]) -> str:
    """Return where the misfit is most significant."""
    found = [row for row in content["location"] if row["q_value"] < CERTAIN]
    if not found:
        return ""
    row = found[0]
    part = "" if row["part"] == "whole" else f"{row['part']} "
    segment = "the hold" if row["segment"] == "hold" else row["segment"]
    sign = "+" if row["residual_nm"] > 0.0 else ""
    residual = f"recorded less simulated depth {sign}{rounded(row['residual_nm'], 2)} nm"
    return f", most clearly {part}in {segment} of {row['condition']} ({residual})"


def _gain(content: Mapping[str, Any]) -> str:
    """Return how the errors change."""
    fit = content["fit"]
    role, tests = ("validate", "held-out") if fit["validate"]["before_rmse_nm"] is not None else ("calibrate", "fitted")
    before, after = fit[role]["before_rmse_nm"], fit[role]["after_rmse_nm"]
    change = f"falls from {before:.1f} to {after:.1f} nm" if after < before else f"stays near {after:.1f} nm"
    if after > RISEN * before:
        change = f"rises from {before:.1f} to {after:.1f} nm"
    return f"the {tests} error {change}; noise and scatter alone would leave {fit['noise_nm']:.1f} nm"


def _bias(content: Mapping[str, Any]) -> str:
    """Return which material parameter was biased most without the effect, in half-widths of its interval."""
    before, after = content["parameters"]["before"], content["parameters"]["after"]

    def moved(name: str) -> float:
        width = 0.5 * (after[name]["upper"] - after[name]["lower"])
        return abs(before[name]["estimate"] - after[name]["estimate"]) / max(width, 1e-12)

    name = max(after, key=moved)
    if moved(name) < 1.0:
        return ""
    was, is_now = before[name]["estimate"], after[name]["estimate"]
    if abs(was - is_now) > abs(is_now):
        return f" Without it, the estimated {in_words(name)} is {rounded(was, 2)} in place of {rounded(is_now, 2)}."
    direction = "high" if was > is_now else "low"
    return f" Without it, the estimated {in_words(name)} is {abs(was / is_now - 1.0):.0%} too {direction}."
