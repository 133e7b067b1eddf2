"""A first study of recordings: what they say is written down, what they do not say is guessed and marked as such."""

from palpate.draft.drafted import Drafted, assumed
from palpate.draft.first_study import readable, write_study
from palpate.draft.guesses import ranges
from palpate.draft.metadata import not_taken
from palpate.draft.solid import Solid, check_units, unlike
from palpate.draft.stated import Stated
from palpate.draft.yaml_text import study_name

__all__ = [
    "Drafted",
    "Solid",
    "Stated",
    "assumed",
    "check_units",
    "not_taken",
    "ranges",
    "readable",
    "study_name",
    "unlike",
    "write_study",
]
