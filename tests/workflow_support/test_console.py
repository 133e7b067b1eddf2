"""What the terminal shows while a study runs: plain lines or one that is written over, and the answer at the end."""

import io
import json

import pytest
from results_of import diagnosis, saved

from palpate.output.results.answer import Answer
from palpate.workflow_support import console


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    (tmp_path / "kernel.nbi").touch()
    study = tmp_path / "results/s"
    (study / "surrogates").mkdir(parents=True)
    for name, error in (("A", 0.05), ("B", 0.21)):
        (study / f"surrogates/{name}.json").write_text(json.dumps({"unit": "nm", "loo_rmse_nm": error}))
    answer = Answer(saved(tmp_path, diagnosis())).to_mapping()
    (study / "report.json").write_text(json.dumps({"sets": [answer]}))
    return study


def shown(folder, monkeypatch, whole=True, terminal=False):
    monkeypatch.setattr(console, "_plans", [console.Plan(folder, {"surrogate": 60.0}, 1, lambda: whole)])
    stream = io.StringIO()
    view = console.Console(stream)
    if terminal:
        monkeypatch.setattr(console.Console, "_terminal", True)
        monkeypatch.setattr("os.get_terminal_size", lambda _: type("Size", (), {"columns": 60}))
        stream.fileno = lambda: 1
    view.planned({"surrogate": 2})
    for job, name in enumerate(("A", "B")):
        view.started(job, "surrogate", f"surrogate of {name}", [str(folder / f"surrogates/{name}.json")])
        view.finished(job)
    view.done()
    view.done()
    return stream.getvalue()


def test_without_a_terminal_each_job_is_a_line_and_the_answer_comes_once(folder, monkeypatch):
    lines = shown(folder, monkeypatch).splitlines()
    assert lines[0] == "2 jobs, about 2 min"
    assert lines[1].startswith("1 of 2 jobs, about ") and lines[1].endswith(" left: surrogate of A")
    assert lines[2:4] == ["worst surrogate error 0.21 nm, B", "2 of 2 jobs: surrogate of B"]
    assert [line.split()[0] for line in lines[4:]] == ["law", "verdict", "parameters", "error", "report"]
    assert "palpate ui" in lines[-1]


def test_for_another_target_there_is_no_answer(folder, monkeypatch):
    assert "verdict" not in shown(folder, monkeypatch, whole=False)


def test_in_a_terminal_the_progress_is_one_line_that_fits(folder, monkeypatch):
    text = shown(folder, monkeypatch, terminal=True)
    progress = [part for part in text.split("\r\x1b[K") if " of 2 jobs" in part and "\n" not in part]
    assert len(progress) >= 3 and all(len(part) < 60 for part in progress)


def test_a_machine_without_kernels_compiles_once(folder, monkeypatch):
    for file in folder.parents[1].glob("*.nbi"):
        file.unlink()
    first, *_ = shown(folder, monkeypatch).splitlines()
    assert "compiling, once" in first


@pytest.mark.parametrize(("compiled", "left"), [(True, "2 min"), (False, "60 s")])
def test_what_is_left_does_not_grow_by_what_is_compiled_once(folder, monkeypatch, compiled, left):
    """The first of two jobs of 60 s each ends after 150 s, 90 s of them for compilation where nothing was compiled."""
    if not compiled:
        (folder.parents[1] / "kernel.nbi").unlink()
    clock = [0.0]
    monkeypatch.setattr(console.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(console, "_plans", [console.Plan(folder, {"surrogate": 60.0}, 1, lambda: True)])
    view = console.Console(io.StringIO())
    view.planned({"surrogate": 2})
    view.started(0, "surrogate", "surrogate of A", [])
    clock[0] = 150.0
    view.finished(0)
    assert f"1 of 2 jobs, about {left} left" in view.stream.getvalue()
