import pkgutil
import subprocess
import sys

import pytest

from evodesign.errors import InputError
from evodesign.records import SearchSettings
from evodesign.searches.registry import SEARCHES, make_search


def settings(**changes):
    values = {"algorithm": "nsga2", "dimension": 2, "objectives": 1, "population": 4, "seed": 0}
    return SearchSettings(**(values | changes))


@pytest.mark.parametrize("name", SEARCHES)
def test_makes_what_it_names(name):
    assert isinstance(make_search(settings(algorithm=name)), pkgutil.resolve_name(SEARCHES[name]))


def test_an_unknown_algorithm_is_refused_with_the_nearest_name():
    with pytest.raises(InputError) as caught:
        make_search(settings(algorithm="nsga-ii"))
    assert str(caught.value) == (
        "search: algorithm: wanted one of cma-es, joint-starts, map-elites, nsga2, random, surrogate, "
        "found 'nsga-ii'; "
        "did you mean 'nsga2'?"
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"dimension": 0}, "dimension: wanted at least 1, found 0"),
        ({"objectives": 0}, "objectives: wanted at least 1, found 0"),
        ({"population": 0}, "population: wanted at least 1, found 0"),
        ({"seed": -1}, "seed: wanted at least 0, found -1"),
        ({"start": ((0.5, 0.5), (0.5,))}, r"start\[1\]: wanted 2 coordinates, found 1"),
        ({"start": ((0.5, 1.5),)}, r"start\[0\]: wanted coordinates in \[0, 1\], found 1.5"),
        ({"start": ((float("nan"), 0.5),)}, r"start\[0\]: wanted coordinates in \[0, 1\], found nan"),
    ],
)
def test_settings_that_no_search_can_use_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        make_search(settings(**changes))


def test_a_search_is_used_without_robots():
    script = (
        "import sys\n"
        "import evodesign.searches.registry\n"
        "print([name for name in ('casadi', 'pinocchio') if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"
