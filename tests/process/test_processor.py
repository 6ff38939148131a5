"""Levels of x86-64 by the abilities that Linux lists."""

import pytest

from neurotouch_hid.process.processor import find_levels, read_abilities

# What Linux says of an AMD EPYC, without what no level needs.
BOTH = (
    "cpu:type:x86,ven0002fam001Amod0002:feature:,0080,0089,008C,008D,0093,0094,0096,0097,009A"
    ",009C,009D,00C0,00C5,0123,0125,0128\n"
)


def test_a_processor_has_every_level_up_to_its_own():
    assert find_levels(BOTH) == ["x86-64-v3", "x86-64-v2"]


@pytest.mark.parametrize("ability", ["008C", "0096", "009A", "009C", "009D", "00C5", "0123"])
def test_without_one_ability_it_lacks_that_level(ability):
    assert find_levels(BOTH.replace(f",{ability}", "")) == ["x86-64-v2"]


@pytest.mark.parametrize("ability", ["0080", "0089", "008D", "0093", "0094", "0097", "00C0"])
def test_without_an_older_ability_it_has_none(ability):
    assert find_levels(BOTH.replace(f",{ability}", "")) == []


@pytest.mark.parametrize("abilities", ["", BOTH.replace("x86,", "aarch64,")])
def test_others_have_none(abilities):
    assert find_levels(abilities) == []


def test_linux_tells_which_processor_this_is():
    assert read_abilities().startswith("cpu:type:")
