# Recordings that the workflow itself provides: the virtual laboratory's, and those converted from a vendor's file.
for laboratory, settings in STUDY.laboratory.items():

    rule:
        name:
            f"laboratory_{laboratory}"
        input:
            STUDY_FILE,
        output:
            directory(STUDY.recordings[laboratory]),
        log:
            f"{FOLDER}/logs/laboratory_{laboratory}.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            laboratory=laboratory,
            settings=settings,
            code=PHYSICS_CODE,
        script:
            "../../scripts/laboratory.py"


if STUDY.source:

    rule vendor_recordings:
        input:
            study=STUDY_FILE,
            vendor=STUDY.source["file"],
        output:
            directory(STUDY.recordings[STUDY.source["recordings"]]),
        log:
            f"{FOLDER}/logs/vendor_recordings.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            data=DATA,
        script:
            "../../scripts/vendor_recordings.py"
