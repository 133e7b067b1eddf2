# Recordings that the workflow itself provides: the virtual laboratory's, and those converted from a vendor's file.
for laboratory, settings in STUDY.laboratory.items():

    rule:
        name:
            f"laboratory_{laboratory}"
        output:
            files_of(STUDY, laboratory),
        log:
            f"{FOLDER}/logs/laboratory/{laboratory}.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            laboratory=laboratory,
            settings=constant(settings),
            curves=curves(STUDY, settings.parameters, "fine"),
            code=code("scripts/laboratory.py"),
        message:
            f"recordings of the virtual laboratory {laboratory}"
        script:
            "../../scripts/laboratory.py"


if STUDY.source:

    rule vendor_recordings:
        input:
            with_stiffness(Path(STUDY.source["file"])),
        output:
            files_of(STUDY, STUDY.source["recordings"]),
        log:
            f"{FOLDER}/logs/vendor_recordings.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            source=constant(
                {key: STUDY.source[key] for key in STUDY.source if key != "file"}
            ),
            content=checksum(*with_stiffness(Path(STUDY.source["file"]))),
            code=code("scripts/vendor_recordings.py"),
        message:
            "recordings from the vendor's file"
        script:
            "../../scripts/vendor_recordings.py"
