"""The settings of a search among explanations, each with its origin."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchPolicy:
    """How far a search goes; chosen for its time, not by the cases that are reported, where nothing else is said.

    Parameters
    ----------
    starts
        Amplitudes from which the fit of a mechanism with several quantities begins; with one, the best is enough. They
        advance side by side, and one that falls behind is given up.
    screened
        By how much the logarithm of the optimistic evidence may lie behind the best fit, once `least` are fitted.
    outdone
        The same behind one that leaves only noise: more than twice that of a ratio of 100, within which both are
        accepted.
    least, most, most_sets
        Numbers of explanations that are fitted at least, and at most, with one mechanism and with several.
    mechanism_penalty
        Logarithm of the likelihood of what is left, by which one more mechanism must raise it to tell the noise of
        recordings without replicates: the cost of a parameter by Akaike's criterion is one, by Schwarz's about three.
    """

    starts: int = 2
    screened: float = 40.0
    outdone: float = 10.0
    least: int = 5
    most: int = 8
    most_sets: int = 5
    mechanism_penalty: float = 2.0
