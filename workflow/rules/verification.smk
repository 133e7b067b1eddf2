# The solver's verification, apart from any study: snakemake --cores 1 verification [--config quick=1 reference=FOLDER]
rule verification:
    input:
        reference_curves,
    output:
        report="results/verification/report.html",
        result="results/verification/verification.json",
    log:
        "results/verification/verification.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        quick=config.get("quick"),
        reference=config.get("reference"),
        code=code("scripts/verification.py"),
    message:
        "verification of the solver"
    script:
        "../../scripts/verification.py"
