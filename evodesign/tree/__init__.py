"""Links, joints and the trees they form; URDF; the generated person."""
