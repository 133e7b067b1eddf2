"""In which order the tests run and where, and what several files ask of the solver and the command line."""

import pytest

from palpate.base.threads import one_thread_each

one_thread_each()

from palpate.cli.main import main  # noqa: E402
from palpate.laboratory import virtual  # noqa: E402
from palpate.solver.axisymmetric import similar  # noqa: E402


def pytest_configure(config):
    """Let each file's tests run in one process, where several processes run; `--dist` alone would stop benchmarks."""
    if config.option.dist == "load":
        config.option.dist = "loadfile"


LONGEST = (
    "test_mechanisms",
    "test_default_study",
    "test_mesh_error",
    "test_document_commands",
    "test_run",
    "test_soak",
    "test_calibration",
)
WITHOUT_KERNELS = ("test_contact", "test_readers")
FIRST = ("test_workflow", *WITHOUT_KERNELS, *LONGEST)


def pytest_collection_modifyitems(items):
    """Begin the longest files first, so that one process does them while the others do the rest.

    The workflow's compile the kernels, beside what needs none, so that two processes do not compile the same ones.
    """
    items.sort(
        key=lambda item: next((k for k, name in enumerate(FIRST) if item.path.name.startswith(name)), len(FIRST))
    )
    for item in items:
        if fault := item.get_closest_marker("faults"):
            item.user_properties.append(("before", fault.kwargs["before"]))


def pytest_terminal_summary(terminalreporter, config):
    """Print what faults did before and do now, where they are asked for: `pytest -m faults`, `-m slow`, `.ci/run`."""
    if config.option.markexpr not in ("faults", "slow", "not browser"):
        return
    rows = []
    for outcome, now in (("passed", "as it says"), ("failed", "FAILED"), ("skipped", "not tried here")):
        for report in terminalreporter.stats.get(outcome, []):
            before = dict(report.user_properties).get("before")
            if before and (report.when == "call" or outcome == "skipped"):
                name = report.nodeid.partition("::test_")[2].replace("_", " ")
                rows.append(f"| {name} | {before} | {now} | {report.duration:.1f} |")
    if rows:
        terminalreporter.write_line("\n".join(["", "| fault | before | now | s |", "|---|---|---|---|", *rows]))


@pytest.fixture
def simulated(monkeypatch):
    """Return how many cases each run of the solver was given."""
    counts, batch = [], similar.indent_batch

    def counting(cases, perturbed=()):
        counts.append(len(cases))
        return batch(cases, perturbed)

    monkeypatch.setattr(similar, "indent_batch", counting)
    return counts


TRUTHS = {}


@pytest.fixture
def truth_once(monkeypatch):
    """Let virtual laboratories simulate a truth once, for tests of what is made of its curves."""
    exact = virtual.exact_curves

    def once(study, settings):
        key = (study.name, study.points, len(study.conditions), str(settings.parameters))
        if key not in TRUTHS:
            TRUTHS[key] = exact(study, settings)
        return TRUTHS[key]

    monkeypatch.setattr(virtual, "exact_curves", once)


@pytest.fixture
def refused(capsys):
    """Return what a command says in one line, which is refused with exit code 2."""

    def run(*arguments):
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as leaving:
            code = leaving.code
        lines = capsys.readouterr().err.splitlines()
        assert code == 2
        assert len(lines) == 1, lines
        return lines[0]

    return run
