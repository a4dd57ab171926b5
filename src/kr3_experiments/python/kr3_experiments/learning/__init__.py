"""The training phase: trials with ground truth, their counts and posteriors, and the models file they make."""
