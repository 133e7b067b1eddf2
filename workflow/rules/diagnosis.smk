# The diagnosis of each set of recordings; its search begins where calibration ended.
rule diagnosis:
    input:
        law=LAW,
        recordings=lambda wildcards: files_of(STUDY, wildcards.recordings),
        calibration=f"{FOLDER}/{{recordings}}/calibration.json",
        evidence=[str(each.file) for each in STUDY.evidence if each.role == "calibrate"],
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
        evidence=evidence("calibrate"),
        seed=STUDY.seed,
        curves=first_curves,
        own_loads=OWN_LOADS,
        code=code("scripts/diagnosis.py"),
    message:
        "diagnosis of {wildcards.recordings}"
    script:
        "../../scripts/diagnosis.py"
