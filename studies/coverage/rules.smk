# How often intervals hold the truth, in closed form: snakemake --cores 2 coverage
from studies.coverage import COUNT, GROUP

COVERAGE = "results/coverage"


rule coverage:
    input:
        f"{COVERAGE}/summary.csv",


rule coverage_structure:
    output:
        structures=f"{COVERAGE}/structures.csv",
        moduli=f"{COVERAGE}/moduli.csv",
    log:
        f"{COVERAGE}/logs/structure.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/coverage/scripts/structure.py"),
    script:
        "scripts/structure.py"


rule coverage_truth:
    output:
        f"{COVERAGE}/sealed/{{group}}.json",
    log:
        f"{COVERAGE}/logs/{{group}}_truth.log",
    wildcard_constraints:
        group=r"\d+",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/coverage/scripts/seal.py"),
    script:
        "scripts/seal.py"


rule coverage_fits:
    input:
        f"{COVERAGE}/sealed/{{group}}.json",
    output:
        f"{COVERAGE}/fits/{{group}}.json",
    log:
        f"{COVERAGE}/logs/{{group}}_fits.log",
    wildcard_constraints:
        group=r"\d+",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/coverage/scripts/fits.py"),
    script:
        "scripts/fits.py"


rule coverage_summary:
    input:
        truths=expand(f"{COVERAGE}/sealed/{{group}}.json", group=range(COUNT // GROUP)),
        fits=expand(f"{COVERAGE}/fits/{{group}}.json", group=range(COUNT // GROUP)),
    output:
        summary=f"{COVERAGE}/summary.csv",
        sets=f"{COVERAGE}/sets.csv",
        law_errors=f"{COVERAGE}/law_errors.csv",
    log:
        f"{COVERAGE}/logs/summary.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/coverage/scripts/summary.py"),
    script:
        "scripts/summary.py"
