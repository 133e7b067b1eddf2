"""Workbooks made for the test: units of the right quantity, sheets without rows, names that look alike."""

import zipfile
from xml.sax.saxutils import escape, quoteattr

import pytest

from palpate.cli import main
from palpate.errors import InputError
from palpate.readers import read_vendor_file
from palpate.recording import read_recording

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
LINKS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006/relationships"
KLA = {"Markers": "", "Time": "s", "Load": "mN", "Depth": "nm"}
XP = {
    "Displacement Into Surface": "nm", "Load On Sample": "mN", "Time On Sample": "s", "Frame Stiffness": "N/m",
    "Harmonic Contact Stiffness": "N/m", "Harmonic Stiffness": "N/m", "Raw Displacement": "um", "Raw Load": "mN",
}  # fmt: skip


def cell(value):
    if isinstance(value, str):
        return f'<c t="inlineStr"><is><t>{escape(value)}</t></is></c>'
    return f"<c><v>{value}</v></c>"


def write_workbook(path, sheets):
    """Write the least that is an Excel workbook: rows of text and numbers by the names of the sheets."""
    listed = "".join(f'<sheet name={quoteattr(n)} sheetId="{k}" r:id="r{k}"/>' for k, n in enumerate(sheets, 1))
    parts = {
        "_rels/.rels": links(["xl/workbook.xml"], "officeDocument"),
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{LINKS}"><sheets>{listed}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": links([f"worksheets/{k}.xml" for k in range(1, len(sheets) + 1)], "worksheet"),
    }
    for k, rows in enumerate(sheets.values(), 1):
        data = "".join(f"<row>{''.join(map(cell, row))}</row>" for row in rows)
        parts[f"xl/worksheets/{k}.xml"] = f'<worksheet xmlns="{MAIN}"><sheetData>{data}</sheetData></worksheet>'
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return path


def links(targets, kind):
    listed = "".join(f'<Relationship Id="r{k}" Type="{LINKS}/{kind}" Target="{t}"/>' for k, t in enumerate(targets, 1))
    return f'<Relationships xmlns="{PACKAGE}">{listed}</Relationships>'


def sheet(units):
    return [
        list(units),
        list(units.values()),
        *([k or "" if name == "Markers" else k for name in units] for k in range(40)),
    ]


@pytest.mark.parametrize(
    ("channels", "name", "unit", "known"),
    [
        *((KLA, "Load", unit, "mN, uN, nN, N") for unit in ("ms", "s", "nm", "N/m")),
        *((KLA, "Depth", unit, "nm, um, mm, m, A") for unit in ("mN", "N/m", "nm/s")),
        (KLA, "Time", "nm", "s, sec, ms, min, h"),
        (XP, "Load On Sample", "nm", "mN, uN, nN, N"),
        (XP, "Harmonic Contact Stiffness", "nm", "N/m"),
        (XP, "Frame Stiffness", "nm", "N/m"),
    ],
)
def test_a_unit_of_another_quantity_is_refused(tmp_path, channels, name, unit, known):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": sheet(channels)})
    assert len(read_vendor_file(file)) == 1
    write_workbook(file, {"Test 1": sheet(channels | {name: unit})})
    with pytest.raises(InputError, match=f"x.xlsx, sheet Test 1: {name} is in '{unit}'; export it in one of: {known}$"):
        read_vendor_file(file)


@pytest.mark.parametrize("head", [["t,P,h"], ["t,P,h", "s,uN,nm"]])
def test_a_sheet_without_rows_does_no_harm_to_the_others(tmp_path, head, capsys):
    named = [row.split(",") for row in head]
    good = [*named, *([k, k, k] for k in range(40))]
    columns = ["--columns", "time=t,load=P,depth=h", "-o", str(tmp_path / "out")]
    file = write_workbook(tmp_path / "x.xlsx", {"A": named, "B": good, "C": []})
    assert main(["read", str(file), *columns]) == 0
    assert main(["read", str(file), "--test", "B", *columns]) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["B.csv"]
    for rows in (named, []):
        write_workbook(file, {"A": rows})
        assert main(["read", str(file), *columns]) == 2
        assert "holds no table with numbers in the columns t, P, h" in capsys.readouterr().err


def test_sheets_whose_names_look_alike_are_all_written(tmp_path):
    names = ["Prüfung 1", "Pr_fung_1", "Pr_fung_1_2", "Pr_fung_1_3"]
    tables = {name: [["t", "P", "h"], [0, 0, 0], [1, k, 1]] for k, name in enumerate(names, 1)}
    file = write_workbook(tmp_path / "x.xlsx", tables)
    assert main(["read", str(file), "--columns", "time=t,load=P,depth=h", "-o", str(tmp_path / "out")]) == 0
    loads = sorted(read_recording(path).load.max() for path in (tmp_path / "out").iterdir())
    assert loads == [1, 2, 3, 4]
