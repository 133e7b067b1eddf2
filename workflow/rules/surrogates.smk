# One surrogate for each condition.
rule surrogate:
    input:
        law=LAW,
        snapshots=lambda wildcards: [
            f"{FOLDER}/snapshots/{name}.parquet"
            for name, batch in batches().items()
            if wildcards.condition
            in [condition.name for condition in batch.conditions]
        ],
    output:
        model=f"{FOLDER}/surrogates/{{condition}}.npz",
        summary=f"{FOLDER}/surrogates/{{condition}}.json",
        record=f"{FOLDER}/tracking/surrogates/{{condition}}.json",
    log:
        f"{FOLDER}/logs/surrogates/{{condition}}.log",
    benchmark:
        f"{FOLDER}/benchmarks/surrogates/{{condition}}.tsv"
    conda:
        "../../envs/palpate.yaml"
    resources:
        mem_mb=1000,
        runtime=60,
    params:
        settings=constant(STUDY.surrogate),
        levels=lambda wildcards: chosen().levels,
        code=code("scripts/surrogate.py"),
    message:
        "surrogate of {wildcards.condition}"
    script:
        "../../scripts/surrogate.py"
