"""Analysis of variance of chapter 4: contributions beside the thesis', and main effects."""

from studies.thesis.figures.effects import analysis_of_variance
from studies.thesis.figures.estimates import ALUMINIUM

FIGURE = analysis_of_variance("anova_aluminium", "Aluminium, modified L16", ALUMINIUM, "-")
