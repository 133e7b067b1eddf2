# One job for each batch: its file holds its curves. The store, a cache of all studies, keeps them one by one as well.
rule snapshots:
    input:
        LAW,
    output:
        f"{FOLDER}/snapshots/{{batch}}.parquet",
    log:
        f"{FOLDER}/logs/snapshots/{{batch}}.log",
    benchmark:
        f"{FOLDER}/benchmarks/snapshots/{{batch}}.tsv"
    conda:
        "../../envs/palpate.yaml"
    resources:
        mem_mb=1000,
        runtime=60,
    params:
        curves=lambda wildcards: batches()[wildcards.batch].identity,
    message:
        "snapshots {wildcards.batch}"
        + ("" if STUDY.family else f", one of {len(planned(''))} batches")
    script:
        "../../scripts/snapshots.py"


rule snapshot_index:
    input:
        lambda wildcards: expand(
            f"{FOLDER}/snapshots/{{batch}}.parquet", batch=batches()
        ),
    output:
        f"{FOLDER}/snapshots.csv",
    log:
        f"{FOLDER}/logs/snapshot_index.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    message:
        "table of all snapshots"
    script:
        "../../scripts/snapshot_index.py"
