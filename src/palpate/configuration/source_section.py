"""The section ``source`` of a study: the vendor's file that a set of recordings is converted from."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from indentation_files.readers import locate
from palpate.base.yaml_file import plain
from palpate.configuration.checked_file import suggestion
from palpate.configuration.study_sections import StudyFile
from palpate.errors import InputError


def source_from(given: StudyFile, data: str | None) -> dict[str, Any]:
    """Return the section ``source``, with the vendor's file at `data` if that is given, and check what it names.

    Raises
    ------
    InputError
        When the study has no such section but data, a set or a condition is not the study's, or the file is missing.
    """
    if given.source is None:
        if data is not None:
            raise InputError(
                "data is given, but the study has no section source", remedy="leave data off", place="data"
            )
        return {}
    under = None if data is None else os.path.expanduser(data)
    section = plain(given.source.model_dump(exclude_none=True))
    source = {**section, "file": locate(os.path.expanduser(given.source.file), under)}
    conditions = [entry.name for entry in given.conditions]
    for key, name, known in (
        ("recordings", source["recordings"], list(given.recordings)),
        *(("condition", name, conditions) for name in conditions_of(source)),
    ):
        if name not in known:
            raise InputError(
                f"{name!r} is not among {', '.join(known) or 'none'}{suggestion(name, known)}",
                remedy=f"name one of the study's {key.rstrip('s')}s",
                place=f"source.{key}",
            )
    for name in conditions:
        if name not in conditions_of(source):
            raise InputError(
                f"no test of condition {name!r} is named",
                remedy="name its tests under source.conditions, or remove the condition",
                place="source",
            )
    if not Path(source["file"]).is_file():
        raise InputError(
            f"the vendor's file {source['file']} is missing",
            remedy="fetch it and give its place: palpate check --data PATH, snakemake --config data=PATH",
            place="source.file",
        )
    return source


def conditions_of(source: Mapping[str, Any]) -> list[str | None]:
    """Return the conditions whose tests a section ``source`` names: those of a table, or the only one."""
    return list(source.get("conditions", [source.get("condition")]))
