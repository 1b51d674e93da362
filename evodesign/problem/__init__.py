"""From a problem file to a problem; objectives; the assessment of one design."""
