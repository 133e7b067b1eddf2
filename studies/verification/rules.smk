# The solver's verification, apart from any study: snakemake --cores 1 verification [--config quick=1 reference=FOLDER]
def quick():
    """Whether the verification leaves out what takes long."""
    try:
        return job.boolean("quick", config.get("quick"))
    except InputError as error:
        refuse(error)


def reference_curves(wildcards):
    """The files of the folder of reference curves, where one is given."""
    folder = config.get("reference")
    if folder and not Path(folder).is_dir():
        remedy = "give a folder of curves"
        refuse(InputError("the folder is missing", remedy=remedy, file=folder))
    return sorted(map(str, Path(folder).glob("*.csv"))) if folder else []


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
