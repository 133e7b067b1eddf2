# A study from its configuration to its report: snakemake --cores 2 [--configfile STUDY.yaml]

# The keys of the default study are not mixed into those of a file that is given.
FILES = workflow.overwrite_configfiles if workflow.modifier.is_main_snakefile() else []
DEFAULT = "study" not in config and not FILES
if DEFAULT:

    configfile: f"{workflow.basedir}/config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/recordings.smk"
include: "workflow/rules/law.smk"
include: "workflow/rules/snapshots.smk"
include: "workflow/rules/surrogates.smk"
include: "workflow/rules/calibration.smk"
include: "workflow/rules/diagnosis.smk"
include: "workflow/rules/report.smk"


for rules in sorted(HERE.glob("studies/*/rules.smk")):

    include: str(rules)


rule all:
    default_target: True
    input:
        RESULTS,
        RECORDS,
        all_recordings,
        f"{FOLDER}/report.html",
        f"{FOLDER}/tracking/receipt.json",
    message:
        f"done: {FOLDER}/report.html"
