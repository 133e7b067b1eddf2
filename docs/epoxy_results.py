"""What the pages say of the epoxy study, from the results that `refresh.py` left in ``docs/data``."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from markdown_pieces import number, table, unit

PAGE = 100  # letters of a line of output
HERE = Path(__file__).parent
DRIFT = "thermal_drift.rate"  # what is concealed
NOTEBOOK = HERE / "data/notebook.json"
ANSWER, FIGURES = HERE / "data/epon862.json", HERE / "data/epon862_figures.json"


def answer() -> dict[str, Any]:
    """Return the answer of the study, as its report gives it."""
    return json.loads(ANSWER.read_text(encoding="utf-8"))["sets"][0]


def figures() -> dict[str, Any]:
    """Return caption, description and checksum of each figure, by name."""
    return json.loads(FIGURES.read_text(encoding="utf-8"))["figures"]


def truth() -> dict[str, float]:
    """Return parameters and concealed effects of the study's virtual laboratory, by name."""
    from palpate.base.yaml_file import read_yaml

    laboratory = read_yaml(HERE.parent / "config/config.yaml")["laboratory"]["virtual"]
    return laboratory["parameters"] | {
        f"{key}.{name}": value for key, values in laboratory["mechanisms"].items() for name, value in values.items()
    }


def result_sentence() -> str:
    """Return what the study found beside its truth, in a sentence."""
    from palpate.base.rounding import interval_of, rounded

    found, true = answer(), truth()
    tests = f"In {found['tests']} synthetic tests of an epoxy with a concealed thermal drift of {true[DRIFT]:g} nm/s"
    drift = next((each for each in found["effects"] if each["name"] == DRIFT), None)
    if found["verdict"] != "identified" or drift is None:
        return f"{tests} the verdict is `{found['verdict']}`."
    modulus = found["parameters"][0]
    return (
        f"{tests}, palpate identifies the drift as {interval_of(drift)} nm/s and finds a Young's modulus of "
        f"{interval_of(modulus)} GPa. The true modulus is {true['youngs_modulus']:g} GPa; a fit without the drift "
        f"gives {rounded(modulus['before']['estimate'])} GPa."
    )


def verdict_sentence() -> str:
    """Return verdict, effects and errors of the held-out tests, in sentences."""
    from palpate.output.results.diagnosis import effect_sentence

    found = answer()
    effects = "; ".join(map(effect_sentence, found["effects"]))
    before, after, noise = (f"{found['held_out'][key]:.1f} nm" for key in ("before_nm", "after_nm", "noise_nm"))
    return (
        f"The verdict is `{found['verdict']}`{': ' if effects else ''}{effects}. The error of the held-out tests is "
        f"{before} with the base model and {after} with the accepted one; noise and scatter alone would leave {noise}."
    )


def coverage() -> str:
    """Return which intervals of the accepted model contain the truth, and which quantities are not identified."""
    from palpate.base.parameters import in_words
    from palpate.output.results.diagnosis import quantity_in_words

    found, true = answer(), truth()
    modulus = found["parameters"][0]["before"]["estimate"] / true["youngs_modulus"] - 1.0
    sentences = [
        f"Young's modulus of the base model is {abs(modulus):.0%} too {'high' if modulus > 0 else 'low'}, because its "
        "parameters compensate for the drift."
    ]
    missed = [
        quantity_in_words(each["name"])
        for each in quantities(found)
        if not each["lower"] <= true.get(each["name"], 0.0) <= each["upper"]
    ]
    but = f" except that of the {joined(missed)}" if missed else ""
    sentences.append(f"All intervals of the accepted model contain the truth{but}.")
    if unknown := [in_words(each["name"]) for each in found["parameters"] if not each["identified"]]:
        verb = "is" if len(unknown) == 1 else "are"
        sentences.append(
            f"The {joined(unknown)} {verb} not identified: these tests hardly depend on "
            f"{'it' if len(unknown) == 1 else 'them'} ([why](identifiability.md#parameters-of-the-law))."
        )
    return " ".join(sentences).replace("% too", " % too")


def quantities(found: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return effects and parameters of an answer, the effects first."""
    return [*found["effects"], *found["parameters"]]


def joined(words: Sequence[str]) -> str:
    """Return words as an enumeration."""
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def values() -> str:
    """Return effects and parameters beside the truth, as a table."""
    from palpate.base.rounding import interval_of

    found, true = answer(), truth()
    named = found["verdict"] == "identified"
    rows = (
        (f"`{each['name']}`", unit(each["unit"]), number(true.get(each["name"], 0.0)), interval_of(each),
         interval_of(each["before"]) if "before" in each else "", "yes" if each.get("identified", named) else "no")
        for each in quantities(found)
    )  # fmt: skip
    return table(("quantity", "unit", "truth", "accepted model (95 %)", "base model (95 %)", "identified"), rows)


def lines() -> str:
    """Return the lines with which a run of the study ends."""
    return "\n".join(["```text", *(wrapped(line, " " * 12) for line in answer()["lines"]), "```"])


def wrapped(line: str, indent: str = "") -> str:
    """Return a line of output in lines that the page holds; those of tables are short."""
    return textwrap.fill(line, PAGE, subsequent_indent=indent) if len(line) > PAGE else line


def figure(name: str) -> str:
    """Return a figure with the caption that was written beside it."""
    found = figures()[name]
    return f"![{found['seen']}](images/epoxy_{name}.svg)\n\n*{found['caption']}*"


def shown(name: str) -> str:
    """Return what an object of the notebook's page prints."""
    texts = json.loads(FIGURES.read_text(encoding="utf-8"))["summaries"]
    texts |= json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    return "\n".join(["```text", *map(wrapped, texts[name].split("\n")), "```"])


GENERATED: dict[str, Callable[..., str]] = {
    "epoxy_result": result_sentence,
    "epoxy_answer": verdict_sentence,
    "epoxy_coverage": coverage,
    "epoxy_table": values,
    "epoxy_lines": lines,
    "epoxy_figure": figure,
    "shown": shown,
}
