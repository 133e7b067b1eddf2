# One job for each batch: its curves go to the store, its table lists their addresses and those that failed.
rule snapshots:
    output:
        f"{FOLDER}/snapshots/{{batch}}.csv",
    log:
        f"{FOLDER}/logs/snapshots/{{batch}}.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        curves=lambda wildcards: BATCHES[wildcards.batch].identity,
    message:
        f"snapshots {{wildcards.batch}}, one of {len(BATCHES)} batches"
    script:
        "../../scripts/snapshots.py"


rule snapshot_index:
    input:
        expand(f"{FOLDER}/snapshots/{{batch}}.csv", batch=BATCHES),
    output:
        f"{FOLDER}/snapshots.csv",
    log:
        f"{FOLDER}/logs/snapshot_index.log",
    conda:
        "../../envs/palpate.yaml"
    message:
        "table of all snapshots"
    script:
        "../../scripts/snapshot_index.py"
