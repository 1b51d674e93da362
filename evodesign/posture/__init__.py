"""The inner problems: postures and reach, solved and checked."""
