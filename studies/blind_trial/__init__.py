"""A blind trial of the diagnosis: recordings with concealed effects, and the rule that scores the answers."""
