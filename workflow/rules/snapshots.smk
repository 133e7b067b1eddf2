# One rule a batch: every snapshot is a declared output, named by the hash of what decides it.
for number, batch in enumerate(BATCHES):

    rule:
        name:
            f"snapshots_{batch.name}"
        output:
            batch.files,
        log:
            f"{FOLDER}/logs/snapshots/{batch.name}.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            study=STUDY_FILE,
            data=DATA,
            batch=batch.name,
        message:
            f"snapshots {batch.name}: {len(batch.files)} snapshots, batch {number + 1} of {len(BATCHES)}"
        script:
            "../../scripts/snapshots.py"


rule snapshot_index:
    input:
        [file for batch in BATCHES for file in batch.files],
    output:
        f"{FOLDER}/snapshots.csv",
    log:
        f"{FOLDER}/logs/snapshot_index.log",
    conda:
        "../../envs/palpate.yaml"
    script:
        "../../scripts/snapshot_index.py"
