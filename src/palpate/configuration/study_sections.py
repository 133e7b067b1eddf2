"""The file of a study: its keys at the top, and the tables of its law, tip, conditions, evidence and source."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from palpate.configuration.declaration import Section, Whole, key, numbers_within, refused
from palpate.configuration.entries import LETTERS, ConditionEntry, EvidenceEntry, Numbers
from palpate.configuration.settings import (
    NOT_ALLOWED,
    Accuracy,
    CalibrationSettings,
    Challenge,
    Design,
    DiagnosisSettings,
    LaboratorySettings,
    SurrogateSettings,
)

NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$"
NAME_REMEDY = f"{LETTERS}underscores, 80 at most, a letter or digit first"
Name = Annotated[str, Field(pattern=NAME)]


def _unique(given: Any) -> Any:
    """Refuse a list that names something twice."""
    if isinstance(given, list | tuple) and len(set(map(repr, given))) < len(given):
        raise PydanticCustomError("not_unique", "")
    return given


Names = Annotated[list[str], Field(min_length=1), BeforeValidator(_unique)]
Tests = Annotated[list[str | int], Field(min_length=1), BeforeValidator(_unique)]


Corrections = Annotated[list[Literal["drift", "frame"]], BeforeValidator(_unique)]


class Described(Section):
    """A table whose other keys belong to the law or the shape that it names, which check them."""

    model_config = ConfigDict(extra="allow")

    @model_validator(mode="before")
    @classmethod
    def _reads_numbers(cls, given: Any) -> Any:
        return numbers_within(given)


class MaterialSection(Described):
    """The law, and the parameters that are known."""

    model: str = key(
        "the law, or several joined by `+` in any order, such as `nonlinear_burgers+ludwik_plasticity`: their strains "
        "add. `burgers_plasticity` is `nonlinear_burgers+bilinear_plasticity`; a draft keeps only linear transient "
        "creep of it beside the yielding, and holds the other parameters of the creep constant. Laws that share a "
        "parameter besides the elastic ones do not join. `auto` leaves [the choice](law_choice.md) to the recordings",
        accepted="a law below, or `auto`",
    )
    family: Literal["polymer", "metal", "glass", "gel"] | None = key(
        "laws among which recordings choose; with `model: auto` alone", None
    )


class TipSection(Described):
    """The indenter."""

    shape: str = key("", accepted="")


def _contact(given: Any) -> Any:
    """Return where tests begin."""
    given = numbers_within(given)
    number = isinstance(given, int | float) and not isinstance(given, bool)
    each = isinstance(given, dict) and given and all(isinstance(depth, int | float) for depth in given.values())
    if given not in ("file", "auto") and not number and not each:
        raise PydanticCustomError(NOT_ALLOWED, "")
    return given


class SourceSection(Section):
    """The vendor's file that a set of recordings is converted from."""

    file: str = key("the vendor's file", accepted="path")
    recordings: str = key("the set of recordings to which its tests are written", accepted="name under `recordings`")
    condition: str | None = key("the condition of all its tests", None, accepted="name; this or `conditions`")
    conditions: Annotated[dict[Any, Tests], Field(min_length=1)] | None = key(
        "the tests of each condition; a test belongs to one condition at most",
        None,
        accepted="`CONDITION: [name or number, ...]`; this or `condition`",
        remedy="list names or numbers of tests",
    )
    contact: Annotated[Any, BeforeValidator(_contact)] = key(
        "where a test begins: at the file's contact, at the contact that palpate finds, or at a depth [nm], for all "
        "tests or for single ones",
        "file",
        accepted="`file`, `auto`, number, `{TEST: NM}`",
        remedy="give file, auto or the depth of contact in nm, or depths of single tests",
    )
    corrections: Corrections | None = key(
        "the vendor's corrections that are applied to the depth; the vendor's own without it",
        None,
        accepted="list of `drift`, `frame`",
        remedy="name the vendor's corrections to keep: drift, frame, both or none of them",
    )
    columns: dict[str, str] | None = key(
        "columns of a table, which the file must have",
        None,
        accepted="`{time: NAME, load: NAME, depth: NAME}`; or numbers from 1, in quotes",
        remedy="name the columns of time, load and depth",
    )
    units: dict[str, str] | None = key(
        "units of these columns; those that the table states without it, s, mN, nm where it states none",
        None,
        accepted="`{time: UNIT, load: UNIT, depth: UNIT}`",
    )
    repository: str | None = key(
        "where the file is published; written into each recording as a comment", None, accepted="text"
    )
    commit: str | None = key("version of the repository; a comment, too", None, accepted="text")
    path: str | None = key("path in the repository; a comment, too", None, accepted="text")
    licence: str | None = key("licence of the file; a comment, too", None, accepted="text")
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] | None = key(
        "checksum that the file must have; not checked without it",
        None,
        accepted="64 digits",
        remedy="give the 64 digits that sha256sum prints",
    )

    @model_validator(mode="after")
    def _names_conditions_once(self) -> SourceSection:
        if (self.condition is None) == (self.conditions is None):
            raise PydanticCustomError(NOT_ALLOWED, "")
        if self.columns is not None and (lacks := [n for n in ("time", "load", "depth") if n not in self.columns]):
            raise refused(f"the key {lacks[0]!r} is missing", "name the columns of time, load and depth", "columns")
        return self


