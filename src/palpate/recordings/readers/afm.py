"""Force curves of atomic force microscopes (JPK, Asylum/Igor, AFM HDF5), read by the library ``afmformats``.

The tip is where the height sensor is, moved by the cantilever's deflection: depth = -(height + force / stiffness).
These files mark no contact; time and depth are counted from the start of the curve, so contact must be found or given.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from palpate.errors import InputError
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.vendor import Corrections, Reader, VendorTest, refuse_corrections, usable
from palpate.recordings.recording import Recording

HDF5, IGOR, ZIP = b"\x89HDF\r\n", b"\x05\x00", b"PK\x03\x04"
JPK_ENDINGS = (".jpk-force", ".jpk-force-map", ".jpk-qi-data")
CHANNELS = ("time", "force", "height (measured)")


def matches(source: Source) -> bool:
    """Return whether the file is HDF5, an Igor wave with a spring constant, or a zip archive of JPK's properties."""
    return _ending(source) is not None


def _ending(source: Source) -> str | None:
    """Return the ending by which ``afmformats`` knows the format."""
    content = source.content
    if content.startswith(HDF5):
        return ".h5"
    if content.startswith(IGOR) and b"SpringConstant" in content:
        return ".ibw"
    if content.startswith(ZIP) and b"header.properties" in content:
        return source.path.suffix if source.path.suffix in JPK_ENDINGS else JPK_ENDINGS[0]
    return None


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read all curves of the file, with their approach."""
    refuse_corrections(source, corrections)
    try:
        from afmformats import errors, load_data
    except ImportError as error:
        raise InputError(
            "force curves need the library afmformats", remedy="install it: pip install afmformats", file=source.path
        ) from error
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / f"curve{_ending(source)}"
        copy.write_bytes(source.content)
        try:
            curves = load_data(copy)
            tests = [_test(source, number, curve) for number, curve in enumerate(curves, 1)]
        except InputError:
            raise
        except (Exception, errors.AFMFileFormatError, errors.MissingMetaDataError) as error:
            raise InputError(
                f"afmformats cannot read it ({type(error).__name__})",
                remedy="copy or export it again",
                file=source.path,
            ) from error
    if not tests:
        raise InputError("holds no force curve", remedy="export force-distance curves", file=source.path)
    return tests


def _test(source: Source, number: int, curve) -> VendorTest:
    """Return one curve of ``afmformats`` as a test."""
    stiffness = curve.metadata.get("spring constant", 0.0)
    missing = [name for name in CHANNELS if name not in curve] + ([] if stiffness > 0 else ["spring constant"])
    if missing:
        raise InputError(f"curve {number} lacks {', '.join(missing)}", remedy="export it calibrated", file=source.path)
    time, force, height = (curve[name] for name in CHANNELS)
    depth = -1e9 * (height + force / stiffness)
    kept, warnings = usable(source, f"curve {number}", time, force, depth)
    time, force, depth = time[kept], force[kept], depth[kept]
    notes = (f"from {source.path.name}",)
    recording = Recording(time - time[0], 1e3 * force, depth - depth[0], str(number), notes)
    facts = {str(key): str(value) for key, value in curve.metadata.items() if key != "path"}
    return VendorTest(str(number), recording, facts, warnings, marked=False)


READER = Reader("afm", "AFM force curve (JPK, Igor, HDF5; by afmformats)", matches, read)
