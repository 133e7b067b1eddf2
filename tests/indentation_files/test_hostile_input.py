"""Files that are meant to do harm, or look as if: one clear line, soon, and nothing executed."""

import os
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest
import yaml

from indentation_files.readers import read_vendor_file
from indentation_files.recording_file import read_recording
from palpate.base.yaml_file import read_yaml
from palpate.cli.main import main
from palpate.configuration.study_file import study_from
from palpate.errors import InputError, PalpateError
from palpate.workflow_support import manifest

PALPATE = Path(sys.executable).parent / "palpate"
CONTENT_TYPES = (
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Override PartName="/xl/workbook.xml" ContentType='
    '"application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"/>'
    '<Override PartName="/xl/worksheets/sheet1.xml" ContentType='
    '"application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"/></Types>'
)
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
PACKAGE = "http://schemas.openxmlformats.org/package/2006/relationships"


def workbook(path, cells):
    """Write a workbook of one sheet whose cells are given as XML, a text or an iterable of bytes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("[Content_Types].xml", CONTENT_TYPES)
        root = f'<Relationship Id="r1" Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/>'
        archive.writestr("_rels/.rels", f'<Relationships xmlns="{PACKAGE}">{root}</Relationships>')
        sheet = '<sheet name="Test 001" sheetId="1" r:id="r1"/>'
        book = f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>{sheet}</sheets></workbook>'
        archive.writestr("xl/workbook.xml", book)
        own = f'<Relationship Id="r1" Type="{OFFICE}/worksheet" Target="worksheets/sheet1.xml"/>'
        archive.writestr("xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{PACKAGE}">{own}</Relationships>')
        with archive.open("xl/worksheets/sheet1.xml", "w", force_zip64=True) as stream:
            stream.write(f'<worksheet xmlns="{MAIN}"><sheetData>'.encode())
            for part in cells:
                stream.write(part)
            stream.write(b"</sheetData></worksheet>")
    return path


def dense(path):
    """Two cells, a whole sheet apart."""
    row = b'<row r="%d"><c r="%s%d"><v>1</v></c></row>'
    return workbook(path, [row % (1, b"A", 1), row % (1048576, b"XFD", 1048576)])


def bomb(path):
    """Small in the archive, gigabytes once unpacked."""
    return workbook(
        path, [b'<row r="1"><c r="A1" t="inlineStr"><is><t>', *[b" " * (1 << 24)] * 160, b"</t></is></c></row>"]
    )


@pytest.mark.faults(before="aborted without a word, exit code 134; 4.2 GB and minutes")
@pytest.mark.parametrize("make", [dense, bomb])
def test_a_workbook_that_grows_without_bound_is_refused_soon(tmp_path, make):
    path, began = make(tmp_path / "hostile.xlsx"), time.monotonic()
    with pytest.raises(InputError, match="is no whole Excel workbook"):
        read_vendor_file(path)
    assert time.monotonic() - began < 30.0


def table(path):
    """A force curve of a few kilobytes whose table is said to hold 80 GB."""
    h5py = pytest.importorskip("h5py")
    facts = {"imaging mode": "force-distance", "feedback mode": "contact", "spring constant": 0.05}
    with h5py.File(path, "w") as file:
        file.attrs.update({"software": "afmformats", "software version": "0.18.0"})
        file.create_group("0").attrs.update(facts)
        for name in ("time", "force", "height (measured)"):
            file["0"].create_dataset(name, (10**10,), "f8", chunks=(10**6,))
    return path


def archive(path):
    """A force curve whose archive unpacks to gigabytes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("header.properties", "type=x")
        with archive.open("segments/0/channels/height.dat", "w", force_zip64=True) as stream:
            for _ in range(65):
                stream.write(bytes(1 << 24))
    return path


@pytest.mark.faults(before="memory without bound")
@pytest.mark.parametrize("make", [table, archive])
def test_a_force_curve_that_grows_without_bound_is_refused_soon(tmp_path, make):
    pytest.importorskip("afmformats")
    path, began = make(tmp_path / "hostile.jpk-force"), time.monotonic()
    assert path.stat().st_size < 8e6
    with pytest.raises(InputError, match=r"cannot read it \(it takes more than 1 GB or 10 s to read\)"):
        read_vendor_file(path)
    assert time.monotonic() - began < 30.0


@pytest.mark.faults(before="memory without bound")
def test_aliases_that_multiply_are_refused(tmp_path):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 30)]
    (tmp_path / "study.yaml").write_text("\n".join(lines))
    with pytest.raises(InputError, match="once its aliases are filled in; write it without aliases"):
        read_yaml(tmp_path / "study.yaml")
    (tmp_path / "study.yaml").write_text("a: &a [*a]")
    with pytest.raises(InputError, match="aliases"):
        read_yaml(tmp_path / "study.yaml")


@pytest.mark.faults(before="gigabytes, or minutes")
@pytest.mark.parametrize("kind", ["study", "entries", "recording", "vendor", "lines"])
def test_what_is_far_too_long_is_refused_soon(tmp_path, kind):
    file, began = tmp_path / ("a_1.csv" if kind == "recording" else "study.yaml"), time.process_time()
    if kind == "entries":
        file.write_text("\n".join(f"k{number}: 1" for number in range(100_000)))
    elif kind == "lines":
        file.write_bytes(b"1\t2\t3\n" * 3_500_000)
    else:
        with file.open("wb") as stream:
            stream.truncate(20 << 30)  # a file that is all hole
    read = {"recording": read_recording, "vendor": read_vendor_file, "lines": read_vendor_file}.get(kind, read_yaml)
    with pytest.raises(
        InputError,
        match=f"{file.name}.*(longer than|larger than|more than 100000 entries|no format that palpate knows)",
    ):
        read(file)
    assert time.process_time() - began < 10.0


@pytest.mark.faults(before="passed palpate check, and failed or filled the memory after it")
@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"study": "x" * 300}, "study: .* 80 at most"),
        ({"study": "many\n"}, "study: .* is not allowed"),
        ({"recordings": {"tracking": "lab"}}, "'tracking' is reserved"),
        ({"recordings": {"sent.json": "lab"}}, "'sent.json' is reserved"),
        ({"study": "mlflow.db.lock"}, "'mlflow.db.lock' is reserved"),
        ({"parameters": {name: [1.0 + k / 1e3 for k in range(500)] for name in ("youngs_modulus", "yield_stress")}},
         "the levels make 250000 materials, more than 200000; give fewer levels, or design"),
        ({"design": {"kind": "sobol", "points": 10**9}}, "design.points: 1000000000 is given, expected 200000 or less"),
        ({"calibration": {"population": 10**12}}, "calibration.population: .* or less"),
    ],
)  # fmt: skip
def test_a_study_that_no_folder_or_memory_holds_is_refused(change, said):
    condition = {"name": "A", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}
    given = {
        "study": "many",
        "material": {"model": "bilinear_plasticity", "poisson_ratio": 0.3, "hardening": 0.1},
        "parameters": {"youngs_modulus": [2.0, 3.0], "yield_stress": [1.0, 2.0]},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "conditions": [condition],
    }
    with pytest.raises(InputError, match=said):
        study_from(given | change, "study.yaml")


@pytest.mark.faults(before="waited for ever")
@pytest.mark.parametrize("command", [["check"], ["read", "-o", "out"], ["draft", "-o", "out"], ["run"]])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path, command):
    os.mkfifo(tmp_path / "pipe")
    asked = [PALPATE, command[0], "pipe", *command[1:]]
    run = subprocess.run(asked, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert run.returncode == 2
    assert run.stderr.splitlines() == ["palpate: pipe: is no regular file; give a file"]


@pytest.mark.faults(before="a traceback")
@pytest.mark.parametrize("command", [["check", "study.yaml"], ["draft", "a.csv", "-o", "loop"]])
def test_a_folder_that_links_to_itself_is_named(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    Path("loop").symlink_to("loop")
    loads = [min(time, 60 - time) / 30 for time in range(61)]
    rows = [f"{time},{load},{400 * load**0.5}" for time, load in enumerate(loads)]
    Path("a.csv").write_text("\n".join(["time_s,load_mN,depth_nm", *rows]))
    condition = {"name": "A", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}
    given = {
        "study": "many",
        "material": {"model": "elastic", "poisson_ratio": 0.3},
        "parameters": {"youngs_modulus": [2.0, 2.5, 3.0, 3.5]},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "conditions": [condition],
        "recordings": {"lab": "loop"},
    }
    Path("study.yaml").write_text(yaml.safe_dump(given))
    assert main(command) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "loop" in line


@pytest.mark.faults(before="a traceback, exit code 1 or 120")
@pytest.mark.parametrize(("output", "code"), [("/dev/full", 2), ("&-", 1)])
def test_an_output_that_is_full_or_closed_costs_no_traceback(tmp_path, output, code):
    script = "from palpate.cli.main import main; import sys; sys.exit(main(['track']))"
    command = f'exec "$1" -c "$2" >{output}'
    (tmp_path / "results/s/tracking").mkdir(parents=True)
    (tmp_path / "results/s/tracking/run.json").write_text("{}")  # one that is listed
    found = subprocess.run(
        ["sh", "-c", command, "sh", sys.executable, script], cwd=tmp_path, capture_output=True, text=True
    )
    assert found.returncode == code
    assert len(found.stderr.splitlines()) == (code == 2)


@pytest.mark.faults(before="a traceback")
def test_a_path_that_no_system_accepts_is_refused(tmp_path):
    (tmp_path / "study.yaml").write_text('recordings: {lab: "a\\0b"}')
    with pytest.raises(InputError, match=r"line 1: is not valid YAML .*a text holds a zero byte"):
        read_yaml(tmp_path / "study.yaml")


@pytest.mark.faults(before="a traceback")
@pytest.mark.parametrize("left", ["[]", '{"configuration": 3, "files": []}', '{"configuration"', ""])
def test_a_damaged_manifest_is_named(tmp_path, left):
    (tmp_path / manifest.NAME).write_text(left)
    with pytest.raises(PalpateError, match=f"{manifest.NAME} is damaged"):
        manifest.changed(None, {}, tmp_path)


@pytest.mark.faults(before="held")
def test_nothing_in_a_study_is_executed(tmp_path):
    (tmp_path / "study.yaml").write_text(f"study: !!python/object/apply:os.mkdir [{tmp_path}/made]")
    with pytest.raises(InputError):
        read_yaml(tmp_path / "study.yaml")
    assert not (tmp_path / "made").exists()


@pytest.mark.faults(before="passed palpate check, stopped Snakemake")
def test_braces_in_a_title_are_a_title(tmp_path):
    from tiny_study import TINY, copied, planned

    study = TINY | {"title": "A {title} with {braces"}
    assert "report" in planned(copied(tmp_path), study=study)
    assert yaml.safe_load((tmp_path / "study.yaml").read_text())["title"] == study["title"]


@pytest.mark.faults(before="passed palpate check, stopped Snakemake")
def test_a_set_of_conditions_may_be_called_like_another_with_an_ending(tmp_path):
    from tiny_study import TINY, copied, planned

    study = TINY | {"condition_sets": {"all.small": ["T030"], "T030": ["T030"]}}
    assert {"calibration", "calibration_on_all"} <= set(planned(copied(tmp_path), study=study))
