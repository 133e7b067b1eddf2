# The solver's verification, apart from any study: snakemake --cores 1 verification [--config quick=1 reference=FOLDER]
def reference_curves(wildcards):
    """The files of the folder of reference curves, where one is given."""
    folder = config.get("reference")
    if folder and not Path(folder).is_dir():
        remedy = "give a folder of curves"
        refuse(InputError("the folder is missing", remedy=remedy, file=folder))
    return sorted(map(str, Path(folder).glob("*.csv"))) if folder else []


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
