# SPDX-License-Identifier: GPL-3.0-or-later
"""What is pressed in a window while something is under way."""


class Listener:
    """A modal operator that hears every event of its window, ten times a second at least, until `over()`."""

    def invoke(self, context, _event):
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        keeps = self.hears(context, event)
        if self.over():
            context.window_manager.event_timer_remove(self.timer)
            return {"CANCELLED", "PASS_THROUGH"}
        return {"RUNNING_MODAL" if keeps else "PASS_THROUGH"}

    def hears(self, context, event) -> bool:
        """Whether nobody else is to have the event."""
        raise NotImplementedError

    def over(self) -> bool:
        raise NotImplementedError
