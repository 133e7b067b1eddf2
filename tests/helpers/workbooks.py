"""An Excel workbook of numbers and words, written with nothing but the standard library."""

import zipfile
from itertools import repeat
from xml.sax.saxutils import escape, quoteattr

RELATIONS = "http://schemas.openxmlformats.org/package/2006/relationships"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
CONTENT = "application/vnd.openxmlformats-officedocument.spreadsheetml"


def write_workbook(path, sheets):
    """Write the `sheets`, rows of cells by name, as an .xlsx file; None and an empty text make no cell.

    A cell (number, format) is shown in that format, such as ``h:mm:ss``.
    """
    names = dict(enumerate(sheets, 1))
    styles = list(dict.fromkeys(c[1] for rows in sheets.values() for row in rows for c in row if isinstance(c, tuple)))
    overrides = {f"/xl/worksheets/sheet{k}.xml": "worksheet" for k in names} | {"/xl/workbook.xml": "sheet.main"}
    overrides["/xl/styles.xml"] = "styles"
    parts = {
        "[Content_Types].xml": '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        + "".join(f'<Override PartName="{p}" ContentType="{CONTENT}.{t}+xml"/>' for p, t in overrides.items())
        + "</Types>",
        "_rels/.rels": _relations({1: ("officeDocument", "xl/workbook.xml")}),
        "xl/_rels/workbook.xml.rels": _relations(
            {k: ("worksheet", f"worksheets/sheet{k}.xml") for k in names} | {len(names) + 1: ("styles", "styles.xml")}
        ),
        "xl/styles.xml": f'<styleSheet xmlns="{MAIN}"><numFmts>'
        + "".join(f'<numFmt numFmtId="{k}" formatCode={quoteattr(style)}/>' for k, style in enumerate(styles, 164))
        + '</numFmts><cellXfs><xf numFmtId="0"/>'
        + "".join(f'<xf numFmtId="{k}"/>' for k in range(164, 164 + len(styles)))
        + "</cellXfs></styleSheet>",
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>'
        + "".join(f'<sheet name={quoteattr(name)} sheetId="{k}" r:id="rId{k}"/>' for k, name in names.items())
        + "</sheets></workbook>",
    }
    for k, rows in enumerate(sheets.values(), 1):
        lines = [
            f'<row r="{n}">{"".join(map(_cell, row, _letters(n), repeat(styles)))}</row>'
            for n, row in enumerate(rows, 1)
        ]
        parts[f"xl/worksheets/sheet{k}.xml"] = (
            f'<worksheet xmlns="{MAIN}"><sheetData>{"".join(lines)}</sheetData></worksheet>'
        )
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in parts.items():
            archive.writestr(name, '<?xml version="1.0" encoding="UTF-8"?>' + text)
    return path


def _letters(row):
    return [f"{letter}{row}" for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ"]


def _cell(value, place, styles):
    if value is None or value == "":
        return ""
    if isinstance(value, str):
        return f'<c r="{place}" t="inlineStr"><is><t xml:space="preserve">{escape(value)}</t></is></c>'
    if isinstance(value, tuple):
        return f'<c r="{place}" s="{styles.index(value[1]) + 1}"><v>{value[0]!r}</v></c>'
    return f'<c r="{place}"><v>{value!r}</v></c>'


def _relations(targets):
    entries = (f'<Relationship Id="rId{k}" Type="{OFFICE}/{t}" Target="{p}"/>' for k, (t, p) in targets.items())
    return f'<Relationships xmlns="{RELATIONS}">{"".join(entries)}</Relationships>'
