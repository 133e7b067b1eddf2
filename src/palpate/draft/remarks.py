"""What a draft asks its user to look at, a line each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from indentation_files.readers.zero import begins_off_contact
from indentation_files.recording import Recording
from indentation_files.sentences import and_more
from palpate.classical.joslin_oliver import UNLIKE, different_materials, load_over_stiffness_squared
from palpate.draft.drafted import Drafted
from palpate.draft.grouping import Group
from palpate.draft.known_tip import KnownTip, unusable
from palpate.draft.law_choice import POLYMER
from palpate.draft.solid import Solid, secant_modulus
from palpate.draft.stated import Stated, area_share, coefficients, of_instrument, poisson_ratio, radius_entry
from palpate.study.area_function import BERKOVICH

NEAR = 0.05  # relative difference from the ideal tip's coefficient, within which a stated one is that
NEAR_AREA = 1.25  # chosen: ratio to the ideal tip's area that a real Berkovich tip has at some depth
SOFTEST_PLASTIC = 0.01  # GPa, chosen: below it a remark asks, and nothing is refused
NamedMetadata = Sequence[tuple[str, Mapping[str, Any]]]


def remarks_on(tests: Sequence[Drafted], stated: Stated, tip: KnownTip, ratio: float) -> list[str]:
    """Return the remarks on tests of which a draft takes what is `stated`, a tip and a Poisson's ratio."""
    recordings, named = [test.recording for test in tests], [(test.recording.name, test.facts) for test in tests]
    deepest = float(np.median([recording.depth.max() for recording in recordings]))
    return [
        *not_taken(named, stated, tip, deepest, ratio),
        *_on_instrument(named),
        *_on_materials(recordings, tip),
        *_on_assumed_loading(tests),
        *_on_pull_off(tests),
    ]


def not_taken(tests: NamedMetadata, stated: Stated, tip: KnownTip, deepest: float, ratio: float) -> list[str]:
    """Return one remark for each of tip and Poisson's ratio that files state and a draft does not take.

    Parameters
    ----------
    tests
        Name and metadata of each.
    stated
        What was taken.
    tip
        That is used; no message is given on the files' tips where one was given.
    deepest
        Largest depth of the tests [nm].
    ratio
        Poisson's, that is guessed where none is taken.
    """
    remarks = []
    if stated.poisson_ratio is None:
        ratios = {name: poisson_ratio(each) for name, each in tests}
        stated_ratios = {name: "" if ratio is None else f"{ratio:g}" for name, ratio in ratios.items()}
        remarks += _remark("Poisson's ratio", stated_ratios, "it is not above 0 and below 0.5", f"{ratio:g} is guessed")
    if tip.why.startswith("guess"):
        instead = "a Berkovich tip is guessed"
        tips = {name: coefficients(each) for name, each in tests}
        if not all(_ideal(area) for area in tips.values()):
            shown = {name: ", ".join(f"{value:g}" for value in area) for name, area in tips.items()}
            reason = _no_tip(next(iter(tips.values())), deepest)
            remarks += _remark("the tip's area function", shown, reason, instead)
        radii = {name: radius_entry(each) for name, each in tests}
        remarks += _remark("the tip's radius", radii, "it is no length above zero", instead)
        shares = {name: area_share(each) for name, each in tests}
        if any(share and not 1.0 / NEAR_AREA < share / BERKOVICH < NEAR_AREA for share in shares.values()):
            times = "times the square of its depth"
            shown = {name: f"{share:.3g} {times}" if share else "" for name, share in shares.items()}
            remarks += _remark("the contact area", shown, f"it is {BERKOVICH} times for a Berkovich tip", instead)
        if stated.shape and stated.shape not in ("berkovich", "vickers"):
            remarks.append(
                f"the files state a tip of the shape {stated.shape}, without what it takes to simulate it; {instead} "
                "(give --sphere, or correct the indenter in the study)"
            )
    return remarks


def _on_instrument(tests: NamedMetadata) -> list[str]:
    """Return one remark with what files state of frame, drift and temperature."""
    entries = of_instrument(tests[0][1])
    if not entries:
        return []
    differ = any(of_instrument(each) != entries for _, each in tests)
    which = f"{tests[0][0]} states" if differ and len(tests) > 1 else "the files state"
    return [f"{which}: {', '.join(entries)}; each recording states which corrections its depth contains"]


