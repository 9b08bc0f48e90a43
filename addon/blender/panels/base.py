# SPDX-License-Identifier: GPL-3.0-or-later
"""What every panel has in common."""

from .. import ENGINE


class EncrePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class SidebarPanel:
    """In the sidebar of the 3D view."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Encre"

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE
