"""A text export of Anton Paar with one test."""


def single(values):
    head = ["", "", "Indentation", "", "   EIT=\t2,5 GPa", "Time (s)\tPd (nm)\tFn (mN)"]
    return "\n".join([*head, *("\t".join(f"{x:.6f}".replace(".", ",") for x in row) for row in values[:, [0, 3, 1]])])
