"""Input for other finite element programs: every module of this folder that defines ``FORMAT`` is found by itself."""

from indentation_files.discovery import discover
from palpate.output.export.format import Format

FORMATS: dict[str, Format] = {found.key: found for found in discover(__name__, __path__, "FORMAT")}

__all__ = ["FORMATS", "Format"]
