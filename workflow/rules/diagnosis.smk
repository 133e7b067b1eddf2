# The diagnosis of each set of recordings; its search begins where calibration ended.
rule diagnosis:
    input:
        law=LAW,
        recordings=lambda wildcards: files_of(STUDY, wildcards.recordings),
        calibration=f"{FOLDER}/{{recordings}}/calibration.json",
        evidence=[str(each.file) for each in STUDY.evidence if each.role == "calibrate"],
        prior=PRIOR,
    output:
        result=f"{FOLDER}/{{recordings}}/diagnosis.json",
        curves=f"{FOLDER}/{{recordings}}/diagnosis.curves.csv",
        record=f"{FOLDER}/tracking/{{recordings}}/diagnosis.json",
    log:
        f"{FOLDER}/logs/diagnosis/{{recordings}}.log",
    benchmark:
        f"{FOLDER}/benchmarks/diagnosis/{{recordings}}.tsv"
    conda:
        "../../envs/palpate.yaml"
    threads: 2
    resources:
        mem_mb=3000,
        runtime=720,
    params:
        recordings=lambda wildcards: contents(wildcards.recordings),
        settings=constant([STUDY.diagnosis, STUDY.calibration]),
        instrument=constant([SHARED, *map(checksum, map(Path, PRIOR))]),
        evidence=evidence("calibrate"),
        seed=STUDY.seed,
        curves=first_curves,
        own_loads=OWN_LOADS,
        code=code("scripts/diagnosis.py"),
    message:
        "diagnosis of {wildcards.recordings}"
    script:
        "../../scripts/diagnosis.py"


# What the diagnosis found of effects that other studies share.
rule instrument:
    input:
        diagnosis=expand(f"{FOLDER}/{{name}}/diagnosis.json", name=DIAGNOSED),
        recordings=all_recordings,
        prior=PRIOR,
    output:
        f"{FOLDER}/instrument.json",
    log:
        f"{FOLDER}/logs/instrument.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("scripts/instrument.py"),
    message:
        "what the study tells of its instrument"
    script:
        "../../scripts/instrument.py"
