"""What tests are compared by: every module of this folder that defines ``OBSERVABLE`` is found by itself."""

from indentation_files.discovery import discover
from palpate.observables.observable import Observable, Quantity
from palpate.study.protocol import Protocol

OBSERVABLES: dict[str, Observable] = {found.name: found for found in discover(__name__, __path__, "OBSERVABLE")}
UNITS = tuple(dict.fromkeys(observable.unit for observable in OBSERVABLES.values()))


def response_to(protocol: Protocol) -> Observable:
    """Return the observable that answers what a test prescribes."""
    return next(found for found in OBSERVABLES.values() if found.control == protocol.control)


__all__ = ["OBSERVABLES", "UNITS", "Observable", "Quantity", "response_to"]
