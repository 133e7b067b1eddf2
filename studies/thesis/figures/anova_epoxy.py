"""Analysis of variance of chapter 5: contributions beside the thesis', and main effects."""

from studies.thesis.figures.effects import analysis_of_variance
from studies.thesis.figures.estimates import EPOXY

FIGURE = analysis_of_variance("anova_epoxy", "Epoxy, L27, 1 mN in 30 s", EPOXY, "nm²")
