"""Where evaluations run; pools know no robots."""
