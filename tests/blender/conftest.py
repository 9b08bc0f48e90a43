# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blenders, one after the other, and cases rendered in them."""

import functools

import blenders
import pytest


@pytest.fixture(params=blenders.params(), scope="module")
def blender(request):
    return request.param


@pytest.fixture(scope="module")
def running(blender):
    """One Blender for all cases of a file."""
    running = blenders.Running(blender)
    yield running.run
    running.stop()


@pytest.fixture(scope="module")
def render(blender, running, tmp_path_factory):
    """render(case): its Shot, which several tests of a file may look at. With `alone`, or more environment variables,
    in a Blender of its own."""
    @functools.cache
    def render(case, alone=False, **environment):
        folder = tmp_path_factory.mktemp(case)
        return blenders.run(blender, case, folder, environment) if alone or environment else running(case, folder)
    return render
