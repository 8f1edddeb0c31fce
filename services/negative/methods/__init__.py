"""The methods, one file each; a file that is added here is a method that can be configured."""

from importlib import import_module
from pkgutil import iter_modules

from cliffscan.services.negative.registry import METHODS

__all__ = ["METHODS"]

for module in iter_modules(__path__):
    import_module(f"{__name__}.{module.name}")
