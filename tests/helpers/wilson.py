"""The interval of a proportion."""

import numpy as np


def wilson(count, total, quantile=1.96):
    """Return the 95 % interval of E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209-212."""
    share, more = count / total, quantile**2 / total
    half = quantile * np.sqrt(share * (1.0 - share) / total + more / (4.0 * total))
    middle = share + more / 2.0
    return (middle - half) / (1.0 + more), (middle + half) / (1.0 + more)
