# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blenders, one after the other, and cases rendered in them."""

import functools

import blenders
import pytest


@pytest.fixture(params=blenders.params(), scope="module")
def blender(request):
    return request.param


@pytest.fixture(scope="module")
def render(blender, tmp_path_factory):
    """render(case): its Shot, which several tests of a file may look at."""
    @functools.cache
    def render(case, **environment):
        return blenders.run(blender, case, tmp_path_factory.mktemp(case), environment)
    return render
