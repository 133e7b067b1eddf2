"""A first study of recordings: what files state is taken, all else is guessed and marked as such."""

from palpate.draft.drafted import Drafted, assumed
from palpate.draft.first_study import FirstStudy, write_study
from palpate.draft.guess_table import lines
from palpate.draft.guesses import ranges
from palpate.draft.known_tip import KnownTip
from palpate.draft.law_choice import chosen_law
from palpate.draft.metadata import not_taken
from palpate.draft.prescribed_drive import Drive
from palpate.draft.readable import readable
from palpate.draft.solid import Solid
from palpate.draft.stated import Stated
from palpate.draft.yaml_text import study_name

__all__ = [
    "Drafted",
    "Drive",
    "FirstStudy",
    "KnownTip",
    "Solid",
    "Stated",
    "assumed",
    "chosen_law",
    "lines",
    "not_taken",
    "ranges",
    "readable",
    "study_name",
    "write_study",
]
