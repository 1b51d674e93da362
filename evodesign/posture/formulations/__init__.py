"""Programs that are solved: who and what is a variable in each."""
