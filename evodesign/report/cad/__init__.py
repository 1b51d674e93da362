"""A design as CAD files: STEP and STL of its links, an assembly, a comparison with the URDF, a drawing."""
