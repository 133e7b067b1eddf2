"""A first study of recordings: what files state is taken, all else is guessed and marked as such."""

from palpate.draft.drafted import Drafted
from palpate.draft.first_study import write_study
from palpate.draft.guess_table import lines
from palpate.draft.readable import readable
from palpate.draft.yaml_text import study_name

__all__ = ["Drafted", "lines", "readable", "study_name", "write_study"]
