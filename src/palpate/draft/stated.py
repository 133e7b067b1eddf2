"""What vendors' files state of tip, instrument and sample beside their curves, by the vendors' names."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from statistics import median
from typing import Any, TypeVar

from indentation_files.readers.numbers_in_text import number
from indentation_files.readers.units import SCALES, plain
from palpate.errors import InputError
from palpate.study.area_function import BERKOVICH
from palpate.study.indenter import Indenter

COEFFICIENTS = {"Area Coefficient {}": 1, "Tip C{}": 0}  # MTS/Agilent XP, Hysitron; number of the first
LENGTH = SCALES["depth"]
SPRINGS = {f"{a}/{b}": SCALES["load"][a] / LENGTH[b] for a in SCALES["load"] for b in LENGTH}  # to mN/nm
PRESSURES = {"Pa": 1e-9, "kPa": 1e-6, "MPa": 1e-3, "GPa": 1.0, "N/mm2": 1e-3, "N/mm^2": 1e-3}
AREAS = {f"{unit}2": scale**2 for unit, scale in LENGTH.items()}
OF_SAMPLE = re.compile(r"(?!.*(indenter|tip|probe|diamond)).*poisson['’]?s? ratio", re.IGNORECASE)
IN_MODULUS = re.compile(r"E ?\[(?:v|nu|ν) ?= ?(\d*[.,]\d+)\]")  # as Optics11 writes it
OF_TIP = "(tip|probe|indenter|bead|sphere|ball|colloid|particle)"
RADIUS = re.compile(rf"(?!.*contact).*({OF_TIP}.*radius|radius.*{OF_TIP})", re.IGNORECASE)
DIAMETER = re.compile(rf"(?!.*contact).*({OF_TIP}.*diameter|diameter.*{OF_TIP})", re.IGNORECASE)
SPRING = re.compile(
    r"k\s*[(\[][munpµμ]?N/[munµμ]?m[)\]]|k cantilever|(cantilever\w* )?spring constant|cantilever (k|stiffness)\b", re.I
)
CONTROL = re.compile(r"control mode|fb mode|feedback mode", re.IGNORECASE)
SHAPE = re.compile(r"(tip|indenter|probe|punch)( (shape|type|geometry|name|id))?\b", re.IGNORECASE)
SHAPES = {
    "flat punch": r"flat|cylind",
    "cube corner": r"cube|corner",
    "vickers": r"vick",
    "berkovich": r"berk",
    "sphero_cone": r"cono|sphero",
    "sphere": r"spher|ball|bead|colloid",
}
MODULUS = re.compile(
    r"(?!.*(reduced|eff|limit|guess|indenter|tip|storage|loss))"
    r"(E ?IT$|E$|E\[|E average|(avg |average )?(young\S* |elastic )?modulus\b)",
    re.IGNORECASE,
)
PLANE_STRAIN = re.compile(r"E ?IT ?/ ?\(1", re.IGNORECASE)  # E / (1 - nu^2), as Fischer writes it
BY_HERTZ = re.compile(r"E ?Hz$")
CONTACT_AREA, CONTACT_DEPTH = re.compile(r"Ap$"), re.compile(r"hc$")  # as Anton Paar writes them
HARDNESS = re.compile(r"(?!.*(limit|vickers))(H ?IT\b|H$|H average|(avg |average )?hardness\b)", re.IGNORECASE)
OF_INSTRUMENT = {
    "frame": re.compile(r"frame (stiffness|compliance)|machine comp", re.IGNORECASE),
    "drift": re.compile(r"(?!.*(allowable|\?)).*(drift (rate|correction)|drift \[)", re.IGNORECASE),
    "temperature": re.compile(r"(test )?temp(erature)?\b", re.IGNORECASE),
}
BLUNT = 2.0  # chosen: a pyramid whose end has worn off does not have so much of the ideal one's area
ROUNDED = 1.1  # chosen: ratio of radii that follow from rounded areas and depths of one tip
Value = TypeVar("Value")


@dataclass(frozen=True)
class Stated:
    """What all tests of a draft say alike.

    Parameters
    ----------
    area
        Coefficients of the tip's area function [nm], see `palpate.study.area_function`; none where files state no tip
        or an ideal one, or a tip that cannot be simulated.
    poisson_ratio
        Of the sample; None where it is not stated.
    radius
        Of a spherical tip, or of the end of a cone or a pyramid [nm].
    shape
        One of `SHAPES`; empty where none is stated.
    spring
        Stiffness of the cantilever by which the load was applied [mN/nm].
    control
        What the instrument held to its course, as the file names it, such as ``Displacement``.
    sphere
        Radius of the sphere whose contact area at the contact depth is the one that the vendor evaluated [nm].
    """

    area: tuple[float, ...] = ()
    poisson_ratio: float | None = None
    radius: float | None = None
    shape: str = ""
    spring: float | None = None
    control: str = ""
    sphere: float | None = None

    @classmethod
    def by_all(cls, metadata: Sequence[Mapping[str, Any]]) -> Stated:
        """Return what the metadata of tests, one mapping each, agree on."""
        ratios = [ratio if ratio is not None and 0.0 < ratio < 0.5 else None for ratio in map(poisson_ratio, metadata)]
        return cls(
            _shared([_area(each) for each in metadata], ()),
            _shared(ratios, None),
            _shared([_radius(each) for each in metadata], None),
            _shared([_shape(each) for each in metadata], ""),
            _shared([quantity(each, SPRING, SPRINGS, "N/m") for each in metadata], None),
            _shared([_entry(each, CONTROL) for each in metadata], ""),
            _alike([_sphere(each) for each in metadata]),
        )


def _shared(values: Sequence[Value], otherwise: Value) -> Value:
    return values[0] if len(set(values)) == 1 else otherwise


def _alike(values: Sequence[float | None]) -> float | None:
    """Return the median of values that differ by no more than `ROUNDED`; None where one is missing or others differ."""
    known = [value for value in values if value is not None]
    if len(known) < max(len(values), 1) or max(known) > ROUNDED * min(known):
        return None
    return median(known)


def quantity(
    metadata: Mapping[str, Any], named: re.Pattern[str], units: Mapping[str, float], usual: str = ""
) -> float | None:
    """Return the first positive quantity of that name, whose unit is behind it or in brackets in its name.

    Parameters
    ----------
    metadata
        What a file states, by the vendor's names.
    named
        Matches the names of the quantity.
    units
        What each unit is in that of the result.
    usual
        The unit where none is stated; such an entry does not count where this is empty.
    """
    for name, entry in metadata.items():
        value = _number(entry) if named.match(name.strip()) else None
        if value is None or value <= 0.0:
            continue
        in_name = re.search(r"[\[(]([^\])=]+)[\])]\W*$", name)
        unit = plain(str(entry).partition(" ")[2]) or (plain(in_name[1]) if in_name else usual)
        if unit in units:
            return value * units[unit]
    return None


def youngs_modulus(metadata: Mapping[str, Any]) -> float | None:
    """Return Young's modulus by the vendor's own evaluation [GPa]; None where it gives none."""
    return quantity(metadata, MODULUS, PRESSURES) or quantity(metadata, BY_HERTZ, PRESSURES)


def plane_strain_modulus(metadata: Mapping[str, Any]) -> float | None:
    """Return E / (1 - nu^2) by the vendor's own evaluation [GPa]; None where it gives none."""
    return quantity(metadata, PLANE_STRAIN, PRESSURES)


