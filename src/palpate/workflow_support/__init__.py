"""What the workflow's scripts share: steps between files, tracking, and how a job ends."""
