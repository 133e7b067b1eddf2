# One calibration for each set of recordings and each set of conditions.
FURTHER = [name for name in STUDY.condition_sets if name != "all"]


rule calibration:
    input:
        law=LAW,
        recordings=lambda wildcards: files_of(STUDY, wildcards.recordings),
        surrogates=lambda wildcards: expand(
            f"{FOLDER}/surrogates/{{condition}}.npz",
            condition=STUDY.condition_sets[wildcards.condition_set],
        ),
        summaries=lambda wildcards: expand(
            f"{FOLDER}/surrogates/{{condition}}.json",
            condition=STUDY.condition_sets[wildcards.condition_set],
        ),
        evidence=[str(each.file) for each in STUDY.evidence],
    output:
        result=f"{FOLDER}/{{recordings}}/calibrations/{{condition_set}}.json",
        curves=f"{FOLDER}/{{recordings}}/calibrations/{{condition_set}}.curves.csv",
        record=f"{FOLDER}/tracking/{{recordings}}/calibrations/{{condition_set}}.json",
    log:
        f"{FOLDER}/logs/calibration/{{recordings}}/{{condition_set}}.log",
    benchmark:
        f"{FOLDER}/benchmarks/calibration/{{recordings}}/{{condition_set}}.tsv"
    wildcard_constraints:
        condition_set="|".join(map(re.escape, FURTHER)) or "(?!)",  # matches no text
    conda:
        "../../envs/palpate.yaml"
    resources:
        mem_mb=1500,
        runtime=240,
    params:
        recordings=lambda wildcards: contents(wildcards.recordings),
        settings=constant(STUDY.calibration),
        evidence=evidence(),
        seed=STUDY.seed,
        curves=first_curves,
        own_loads=OWN_LOADS,
        code=code("scripts/calibration.py"),
    message:
        "calibration of {wildcards.recordings} on the condition set {wildcards.condition_set}"
    script:
        "../../scripts/calibration.py"


# The diagnosis depends on this calibration alone, so it comes first.
use rule calibration as calibration_on_all with:
    wildcard_constraints:
        condition_set="all",
    priority: 1


rule main_calibration:
    input:
        f"{FOLDER}/{{recordings}}/calibrations/all.json",
    output:
        f"{FOLDER}/{{recordings}}/calibration.json",
    log:
        f"{FOLDER}/logs/main_calibration/{{recordings}}.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    message:
        "main calibration of {wildcards.recordings}"
    script:
        "../../scripts/main_calibration.py"
