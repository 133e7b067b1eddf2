# What all rules share: the checked study, its plan of snapshots, and the identity of this execution.
import datetime
import functools
import os
import re
import sys
from pathlib import Path

os.environ.setdefault(
    "PALPATE_EXECUTION", datetime.datetime.now().strftime("%Y-%m-%d %H:%M:%S")
)
os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
os.environ.setdefault("DO_NOT_TRACK", "true")
SOURCE = [str(Path(workflow.basedir) / "src"), str(workflow.basedir)]
os.environ.update(
    PYTHONPATH=os.pathsep.join(filter(None, [*SOURCE, os.environ.get("PYTHONPATH")]))
)
sys.path[:0] = SOURCE  # so that what is planned here is what scripts compute

from palpate.base.threads import one_thread_each

one_thread_each()

from palpate.errors import InputError


def refuse(problem):
    """End the execution with one line."""
    print(f"palpate: {problem}", file=sys.stderr)
    sys.exit(2)


try:
    from palpate.solver import store
except InputError as error:  # compiled kernels can be kept nowhere
    refuse(error)

from palpate.workflow_support.check_study import checked_study
from palpate.base.fingerprint import fingerprint
from palpate.inference.study_recordings import files_of
from palpate.base.yaml_file import read_yaml

STUDY_FILE = (
    str(workflow.configfiles[-1]) if workflow.configfiles else "config/config.yaml"
)
DATA = config.get("data") if workflow.configfiles else None
COMMAND_LINE = {  # what --config takes, and the rules that it is for
    "data": "data=FILE",
    "quick": "quick=1 (verification)",
    "reference": "reference=FOLDER (verification)",
}

if others := set(workflow.config_settings.config) - set(COMMAND_LINE):
    refuse(
        f"--config {' '.join(sorted(others))}: only {', '.join(COMMAND_LINE.values())} may be given there; "
        "write the study's keys in its file"
    )


@functools.cache
def checked(file, data):
    """The study in `file`, checked; a mistake ends the execution with one line."""
    try:
        return checked_study(file, data)
    except InputError as error:
        refuse(error)


def vendor_file(wildcards):
    """The file behind a study of config/real, which is checked first."""
    file = f"{workflow.basedir}/config/real/{wildcards.real}.yaml"
    return checked(file, config.get("data")).source["file"]


def real_pages(wildcards):
    """The pages of all studies in config/real, which are read when they are asked for."""
    for name in REAL:
        source = read_yaml(f"{workflow.basedir}/config/real/{name}.yaml")["source"]
        yield f"results/{name}/{source['recordings']}/diagnosis.html"


def reference_curves(wildcards):
    """The files of the folder of reference curves, where one is given."""
    folder = config.get("reference")
    if folder and not Path(folder).is_dir():
        refuse(
            InputError(
                "the folder is missing", remedy="give a folder of curves", file=folder
            )
        )
    return sorted(map(str, Path(folder).glob("*.csv"))) if folder else []


STUDY = checked(STUDY_FILE, DATA)
FOLDER = f"results/{STUDY.name}"
BATCHES = store.plan(STUDY)
CALIBRATED = [
    condition.name for condition in STUDY.conditions if condition.role == "calibrate"
]
DIAGNOSED = list(STUDY.recordings) if STUDY.diagnosis["enabled"] else []


def code(script):
    """The identity of a script in this file's repository, and of all that it imports."""
    return fingerprint(Path(workflow.basedir) / script)


def curves(values, accuracy):
    """What the recordings of every condition are compared with: address and role of the curve at `values`."""
    return [
        (
            condition.name,
            condition.role,
            store.address(STUDY.specification(values, condition, accuracy)),
        )
        for condition in STUDY.conditions
    ]


wildcard_constraints:
    case=r"case_\d+",
    recordings="|".join(map(re.escape, STUDY.recordings)) or "none",
    condition="|".join(map(re.escape, CALIBRATED)),
    condition_set="|".join(map(re.escape, STUDY.condition_sets)),
