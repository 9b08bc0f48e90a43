# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that several processes or machines share.

In: a folder that all of them see. Out: each frame drawn by one of them.

workplace is a process's own folder there: it keeps what is half made and who has claimed what; lease says until when,
and who is dead. serve keeps one Blender for frames that are asked for later, crew lets several of these share frames;
jobs has several processes draw a sequence again.
"""
