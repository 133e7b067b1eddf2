"""Laws joined by ``+``: their strains add under the same stress, with one pair of elastic constants."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.materials.first_guess import Glimpse, Guessed
from palpate.materials.law import Law, Term


def joined(laws: Sequence[Law], key: str = "", title: str = "") -> Law:
    """Return the law whose strains are those of `laws` together, in the order of their keys.

    Raises
    ------
    InputError
        When two of them share a parameter.
    """
    laws = sorted(laws, key=lambda law: law.key)
    key = key or "+".join(law.key for law in laws)

    def flow(values: Mapping[str, object]) -> tuple[Parameter, ...]:
        return tuple(p for law in laws for p in (law.extend(values) if law.extend else law.flow))

    twice = next((name for name, n in Counter(p.name for p in flow({})).items() if n > 1), None)
    if twice:
        first, second, *_ = (law.key for law in laws if any(p.name == twice for p in law.flow))
        raise InputError(
            f"{first} and {second} cannot be joined: both have the parameter {twice}",
            remedy="leave one of them out",
            place="model",
        )

    def terms(values: Mapping[str, float]) -> list[Term]:
        return [term for law in laws for term in law.terms(values)]

    def guess(glimpse: Glimpse) -> dict[str, Guessed]:
        return {name: found for law in laws for name, found in law.guess(glimpse).items()}

    return Law(
        key,
        title or " with ".join(law.title for law in laws),
        flow({}),
        terms,
        flow,
        parts=tuple(law.key for law in laws),
        example={name: value for law in laws for name, value in law.example.items()},
        guess=guess,
    )
