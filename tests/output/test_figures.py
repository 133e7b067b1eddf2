"""Figures for papers: names that readers know, type of 7 pt, lines that print in grey, numbers and caption beside."""

import re

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from PIL import Image
from results_of import diagnosis, saved

from palpate.output.figures import curves, misfit_map, search_history
from palpate.output.figures.catalogue import FIGURES
from palpate.output.figures.curve_panels import of_fit
from palpate.output.figures.style import ACCEPTED, BASE, LOOK, SERIES, SMALLEST, drawn
from palpate.output.written_figures import write_figures

WIDTH = 3.5


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("figures")
    write_figures([saved(place, diagnosis())], place / "all", ("svg", "png", "pdf"), WIDTH)
    return place / "all"


def test_every_figure_is_one_file_with_numbers_and_caption_beside_it(folder):
    names = {*(f"lab_{name}" for name, each in FIGURES.items() if not each.of_study), "surrogates"}
    names -= {"lab_uniaxial", "lab_imprint"}  # of a study with further evidence
    for ending in ("svg", "png", "pdf", "csv", "txt"):
        assert {file.stem for file in folder.glob(f"*.{ending}")} == names
    for file in folder.glob("*.txt"):
        assert file.read_text().count(".") >= 1 and len(pd.read_csv(file.with_suffix(".csv")))


def test_type_is_large_enough_and_names_are_those_of_readers(folder):
    for file in folder.glob("*.svg"):
        text = file.read_text()
        sizes = [float(size) for size in re.findall(r"<text [^>]*font-size: ([\d.]+)px", text)]  # indices are smaller
        shrunk = float(re.search(r'width="([\d.]+)pt"', text)[1]) / float(re.search(r'viewBox="0 0 ([\d.]+)', text)[1])
        assert min(sizes) * shrunk >= SMALLEST - 0.01, (file.name, sizes)
    assert "1 mN, 30 s" in (folder / "lab_curves.svg").read_text()


def test_width_and_resolution_are_as_asked(folder):
    for file in folder.glob("*.png"):
        with Image.open(file) as picture:
            assert picture.width / WIDTH >= 299.9, file.name
    assert 'width="252pt"' in (folder / "lab_curves.svg").read_text()


def test_the_two_models_are_told_apart_in_grey_print(folder):
    light = {key: luminance(look["color"]) for key, look in (("base", BASE), ("accepted", ACCEPTED))}
    assert light["base"] - light["accepted"] > 0.2 and BASE["linestyle"] != ACCEPTED["linestyle"]
    for name in ("lab_curves", "lab_residuals"):
        drawn_ = (folder / f"{name}.svg").read_text()
        assert "stroke-dasharray" in drawn_ and BASE["color"] in drawn_ and ACCEPTED["color"] in drawn_


def luminance(colour):
    return float(np.array(to_rgb(colour)) ** 2.2 @ [0.2126, 0.7152, 0.0722])


def test_synthetic_recordings_are_marked_with_and_without_a_title(folder, tmp_path):
    write_figures([saved(tmp_path, diagnosis())], tmp_path, titles=False)
    bare, titled = ((place / "lab_curves.svg").read_text() for place in (tmp_path, folder))
    assert "Recorded and simulated curves" in titled and "Recorded and simulated curves" not in bare
    assert "synthetic recordings" in titled and "synthetic recordings" in bare
    write_figures([saved(tmp_path, diagnosis(), synthetic=False)], tmp_path)
    assert "synthetic" not in (tmp_path / "lab_curves.svg").read_text()


def test_files_are_the_same_whenever_their_content_is(folder, tmp_path):
    write_figures([saved(tmp_path, diagnosis())], tmp_path / "again", ("svg", "png", "pdf"), WIDTH)
    for file in folder.iterdir():
        assert (tmp_path / "again" / file.name).read_bytes() == file.read_bytes(), file.name


def test_drawing_leaves_the_settings_of_matplotlib_alone(tmp_path):
    before = dict(matplotlib.rcParams)
    style = tmp_path / "mine.mplstyle"
    style.write_text("lines.linewidth: 3\n")
    write_figures([saved(tmp_path, diagnosis())], tmp_path, style=style)
    assert dict(matplotlib.rcParams) == before


def test_parameters_are_drawn_with_symbol_and_unit(folder):
    text = (folder / "lab_parameters.svg").read_text()
    assert "Young's" in text and "accepted" in text and "GPa" in text


@pytest.mark.parametrize(("objective", "unit"), [("mean_square", "nm$^2$"), ("relative", "-")])
def test_convergence_is_drawn_with_its_unit(tmp_path, objective, unit):
    found = saved(tmp_path)
    content = found.calibrations["all"] | {"settings": {"objective": objective}}
    numbers = search_history.table(saved(tmp_path, calibrations={"all": content}))
    with matplotlib.rc_context(LOOK):
        figure = drawn(search_history.draw, numbers)
    assert figure.axes[0].get_ylabel().endswith(f"[{unit}]")


def test_series_are_told_apart_by_who_confuses_red_and_green():
    """As a deuteranope sees them: G. M. Machado et al., IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, severity 1."""
    seen = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])
    light = np.array([to_rgb(colour) for colour in SERIES]) ** 2.2
    colours = (light @ seen.T).clip(0.0, 1.0) ** (1 / 2.2)
    apart = np.linalg.norm(colours[:, None] - colours, axis=2)
    assert apart[np.triu_indices(len(SERIES), 1)].min() > 0.15


def test_the_map_of_misfits_says_what_is_significant(tmp_path):
    numbers = misfit_map.table(saved(tmp_path, diagnosis()))
    assert "A dot and bold type mark q < 0.05" in misfit_map.caption(numbers)
    assert "No part alone is significant" in misfit_map.caption(numbers.assign(q_value=1.0))
    assert "-5.0 nm, early in the loading of 1 mN, 30 s" in misfit_map.seen(numbers)


def test_a_load_under_displacement_control_is_drawn_over_time():
    fit = pd.DataFrame({"condition": "A", "role": "calibrate", "time_s": [1.0, 2.0], "displacement_nm": [5.0, 9.0]})
    fit = fit.assign(recorded_mN=[0.1, 0.2], simulated_mN=[0.1, 0.21], spread_mN=0.01, surrogate_mN=0.1)
    with matplotlib.rc_context(LOOK):
        (axis,) = drawn(curves.draw, of_fit(fit)).axes
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("time [s]", "load [mN]")
