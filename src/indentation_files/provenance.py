"""Where a recording comes from and what was done to it: the comments with which a test of a file is written."""

from __future__ import annotations

from indentation_files.readers.vendor import Corrections, VendorTest, in_words

CORRECTED = "corrections in depth: "


def provenance(test: VendorTest, corrections: Corrections) -> tuple[str, ...]:
    """Return the notes of a test, the corrections that its depth contains, its warnings, and what its file states.

    A recording that palpate has written states its corrections itself.

    Parameters
    ----------
    test
        As it was read.
    corrections
        That were asked for; None for the vendor's own.
    """
    notes = test.recording.notes
    if not any(note.startswith(CORRECTED) for note in notes):
        notes = (*notes, CORRECTED + in_words(corrections))
    return (*notes, *test.warnings, *(f"{key}: {value}" for key, value in test.metadata.items()))
