# Where a study leaves its law to the recordings: what depends on the law is planned once it is chosen.
if STUDY.family:
    JUDGE = next(iter(STUDY.recordings))  # the set by which the law is chosen

    checkpoint choose_law:
        input:
            files_of(STUDY, JUDGE),
        output:
            law=f"{FOLDER}/law.json",
            record=f"{FOLDER}/tracking/law.json",
        log:
            f"{FOLDER}/logs/choose_law.log",
        benchmark:
            f"{FOLDER}/benchmarks/choose_law.tsv"
        conda:
            "../../envs/palpate.yaml"
        resources:
            mem_mb=1500,
            runtime=240,
        params:
            recordings=contents(JUDGE),
            family=STUDY.family,
            fixed=constant(dict(STUDY.fixed)),
            settings=constant(STUDY.calibration),
            tests=curves(replace(STUDY, model="elastic"), {"youngs_modulus": 1.0}, None),
            seed=STUDY.seed,
            code=code("scripts/choose_law.py"),
        message:
            f"choice of the law of {{params.family}} by {JUDGE}"
        script:
            "../../scripts/choose_law.py"
