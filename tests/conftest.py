"""In which order the tests run."""


def pytest_collection_modifyitems(items):
    """Begin the longest file first, so that one process does it while the others do the rest."""
    items.sort(key=lambda item: item.path.name != "test_workflow.py")
