# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre submit`: a scene's frames as a job of a farm's own system.

In: a scene, its frames and options. Out: files of a job, in a folder or handed over. submit takes the command, systems
writes the files of each system, mapping reads the rules by which a farm says where files lie on other machines.

To add a system: a function in systems, and its row in systems.FARMS.
"""
