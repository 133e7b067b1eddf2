"""The entries of a study's lists: a condition under which tests are made, and a file of further evidence."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from palpate.configuration.declaration import Number, Pair, Section, key, numbers_within
from palpate.configuration.settings import NOT_ALLOWED

LETTERS = "use letters, digits, dots, hyphens and "
CONDITION = r"^[A-Za-z0-9][A-Za-z0-9.-]*(_[A-Za-z0-9.-]+)*$"
CONDITION_REMEDY = f"{LETTERS}single underscores between them, 80 at most, a letter or digit first"
TIP = "[A-Za-z0-9][A-Za-z0-9_-]{0,39}"
Numbers = Annotated[list[Number], Field(min_length=1)]
Role = Literal["calibrate", "validate"]


def _tip_of_its_own(given: Any) -> Any:
    """Return the tip of a condition: its keys, or its name."""
    name = given.get("name") if isinstance(given, dict) else given
    described = not isinstance(given, dict) or isinstance(given.get("shape"), str)
    if not (isinstance(name, str) and re.fullmatch(TIP, name) and described):
        raise PydanticCustomError(NOT_ALLOWED, "")
    return numbers_within(given)


class ConditionEntry(Section):
    """A test that is simulated."""

    name: Annotated[str, Field(pattern=CONDITION, max_length=80)] = key(
        "recordings of the condition are `NAME_REPLICATE.csv`",
        accepted="up to 80 letters, digits, `.`, `-`, single `_` between them",
        remedy=CONDITION_REMEDY,
    )
    role: Role = key(
        "`calibrate`: is fitted; `validate`: takes no part in calibration and diagnosis, and measures their errors",
        "calibrate",
    )
    held_out: Annotated[list[Pair], Field(min_length=1)] | None = key(
        "parts of the test, see below, that are simulated and compared, and take no part in calibration and diagnosis "
        "[s]",
        None,
        accepted="`[[FROM_S, TO_S], ...]` within the test, which do not overlap; not with `role: validate`",
        remedy="give [[FROM_S, TO_S], ...]",
    )
    indenter: Annotated[Any, BeforeValidator(_tip_of_its_own)] = key(
        "a tip of its own, see below: its keys and a `name`, or the name of a tip that another condition describes; "
        "the study's `indenter` without it",
        None,
        accepted="table with `name` (up to 40 letters, digits, `-`, `_`) and the keys of [`indenter`](#indenter); name",
        remedy="give {name: NAME, shape: SHAPE, ...}, the name of letters, digits, hyphens and underscores, or the "
        "name of a tip that another condition describes",
    )
    drive: Literal["load", "displacement"] = key("what the instrument prescribes", "load")
    max_load: Number | None = key("largest load [mN]", None, gt=0)
    max_displacement: Number | None = key("largest displacement [nm]", None, gt=0)
    spring: Number | None = key("stiffness of the transducer [mN/nm]; rigid without it", None, gt=0)
    loading_time: Number | None = key("[s]", None, gt=0)
    hold_time: Number | None = key("at the largest load [s]; none without it", None, ge=0)
    unloading_time: Number | None = key("[s]", None, gt=0)
    strain_rate: Number | None = key("loading at constant indentation strain rate [1/s]", None, gt=0)
    start_fraction: Number | None = key(
        "share of the largest load at which the constant strain rate begins; 0.01 without it", None, ge=0.0001, le=0.5
    )
    times: Numbers | None = key(
        "points of a piecewise linear history [s]; the one at zero may be left out", None, accepted="increasing"
    )
    loads: Numbers | None = key("loads at these times [mN]", None, accepted="one for each")
    displacements: Numbers | None = key("displacements at these times [nm]", None, accepted="one for each")
    own_loads: bool = key(
        "whether each recording reaches a load, or displacement, of its own, as under depth or strain-rate control: "
        "the largest may differ from that of the condition by a half, the duration by a factor of three, and the "
        "normalised history by a tenth. Each recording is simulated under its own load, and "
        "[corrected](inference.md#what-is-compared) to that of the condition",
        False,
    )
    load_history: str | None = key(
        "a recorded load or displacement: `recorded`, that of the first recording of the condition in a set that no "
        "`laboratory` writes; or a CSV file with the header `time_s,load_mN` or `time_s,displacement_nm`",
        None,
        accepted="`recorded`, path",
    )


class EvidenceEntry(Section):
    """What was measured of the same material besides indentation."""

    kind: Literal["uniaxial", "imprint"] = key(
        "`uniaxial`: tension, compression, creep, relaxation or cycles; `imprint`: the residual profile of a test"
    )
    of: str | None = key(
        "the condition whose test made an imprint; a uniaxial test belongs to none",
        "none",
        accepted="a condition, `none`",
    )
    file: str = key(
        "of a uniaxial test a CSV with the header `time_s,strain,stress_GPa`: logarithmic strain and true stress, "
        "positive in tension. A comment line `# engineering` says that both are nominal, `# compression` that they are "
        "positive in compression. Of an imprint a CSV with the header `radius_nm,height_nm`. Results call it by its "
        "name without ending",
        accepted="path",
    )
    role: Role = key(
        "`calibrate`: is fitted beside the recordings; `validate`: only judges the law that was calibrated, as an "
        "imprint must",
        "calibrate",
    )
    control: Literal["auto", "strain", "stress"] = key(
        "what the machine prescribed in a uniaxial test; the other one is compared. `auto`: the stress where it was "
        "held much longer than the strain, as in creep, else the strain",
        "auto",
    )
