"""One simulated test, from a specification by a mapping, a YAML file or keywords."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes

from indentation_files.recording import SYNTHETIC, Recording
from palpate.base.yaml_file import plain, read_yaml
from palpate.errors import InputError, PalpateError, located_in
from palpate.output.figures.style import RECORDED
from palpate.output.shown import ShownCurve
from palpate.solver import simulation
from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedCurve(ShownCurve):
    """A simulated test.

    Parameters
    ----------
    specification
        Everything on which the curve depends.
    recording
        The curve, which can be drafted and calibrated like a measured one.
    solver_seconds
        Wall time spent in the solver [s].
    """

    specification: Specification
    recording: Recording
    solver_seconds: float

    def sentences(self) -> list[str]:
        """Return material, extent of the curve, settings and effects."""
        spec = self.specification
        return [
            "material: " + ", ".join(f"{name} {value:.4g}" for name, value in spec.parameters.items()),
            self.extent(),
            f"{spec.kinematics} strains, accuracy {spec.accuracy}, {self.solver_seconds:.3g} s in the solver",
            *(f"with {key}: {dict(values)}" for key, values in spec.mechanisms.items()),
        ]

    def draw(self, ax: Axes) -> None:
        """Draw the load over the depth, dashed."""
        ax.plot(self.depth, self.load, "--", color=RECORDED, label=f"simulated, {self.specification.model}")

    def __repr__(self) -> str:
        return f"<SimulatedCurve of {self.specification.model} under {self.specification.indenter.shape}>"


def simulate(
    specification: Specification | Mapping[str, Any] | str | Path | None = None,
    *,
    material: Mapping[str, Any] | None = None,
    indenter: Mapping[str, Any] | None = None,
    protocol: Mapping[str, Any] | None = None,
    mechanisms: Mapping[str, Mapping[str, float]] | None = None,
    kinematics: str | None = None,
    accuracy: str | None = None,
) -> SimulatedCurve:
    """Simulate one indentation by finite elements.

    Parameters
    ----------
    specification
        A mapping with the keys below, the path of such a YAML file, or what ``Study.specification`` returns. Keywords
        replace entries of a mapping or a file. Numbers and arrays may be those of NumPy.
    material
        ``model`` and all parameters of that law by name, such as
        ``{"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.35}`` [GPa], [-].
    indenter
        ``shape`` and what the shape needs, such as ``{"shape": "cone", "half_angle": 70.3}`` [deg].
    protocol
        Such as ``{"max_load": 1.0, "loading_time": 30, "unloading_time": 30}`` [mN], [s]; ``points`` is the number of
        samples, 100 where none is given.
    mechanisms
        Effects beside the base model: for each key of `palpate.mechanisms` its parameters by name.
    kinematics
        ``large`` (the default) or ``small`` strains.
    accuracy
        ``standard`` (the default), ``medium``, ``fine`` or ``finest``.

    Returns
    -------
    SimulatedCurve

    Raises
    ------
    InputError
        When anything is unknown, missing or outside its physical range.
    PalpateError
        When the solver fails.
    """
    sections = {
        "material": material, "indenter": indenter, "protocol": protocol, "mechanisms": mechanisms,
        "kinematics": kinematics, "accuracy": accuracy,
    }  # fmt: skip
    given = {key: value for key, value in sections.items() if value is not None}
    asked = _asked(specification, given)
    found = simulation.simulate(asked)
    if found.status != "ok":
        raise PalpateError(f"the simulation failed: {found.reason}")
    name, notes = f"simulated_{asked.model}", (f"{SYNTHETIC}: simulated by palpate",)
    return SimulatedCurve(asked, Recording(found.time, found.load, found.depth, name, notes), found.solver_seconds)


def _asked(specification: Any, given: Mapping[str, Any]) -> Specification:
    """Return what to simulate, with the `given` sections in place of its own."""
    if isinstance(specification, Specification):
        for name in given:
            remedy = "change the specification with dataclasses.replace, or give a mapping"
            raise InputError(f"{name} is given beside a whole specification", remedy=remedy, place=name)
        return specification
    file = specification if isinstance(specification, str | Path) else None
    values: Any = read_yaml(file) if file is not None else specification or {}
    with located_in(file):
        return simulation.specification_from(plain({**values, **given}) if isinstance(values, Mapping) else values)
