# SPDX-License-Identifier: GPL-3.0-or-later
"""What every panel has in common."""

from .. import ENGINE
from ..languages import CONTEXT


class EncrePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_translation_context = CONTEXT
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class SidebarPanel:
    """In the sidebar of the 3D view."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Encre"
    bl_translation_context = CONTEXT

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE
