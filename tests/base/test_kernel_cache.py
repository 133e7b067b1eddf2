"""Where compiled kernels are kept when neither the package nor the home folder can be written."""

import os
import re
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core import caching

from palpate.base import checked_kernels, kernel_cache
from palpate.errors import InputError

SOURCE = kernel_cache.PACKAGE
READ_ONLY = 'mount --bind "$1" "$1" && mount -o remount,ro,bind "$1" && shift && exec "$@"'
NAMESPACE = ("unshare", "--mount", "--map-root-user", "sh", "-c", READ_ONLY, "sh")
KERNELS = "import os, palpate.solver.axisymmetric.march_cases; print(os.environ['NUMBA_CACHE_DIR'])"
SPECIFICATION = """
material: {model: elastic, youngs_modulus: 3.0, poisson_ratio: 0.3}
indenter: {shape: cone, half_angle: 70.3}
protocol: {max_load: 1.0, loading_time: 1, unloading_time: 1}
"""


@pytest.fixture
def read_only(tmp_path):
    """Return a function that runs Python with a package and a home that are mounted read-only."""
    fixed, temporary = tmp_path / "fixed", tmp_path / "temporary"
    temporary.mkdir()
    (fixed / "home").mkdir(parents=True)
    (fixed / "specification.yaml").write_text(SPECIFICATION)
    shutil.copytree(SOURCE, fixed / "palpate", ignore=shutil.ignore_patterns("__pycache__"))
    kept = {key: value for key, value in os.environ.items() if key not in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME")}
    environment = kept | {"HOME": str(fixed / "home"), "TMPDIR": str(temporary), "PYTHONPATH": str(fixed)}

    def run(*arguments, **changes):
        command = [*NAMESPACE, str(fixed), *arguments]
        return subprocess.run(command, env=environment | changes, cwd=temporary, capture_output=True, text=True)

    try:
        usable = run("touch", str(fixed / "x")).returncode != 0 and run("touch", str(temporary / "x")).returncode == 0
    except OSError:
        usable = False
    if not usable:
        pytest.skip("this system lets nobody mount a folder read-only in a namespace of its own")
    return run


@pytest.mark.faults(before="RuntimeError: no locator available")
@pytest.mark.slow
def test_with_package_and_home_read_only_kernels_are_kept_in_a_folder_of_the_user(read_only, tmp_path):
    found = read_only(sys.executable, "-c", KERNELS)
    assert found.returncode == 0, found.stderr
    kept = Path(found.stdout.strip())
    assert kept.parent == tmp_path / f"temporary/palpate-kernels-{os.getuid()}"
    assert stat.S_IMODE(kept.parent.stat().st_mode) == 0o700
    assert list(kept.iterdir())


@pytest.mark.faults(before="RuntimeError: no locator available")
def test_where_nothing_can_be_written_one_line_names_the_remedy(read_only, tmp_path):
    (tmp_path / f"temporary/palpate-kernels-{os.getuid()}").symlink_to(tmp_path)
    asked = read_only(
        sys.executable, "-m", "palpate.cli.main", "simulate", "../fixed/specification.yaml", "-o", "curve.csv"
    )
    assert asked.returncode == 2
    assert len(asked.stderr.splitlines()) == 1
    assert "set NUMBA_CACHE_DIR to a folder of yours" in asked.stderr


@pytest.mark.faults(before="RuntimeError: no locator available")
def test_a_given_folder_that_cannot_be_written_is_named(read_only, tmp_path):
    given = str(tmp_path / "fixed/kernels")
    found = read_only(sys.executable, "-c", KERNELS, NUMBA_CACHE_DIR=given)
    assert f"NUMBA_CACHE_DIR is {given}, which cannot be written; set" in found.stderr.splitlines()[-1]


def test_a_given_folder_holds_one_for_each_state_of_the_sources(monkeypatch, tmp_path):
    monkeypatch.setenv(kernel_cache.VARIABLE, str(tmp_path / "given"))
    monkeypatch.setattr(kernel_cache, "PACKAGE", tmp_path)
    (tmp_path / "materials").mkdir()
    found = []
    for source in ("x = 1", "x = 2", "x = 1"):
        (tmp_path / "materials/law.py").write_text(source)
        kernel_cache.choose()
        found.append(Path(os.environ[kernel_cache.VARIABLE]))
    assert {folder.parent for folder in found} == {tmp_path / "given"}
    assert found[0] == found[2] != found[1]


@pytest.fixture
def nowhere_else(monkeypatch, tmp_path):
    """Leave the folder for temporary files alone: a file is where the package's and the user's own should be."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(kernel_cache.VARIABLE, "unset at the end")
    monkeypatch.delenv(kernel_cache.VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(kernel_cache, "PACKAGE", tmp_path / "file")
    monkeypatch.setattr(kernel_cache.tempfile, "tempdir", str(tmp_path))
    return tmp_path / f"palpate-kernels-{os.getuid()}"


def test_the_temporary_folder_is_the_last_choice(nowhere_else):
    kernel_cache.choose()
    kernel_cache.require()
    assert Path(os.environ[kernel_cache.VARIABLE]).parent == nowhere_else


@pytest.mark.parametrize("planted", ["link", "file", "open to others", "another user's"])
def test_what_somebody_else_may_have_planted_is_refused(nowhere_else, planted):
    if planted == "link":
        nowhere_else.symlink_to(nowhere_else.parent)
    elif planted == "file":
        nowhere_else.write_text("")
    elif planted == "open to others":
        nowhere_else.mkdir()
        nowhere_else.chmod(0o777)
    else:
        nowhere_else.mkdir(mode=0o700)
        try:
            os.chown(nowhere_else, os.getuid() + 1, -1)
        except PermissionError:
            pytest.skip("only root can give a folder to somebody else")
    kernel_cache.choose()
    assert kernel_cache.VARIABLE not in os.environ
    with pytest.raises(InputError, match=f"{nowhere_else.name}: they are read-only, or another user's; set NUMBA"):
        kernel_cache.require()


@pytest.mark.faults(before="a traceback at every start, or machine code as it was altered")
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("fault", ["empty", "cut", "altered"])
@pytest.mark.slow
def test_a_damaged_kernel_is_compiled_again(tmp_path, ending, fault):
    index = checked_kernels.CheckedCacheFile(str(tmp_path), "kernel", "stamp")
    index.save("key", ("machine code",))
    assert index.load("key") == ("machine code",)
    (file,) = tmp_path.glob(f"*.{ending}")
    whole = file.read_bytes()
    altered = whole[:40] + bytes([whole[40] ^ 1]) + whole[41:]
    file.write_bytes({"empty": b"", "cut": whole[:-3], "altered": altered}[fault])
    assert index.load("key") in (None, ("machine code",) if ending == "nbi" else None)
    index.save("key", ("machine code",))
    assert index.load("key") == ("machine code",)


def test_kernels_are_kept_with_their_checksums():
    assert caching.IndexDataCacheFile is checked_kernels.CheckedCacheFile


def test_every_folder_that_holds_kernels_is_hashed_and_asks_first_whether_they_can_be_kept():
    files = [f for f in SOURCE.rglob("*.py") if f not in kernel_cache.FORM]
    holding = [f for f in files if re.search("(numba|inner_kernel) import", f.read_text())]
    folders = {file.relative_to(SOURCE).parent.as_posix() for file in holding}
    assert folders | {"materials"} == set(kernel_cache.SOURCES)  # laws hold kernels of their own
    for folder in folders:
        asks = [SOURCE / folder / "__init__.py", SOURCE / folder.split("/")[0] / "__init__.py"]
        assert any("kernel_cache.require()" in file.read_text() for file in asks)