def hardness(metadata: Mapping[str, Any]) -> float | None:
    """Return the hardness by the vendor's own evaluation [GPa]; None where it gives none."""
    return quantity(metadata, HARDNESS, PRESSURES)


def of_instrument(metadata: Mapping[str, Any]) -> list[str]:
    """Return what a file states of frame, drift and temperature, as it is written there."""
    found = (_entry_with_name(metadata, named) for named in OF_INSTRUMENT.values())
    return [entry for entry in found if entry]


def _entry_with_name(metadata: Mapping[str, Any], named: re.Pattern[str]) -> str:
    return next(
        (f"{name.strip()} {entry}" for name, entry in metadata.items() if named.match(name.strip()) and entry), ""
    )


def _entry(metadata: Mapping[str, Any], named: re.Pattern[str]) -> str:
    return next((str(entry).strip() for name, entry in metadata.items() if named.match(name.strip())), "")


def radius_entry(metadata: Mapping[str, Any]) -> str:
    """Return what a file states of the tip's radius or diameter, as it is written there; empty where it does not."""
    return _entry_with_name(metadata, RADIUS) or _entry_with_name(metadata, DIAMETER)


def _radius(metadata: Mapping[str, Any]) -> float | None:
    diameter = quantity(metadata, DIAMETER, LENGTH)
    return quantity(metadata, RADIUS, LENGTH) or (diameter / 2.0 if diameter else None)


def area_share(metadata: Mapping[str, Any]) -> float | None:
    """Return the vendor's contact area as a multiple of the square of its contact depth; None where it is not stated.

    It is 24.5 for an ideal Berkovich or Vickers tip.
    """
    area, depth = quantity(metadata, CONTACT_AREA, AREAS), quantity(metadata, CONTACT_DEPTH, LENGTH)
    return area / depth**2 if area and depth else None


def _sphere(metadata: Mapping[str, Any]) -> float | None:
    """Return the radius of the sphere of the vendor's contact area [nm]; None where a pyramid may have it too.

    A spherical cap of height h has the area pi (2 R h - h^2) at its edge.
    """
    share, depth = area_share(metadata), quantity(metadata, CONTACT_DEPTH, LENGTH)
    if share is None or depth is None or share < BLUNT * BERKOVICH:
        return None
    return depth * (share / math.pi + 1.0) / 2.0


def _shape(metadata: Mapping[str, Any]) -> str:
    """Return the shape of the tip that an entry names."""
    shapes = " ".join(str(value) for name, value in metadata.items() if SHAPE.fullmatch(name.strip())).lower()
    return next((shape for shape, words in SHAPES.items() if re.search(words, shapes)), "")


def _area(metadata: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the coefficients of a tip that is not ideal and can be simulated."""
    area = coefficients(metadata)
    if len(area) > 1:
        with suppress(InputError):
            return Indenter.from_mapping({"shape": "area_function", "area": list(area)}).area
    return ()


def coefficients(metadata: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the coefficients of an area function as a file states them, without zeros at the end."""
    for name, first in COEFFICIENTS.items():
        area: list[float] = []
        while (value := _number(metadata.get(name.format(first + len(area))))) is not None:
            area.append(value)
        while area and area[-1] == 0.0:
            area.pop()
        if area:
            return tuple(area)
    return ()


def poisson_ratio(metadata: Mapping[str, Any]) -> float | None:
    """Return what a file states as its sample's Poisson's ratio, whatever that is; None where it states none."""
    ratios = [_number(value) for name, value in metadata.items() if OF_SAMPLE.match(name)]
    ratios += [_number(found[1]) for found in map(IN_MODULUS.match, metadata) if found]
    return next((value for value in ratios if value is not None), None)


def _number(entry: object) -> float | None:
    """Return the number with which an entry begins, before its unit; None where there is none."""
    value = number("".join(str(entry).split()[:1]))
    return value if math.isfinite(value) else None
