"""``palpate figures``: what it refuses in one line."""

import pytest

from palpate.cli.figures_command import _width
from palpate.cli.main import main


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--format", "gif"], "'gif' is no format; use some of: pdf, svg, png"),
        (["--width", "wide"], "'wide' is not a width from 1.5 to 20 inches, such as 3.5 or 90mm"),
        (["--width", "0.2"], "'0.2' is not a width"),
        (["--style", "none.mplstyle"], "none.mplstyle, --style: is no file; give a style sheet of Matplotlib"),
        ([], "'nothing' is no file, and results holds no study of that name; run one first: palpate run STUDY.yaml"),
    ],
)
def test_bad_input_is_one_line(arguments, words, refused, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert words in refused("figures", "nothing", *arguments)


def test_missing_results_are_named_with_the_remedy(refused, tmp_path, monkeypatch):
    from study_file import load

    monkeypatch.chdir(tmp_path)
    load(tmp_path)
    line = refused("figures", "study.yaml")
    assert "results/s/surrogates/P1_T30.json" in line and "run the study first" in line


def test_widths_are_inches_or_millimetres():
    assert [_width(text) for text in ("3.5", "90mm", "9cm", "7in")] == pytest.approx([3.5, 90 / 25.4, 9 / 2.54, 7.0])


def test_commands_draw_files_whatever_a_notebook_asks_for(monkeypatch, tmp_path, refused):
    import os

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    assert main(["track"]) == 0
    assert os.environ["MPLBACKEND"] == "Agg"
