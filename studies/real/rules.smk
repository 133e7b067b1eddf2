# Real recordings, read and diagnosed: snakemake --cores 2 real --config data=FOLDER, for every study in config/real.
REAL = [path.stem for path in sorted(HERE.glob("config/real/*.yaml"))]
OTHERS = [name for name in REAL if name != STUDY.name]  # it has rules of its own
NOTHING = "(?!)"  # matches no text


include: "functions.smk"


rule reading:
    input:
        study=f"{HERE}/config/real/{{real}}.yaml",
        recordings=vendor_file,
    output:
        page="results/{real}/reading/reading.html",
        table="results/{real}/reading/survey.csv",
    log:
        "results/{real}/logs/reading.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        data=config.get("data"),
        code=code("studies/real/scripts/reading.py"),
    script:
        "scripts/reading.py"


rule real_study:
    input:
        study=f"{HERE}/config/real/{{real}}.yaml",
        recordings=vendor_file,
    output:
        result="results/{real}/{recordings}/diagnosis.json",
        curves="results/{real}/{recordings}/diagnosis.curves.csv",
        figures=directory("results/{real}/{recordings}/figures"),
    log:
        "results/{real}/logs/real_study_{recordings}.log",
    wildcard_constraints:
        real="|".join(OTHERS) or NOTHING,
        recordings="[^/]+",
    conda:
        "../../envs/palpate.yaml"
    params:
        data=config.get("data"),
        code=code("studies/real/scripts/real_study.py"),
    script:
        "scripts/real_study.py"


rule real:
    input:
        expand("results/{real}/reading/reading.html", real=REAL),
        real_diagnoses,
