# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blenders, one after the other, and cases rendered in them."""

import blenders
import pytest


@pytest.fixture(params=blenders.params(), scope="module")
def blender(request):
    return request.param


@pytest.fixture
def render(blender, tmp_path):
    return lambda case, **environment: blenders.run(blender, case, tmp_path, environment)
