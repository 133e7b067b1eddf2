"""The settings of a study by topic: design, surrogates, calibration, diagnosis, virtual laboratories."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from palpate.configuration.declaration import Number, Pair, Section, Whole, key, numbers_within, refused

Accuracy = Literal["standard", "medium", "fine", "finest"]
Ranges = Annotated[dict[str, Pair], Field(min_length=1)]
NOT_ALLOWED = "not_allowed"  # type of the error
LEAST_PART = 4  # individuals of a subpopulation: parents of two children


class Design(Section):
    """How the simulated materials are distributed over the levels."""

    kind: Literal["factorial", "sobol"] = key(
        "`factorial` takes every combination of the levels; `sobol` fills the ranges between the lowest and the "
        "highest",
        "factorial",
    )
    points: Whole = key("number of materials of `sobol`", 128, ge=8, le=200000)


def _length(given: Any) -> Any:
    """Return the length of a radial function, or how it is chosen."""
    given = numbers_within(given)
    number = isinstance(given, int | float) and not isinstance(given, bool)
    if not (number and given > 0) and given not in ("loo", "loo_each"):
        raise PydanticCustomError(NOT_ALLOWED, "")
    return given


class SurrogateSettings(Section):
    """How curves are interpolated between the snapshots; arguments of `palpate.surrogate.PODRBF`."""

    kernel: Literal["linear", "cubic", "multiquadric", "gaussian", "inverse_multiquadric"] = key(
        "radial basis function", "multiquadric"
    )
    shape: Annotated[Any, BeforeValidator(_length)] = key(
        "length of the radial function, in units of the ranges of the parameters, which changes neither `linear` nor "
        "`cubic`; `loo`: that of least leave-one-out error; `loo_each`: one for each parameter",
        "loo",
        accepted="above 0, `loo`, `loo_each`",
        remedy="give a positive number, or loo to choose it by leave-one-out, or loo_each for a length of each "
        "parameter",
    )
    energy: Number = key("share of the variance of the curves that the POD modes keep", 0.99999999, gt=0, le=1)
    n_modes: Whole | None = key("number of modes, in place of `energy`", None, ge=1)
    max_condition: Number = key("largest condition number of the interpolation", 1e12, gt=1)


class CalibrationSettings(Section):
    """How the parameters are estimated: the numbers of the genetic search, and the errors that are allowed for."""

    removed: ClassVar[dict[str, str]] = {
        "corrections": "estimates are fitted on the finite elements until they converge"
    }
    strategy: Literal["nsga2", "aggregate"] = key("one objective for each condition (NSGA-II), or their sum", "nsga2")
    objective: Literal["mean_square", "relative"] = key(
        "objective of a condition: mean square of the error [nm^2] (chapter 5 of the thesis), or of the relative error "
        "(its chapter 4)",
        "mean_square",
    )
    population: Whole = key(
        "individuals of the genetic search, a multiple of `subpopulations`, four of each or more", 200, ge=8, le=100000
    )
    generations: Whole = key("largest number of generations", 600, ge=1, le=1000000)
    tournament: Whole = key("individuals in one tournament of the selection", 2, ge=1)
    crossover_fraction: Number = key("share of the children made by crossover, the others by mutation", 0.8, ge=0, le=1)
    crossover_ratio: Number = key("ratio of the intermediate crossover", 1.0, gt=0)
    mutation_scale: Number = key(
        "standard deviation of a mutation in the first generation, in ranges of the parameters", 1.0, gt=0
    )
    mutation_shrink: Number = key("share by which it has shrunk at the last generation", 1.0, ge=0, le=1)
    subpopulations: Whole = key(
        "equal parts that evolve side by side, which the thesis does not give; with 1 there is no migration", 4, ge=1
    )
    migration_fraction: Number = key(
        "share of a subpopulation whose copies replace the worst of the next one", 0.2, ge=0, le=1
    )
    migration_interval: Whole = key("generations between migrations", 20, ge=1)
    tolerance: Number = key(
        "relative change of the best value of each objective, and of their sum, below which the search ends early; 0: "
        "never",
        0.0001,
        ge=0,
    )
    stall_generations: Whole = key(
        "generations over which that change is measured; MATLAB's default for several objectives", 100, ge=1
    )
    site_scatter: Number = key(
        "relative standard deviation of the depth between sites; used where at most half of the conditions have "
        "replicates",
        0.01,
        remedy="give a ratio: 0.01 is 1 %",
        ge=0,
        le=0.5,
    )
    solver_error: Number = key(
        "relative standard deviation of the error of the mesh, one factor common to all simulated depths of a "
        "tip. The default "
        "suits laws that are elastic or creep; give 0.005 where the law yields. What the law itself leaves is "
        "`law_error`",
        0.003,
        remedy="it is the error of the mesh: state what the law leaves by calibration.law_error, a ratio (0.0025 is "
        "0.25 %)",
        ge=0,
        le=0.005,
    )
    law_error: Number = key(
        "median of the prior of the [discrepancy of the law](inference.md#the-discrepancy-of-the-law), a standard "
        "deviation as a share of the depth; its size is estimated with the parameters, so that the value matters "
        "little where there are several tests. Give more for a material that no law here describes; 0 takes the law to "
        "be exact",
        0.0025,
        remedy="give a ratio: 0.0025 is 0.25 %; 0 takes the law to be exact",
        ge=0,
        le=0.2,
    )

    @property
    def aggregated(self) -> bool:
        """Whether the sum of all objectives is searched for in place of the Pareto front."""
        return self.strategy == "aggregate"

    @model_validator(mode="after")
    def _has_equal_parts(self) -> CalibrationSettings:
        if self.population % self.subpopulations or self.population < LEAST_PART * self.subpopulations:
            parts = f"{self.subpopulations} equal parts of {LEAST_PART} or more"
            problem = f"population {self.population} cannot be split into {parts}"
            raise refused(problem, "change population or subpopulations", "subpopulations")
        return self


class Reference(Section):
    """What is known of a reference sample and of the tip together."""

    youngs_modulus: Number = key("of the sample [GPa]", remedy="give it in GPa", gt=0, le=2000)
    poisson_ratio: Number = key("of the sample", ge=0, le=0.4999)
    area: list[Number] = key(
        r"C_0, C_1, ... of the tip: $A = C_0 h_c^2 + C_1 h_c + C_2 h_c^{1/2} + \dots$ [nm²]",
        accepted="positive and growing from 100 nm to 10 um, there that of a cone of 20 to 89 degrees",
        min_length=1,
    )
    uncertainty: Number = key(
        "relative standard deviation of beta times reduced modulus times square root of area "
        "([beta](reference_sample.md))",
        gt=0,
        le=0.5,
    )


class DiagnosisSettings(Section):
    """How missing effects are searched."""

    removed: ClassVar[dict[str, str]] = {
        "snapshots": "explanations are fitted on the finite elements and need no snapshots"
    }
    enabled: bool = key("whether the diagnosis is made", True)
    mechanisms: list[str] = key(
        "mechanisms that are tried; with `[]` all that are considered by default and apply to the study",
        [],
        accepted="keys as below",
    )
    ranges: dict[str, Ranges] = key(
        "plausible ranges of a mechanism's quantities in place of the default ones, such as `{frame_compliance: "
        "{compliance: [0, 40]}}`; estimates may lie outside. The range of an instrument's error holds half of its "
        "[prior](evidence.md#which-effects-act)",
        {},
        accepted="[lower, upper]",
        remedy="give [lower, upper] for each quantity of a mechanism that is searched",
    )
    significance: Number = key(
        "significance level of the test of the base model, all of its parts together", 0.01, gt=0, lt=0.5
    )
    tolerance: Number = key(
        "discrepancy of the law that the study accepts, as a share of the depth",
        0.01,
        remedy="give the discrepancy of the law that is accepted, a ratio: 0.01 is 1 % of the depth",
        ge=0,
        le=0.2,
    )
    smallest_effect: Number = key(
        "change of the mean depth of half of a segment above which an effect counts as acting, as a share of the depth",
        0.003,
        remedy="give the smallest change of a part of a test that counts as an effect, a ratio: 0.003 is 0.3 % of the "
        "depth",
        ge=0,
        le=0.2,
    )
    bootstrap: Whole = key(
        "draws of the noise from which a p-value is computed; at least 3 / `significance`", 1000, ge=200, le=100000
    )
    largest_set: Whole = key(
        "largest number of mechanisms in one explanation",
        2,
        remedy="most mechanisms in one explanation",
        ge=1,
        le=4,
    )
    reference: Reference | None = key(
        "states that sample and tip are known, so that [unloadings give the frame compliance](reference_sample.md); "
        "for fitted tests under load control",
        None,
        remedy="give modulus, Poisson's ratio, the tip's area function and their uncertainty together",
    )


class Challenge(Section):
    """The cases of the blind trial."""

    seed: Whole = key("of the random choice of cases", 0, ge=0)
    none: Whole = key("number of cases that conceal nothing", 60, ge=0, le=10000)
    one: Whole = key("number of cases with one effect", 100, ge=0, le=10000)
    two: Whole = key("number of cases with two effects", 50, ge=0, le=10000)
    mechanisms: list[str] = key(
        "mechanisms that are concealed, in the order from which the seed draws; with `[]` all that are considered by "
        "default",
        [],
        accepted="keys of the table above",
    )
    unknown: Whole = key("number of cases with an effect that is no mechanism of palpate", 30, ge=0, le=10000)
    accuracy: Accuracy = key("mesh of the laboratory, finer than those on which fits end", "finest")


class LaboratorySettings(Section):
    """A virtual laboratory that writes synthetic recordings of a known material."""

    parameters: dict[str, Number] = key(
        "the true material", accepted="a number for each name under `parameters`, none for those under `material`"
    )
    seed: Whole = key("of the noise", 0, ge=0)
    replicates: Whole = key("recordings of each condition", 3, ge=1, le=10000)
    noise_nm: Number = key("standard deviation of the noise [nm]", 1.0, ge=0)
    noise_time: Number = key("correlation time of the noise [s]", 1.0, gt=0)
    site_scatter: Number = key(
        "relative standard deviation of the depth between recordings",
        0.01,
        remedy="give a ratio: 0.01 is 1 %",
        ge=0,
        le=0.5,
    )
    mechanisms: dict[str, dict[str, Number]] = key(
        "effects that are concealed in the recordings, such as `{thermal_drift: {rate: 0.12}}`",
        {},
        accepted="`KEY: {PARAMETER: VALUE}`",
    )
