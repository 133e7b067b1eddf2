# Recordings that the workflow itself provides: the virtual laboratory's, and those converted from a vendor's file.
for laboratory, settings in STUDY.laboratory.items():

    rule:
        name:
            f"laboratory_{laboratory}"
        output:
            directory(STUDY.recordings[laboratory]),
        log:
            f"{FOLDER}/logs/laboratory_{laboratory}.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            study=STUDY_FILE,
            data=DATA,
            laboratory=laboratory,
            settings=settings,
            curves=curves(settings["parameters"], "fine"),
            code=code("scripts/laboratory.py"),
        script:
            "../../scripts/laboratory.py"


if STUDY.source:

    rule vendor_recordings:
        input:
            STUDY.source["file"],
        output:
            directory(STUDY.recordings[STUDY.source["recordings"]]),
        log:
            f"{FOLDER}/logs/vendor_recordings.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            study=STUDY_FILE,
            data=DATA,
            source={key: STUDY.source[key] for key in STUDY.source if key != "file"},
            code=code("scripts/vendor_recordings.py"),
        script:
            "../../scripts/vendor_recordings.py"
