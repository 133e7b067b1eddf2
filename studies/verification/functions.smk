# What the rules of the verification take from the command line.
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