class InstrumentSection(Section):
    """Effects of the instrument and of its tip that studies share."""

    name: Name = key("of the instrument", remedy=NAME_REMEDY)
    shares: Names = key(
        "mechanisms of the instrument or of a tip, which have one value in all of its tests and are tried by the "
        "diagnosis",
        accepted="list of keys among [those that may be shared](shared_instruments.md)",
        remedy="list keys of mechanisms",
    )
    prior: str | None = key(
        "the study on the same instrument whose posterior, `results/STUDY/instrument.json`, is the prior of the shared "
        "effects; or such a file",
        None,
        accepted="name of a study, path that ends in `.json`",
    )


class StudyFile(Section):
    """The keys at the top of a study's file."""

    study: Name = key(
        "name; results go to `results/NAME`",
        accepted="up to 80 letters, digits, `.`, `-`, `_`, a letter or digit first",
        remedy=NAME_REMEDY,
    )
    title: str | None = key("title on figures and pages; the name without it", None, accepted="text")
    data: str | None = key(
        "vendor's file in place of `source.file`, or a folder in which the file is looked for, first by that path, "
        "then by its name; usually given as `--config data=PATH`",
        None,
        accepted="path",
    )
    seed: Whole = key("of all random numbers", 0, ge=0)
    material: MaterialSection = key("the law, and the parameters that are known, see below")
    parameters: Annotated[dict[str, Numbers], Field(min_length=1)] | None = key(
        "the other parameters of the law: levels of the grid of snapshots; a single level holds a parameter constant; "
        "at least one parameter has several; required, but for `model: auto`, with which they are left out",
        None,
        accepted="list of numbers for each, rising or falling",
    )
    design: Design = key("how the simulated materials are distributed over the levels", Design())
    indenter: TipSection = key("the tip")
    kinematics: Literal["small", "large"] = key("strains of the simulations", "large")
    accuracy: Accuracy = key(
        "mesh and time steps of the snapshots; fits use the next finer one, and end with "
        "[the one after it](inference.md#how-the-minimum-is-found)",
        "standard",
    )
    points: Whole = key("points on a simulated curve", 100, ge=10, le=10000)
    cells_per_job: Whole | None = key(
        "number of materials that one job of the workflow simulates, under one condition or all those that differ in "
        "size alone; null: 24, or more so that there are about 400 jobs",
        None,
        ge=1,
    )
    conditions: Annotated[list[ConditionEntry], Field(min_length=1)] = key(
        "the tests that are simulated, one entry each", accepted="list"
    )
    recordings: dict[Name, str] = key(
        "folder of each set of recordings, which holds `CONDITION_REPLICATE.csv`; without it nothing is calibrated. A "
        "set that `laboratory` or `source` writes lies in a folder of its own below `results/NAME/recordings`, which "
        "the workflow empties first. Paths have no braces",
        {},
        accepted="`NAME: FOLDER`",
        remedy=NAME_REMEDY,
    )
    evidence: list[EvidenceEntry] = key(
        "[uniaxial tests of the bulk](uniaxial.md), which calibrate as well or judge the law, and "
        "[imprints](imprint.md), which judge it; one entry each",
        [],
        accepted="list",
    )
    condition_sets: dict[Name, Names] = key(
        "further calibrations, each on some of the conditions with `role: calibrate`; the set `all` has all of them",
        {},
        accepted="`NAME: [CONDITION, ...]`",
    )
    surrogate: SurrogateSettings = key("how curves are interpolated between the snapshots", SurrogateSettings())
    calibration: CalibrationSettings = key("how the parameters are estimated", CalibrationSettings())
    diagnosis: DiagnosisSettings = key("how missing effects are searched", DiagnosisSettings())
    instrument: InstrumentSection | None = key(
        "effects that [studies on one instrument share](shared_instruments.md)", None
    )
    laboratory: dict[str, LaboratorySettings] = key(
        "writes synthetic recordings of a known material, for each set named", {}, accepted="`NAME: table`"
    )
    source: SourceSection | None = key(
        "the vendor's file that a set of recordings is converted from",
        None,
        remedy="give file, recordings and either condition or conditions",
    )
    challenge: Challenge = key("cases of [the blind trial](blind_trial.md), `snakemake challenge`", Challenge())
