# The solver's verification, apart from any study: snakemake --cores 1 verification [--config quick=1 reference=FOLDER]


include: "functions.smk"


rule verification:
    input:
        report="results/verification/report.html",
        result="results/verification/verification.json",
    log:
        "results/verification/checks.log",
    conda:
        "../../envs/palpate.yaml"
    message:
        "checks of the solver"
    script:
        "scripts/checks.py"


# A rule of its own: Snakemake removes the output of a rule that fails, and failed checks are in this report.
rule verification_report:
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
        quick=quick(),
        reference=config.get("reference"),
        code=code("studies/verification/scripts/report.py"),
    message:
        "verification of the solver"
    script:
        "scripts/report.py"
