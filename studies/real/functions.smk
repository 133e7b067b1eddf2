# What the rules of the real studies read, when it is asked for.
def vendor_file(wildcards):
    """The file behind a study of config/real, which is checked first."""
    return read_study(f"{HERE}/config/real/{wildcards.real}.yaml").source["file"]


def real_diagnoses(wildcards):
    """The diagnoses of all studies in config/real, which are read when they are asked for."""
    for name in REAL:
        source = read_yaml(f"{HERE}/config/real/{name}.yaml")["source"]
        yield f"results/{name}/{source['recordings']}/diagnosis.json"
