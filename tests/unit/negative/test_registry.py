"""A method is one file: what it registers can be configured, runs and is published."""

from pkgutil import iter_modules

import pytest

from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.services.negative import methods
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.negative.scans import negative_scans


def test_each_file_is_a_method_of_its_name():
    assert sorted(METHODS) == sorted(module.name for module in iter_modules(methods.__path__))


@pytest.mark.parametrize("name", METHODS)
def test_a_method_can_be_configured_and_makes_a_scan(name):
    config = NegativeConfig(methods=(name,))
    assert set(METHODS[name].settings.model_fields) <= set(NegativeConfig.model_fields)
    assert list(negative_scans(WARMUP_IMAGE, config).by_method) == [name]
