"""Subcommands of ``palpate``, one a file: each defines NAME, HELP, ``add_arguments(parser)`` and ``run(arguments)``."""
