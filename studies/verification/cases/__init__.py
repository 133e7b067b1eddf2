"""What the solver is compared with: every module of this folder that defines ``CASES`` is found by itself."""

from indentation_files.discovery import discover
from studies.verification.case import Verification

CASES: tuple[Verification, ...] = tuple(case for cases in discover(__name__, __path__, "CASES") for case in cases)
