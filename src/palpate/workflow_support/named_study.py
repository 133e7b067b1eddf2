"""A study that a command is given: its file, or its name below results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from palpate.base.yaml_file import read_yaml
from palpate.errors import InputError
from palpate.workflow_support import manifest
from palpate.workflow_support.result_files import read_json


def named_study(given: str) -> tuple[dict[str, Any], Path]:
    """Return the keys of a study, and the file that holds them: its own, or the manifest of its last report.

    Raises
    ------
    InputError
        When there is neither.
    """
    if Path(given).is_file():
        return read_yaml(given), Path(given)
    file = Path("results") / given / manifest.NAME
    if not file.is_file():
        names = sorted(each.parent.name for each in Path("results").glob(f"*/{manifest.NAME}"))
        there = f"use one of: {', '.join(names)}" if names else "run one first: palpate run STUDY.yaml"
        raise InputError(f"{given!r} is no file, and results holds no study of that name", remedy=there, place="STUDY")
    return read_json(file)["configuration"], file
