"""In which order the tests run and where, and what several files ask of the solver."""

import pytest

from palpate.base.threads import one_thread_each

one_thread_each()

from palpate.solver.axisymmetric import similar  # noqa: E402


def pytest_configure(config):
    """Let each file's tests run in one process, where several processes run; `--dist` alone would stop benchmarks."""
    if config.option.dist == "load":
        config.option.dist = "loadfile"


def pytest_collection_modifyitems(items):
    """Begin the longest file first, so that one process does it while the others do the rest."""
    items.sort(key=lambda item: item.path.name != "test_workflow.py")


@pytest.fixture
def simulated(monkeypatch):
    """Return how many cases each run of the solver was given."""
    counts, batch = [], similar.indent_batch

    def counting(cases, beside=()):
        counts.append(len(cases))
        return batch(cases, beside)

    monkeypatch.setattr(similar, "indent_batch", counting)
    return counts
