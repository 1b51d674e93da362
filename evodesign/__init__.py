"""Humanoid robots designed by evolution, so that robot and person lifting together both strain less."""

from importlib.metadata import version

__version__ = version("evodesign")
__all__ = ["__version__"]
