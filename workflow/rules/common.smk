# What all rules share: the checked study, its plan of snapshots, and the identity of this execution.
import datetime
import functools
import os
import re
import shlex
import sys
from dataclasses import replace
from pathlib import Path

EXECUTION = os.environ.setdefault(
    "PALPATE_EXECUTION", datetime.datetime.now().strftime("%Y-%m-%d %H:%M:%S")
)
HERE = Path(workflow.current_basedir).parents[1]
SOURCE = [str(HERE / "src"), str(HERE)]
os.environ.update(
    PYTHONPATH=os.pathsep.join(filter(None, [*SOURCE, os.environ.get("PYTHONPATH")])),
    MPLBACKEND="Agg",  # figures are files, whatever a notebook's kernel asks for
)
sys.path[:0] = SOURCE  # so that what is planned here is what scripts compute
# Snakemake puts it into shell commands as it is, spaces and all.
sys.executable = shlex.quote(sys.executable)

from palpate.base.threads import one_thread_each

one_thread_each()

from palpate.errors import InputError, PalpateError, of_system


def refuse(problem):
    """End the execution with one line."""
    print(f"palpate: {problem}", file=sys.stderr)
    sys.exit(2)


try:
    from palpate.solver import store
except InputError as error:  # compiled kernels can be kept nowhere
    refuse(error)

from pydantic_core import to_jsonable_python

import palpate
from palpate.base.checksum import checksum
from palpate.base.fingerprint import fingerprint
from palpate.base.yaml_file import read_yaml
from palpate.configuration.study_file import load_study, study_from
from palpate.data.study_recordings import (
    files_of,
    with_stiffness,
    written_by_workflow,
)
from palpate.workflow_support import console, job, manifest
from palpate.workflow_support.check_study import checked
from palpate.workflow_support.expected_time import job_seconds
from palpate.workflow_support.result_files import (
    read_json,
    refuse_altered,
)


@functools.cache
def read_study(file=None):
    """The study of this workflow, or that in a file, checked; a mistake ends the execution with one line."""
    try:
        if file:
            return checked(load_study(file, config.get("data")))
        given = [str(each) for each in workflow.configfiles]
        for each in given:
            # It refuses a key that is given twice, of which Snakemake keeps the last.
            read_yaml(each)
        name = given[-1] if given else job.CONFIGURATION
        values = job.plain(config)
        if "data" in config and given and not DEFAULT:
            values["data"] = config["data"]
        return checked(study_from(values, name))
    except InputError as error:
        refuse(error)


def code(script):
    """The identity of a script of this workflow, and of all that it imports."""
    return fingerprint(HERE / script)


def constant(value):
    """A parameter as it is, of settings their keys: in bare text Snakemake would take {braces} for wildcards."""
    given = to_jsonable_python(value)
    return lambda wildcards: given


def attempt(receipt):
    """A value that changes, so that the rule runs again, while runs on disk are not in MLflow yet."""
    if not Path(receipt).is_file():
        return "first"
    try:
        found = read_json(receipt)
    except PalpateError:
        return EXECUTION
    return EXECUTION if found["status"] == "pending" else found["attempt"]


def accepted(function, *arguments):
    """What a function returns; a mistake ends the execution with one line."""
    try:
        return function(*arguments)
    except InputError as error:
        refuse(error)


def curves(study, values, accuracy):
    """Role and address of the simulated curve of every condition, for the parameters `values`."""
    return [
        (
            condition.name,
            condition.role,
            store.address(study.specification(values, condition, accuracy)),
        )
        for condition in study.conditions
    ]


def choice():
    """The checksum of the law that recordings have chosen; none where the study states its law."""
    if not STUDY.family:
        return ""
    return checksum(Path(checkpoints.choose_law.get().output[0]))


@functools.cache
def with_choice(of):
    """The study with its law, as it is read once the choice of a checksum is in place."""
    return read_study.__wrapped__() if of else STUDY


@functools.cache
def planned(of):
    """The batches of snapshots by name, with the choice of a checksum."""
    return {batch.name: batch for batch in store.plan(with_choice(of))}


def chosen():
    """The study with its law."""
    return with_choice(choice())


def batches():
    """The batches of snapshots, by name."""
    return planned(choice())


def first_curves(wildcards):
    """Role and address of each condition's curve for the first material of the grid."""
    study = chosen()
    return curves(study, study.cells[0], None)


@functools.cache
def captions():
    """What each figure shows, by name: the first line of its file."""
    folder = Path(palpate.__file__).parent / "output/figures"
    texts = {
        file: file.read_text(encoding="utf-8") for file in sorted(folder.glob("*.py"))
    }
    return {
        re.search(r'PaperFigure\(\s*"(\w+)"', text)[1]: text.split("\n")[0].strip('"')
        for text in texts.values()
        if "\nFIGURE = " in text
    }


@functools.cache
def contents(name):
    """The checksum of a set of recordings, as a copy keeps the time of an old one; none of what the workflow writes."""
    if written_by_workflow(STUDY, name):
        return ""
    return checksum(*files_of(STUDY, name))


def evidence(*roles):
    """The content of the files of further evidence of some roles, of all by default, and how each is used."""
    return [
        [checksum(each.file), each.role, each.control]
        for each in STUDY.evidence
        if not roles or each.role in roles
    ]


def all_recordings(wildcards):
    """The files of all sets of recordings."""
    return [file for name in STUDY.recordings for file in files_of(STUDY, name)]


STUDY = read_study()
FOLDER = f"results/{STUDY.name}"
if workflow.is_main_process:
    try:
        refuse_altered(Path(FOLDER, "logs"), sys.argv[1:])
    except InputError as error:
        refuse(error)
    except OSError as error:
        refuse(of_system(error))
# Results that depend on a law that is chosen depend on this file.
LAW = [f"{FOLDER}/law.json"] if STUDY.family else []
CALIBRATED = [condition.name for condition in STUDY.calibrated]
OWN_LOADS = [condition.name for condition in STUDY.conditions if condition.own_loads]
if workflow.is_main_process:
    console.announce(
        console.Plan(
            Path(FOLDER),
            job_seconds(STUDY),
            workflow.resource_settings.cores or 1,
            lambda: set(workflow.dag_settings.targets) <= {"all"},
        )
    )
DIAGNOSED = list(STUDY.recordings) if STUDY.diagnosis.enabled else []
# Effects that studies on one instrument share, the file of their prior, and what this study finds of them.
SHARED = list(STUDY.instrument.shares) if STUDY.instrument else []
PRIOR = (
    [str(STUDY.instrument.file)] if STUDY.instrument and STUDY.instrument.file else []
)
INSTRUMENT = [f"{FOLDER}/instrument.json"] if SHARED and DIAGNOSED else []


wildcard_constraints:
    batch="[^/]+" if STUDY.family else "|".join(map(re.escape, planned(""))),
    recordings="|".join(map(re.escape, STUDY.recordings)) or "none",
    condition="|".join(map(re.escape, CALIBRATED)),
    condition_set="|".join(map(re.escape, STUDY.condition_sets)),
