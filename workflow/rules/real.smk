# Real recordings as they were read: snakemake --cores 2 real --config data=FOLDER, for every study in config/real.
REAL = [path.stem for path in sorted(Path(workflow.basedir).glob("config/real/*.yaml"))]


rule reading:
    input:
        study=f"{workflow.basedir}/config/real/{{real}}.yaml",
    output:
        page="results/{real}/reading/reading.html",
        table="results/{real}/reading/survey.csv",
    log:
        "results/{real}/logs/reading.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        data=config.get("data"),
        code=READING_CODE,
    script:
        "../../scripts/reading.py"


rule real:
    input:
        expand("results/{real}/reading/reading.html", real=REAL),
