# Every study of the thesis, from its curves to one page of verdicts: snakemake --cores 2 thesis
from studies.thesis import DESIGNS, STUDIES
from studies.thesis.libraries import with_libraries

THESIS = "results/thesis"
MATERIALS = {name: f"config/thesis/{name}.yaml" for name in ("aluminium", "epoxy")}


rule thesis:
    input:
        f"{THESIS}/index.html",
        f"{THESIS}/tracking/receipt.json",


rule thesis_recordings:
    input:
        "config/thesis/{material}.yaml",
    output:
        directory(f"{THESIS}/recordings/{{material}}"),
    log:
        f"{THESIS}/logs/recordings_{{material}}.log",
    wildcard_constraints:
        material="|".join(MATERIALS),
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/thesis/scripts/recordings.py"),
    script:
        "scripts/recordings.py"


rule thesis_design:
    input:
        outcomes=lambda wildcards: expand(
            f"{THESIS}/{{study}}.json", study=DESIGNS[wildcards.design].after
        ),
        studies=lambda wildcards: accepted(
            with_libraries,
            DESIGNS[wildcards.design].libraries,
            [MATERIALS[DESIGNS[wildcards.design].material]],
        ),
    output:
        f"{THESIS}/designs/{{design}}.npz",
    log:
        f"{THESIS}/logs/design_{{design}}.log",
    wildcard_constraints:
        design="|".join(map(re.escape, DESIGNS)),
    conda:
        "../../envs/studies.yaml"
    params:
        code=lambda wildcards: fingerprint(
            "palpate.solver.simulation", DESIGNS[wildcards.design].module
        ),
    script:
        "scripts/design.py"


rule thesis_study:
    input:
        designs=lambda wildcards: expand(
            f"{THESIS}/designs/{{design}}.npz", design=STUDIES[wildcards.key].designs
        ),
        recordings=lambda wildcards: expand(
            f"{THESIS}/recordings/{{material}}",
            material=STUDIES[wildcards.key].recordings,
        ),
        studies=lambda wildcards: accepted(
            with_libraries,
            STUDIES[wildcards.key].libraries,
            sorted(
                {
                    MATERIALS[DESIGNS[name].material]
                    for name in STUDIES[wildcards.key].designs
                }
            ),
        ),
    output:
        outcome=f"{THESIS}/{{key}}.json",
        fitted=directory(f"{THESIS}/fitted/{{key}}"),
        record=f"{THESIS}/tracking/{{key}}.json",
    log:
        f"{THESIS}/logs/{{key}}.log",
    wildcard_constraints:
        key="|".join(STUDIES),
    conda:
        "../../envs/studies.yaml"
    params:
        code=lambda wildcards: fingerprint(f"studies.thesis.{wildcards.key}"),
    script:
        "scripts/study.py"


rule thesis_tracking:
    input:
        expand(f"{THESIS}/tracking/{{key}}.json", key=STUDIES),
    output:
        f"{THESIS}/tracking/receipt.json",
    log:
        f"{THESIS}/logs/tracking.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        attempt=attempt(f"{THESIS}/tracking/receipt.json"),
    script:
        "../../scripts/tracking.py"


rule thesis_figure:
    input:
        f"{THESIS}/{{key}}.json",
    output:
        multiext(f"{THESIS}/figures/{{key}}", ".svg", ".pdf", ".csv", ".txt"),
    log:
        f"{THESIS}/logs/figure_{{key}}.log",
    wildcard_constraints:
        key="|".join(STUDIES),
    conda:
        "../../envs/palpate.yaml"
    params:
        code=lambda wildcards: fingerprint(f"studies.thesis.figures.{wildcards.key}"),
    script:
        "scripts/figure.py"


rule thesis_index:
    input:
        outcomes=expand(f"{THESIS}/{{key}}.json", key=STUDIES),
        figures=expand(f"{THESIS}/figures/{{key}}.svg", key=STUDIES),
        designs=expand(f"{THESIS}/designs/{{design}}.npz", design=DESIGNS),
    output:
        f"{THESIS}/index.html",
    log:
        f"{THESIS}/logs/index.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/thesis/scripts/index.py"),
    script:
        "scripts/index.py"