def _on_materials(recordings: Sequence[Recording], tip: KnownTip) -> list[str]:
    """Return a remark when tests of one draft seem to be of different materials, else none.

    Unloadings decide. Without them the depths do, unless one begins off contact, where its depth is not the body's.
    """
    unloaded = [test for test in recordings if not math.isnan(load_over_stiffness_squared(test))]
    if len(unloaded) == len(recordings):
        found = different_materials(recordings)
        return [f"{found}; draft a study of each"] if found else []
    if any(map(begins_off_contact, recordings)):
        return []
    moduli = [secant_modulus(recording, tip) for recording in recordings]
    soft, stiff = (moduli.index(end(moduli)) for end in (min, max))
    if moduli[stiff] <= UNLIKE * moduli[soft]:
        return []
    return [
        f"the tests look like different materials: elastic bodies as deep have moduli from {moduli[soft]:.3g} GPa "
        f"({recordings[soft].name}) to {moduli[stiff]:.3g} GPa ({recordings[stiff].name}); draft a study of each"
    ]


def on_stiffness(law: str, solid: Solid) -> list[str]:
    """Return a remark on a solid that is as stiff as no polymer is, or as soft as no plastic."""
    remark = f"an elastic body as deep has a modulus of {solid.secant:.3g} GPa, which is"
    if law == POLYMER and solid.stiff:
        return [f"{remark} no polymer's; --law bilinear_plasticity is for metals and ceramics; or are loads in uN?"]
    if solid.secant < SOFTEST_PLASTIC:
        return [f"{remark} a gel's or a rubber's; if the sample is neither: are depths in pm, or loads in N?"]
    return []


def on_held_out(groups: Sequence[Group]) -> list[str]:
    """Return a remark for each group of which cycles are held out."""
    return [
        f"too few kinds of tests to hold one out; held out to measure the errors (held_out): {group.held_out} of "
        f"{group.name}"
        for group in groups
        if group.held_out
    ]


def _on_assumed_loading(tests: Sequence[Drafted]) -> list[str]:
    """Return a remark on tests that begin under load, none where there is no such test."""
    found = [test for test in tests if test.assumed]
    if not found:
        return []
    first, others = found[0], and_more(found)
    longest = max(test.assumed for test in found)
    return [
        f"{first.recording.name}{others} begin{'' if others else 's'} under load ({first.preload:.3g} mN): the loading "
        f"up to there{', up to' if others else ','} {longest:.3g} s, was not recorded and is assumed to be as fast as "
        "what follows; export from contact on if you can"
    ]


def _on_pull_off(tests: Sequence[Drafted]) -> list[str]:
    """Return a remark on pulls that were cut off, none where there is none."""
    found = [test for test in tests if test.pull]
    if not found:
        return []
    most = max(test.pull for test in found)
    return [
        f"{found[0].recording.name}{and_more(found)}: the surface pulls on the tip by up to {most:.3g} mN while it "
        "leaves; that part is cut off, as a test ends where its load is zero"
    ]


def _remark(what: str, entries: Mapping[str, str], reason: str, instead: str) -> list[str]:
    """Return what tests state, each value with the first test that states it; nothing where none states anything."""
    tests_of: dict[str, list[str]] = {}
    for name, value in entries.items():
        tests_of.setdefault(value, []).append(name)
    if not any(tests_of):
        return []
    if len(tests_of) == 1:
        return [f"{what} is stated as {next(iter(tests_of))} and not taken, as {reason}; {instead}"]
    shown = [f"{value or 'nothing'} by {names[0]}{and_more(names)}" for value, names in tests_of.items()]
    return [f"{what} differs between the files and is not taken: {'; '.join(shown)}; {instead}"]


def _ideal(area: tuple[float, ...]) -> bool:
    """Return whether no tip is stated, or the ideal Berkovich tip that is taken anyway."""
    return not area or (len(area) == 1 and math.isclose(area[0], BERKOVICH, rel_tol=NEAR))


def _no_tip(area: tuple[float, ...], deepest: float) -> str:
    """Return why an area function cannot be taken."""
    ideal = f"a single coefficient other than {BERKOVICH} is an ideal tip that is no Berkovich's"
    return ideal if len(area) == 1 else unusable(area, deepest)
