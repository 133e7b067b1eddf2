"""The summary of a diagnosis in one paragraph."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from palpate.base.parameters import Parameter, in_words
from palpate.base.rounding import interval_with_unit, percent, rounded, share_in_words
from palpate.diagnosis.locate import CERTAIN
from palpate.mechanisms import MECHANISMS, Mechanism

RISEN = 1.05  # ratio of errors from which they are reported to rise
LIKELIER = 0.5  # probability from which on something is likelier than not
WORTH_NAMING = 0.05  # inclusion from which on a hidden mechanism is named


def sentence(content: Mapping[str, Any]) -> str:
    """Return the summary of a diagnosis, from the content of `diagnosis.json`."""
    verdict, law = content["verdict"], _law(content)
    if verdict == "adequate":
        claim = "The base model describes the recordings; no effect of the library is needed beside it."
        if effect_is_likelier(content["nothing_further"]):
            claim = "The base model may describe the recordings alone, but an effect beside it is likelier."
        elif content["law_within_tolerance"] is not True:
            claim = "No effect of the library is certain, nor that the base model describes the recordings without one."
        return f"{claim}{law}{_open(content)}{_next_test(content, _hidden(content))}"
    if verdict == "unexplained":
        claim = "No set of known mechanisms that was tried describes the recordings: something else is missing."
        return f"{claim}{law}{_nearest(content)}{_missing(content['missing'])}"
    where = _where(content)
    start = f"The base model misses the recordings{where}." if where else "The base model alone is improbable."
    if verdict == "identified":
        claim = _claim(content["candidates"][0])
        return f"{start} {claim[0].upper()}{claim[1:]}: {_gain(content)}.{_bias(content)}{law}{_open(content)}"
    if verdict == "suspected":
        best = f"The best explanation: {_claim(content['candidates'][0])}"
        uncertain = _may_be_none(content["candidates"][0])
        why = f", because the mean of the {uncertain} may be zero" if uncertain else ""
        best = f"{best}. These recordings do not suffice to identify it{why}; {_gain(content)}."
        return f"{start} {best}{law}{_next_test(content, 'it from the base model')}"
    names = "; ".join(f"{_claim(c)} ({percent(c['probability'])})" for c in content["candidates"])
    names = f"Each of these explains it, and these tests do not distinguish them: {names}"
    return f"{start} {names}.{_in_all(content)}{law}{_next_test(content, 'the first two')}"


def effect_is_likelier(further: Mapping[str, Any]) -> bool:
    """Return whether an effect beside an adequate base model is likelier than none, by ``nothing_further``."""
    return bool(further["probability"] < LIKELIER)


CLASS_IN_WORDS = {
    "scaling": "alike at all loads, as the law of the material is",
    "length": "different at different loads, as what has a length is",
    "clock": "following the clock, as a drift does",
    "reversal": "where the load turns, as what belongs to the controller",
}


def _law(content: Mapping[str, Any]) -> str:
    """Return how far the law is off, and what that resembles."""
    found = content["discrepancy"]
    if found is None:
        return ""
    alike = f", {CLASS_IN_WORDS[found['class']]}" if found["class"] in CLASS_IN_WORDS else ""
    within = {
        True: "",
        False: "; that is more than the tolerance of the study",
        "undecided": "; whether that is within the tolerance of the study is undecided",
    }[content["law_within_tolerance"]]
    return f" What is left departs from the law by {share_in_words(found)}{alike}{within}."


def _open(content: Mapping[str, Any]) -> str:
    """Return how probable it is that nothing further acts, and what may hide."""
    found = content["nothing_further"]
    hidden = [
        f"{MECHANISMS[each['mechanism']].title} ({percent(each['probability'])})"
        for each in found["hidden"][:2]
        if each["probability"] >= WORTH_NAMING
    ]
    may = f"; most likely hidden: {' or '.join(hidden)}" if hidden else ""
    return f" That nothing further of the library acts has a probability of {percent(found['probability'])}{may}."


def _next_test(content: Mapping[str, Any], what: str) -> str:
    """Return the test that would distinguish `what`, with its power; nothing where none was found."""
    if not (test := content["discriminating_test"]):
        return ""
    phrase = f"{test['test'][0].upper()}{test['test'][1:]}"
    return f" {phrase} would distinguish {what} with a probability of {percent(test['expected_power'])}."


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
            named = " of" if title.endswith(name) else f", {name}"
            values.append(f"{named} {interval_with_unit(dict(entry) | {'unit': parameter.unit})}")
        claims.append(title + "".join(values))
    return " with ".join(claims)


def _nearest(content: Mapping[str, Any]) -> str:
    """Return the most likely explanation, where its residual is clearly more than noise."""
    best = content["tried"][0]
    if not best["mechanisms"]:
        return ""
    claims = []
    for key in best["mechanisms"]:
        mechanism = MECHANISMS[key]
        found = ((p, best["parameters"][f"{key}.{p.name}"]) for p in mechanism.parameters)
        values = (f"{p.name.replace('_', ' ')} {_amount(value, p)}" for p, value in found)
        claims.append(f"{mechanism.title} ({', '.join(values)})")
    return f" The closest is {' with '.join(claims)}."


CHANGES = {
    ("loading", True): "make the body softer {part}in loading",
    ("loading", False): "make the body stiffer {part}in loading",
    ("hold", True): "let it creep more {part}in the hold",
    ("hold", False): "let it creep less {part}in the hold",
    ("unloading", True): "let it recover less {part}in unloading",
    ("unloading", False): "let it recover more {part}in unloading",
}


def _missing(content: Mapping[str, Any]) -> str:
    """Return what the missing physics would have to change, most significant first; only significant parts count."""
    changes: dict[str, str] = {}
    for row in content["location"]:
        if row["q_value"] < CERTAIN and row["segment"] not in changes:
            part = "" if row["part"] == "whole" else f"{row['part']} "
            change = CHANGES[row["segment"], row["residual_nm"] > 0.0].format(part=part)
            changes[row["segment"]] = f"{change} of {row['condition']} ({row['residual_nm']:+.2g} nm)"
    if not changes:
        return ""
    *others, last = changes.values()
    text = f" What is missing would have to {', '.join(others)}{' and ' if others else ''}{last}"
    for trend in content["trends"]:
        if trend["p_value"] < CERTAIN:
            ends = f"{trend['from']:.3g} to {trend['to']:.3g} {trend['unit']}"
            change = f"{trend['residual_from']:+.1%} to {trend['residual_to']:+.1%} of the depth"
            text += f"; from a {trend['by']} of {ends} the difference goes from {change}"
    return f"{text}."


def _in_all(content: Mapping[str, Any]) -> str:
    """Return the effects that all accepted explanations have in common."""
    shared = set.intersection(*(set(candidate["mechanisms"]) for candidate in content["candidates"]))
    titles = " and ".join(MECHANISMS[key].title for key in sorted(shared))
    return f" All of them need {titles}." if shared else ""


def _where(content: Mapping[str, Any]) -> str:
    """Return where the misfit is most significant."""
    found = [row for row in content["location"] if row["q_value"] < CERTAIN]
    if not found:
        return (
            f" in no single part significantly, but in all together, as {content['pattern']} does"
            if content["pattern"]
            else ""
        )
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
    elif risen := fit[role]["risen_nm"]:
        under = [f"{error:.1f} nm under {name}" for name, error in risen.items()]
        change += f", though it rises to {' and '.join(under)}"
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
    return f" Without it, the estimated {in_words(name)} is {abs(100 * was / is_now - 100):.0f} % too {direction}."
