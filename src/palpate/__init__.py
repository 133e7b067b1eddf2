"""palpate: the law of a material from instrumented indentation, and the physics that a model left out."""

__version__ = "0.1.0"

from palpate.base import kernel_cache

kernel_cache.choose()
